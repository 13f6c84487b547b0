"""What is kept of the work: the model, the report of the way to it, the result as JSON, and the Python that repeats it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import jaxbacklash as jb

from ..errors import BadInput
from ..plot.drawing import svg_of
from ..report.diagnose_report import failure_panels
from ..report.fit_report import pictures, series
from ..report.html import Panel, write_report
from ..report.refine_report import ranking_panel
from ..report.refine_result import candidates_json
from ..report.result import as_json, stage
from ..whole_file import write_whole
from .figures import SCALE
from .tree import Model

FILES = ("result.json", "model.toml", "report.html", "repeat.py")


def save(folder: Path, path: Sequence[Model], python: str) -> list[str]:
    """Write everything about the last of these models into a folder.

    Parameters
    ----------
    folder : a new one, or an empty one
    path : the models that led to it, the first one first
    python : the program that repeats the way

    Returns
    -------
    names of the files

    Raises
    ------
    BadInput
        The folder cannot be written.
    """
    last = path[-1]
    result = told(path)
    heading = f"{last.fit.records[0].summary()}\n{result['verdict_text']}"
    fit = last.fit
    model = jb.dump_model(
        fit.system, translational=fit.translational, per_inertia=fit.per_inertia, known_noise=fit.known_noise, heading=heading
    )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        write_whole(folder / "result.json", json.dumps(result, indent=2, allow_nan=False) + "\n")
        write_whole(folder / "model.toml", model)
        write_whole(folder / "repeat.py", python)
    except OSError as error:
        raise BadInput(f"{folder}: cannot be written ({error.strerror}), wanted a folder to write into") from None
    panels = _panels(path)
    write_report(folder / "report.html", result, panels, series(fit.records[0], fit.score, fit.translational))
    return list(FILES)


def told(path: Sequence[Model]) -> dict[str, Any]:
    """result.json of the last model, with a stage for every model on the way to it."""
    last = path[-1]
    said: dict[str, Any] = {"command": "studio", "command_line": "jaxbacklash studio", "version": jb.__version__}
    result = as_json(last.fit, **said, causes=last.causes or ())
    result["stages"] = [
        stage(model.fit, added(path, number))
        | {"dropped": dropped(path, number), "candidates": [] if model.ranking is None else candidates_json(model.ranking)}
        for number, model in enumerate(path)
    ]
    return result | ({} if last.findings is None else last.findings.as_json())


def verdict(model: Model) -> str:
    """What a fit tells of itself in a few sentences, with causes in the record where those are known."""
    return str(as_json(model.fit, checked={}, causes=model.causes or ())["verdict_text"])


def added(path: Sequence[Model], number: int) -> str | None:
    """The effects that a model has and the one before has not, None where there are none."""
    before = path[number - 1].effects if number else path[0].effects
    return " + ".join(name for name in path[number].effects if name not in before) or None


def dropped(path: Sequence[Model], number: int) -> list[str]:
    """The effects that the model before has and this one has not."""
    return [name for name in path[number - 1].effects if name not in path[number].effects] if number else []


def _panels(path: Sequence[Model]) -> list[Panel]:
    """Errors of all models, then what the first and the last lack, then the last beside its record."""
    last = path[-1]
    panels = []
    if len(path) > 1 or last.fit.heldout is not None:
        sentence = "1 means that noise alone is left, on this record and, where there is one, on the held-out one."
        panels.append(Panel("Prediction error, model by model", sentence, svg_of(jb.plot.stages, [m.fit for m in path]), "error"))
    for number in sorted({0, len(path) - 1}):
        model = path[number]
        if model.ranking is not None and len(model.ranking):
            said = f"What the error would become with one effect added; evidence {SCALE}."
            panels.append(ranking_panel(f"What does it lack: {model.name}", said, svg_of(jb.plot.ranking, model.ranking), number))
        if model.findings is not None:
            panels += [
                replace(panel, title=f"{panel.title}: {model.name}", anchor=f"{panel.anchor}-{number}")
                for panel in failure_panels(model.findings)
            ]
    return panels + pictures(last.fit)
