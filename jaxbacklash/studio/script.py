"""The Python that repeats the work: reads the same file in the same way and fits the models that led to the one looked at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import Any

from ..records.options import ReadOptions
from .choice import Choice
from .tree import Model
from .work import Setup

HEAD = '''"""Repeats what was found at the page of ``jaxbacklash studio``. Begin it in the folder of the record."""

import jaxbacklash as jb

jb.start()
'''


def script(choice: Choice, heldout: Choice | None, setup: Setup, path: Sequence[Model], *, model_file: str = "model.toml") -> str:
    """The text of a program.

    Parameters
    ----------
    choice, heldout : how the record and the held-out one are read; None: there is none
    setup : what every fit begins with
    path : the models from the first to the one looked at
    model_file : where the program writes that model

    Returns
    -------
    Python, which prints the error of every model beside what the page has shown

    Examples
    --------
    >>> from jaxbacklash.studio.choice import Choice
    >>> from jaxbacklash.studio.work import Setup
    >>> print(script(Choice("run1.csv"), None, Setup(inertia=3.16), []))
    \"""Repeats what was found at the page of ``jaxbacklash studio``. Begin it in the folder of the record.\"""
    ...
    record = jb.read_record('run1.csv')
    ...
    """
    lines = [HEAD, f"record = {_read(choice)}"]
    if heldout is not None:
        lines.append(f"heldout = {_read(heldout)}")
    held = ", heldout=heldout" if heldout is not None else ""
    how = "".join(f", {name}={value!r}" for name, value in setup.words().items())
    for model in path:
        lines += ["", f"# {model.name}: at the page {_errors(model)}"]
        effects = f", effects={list(model.effects)!r}" if model.effects else ""
        lines.append(f"fit = jb.fit(record{held}{effects}{how})")
        lines.append(f'print("{model.name}:", "error over the noise", fit.score.rms{_and_held(held)})')
    if path:
        lines += [
            "",
            "print(fit)",
            "print(jb.where_it_fails(fit))",
            "print(jb.rank_effects(fit))",
            "",
            f'with open({model_file!r}, "w", encoding="utf-8") as file:',
            "    file.write(jb.dump_model("
            "fit.system, translational=fit.translational, per_inertia=fit.per_inertia, known_noise=fit.known_noise))",
        ]
    return "\n".join(lines) + "\n"


def _and_held(held: str) -> str:
    return ', "held out", fit.heldout.rms' if held else ""


def _errors(model: Model) -> str:
    held = "" if model.heldout_rms is None else f", on the held-out record {model.heldout_rms:.6g}"
    return f"the error over the noise was {model.rms:.6g}{held}"


def _read(choice: Choice) -> str:
    words = [repr(choice.name), *(f"{name}={_literal(value)}" for name, value in said(choice.options).items())]
    return f"jb.read_record({', '.join(words)})"


def said(options: ReadOptions) -> dict[str, Any]:
    """The options that are not as they are by default, as `jaxbacklash.read_record` calls them."""
    usual = ReadOptions()
    given = {one.name: getattr(options, one.name) for one in fields(ReadOptions)}
    return {name: value for name, value in given.items() if value != getattr(usual, name)}


def _literal(value: Any) -> str:
    return repr(sorted(value)) if isinstance(value, frozenset) else repr(dict(value)) if hasattr(value, "items") else repr(value)
