"""``jaxbacklash lost-motion``: the play of a slow record, without dynamics."""

from __future__ import annotations

import dataclasses
import shlex
import sys
import warnings
from pathlib import Path

from .. import __version__
from ..errors import BadInput, NoAnswer
from ..quasistatic import Condition, LostMotion, lost_motion
from ..quasistatic.result import verdict
from ..records import Record
from ..records.files import read_table
from ..records.header_units import split_unit
from ..records.options import ReadOptions
from ..records.reader import record_of
from ..records.table import Table
from ..report.lost_motion_result import lost_motion_json
from .common import json_text, out_folder, progress, write_text
from .reading import Reading

OTHER_NAMES = {"motor": "x", "link": "y", "torque": "T"}
"""Names that a drive's columns go by, and the channel that each is here."""
NO_MATTER = frozenset(
    {"gear", "sign", "absolute", "driven", "held-first", "clipped", "no-answer", "held", "held-rows", "stale", "stale-first",
     "time-unit"}
)  # fmt: skip
"""Findings that would stop a fit: slow records are counted coarsely and rest for long, and what else is wrong is told here."""
JUMPS = frozenset({"shift", "wrap"})
"""Findings that z from one edge to the other looks like, in few samples."""


def run(
    path: Path, *, wind_up: float | None, out: Path | None, as_json: bool, reading: Reading, translational: bool
) -> None:  # fmt: skip
    """Read, estimate, print; write the result and the report when a folder is given.

    Raises
    ------
    BadInput
        An option is missing that would put the record right.
    NoAnswer
        The record does not show its play.
    """
    record = read_slow(path, reading)
    folder = out_folder(out)
    with progress(as_json) as tell:
        tell("reading both edges", 0.2)
        found = lost_motion(record, gear_ratio=reading.ratio, wind_up=wind_up, translational=translational)
        _refuse_misread(path, found, reading)
        result = lost_motion_json(found, command_line=shlex.join(["jaxbacklash", *sys.argv[1:]]), version=__version__)
        words = json_text(result)
        if folder is not None:
            tell("drawing the report", 0.8)
            write_text(folder / "result.json", words)
            # Pictures bring matplotlib, which a plain run need not wait for.
            from ..report.lost_motion_report import lost_motion_report

            lost_motion_report(found, result, folder / "report.html")
    if as_json:
        sys.stdout.write(words)
    else:
        print(found if found.applies else str(found).rpartition("\n")[0])
        if folder is not None:
            print(f"written: {folder}/result.json, report.html")
    if not found.applies:
        raise NoAnswer(verdict(found))


def _refuse_misread(path: Path, found: LostMotion, reading: Reading) -> None:
    """Refuse a record that an option would put right, and name that."""
    failed = found.failed
    if failed is not None and failed.way_out.startswith("--"):
        turned = failed.way_out == "--sign y" and "y" in reading.options().sign
        raise BadInput(f"{path}: {failed.why}.", remedy="" if turned else failed.way_out)


def read_slow(path: Path, reading: Reading) -> Record:
    """The record in a file, whose columns may go by a drive's names; a ratio divides the motor's."""
    renamed = [_renamed(text) for text in reading.columns or []]
    reading = dataclasses.replace(reading, columns=renamed or None)
    options = reading.options()
    table = read_table(path, options)
    own = {split_unit(name)[0].lower(): name for name in table.names}
    taken = set(options.columns) | ({"x", "y", "z", "T"} & {split_unit(name)[0] for name in table.names})
    columns = dict(options.columns)
    for name, channel in OTHER_NAMES.items():
        if name in own and not taken & ({"y", "z"} if channel == "y" else {channel}):
            columns[channel] = own[name]
    jumps = JUMPS if {"z", "F"} & (set(columns) | set(own.values())) else frozenset()
    options = dataclasses.replace(options, columns=columns, accept=options.accept | NO_MATTER | jumps)
    try:
        return record_of(table, options, str(path))
    except BadInput:
        # Angles that are large for a joint are so for want of a gear's ratio, or in another unit: the motion tells which.
        wrong = _ratio(table, options, str(path), reading.ratio)
        if wrong is None:
            raise
        raise BadInput(f"{path}: {wrong.why}.", remedy=wrong.way_out) from None


def _ratio(table: Table, options: ReadOptions, where: str, ratio: float | None) -> Condition | None:
    """What the record says of the ratio if its angles are believed, None where that is right or cannot be told."""
    if not {"x", "y"} <= set(options.columns) | set(table.names) or options.units:
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            believed = record_of(table, dataclasses.replace(options, units={"x": "rad", "y": "rad"}), where)
        except BadInput:
            return None
        failed = lost_motion(believed, gear_ratio=ratio).failed
    return failed if failed is not None and failed.name == "gear ratio" else None


def _renamed(text: str) -> str:
    """Columns as they were typed, with a drive's names for channels replaced."""
    for name, channel in OTHER_NAMES.items():
        text = text.replace(f"{name}=", f"{channel}=")
    return text
