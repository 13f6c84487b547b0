"""``jaxbacklash fit RECORDS... --each`` and ``jaxbacklash refine RECORDS... --each``: many records, each by itself."""

from __future__ import annotations

import functools
import shlex
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .. import __version__
from ..errors import BadInput, NoAnswer
from ..many import Each, fit_each, refine_each
from ..many.cluster import connected
from ..many.rows import FAILED
from ..report.many_result import many_json
from ..system import System
from .common import check_window, json_text, model_of_file, names, out_folder, progress, write_text
from .doors import each_file
from .laws import load_laws
from .reading import Reading


def run(
    command: str,
    paths: Sequence[Path],
    *,
    inertia: float | None,
    model: str,
    effects: str | None = None,
    laws: Path | None = None,
    heldout: Path | None,
    out: Path | None,
    as_json: bool,
    reading: Reading,
    window: float | None,
    starts: int = 4,
    translational: bool,
    seed: int,
    cluster: str | None,
    workers: int | None,
) -> None:
    """Fit or refine each record by itself, print what changed, and write table, result and page when a folder is given."""
    check_window(window)
    reading.options()  # what cannot be understood is told once, not in every row
    records = [file for path in paths for file in each_file(path)]
    if not records:
        raise BadInput(f"{paths[0]}: is a folder without a file, wanted records")
    folder = out_folder(out)
    how: dict[str, Any] = {
        "model": model, "inertia": inertia, "window": window, "seed": seed, "translational": translational, "workers": workers,
        "heldout": reading.record(heldout) if heldout is not None else None, "system": model_of_file(model, inertia),
        "folder": folder, "read": reading.record,
        "before": None if laws is None else functools.partial(load_laws, laws.absolute()),
    }  # fmt: skip
    if how["system"] is not None:
        how["model"] = "joint"
    if command == "refine" and how["system"] is not None:
        how["system"] = _joint_of(how["system"])
    client = connected(cluster) if cluster is not None else None
    with progress(as_json) as tell:
        how |= {"client": client, "progress": tell}
        found = (
            fit_each(records, effects=names(effects), starts=starts, **how) if command == "fit" else refine_each(records, **how)
        )
        deliver(found, folder, as_json, tell)
    if found.count(FAILED) == len(found.rows):
        raise NoAnswer(f"none of the {len(found.rows)} records has a result; the first: {found.rows[0]['why']}")


def _joint_of(full: System) -> System:
    return System(full.inertia, full.contact, full.damper, {}, full.observed)


def deliver(found: Each, folder: Path | None, machine: bool, tell: Any) -> None:
    """Print what was found, and write table.csv, result.json and report.html (and table.parquet) into the folder."""
    tell("looking for what has changed", 0.98)
    result = many_json(found, command_line=shlex.join(["jaxbacklash", *sys.argv[1:]]), version=__version__)
    text = json_text(result)
    written = []
    if folder is not None:
        tell("drawing the report", 0.99)
        written = _write(found, result, text, folder)
    if machine:
        sys.stdout.write(text)
        return
    print(found)
    if folder is not None:
        print(f"written: {folder}/{', '.join(written)}")


def _write(found: Each, result: dict[str, Any], text: str, folder: Path) -> list[str]:
    from ..report.many_report import many_report  # pictures bring matplotlib, for which a plain run need not wait

    found.write(folder / "table.csv")
    write_text(folder / "result.json", text)
    written = ["table.csv", "result.json", "report.html"]
    try:
        import pyarrow  # noqa: F401
    except ImportError:
        pass
    else:
        found.write(folder / "table.parquet")
        written.insert(1, "table.parquet")
    try:
        many_report(found, result, folder / "report.html")
    except (BadInput, ValueError) as error:
        warnings.warn(f"the page was not written: {error}", stacklevel=2)
        written.remove("report.html")
    return written
