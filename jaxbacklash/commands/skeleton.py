"""``jaxbacklash skeleton``."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path

from .. import __version__
from ..report.skeleton_result import skeletons_json
from ..skeletons import skeleton
from .common import json_text, out_folder, progress, write_text
from .reading import Reading


def run(
    path: Path,
    *,
    inertia: float | None,
    gravity: float,
    out: Path | None,
    as_json: bool,
    reading: Reading,
    translational: bool,
) -> None:
    """Read, estimate by both methods, print; write the result and the report when a folder is given."""
    record = reading.record(path)
    folder = out_folder(out)
    with progress(as_json) as tell:
        found = skeleton(record, inertia, gravity=gravity, translational=translational, progress=tell)
        result = skeletons_json(found, command_line=shlex.join(["jaxbacklash", *sys.argv[1:]]), version=__version__)
        text = json_text(result)
        if folder is not None:
            tell("drawing the report", 0.8)
            write_text(folder / "result.json", text)
            from ..report.skeleton_report import skeleton_report  # pictures bring matplotlib, which a plain run need not wait for

            skeleton_report(found, result, folder / "report.html")
    if as_json:
        sys.stdout.write(text)
        return
    print(found)
    if folder is not None:
        print(f"written: {folder}/result.json, report.html")
