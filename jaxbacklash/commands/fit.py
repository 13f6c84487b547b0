"""``jaxbacklash fit``."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .. import __version__
from ..causes import Cause, find_causes
from ..errors import BadInput
from ..fitting import Fit
from ..fitting import fit as fit_records
from ..fitting.result import WITHOUT_KT
from ..fitting.result import text as fit_text
from ..fitting.setup import add_effects
from ..model_file import dump_model
from ..records.force import between
from ..report.result import as_json as result_of
from .common import check_window, json_text, model_of_file, names, out_folder, progress, write_text
from .heldout import check_heldout
from .reading import Reading

OWN = {"--effects": 1, "--starts": 1, "--profile": 0, "--out": 1, "--json": 0, "--seed": 1}
"""Options of ``fit`` that are not handed on to ``refine``, and how many words follow each."""


def run(
    paths: Sequence[Path],
    *,
    inertia: float | None,
    model: str,
    effects: str | None,
    heldout: Path | None,
    out: Path | None,
    as_json: bool,
    reading: Reading,
    window: float | None,
    starts: int,
    profile: bool,
    translational: bool,
    seed: int,
) -> None:
    """Read, fit, print; write the result, the model and the report when a folder is given."""
    check_window(window)
    if starts < 1:
        raise BadInput(f"--starts {starts}: wanted one or more")
    records = [reading.record(path) for path in paths]
    held = reading.record(heldout) if heldout is not None else None
    check_heldout(records, held)
    folder = out_folder(out)
    system = model_of_file(model, inertia)
    added = names(effects)
    if system is not None:
        system = add_effects(system, added)
    with progress(as_json) as tell:
        found = fit_records(
            records, model=model if system is None else "joint", inertia=inertia, effects=added, system=system, heldout=held,
            window=window, starts=starts, seed=seed, translational=translational, profile=profile, progress=tell,
        )  # fmt: skip
        deliver(found, folder, as_json, tell)


def deliver(found: Fit, folder: Path | None, machine: bool, tell: Any, *, silent: bool = False) -> None:
    """Print a fit, unless silent, and write result.json, model.toml and report.html into the folder."""
    words = shlex.join(["jaxbacklash", *sys.argv[1:]])
    causes: list[Cause] = find_causes(found, tell)
    result = result_of(found, command="fit", command_line=words, version=__version__, causes=causes)
    if not found.adequate and not causes:
        result["next"] = refining(sys.argv[1:], [record.path for record in found.records[1:]])
    text = json_text(result)
    if folder is not None:
        from ..report.fit_report import fit_report  # pictures bring matplotlib, which a plain run need not wait for

        tell("drawing the report", 0.95)
        write_text(folder / "result.json", text)
        heading = f"{found.records[0].summary()}\n{result['verdict_text']}"
        heading += f"\n{WITHOUT_KT}" if found.records[0].per_kt else ""
        write_text(
            folder / "model.toml",
            dump_model(
                found.system,
                translational=found.translational,
                per_inertia=found.per_inertia,
                heading=heading,
                between=between(found.records),
                known_noise=found.known_noise,
            ),
        )
        fit_report(found, result, folder / "report.html")
    if machine:
        sys.stdout.write(text)
    elif not silent:
        print(fit_text(found, causes))
        print(result["cross_check"]["text"])
        if "next" in result:
            print(f"next, to find what is missing: {result['next']}")
        if folder is not None:
            print(f"written: {folder}/result.json, model.toml, report.html")


def refining(words: Sequence[str], others: Sequence[str] = ()) -> str:
    """The command that looks for what a fit misses.

    Parameters
    ----------
    words : of the fit, without the program's name
    others : records of the fit beside its first one, as they were typed; one record is refined at a time

    Examples
    --------
    >>> refining(["fit", "run1.csv", "--inertia", "3.16", "--effects", "gravity", "--out", "found"])
    'jaxbacklash refine run1.csv --inertia 3.16'
    >>> refining(["fit", "run1.csv", "run2.csv", "--heldout", "run3.csv"], ["run2.csv"])
    'jaxbacklash refine run1.csv --heldout run3.csv'
    """
    words = list(words)
    for one in others:
        places = [k for k, word in enumerate(words) if str(Path(word)) == one and words[k - 1] != "--heldout"]
        if places:
            del words[places[-1]]
    kept, left = [], 0
    for word in words[1:]:
        if left:
            left -= 1
            continue
        name, given, _ = word.partition("=")
        if name in OWN:
            left = 0 if given else OWN[name]
        else:
            kept.append(word)
    return shlex.join(["jaxbacklash", "refine", *kept])
