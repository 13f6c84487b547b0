"""``jaxbacklash compare``."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Any

from .. import __version__
from ..fitting import compare as compare_records
from ..model_file import dump_model, load_model, noise_known
from ..records.force import between
from ..report.result import comparison_json
from .common import check_window, json_text, out_folder, progress, write_text
from .reading import Reading


def run(
    model: Path,
    path: Path,
    *,
    out: Path | None,
    as_json: bool,
    reading: Reading,
    window: float | None,
    translational: bool,
) -> None:
    """Read both, predict window by window, print; write the result and the report when a folder is given."""
    check_window(window)
    system, known = load_model(model), noise_known(model)
    record = reading.record(path)
    folder = out_folder(out)
    with progress(as_json) as tell:
        tell("predicting", 0.1)
        found = compare_records(system, record, window=window, translational=translational, known=known)
        words = shlex.join(["jaxbacklash", *sys.argv[1:]])
        result = comparison_json(found, str(model), command_line=words, version=__version__)
        if folder is not None:
            from ..report.fit_report import compare_report  # pictures bring matplotlib, which a plain run need not wait for

            tell("drawing the report", 0.8)
            write_text(folder / "result.json", json_text(result))
            facts: dict[str, Any] = {"between": between([record]), "known_noise": known}
            write_text(folder / "model.toml", dump_model(system, translational=translational, **facts))
            compare_report(found, result, folder / "report.html")
    if as_json:
        sys.stdout.write(json_text(result))
        return
    print(found)
    if folder is not None:
        print(f"written: {folder}/result.json, model.toml, report.html")
