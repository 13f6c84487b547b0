"""An odd file before it is written: columns as text or numbers, what stands around them, and what is right to make of it."""

from __future__ import annotations

import gzip
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from tests.odd_files.good import INERTIA, TRUTH, Measured

READ, REFUSED, SAID = "read", "refused", "said"
"""What is right: the truth inside the intervals; exit code 2 with a sentence, whose text to paste leads on; or either of the
two, or the answer with a word about the cause beside it."""


@dataclass
class Column:
    """A column to be written: of a channel ("t", "x", "z", "y") or of none, under a name, with values or ready text."""

    channel: str | None
    name: str
    values: np.ndarray
    digits: int = 9
    cells: list[str] | None = None
    unit: str = ""

    def texts(self) -> list[str]:
        """Its cells as text, with a decimal point."""
        return self.cells if self.cells is not None else [f"{value:.{self.digits}g}" for value in self.values]


@dataclass
class Draft:
    """A file to be and a command for it.

    The writing fields say how the table looks; ``options`` are the words a person would type beside ``fit FILE``; ``right`` is
    what to expect of the file as it stands, ``rights`` of each of its kinds, and ``words`` holds for each kind the regular
    expressions that its refusal must match, all of them; the last one is the cause, which a word beside an answer must match.
    ``remedy`` picks among several texts to paste the one that is true of this file. ``reference`` is the record in SI as it
    should arrive, within ``tolerance`` [rad]; None where no record should arrive.
    """

    columns: list[Column]
    reference: Measured | None
    kinds: list[str] = field(default_factory=list)
    separator: str = ","
    mark: str = "."
    quoted: str = ""  # "", "all" or "header"
    header: bool = True
    header_prefix: str = ""
    above: list[str] = field(default_factory=list)
    below_header: list[str] = field(default_factory=list)
    footer: list[str] = field(default_factory=list)
    trailing: str = ""
    line_end: str = "\n"
    encoding: str = "utf-8"
    byte_mark: bytes = b""
    zipped: bool = False
    suffix: str = ".csv"
    stem: str = "run 1"
    writer: Callable[[Draft, Path], None] | None = None
    said_columns: dict[str, str] = field(default_factory=dict)
    options: list[str] = field(default_factory=list)
    effects: bool = True
    right: str = READ
    rights: list[str] = field(default_factory=list)
    words: list[tuple[str, ...]] = field(default_factory=list)
    remedy: str = ""
    truth: dict[str, float] | None = field(default_factory=lambda: dict(TRUTH))
    tolerance: float = 2e-7

    def column(self, channel: str) -> Column:
        """The column of a channel; asked for z, that of y where the file holds the link against the ground."""
        names = ("z", "y") if channel == "z" else (channel,)
        return next(column for column in self.columns if column.channel in names)

    def rename(self, **names: str) -> None:
        """Call channels' columns something else, and say so on the command line."""
        for channel, name in names.items():
            column = self.column(channel)
            column.name = name
            self.said_columns[column.channel or channel] = name

    def numbered(self) -> dict[str, str]:
        """Its columns by number, as --columns takes them."""
        return {column.channel: f"#{place}" for place, column in enumerate(self.columns, 1) if column.channel}

    def expect(self, right: str, *words: str, remedy: str = "") -> None:
        """State what is right; what one kind refuses another does not make good."""
        order = (READ, SAID, REFUSED)
        self.right = max(self.right, right, key=order.index)
        self.rights.append(right)
        if words:
            self.words.append(words)
        self.remedy = remedy or self.remedy

    @property
    def name(self) -> str:
        """The file's name."""
        return self.stem + self.suffix + (".gz" if self.zipped else "")

    def command(self) -> list[str]:
        """The words after `jaxbacklash`."""
        words = ["fit", self.name, "--inertia", str(INERTIA)]
        if self.effects:
            words += ["--effects", "gravity"]
        if self.said_columns:
            words += ["--columns", ",".join(f"{channel}={word(name)}" for channel, name in self.said_columns.items())]
        return words + self.options

    def write(self, folder: Path) -> Path:
        """Write the file into a folder."""
        path = folder / self.name
        path.unlink(missing_ok=True)
        if self.writer is not None:
            self.writer(self, path)
            return path
        data = self.byte_mark + self.text().encode(self.encoding)
        path.write_bytes(gzip.compress(data) if self.zipped else data)
        return path

    def text(self) -> str:
        """The whole text of the file."""
        texts = [[cell.replace(".", self.mark) if _number(cell) else cell for cell in column.texts()] for column in self.columns]
        names = [column.name for column in self.columns]
        rows = [self.separator.join(self._quote(cell, False) for cell in row) + self.trailing for row in zip(*texts, strict=True)]
        head = [self.header_prefix + self.separator.join(self._quote(name, True) for name in names) + self.trailing]
        lines = [*self.above, *(head if self.header else []), *self.below_header, *rows, *self.footer]
        return self.line_end.join(lines) + self.line_end

    def _quote(self, cell: str, in_header: bool) -> str:
        needs = (self.separator.strip() and self.separator in cell) or '"' in cell
        if needs or self.quoted == "all" or (self.quoted == "header" and in_header):
            return '"' + cell.replace('"', '""') + '"'
        return cell


def word(name: str) -> str:
    """A column's name as README says to write it within --columns: quoted like a shell word where a comma or quote is in it."""
    if '"' in name:
        return f"'{name}'"
    return f'"{name}"' if "," in name or "=" in name or name != name.strip() else name


def _number(cell: str) -> bool:
    return re.fullmatch(r"-?[\d.]+(e[-+]?\d+)?", cell) is not None


def good_draft(record: Measured) -> Draft:
    """A plain CSV file of a record, nothing odd about it yet."""
    columns = [Column("t", "t", record.t)]
    columns += [Column(name, name, values) for name, values in record.channels.items()]
    return Draft(columns, Measured(record.t, dict(record.channels)))
