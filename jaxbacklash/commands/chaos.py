"""``jaxbacklash chaos``."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path

import numpy as np

from .. import __version__
from ..errors import BadInput
from ..records import MeasuredSeries
from ..records.size import rate_for
from ..report.chaos_result import chaos_json
from ..timeseries import chaos
from .common import json_text, out_folder, progress, write_text
from .ranges import bounded
from .reading import Reading

MOST = 60_000_000
"""Values of all surrogates together at most, 0.5 GB: the usual 39 of a million and a half samples."""
LONG = 400_000
"""Samples from which on a series is asked whether its motion needs its rate: a million take a minute."""
DRIVES = {"x": "base motion", "F": "force"}


def run(
    path: Path,
    *,
    channel: str | None,
    out: Path | None,
    as_json: bool,
    reading: Reading,
    surrogates: str,
    count: int,
    clean: bool,
    seed: int,
) -> None:
    """Read one channel, judge it, print; write the result and the report when a folder is given."""
    source = reading.series(path, channel)
    bounded(f"--surrogate-count {count} of {source.values.size} samples", count * source.values.size, MOST, "values in all",
            "take fewer surrogates, or a lower rate with --resample-rate")  # fmt: skip
    _too_fine(path, source)
    folder = out_folder(out)
    with progress(as_json) as tell:
        try:
            found = chaos(
                source.values, source.dt, drive=source.drive, motion=_across(source),
                drive_name=DRIVES.get(source.drive_name or "", "drive"),
                surrogates=surrogates, count=count, clean=clean, seed=seed, progress=tell,
            )  # fmt: skip
        except BadInput as why:
            raise BadInput(f"{path}, channel {source.name}: {why}") from None
        result = chaos_json(found, source, command_line=shlex.join(["jaxbacklash", *sys.argv[1:]]), version=__version__)
        text = json_text(result)
        if folder is not None:
            from ..report.chaos_report import chaos_report  # pictures bring matplotlib, which a plain run need not wait for

            tell("drawing the report", 0.97)
            write_text(folder / "result.json", text)
            chaos_report(found, source, result, folder / "report.html")
    if as_json:
        sys.stdout.write(text)
        return
    print(source.summary())
    print(found)
    if folder is not None:
        print(f"written: {folder}/result.json, report.html")


def _too_fine(path: Path, source: MeasuredSeries) -> None:
    """Refuse a long series that is sampled much faster than its motion needs, and propose a rate."""
    rate = 1.0 / source.dt
    if source.values.size <= LONG or (wanted := rate_for(source.values, source.dt)) > 0.5 * rate:
        return
    raise BadInput(
        f"{path}, channel {source.name}: has {source.values.size} samples at {rate:.6g} Hz; the motion needs {wanted:.6g} Hz, at "
        f"which it is judged in seconds: add --resample-rate {wanted:.6g}"
    )


def _across(source: MeasuredSeries) -> np.ndarray | None:
    """The motion across the joint, where the channel is the link's own over a moving base."""
    if source.drive is None or (source.name, source.drive_name) != ("y", "x"):
        return None
    return source.values - source.drive
