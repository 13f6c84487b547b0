"""``jaxbacklash refine``."""

from __future__ import annotations

import shlex
import sys
import warnings
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

from .. import __version__
from ..criticism import Refinement
from ..criticism import refine as refine_record
from ..criticism.causes_first import causes_first, told
from ..criticism.ranking import plain
from ..errors import NoAnswer
from ..model_file import dump_model
from ..records.force import between
from ..report.refine_result import other_methods, refinement_json
from ..residuals import Findings, Surface, where_it_fails
from ..system import System
from .common import check_window, json_text, model_of_file, out_folder, progress, write_text
from .heldout import check_heldout
from .reading import Reading

WORTH_A_TABLE = 0.3
"""Share of the missing torque that a table must predict out of sample before it is offered as a stopgap."""


def run(
    path: Path,
    *,
    heldout: Path | None,
    inertia: float | None,
    model: str,
    out: Path | None,
    as_json: bool,
    reading: Reading,
    window: float | None,
    translational: bool,
    seed: int,
) -> None:
    """Read, find the missing effects, print; write the result, the model and the report when a folder is given."""
    check_window(window)
    record = reading.record(path)
    held = reading.record(heldout) if heldout is not None else None
    check_heldout([record], held)
    folder = out_folder(out)
    system = _given(model, inertia)
    # What other methods say of the model that is likely kept is worked out beside the search for more.
    with progress(as_json) as tell, ThreadPoolExecutor(1) as aside:
        checked: list[Future[dict[str, Any]]] = []
        how: dict[str, Any] = {
            "heldout": held, "model": model if system is None else "joint", "inertia": inertia, "system": system,
            "window": window, "translational": translational, "seed": seed, "progress": tell,
        }  # fmt: skip
        early, causes = causes_first(record, **how)
        if early is not None:
            deliver(early, folder, as_json, tell)
            return
        found = refine_record(record, **how, settled=lambda fit: checked.append(aside.submit(other_methods, fit)))
        mended = told(found, causes)
        deliver(mended, folder, as_json, tell, checked[-1].result if mended is found else lambda: {})


def _given(model: str, inertia: float | None) -> System | None:
    """The joint of a model file, None for a model by name."""
    full = model_of_file(model, inertia)
    if full is None:
        return None
    if full.effects:
        known = ", ".join(sorted(full.effects))
        warnings.warn(
            f"{model}: its effects ({known}) are not taken for granted, only its joint is; they are looked for again",
            stacklevel=2,
        )
    return System(full.inertia, full.contact, full.damper, {}, full.observed, motor=full.motor)


def deliver(
    found: Refinement, folder: Path | None, machine: bool, tell: Any, checked: Callable[[], dict[str, Any]] = lambda: {}
) -> None:
    """Print a refinement and write result.json, model.toml and report.html into the folder; ``checked`` waits for what other
    methods say of it, nothing if they have not been asked."""
    with ThreadPoolExecutor(1) as aside:
        last = None if found.verdict.complete or found.causes else _look(found, -1, tell)
        # The base model is looked at beside the writing and drawing of all else.
        alone = (last is not None and len(found.stages) == 1) or bool(found.causes)
        base = None if alone or folder is None else aside.submit(_look, found, 0, tell)
        words = shlex.join(["jaxbacklash", *sys.argv[1:]])
        result = refinement_json(found, last, command_line=words, version=__version__, checked=checked() or None)
        written = []
        if folder is not None:
            tell("drawing the report", 0.97)
            written = _write(found, result, last, base, folder)
    if machine:
        sys.stdout.write(json_text(result))
        return
    print(text(found, last))
    print(result["cross_check"]["text"])
    if folder is not None:
        print(f"written: {folder}/{', '.join(written)}")


def _write(
    found: Refinement, result: dict[str, Any], last: Findings | None, base: Future[Findings | None] | None, folder: Path
) -> list[str]:
    """The files of a refinement, by name; ``base`` will tell where the base model fails, None where ``last`` tells it."""
    fit = found.fit
    write_text(folder / "result.json", json_text(result))
    about: dict[str, Any] = {
        "translational": fit.translational, "per_inertia": fit.per_inertia, "between": between(fit.records),
        "known_noise": fit.known_noise,
    }  # fmt: skip
    title = f"{fit.records[0].summary()}\n{result['verdict_text']}"
    write_text(folder / "model.toml", dump_model(fit.system, heading=title, **about))
    written = ["result.json", "model.toml", "report.html"]
    surface = _worth_a_table(found, last)
    if surface is not None:
        stopgap = surface.system.with_effects(surface.effect())
        title += "\nThe learned torque is a table read from this record: a stopgap, not physics."
        write_text(folder / "model-with-learned-torque.toml", dump_model(stopgap, heading=title, **about))
        written.insert(2, "model-with-learned-torque.toml")
    from ..report.refine_report import refine_report  # pictures bring matplotlib, for which a plain run need not wait

    refine_report(found, result, folder / "report.html", first=base.result if base is not None else lambda: last, last=last)
    return written


def text(found: Refinement, last: Findings | None) -> str:
    """What a person reads: the loop's report, and where an incomplete model still fails."""
    if last is None:
        return str(found)
    lines = [str(found), "", "where it still fails", *(f"  {sentence}" for sentence in last.sentences)]
    if _worth_a_table(found, last) is not None:
        lines.append("  With --out, model-with-learned-torque.toml holds that torque as a table: a stopgap, not physics.")
    return "\n".join(lines)


def _worth_a_table(found: Refinement, last: Findings | None) -> Surface | None:
    """What is missing, where it can be offered as a table: a force missing from a measured one is no torque on
    the link, nor is one at the motor."""
    elsewhere = found.fit.records[0].kind == "transmitted" or found.fit.records[0].blind
    surface = None if last is None or elsewhere else last.surface
    return surface if surface is not None and surface.share > WORTH_A_TABLE else None


def _look(found: Refinement, stage: int, tell: Any) -> Findings | None:
    """Where one of the models fails; None where that cannot be told, as of a drive of which the link alone is seen."""
    record = found.stages[stage].fit.records[0]
    if record.blind and "motor" not in record.channels:
        return None
    tell("looking for the missing torque", 0.94)
    try:
        return where_it_fails(plain(found.stages[stage].fit))
    except NoAnswer as error:
        warnings.warn(f"where the model fails cannot be told: {error}", stacklevel=2)
        return None
