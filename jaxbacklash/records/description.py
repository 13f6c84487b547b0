"""What is in a file and what it seems to be: the facts behind `jaxbacklash look`.

The file is read as a record would be. What refuses it becomes a question, the proposed remedy is taken, and it is read again,
until it can be read or only the user can answer. So the command that is proposed at the end is one that was tried.
"""

from __future__ import annotations

import dataclasses
import shlex
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from jaxbacklash.errors import BadInput

from .clocks import clock_of
from .columns import Picked, pick
from .files import read_table
from .header_units import split_unit
from .options import ReadOptions
from .reader import record_of
from .record import Record
from .remedies import applied, with_remedy
from .roles import columns_option, guess_roles, holds_numbers, numbers_but_for_a_word, numeric
from .table import Column, Table

MOST_QUESTIONS = 8
"""Refusals that are answered by their remedies one after another before the file counts as unreadable."""
MOST_LEVELS = 4096
"""Distinct values up to which a column is told to be counted."""

KINDS = {
    "base_motion": "a record of base motion", "force": "a force-driven record", "free_decay": "a free decay",
    "transmitted": "base motion with the transmitted force", "series": "a series of one channel",
    "loop": "a slow loop of torque over angle", "drive": "a drive: torque at its motor, and what its encoders show",
    "servo": "a drive with a servo: the position that it was told, and what its encoders show",
}  # fmt: skip


@dataclasses.dataclass(frozen=True)
class ColumnFacts:
    """One column: what it holds and what was found in it. ``low``, ``high`` in the column's own unit, None for text."""

    number: int
    name: str
    role: str
    unit: str
    low: float | None
    high: float | None
    missing: int
    findings: tuple[str, ...]
    column: Column

    def as_json(self) -> dict[str, Any]:
        """The entry of result.json."""
        return {
            "name": self.name, "number": self.number, "role": self.role or None, "unit": self.unit or None, "min": self.low,
            "max": self.high, "missing": self.missing, "findings": list(self.findings),
        }  # fmt: skip


@dataclasses.dataclass(frozen=True)
class Description:
    """What `look` tells: the table, each column, what was asked and noted, the kind of record, and the command to go on with."""

    path: str
    table: Table
    columns: tuple[ColumnFacts, ...]
    rate_hz: float | None
    kind: str | None
    notes: tuple[str, ...]
    questions: tuple[str, ...]
    command: str
    record: Record | None
    obstacle: str = ""

    @property
    def seems(self) -> str:
        """What the file seems to be, in words."""
        servo = self.record is not None and self.record.input_name == "command"
        return KINDS.get("servo" if servo else self.kind or "", "no record that can be fitted as it stands")

    @property
    def ready(self) -> bool:
        """Whether the command to go on with can be typed as it stands."""
        return self.record is not None or self.kind == "series"

    def as_json(self) -> dict[str, Any]:
        """result.json of `look`."""
        details = self.table.details
        return {
            "schema": 1, "path": self.path, "format": self.table.format, "encoding": details.get("encoding"),
            "details": details, "rows": self.table.rows, "rate_hz": self.rate_hz,
            "columns": [column.as_json() for column in self.columns], "kind": self.kind, "notes": list(self.notes),
            "questions": list(self.questions), "command": self.command,
        }  # fmt: skip


def describe(path: Path, options: ReadOptions, *, typed: tuple[str, ...] = ()) -> Description:
    """Look at a file.

    Parameters
    ----------
    path : Path
    options : ReadOptions
        What the user said of it already.
    typed : tuple of str
        The same options as they were typed; the proposed command repeats them.

    Raises
    ------
    BadInput
        When the file holds no table at all.
    """
    table, where = read_table(path, options), str(path)
    words = ["jaxbacklash", "fit", where, *typed]
    questions: list[str] = []
    told: list[str] = []
    record, obstacle, series = None, "", False
    for _ in range(MOST_QUESTIONS):
        try:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                record = record_of(table, options, where)
            told = [_sentence(str(one.message), where) for one in caught]
            break
        except BadInput as why:
            obstacle = _sentence(str(why), where)
            remedy = why.remedy
            if not remedy or with_remedy(words, remedy) == words:
                break
            questions.append(obstacle)
            try:
                options = applied(options, remedy)
                table = read_table(path, options)
            except BadInput:
                break
            words = with_remedy(words, remedy)
    roles = _roles(table, options, where)
    moving = [number for number, column in enumerate(table.columns) if holds_numbers(column) and number != roles.get("t")]
    if record is None and len(moving) == 1 and not {"F", "T"} & set(roles):
        series = True
    command = _command(words, table, roles, record, series)
    return Description(
        where, table, tuple(_facts(table, roles, [*told, *questions, *([obstacle] if record is None else [])])),
        record.rate_hz if record is not None else _rate(table, roles, options, where),
        record.kind if record is not None else ("series" if series and roles else None),
        tuple(told), tuple(questions if record is not None else [*questions, *([obstacle] if obstacle not in questions else [])]),
        command, record, "" if record is not None else obstacle,
    )  # fmt: skip


def _sentence(text: str, where: str) -> str:
    """A message without the file's name, which everything here is about."""
    return text.removeprefix(f"{where}: ").removeprefix(f"{where}, ")


def _roles(table: Table, options: ReadOptions, where: str) -> dict[str, int]:
    """Columns by channel: as they would be read, else as they are guessed."""
    try:
        picked: Picked = pick(table, options.columns, where, timed=options.rate is None)
    except BadInput:
        return guess_roles(table)
    return picked.numbers


def _facts(table: Table, roles: dict[str, int], sentences: list[str]) -> list[ColumnFacts]:
    names = {number: channel for channel, number in roles.items()}
    facts = []
    for number, column in enumerate(table.columns):
        values = column.values
        known = values[np.isfinite(values)] if values.dtype.kind == "f" else np.empty(0)
        about = {f"column {name}" for name in (column.name, names.get(number)) if name}
        own = [text for text in sentences if any(text.startswith((f"{head}:", f"{head},")) for head in about)]
        low, high = (float(known.min()), float(known.max())) if known.size else (None, None)
        missing = int(np.isnan(values).sum()) if values.dtype.kind == "f" else 0
        unit = column.unit or split_unit(column.name)[1]
        words = (*_plain(column, table), *own)
        facts.append(ColumnFacts(number + 1, column.name, names.get(number, ""), unit, low, high, missing, words, column))
    return facts


def _plain(column: Column, table: Table) -> list[str]:
    """What a column shows by itself: text, a constant, or a few levels as counting makes them."""
    if column.values.dtype.kind == "U":
        known = numbers_but_for_a_word(column)
        if known is not None:
            row = int(np.flatnonzero(np.isnan(known))[0])
            return [f'numbers, but "{column.values[row][:40]}" at {table.place(row)}']
        first = column.values[0] if column.values.size else ""
        return [f'text, such as "{first[:40]}"']
    if not numeric(column):
        return ["never changes"]
    levels = np.unique(column.values[np.isfinite(column.values)])
    if 2 < levels.size < min(MOST_LEVELS, column.values.size // 4):
        return [f"{levels.size} distinct values, {float(np.min(np.diff(levels))):.4g} apart at least"]
    return []


def _rate(table: Table, roles: dict[str, int], options: ReadOptions, where: str) -> float | None:
    """Samples per second by the times, or as stated."""
    if options.rate is not None:
        return options.rate
    if "t" in roles:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                t, _ = clock_of(table, roles["t"], options.units.get("t"), where)
        except BadInput:
            return table.rate_hz
        t = t[np.isfinite(t)]
        if t.size > 1 and t[-1] > t[0]:
            return float((t.size - 1) / (t[-1] - t[0]))
    return table.rate_hz


def _command(words: list[str], table: Table, roles: dict[str, int], record: Record | None, series: bool) -> str:
    """The command to go on with, quoted for a shell."""
    if record is None and series:
        moving = next((n for n, c in enumerate(table.columns) if holds_numbers(c) and n != roles.get("t")), None)
        if moving is None:
            return ""
        words = ["jaxbacklash", "chaos", *words[2:], "--channel", f"#{moving + 1}"]
        if "t" in roles and table.columns[roles["t"]].name != "t":
            words = with_remedy(words, f"--columns t=#{roles['t'] + 1}")  # in place of what was proposed for a record
        elif "t" not in roles and "--rate" not in words:
            words += ["--rate", f"{table.rate_hz:.9g}" if table.rate_hz else "HZ"]
        return shlex.join(words)
    if record is None and "--columns" not in words:
        option = columns_option(table, roles)
        words = words + shlex.split(option)
    if record is None and "t" not in roles and "--rate" not in words:
        words = [*words, "--rate", f"{table.rate_hz:.9g}" if table.rate_hz else "HZ"]
    return shlex.join(words)
