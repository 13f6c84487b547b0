"""``jaxbacklash look``: what is in a file, what it seems to be, and the command to go on with."""

from __future__ import annotations

import dataclasses
import itertools
import json
import shlex
import sys
from pathlib import Path

import numpy as np

from .. import __version__
from ..errors import NoAnswer
from ..quasistatic import said_of, slow_reading
from ..records.description import ColumnFacts, Description, describe
from .reading import Reading

BLOCKS = " ▁▂▃▄▅▆▇█"
WIDTH = 48


def run(path: Path, *, out: Path | None, as_json: bool, reading: Reading) -> None:
    """Look, print; draw every column when a folder is given."""
    found = _slowly(describe(path, reading.options(), typed=reading.typed()))
    result = found.as_json() | {"command_line": shlex.join(["jaxbacklash", *sys.argv[1:]]), "version": __version__}
    words = json.dumps(result, indent=2, allow_nan=False) + "\n"
    folder = None
    if out is not None:
        from ..report.look_report import look_report  # pictures bring matplotlib, which a plain look need not wait for
        from .common import out_folder, write_text

        folder = out_folder(out)
        assert folder is not None
        write_text(folder / "result.json", words)
        look_report(found, result, folder / "report.html")
    if as_json:
        sys.stdout.write(words)
    else:
        print(text(found))
        if folder is not None:
            print(f"written: {folder}/result.json, report.html")
    if found.record is None and not found.command:
        raise NoAnswer(f"{path}: no column of numbers that change, so that there is nothing to fit")


def _slowly(found: Description) -> Description:
    """The same with the command for slow records, where it is one."""
    slow = None if found.record is None else slow_reading(found.record)
    if slow is None:
        return found
    command = found.command.replace("jaxbacklash fit", "jaxbacklash lost-motion", 1)
    kind = "loop" if slow.way == "loop" else found.kind
    return dataclasses.replace(found, notes=(*found.notes, said_of(slow)), command=command, kind=kind)


def text(found: Description) -> str:
    """What a person reads."""
    table = found.table
    rate = f", {found.rate_hz:.6g} Hz" if found.rate_hz else ""
    lines = [f"{found.path}: {table.format}, {table.rows} rows, {len(table.columns)} columns{rate}"]
    lines += [f"  {name}: {value}" for name, value in table.details.items()]
    lines += ["", *(line for column in found.columns for line in _column(column, said=found.questions))]
    if found.notes:
        lines += ["", "noted", *(f"  {note}" for note in found.notes)]
    if found.questions:
        answered = " (the command below takes what is proposed)" if found.record is not None else ""
        lines += ["", f"to be settled{answered}", *(f"  {question}" for question in found.questions)]
    lines += ["", f"it seems to be {found.seems}"]
    if found.command:
        lines.append(f"{'next' if found.ready else 'once that is settled'}: {found.command}")
    return "\n".join(lines).rstrip()


def _column(column: ColumnFacts, said: tuple[str, ...]) -> list[str]:
    """A line of facts, a picture, and what was found that is not ``said`` below."""
    role = f"-> {column.role}" if column.role else ""
    unit = f" [{column.unit}]" if column.unit else ""
    span = "" if column.low is None else f"{column.low:.6g} ... {column.high:.6g}{unit}"
    missing = f", {column.missing} missing" if column.missing else ""
    head = f"  #{column.number} {column.name}"
    lines = [f"{head:<24} {role:<5} {span}{missing}".rstrip()]
    picture = spark(column.column.values)
    if picture:
        lines.append(f"{'':<31}{picture}")
    return lines + [f"{'':<31}{sentence}" for sentence in column.findings if sentence not in said]


def spark(values: np.ndarray, width: int = WIDTH) -> str:
    """A column as a row of blocks: the mean of each stretch between the column's smallest and largest value.

    Examples
    --------
    >>> spark(np.array([0.0, 1.0, 2.0, 1.0]), 4)
    '▁▄█▄'
    """
    if values.dtype.kind != "f" or values.size < 2 or not np.isfinite(values).any():
        return ""
    low, high = float(np.nanmin(values[np.isfinite(values)])), float(np.nanmax(values[np.isfinite(values)]))
    if not high > low:
        return ""
    edges = np.linspace(0, values.size, min(width, values.size) + 1).astype(int)
    levels = []
    for first, last in itertools.pairwise(edges):
        piece = values[first:last]
        piece = piece[np.isfinite(piece)]
        # One sample of each stretch keeps a fast motion visible, which a mean would flatten.
        levels.append(0 if not piece.size else 1 + round((float(piece[0]) - low) / (high - low) * (len(BLOCKS) - 2)))
    return "".join(BLOCKS[level] for level in levels)
