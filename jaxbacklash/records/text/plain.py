"""The fast way to read a text table: NumPy's reader, for tables in which every cell is a number.

It gives up (returns None) at anything else, and `by_cell` reads the file again.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from typing import TextIO

import numpy as np

from .cells import MISSING, NUMBER, split
from .layout import Layout
from .numbers import LONG, TWO_WAYS, Cells, judged
from .opening import last_line

CHUNK = 2**18
"""Characters read at once."""


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
        with layout.source.lines(layout.first_line - 1) as file:
            values = _load(itertools.chain.from_iterable(_lines(file, comma)), layout)
            consecutive = last_line(file) == layout.first_line + len(values) - 1
    except ValueError:
        return None
    if values.shape[1] != len(layout.names) or (layout.separator != "," and _may_group(layout, values, comma, decimal)):
        return None
    return values, "," if comma else ".", None if consecutive else _line_numbers(layout, len(values))


def _load(lines: Iterable[str], layout: Layout) -> np.ndarray:
    return np.loadtxt(lines, delimiter=layout.separator, comments="#", ndmin=2, quotechar='"' if layout.quoted else None)


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
