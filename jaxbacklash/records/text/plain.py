"""The fast way to read a text table: NumPy's reader, for tables in which every cell is a number.

It gives up (returns None) at anything else, and `by_cell` reads the file again.
"""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Iterable, Iterator
from typing import TextIO

import numpy as np

from .cells import MISSING, NUMBER, split
from .layout import Layout
from .numbers import LONG, TWO_WAYS, Cells, judged
from .opening import last_line

CHUNK = 2**18
"""Characters read at once."""

ASCII = ("utf-8-sig", "cp1252")
"""Encodings in which a byte that is a digit, a mark or the end of a line stands for nothing else."""

PACKED_SUFFIXES = (".gz", ".bz2", ".xz", ".lzma")
"""Suffixes by which NumPy unpacks a file, whatever it holds."""


def read_plain(layout: Layout, decimal: str | None) -> tuple[np.ndarray, str, np.ndarray | None] | None:
    """All values of a table of numbers.

    Parameters
    ----------
    layout : Layout
    decimal : str or None
        The decimal mark, where the user said it.

    Returns
    -------
    values : array of shape (N, columns)
    mark : str
        The decimal mark.
    lines : array of shape (N,) or None
        Line of each row, where they do not follow each other; None where they do.

    None where some cell is no number that NumPy reads, or where marks inside numbers need a closer look.
    """
    if layout.width != len(layout.names) or not set(layout.kinds) <= {NUMBER, MISSING}:
        return None
    comma = any("," in line for line in layout.sample) and layout.separator != ","
    if comma and not _is_decimal_comma(layout, decimal):
        return None
    if (layout.quoted and comma) or any(map(LONG.fullmatch, split(layout.sample[0], layout.separator))):
        return None
    try:
        _load(map(_pointed, layout.sample) if comma else layout.sample, layout)
        values, last = (None if comma else _at_once(layout)) or _by_lines(layout, comma)
    except ValueError:
        return None
    if values.shape[1] != len(layout.names) or (layout.separator != "," and _may_group(layout, values, comma, decimal)):
        return None
    consecutive = last == layout.first_line + len(values) - 1
    return values, "," if comma else ".", None if consecutive else _line_numbers(layout, len(values))


def _load(lines: Iterable[str], layout: Layout) -> np.ndarray:
    return np.loadtxt(lines, delimiter=layout.separator, comments="#", ndmin=2, quotechar='"' if layout.quoted else None)


def _at_once(layout: Layout) -> tuple[np.ndarray, int] | None:
    """All values, and the number of the last line, of a file that NumPy opens itself: a third faster than line by line.

    None where it would not read what `Source.lines` does: out of a packed file, of one whose suffix says that it is packed, in
    quotes, or where a byte is no character.

    Raises
    ------
    ValueError
        Where some cell is no number.
    """
    source = layout.source
    if source.gzip or source.encoding not in ASCII or layout.quoted or source.path.suffix.lower() in PACKED_SUFFIXES:
        return None
    last = source.last_line()
    # One more than there should be, so that none is cut off unseen: a line that ends in CR among others in LF is not counted.
    most = max(last - layout.first_line + 2, 1)
    try:
        values = _opened(layout, most)
        if len(values) == most:
            values = _opened(layout, None)
    except UnicodeDecodeError:
        return None
    return values, last


def _opened(layout: Layout, most: int | None) -> np.ndarray:
    """The first ``most`` rows of a file that NumPy opens: where it knows how many come, it takes memory for them once."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Input line")  # A blank one, which it tells of where the rows are limited.
        return np.loadtxt(
            str(layout.source.path),
            delimiter=layout.separator,
            comments="#",
            ndmin=2,
            encoding=layout.source.encoding,
            skiprows=layout.first_line - 1,
            max_rows=most,
        )


def _by_lines(layout: Layout, comma: bool) -> tuple[np.ndarray, int]:
    """As `_at_once`, of any file."""
    with layout.source.lines(layout.first_line - 1) as file:
        values = _load(itertools.chain.from_iterable(_lines(file, comma)), layout)
        return values, last_line(file)


def _pointed(text: str) -> str:
    """Text with decimal points. A point in a file of decimal commas may mark thousands: it is made unreadable here."""
    return text.replace(".", "_").replace(",", ".")


def _lines(file: TextIO, comma: bool) -> Iterator[list[str]]:
    """The lines of a file, many at once: that is faster than one by one."""
    rest = ""
    while chunk := file.read(CHUNK):
        lines = (rest + (_pointed(chunk) if comma else chunk)).split("\n")
        rest = lines.pop()
        yield lines
    if rest:
        yield [rest]


def _is_decimal_comma(layout: Layout, decimal: str | None) -> bool:
    """Whether the first lines prove that the comma is the decimal mark of every column that has one."""
    rows = [split(line, layout.separator) for line in layout.sample]
    columns: list[Cells] = [judged(column) for column in zip(*rows, strict=False)]
    proved = any("," in column.proof for column in columns) or decimal == ","
    return proved and decimal != "." and not any("." in column.proof for column in columns)


def _may_group(layout: Layout, values: np.ndarray, comma: bool, decimal: str | None) -> bool:
    """Whether a column may hold counts with points for marks of thousands: `numbers` looks at every cell then.

    So it is where the first cells are whole or have three digits behind the point, and not all numbers of the column are whole.
    """
    if comma:
        return False
    rows = zip(*(split(line, layout.separator) for line in layout.sample), strict=False)
    for column, numbers in zip(rows, values.T, strict=False):
        pointed = [cell for cell in column if "." in cell]
        doubtful = all(map(TWO_WAYS, pointed)) and (decimal == "," or len(pointed) < len(column))
        if doubtful and not np.array_equal(numbers, np.round(numbers)):
            return True
    return False


def _line_numbers(layout: Layout, rows: int) -> np.ndarray | None:
    """Line of each row where comments or blank lines stand between them."""

    def numbered() -> Iterator[int]:
        with layout.source.lines(layout.first_line - 1) as file:
            for number, line in enumerate(file, layout.first_line):
                if line.partition("#")[0].strip():
                    yield number

    lines = np.fromiter(numbered(), dtype=np.int64)
    return lines if lines.size == rows else None
