"""The thorough way to read a text table: every line cut into cells, for tables that hold more than plain numbers.

It passes over what stands between and below the rows (blank lines, comments, a header that comes again, a footer), and
refuses a line with too few or too many values by its number.
"""

from __future__ import annotations

import csv
import gc
import re
from collections.abc import Sequence

import numpy as np

from ..checks import listed, wrong
from .cells import NUMBER, STAMP, WORD, kind, unframed
from .head import COMMENT
from .layout import Layout

FOOTER = re.compile(r"\W*[^\W\d_]")
"""How a line below the table begins: with a word. One that begins with a digit is half a row."""

LONGEST_FOOTER = 50
"""Lines below a table that may be a footer."""


def read_cells(layout: Layout) -> tuple[list[Sequence[str]], np.ndarray, list[str]]:
    """The cells of a table by column.

    Returns
    -------
    columns : list of sequences of str
    lines : array of shape (N,)
        Line of each row in the file.
    notes : list of str

    Raises
    ------
    BadInput
        Naming the line that has too few or too many values, a quote without end or NUL bytes.
    """
    # Millions of small lists make Python's collector of cycles walk through them again and again; there are no cycles.
    collecting = gc.isenabled()
    gc.disable()
    try:
        return _read_cells(layout, str(layout.source.path), layout.first_line)
    finally:
        if collecting:
            gc.enable()


def _read_cells(layout: Layout, where: str, first: int) -> tuple[list[Sequence[str]], np.ndarray, list[str]]:
    with layout.source.lines(first - 1) as file:
        lines = list(file)
    bad = next((row for row, line in enumerate(lines) if "\0" in line), None)
    if bad is not None:
        raise wrong(f"{where} line {bad + first}", "NUL bytes", "text (delete the line, or copy the file again)")
    rows = _cut(lines, layout, where)
    notes: list[str] = []
    kept = [
        row
        for row, cells in enumerate(rows)
        if cells and not (cells[0][:1] in _MARKS and _passed(lines[row], layout)) and (len(cells) > 1 or cells[0].strip(" \x1a"))
    ]
    kept = _without_repeats(kept, rows, lines, layout, notes)
    kept = _without_footer(kept, rows, lines, layout, notes)
    width = len(layout.names)
    blank = set()
    for row in [row for row in kept if len(rows[row]) != width]:
        rows[row] = _mended(rows[row], lines[row], layout)
        if not any(cell.strip() for cell in rows[row]):
            blank.add(row)
        elif len(rows[row]) != width:
            cut = row == len(lines) - 1 and not lines[row].endswith("\n")
            _refuse_line(f"{where} line {row + first}", rows[row], layout.names, cut)
    kept = [row for row in kept if row not in blank] if blank else kept
    columns: list[Sequence[str]] = list(zip(*(rows[row] for row in kept), strict=True))
    return columns, np.array(kept, dtype=np.int64) + first, notes


_MARKS = frozenset("#%/;!")


def _passed(line: str, layout: Layout) -> bool:
    return COMMENT.match(line) is not None or (layout.separator != ";" and line.lstrip().startswith(";"))


def _cut(lines: list[str], layout: Layout, where: str) -> list[list[str]]:
    """Cells of each line; a line may not end inside a quote."""
    if layout.separator is None:
        if not any('"' in line for line in lines):
            return [line.split() for line in lines]
        lines = [line.replace("\t", " ").strip() for line in lines]
    elif layout.separator == "|":
        lines = [unframed(line) for line in lines]
    csv.field_size_limit(2**31 - 1)
    rows = list(csv.reader(lines, delimiter=layout.separator or " ", skipinitialspace=True))
    if len(rows) != len(lines):
        bad = next(row for row, line in enumerate(lines) if line.count('"') % 2)
        wanted = "a second one in the same line"
        raise wrong(f"{where} line {bad + layout.first_line}", "a quotation mark without an end", wanted)
    return rows


def _valued(cells: list[str], layout: Layout) -> bool:
    """Whether a line has the make of a row: its width, and a value or nothing where rows have their first value."""
    first = next((place for place, each in enumerate(layout.kinds) if each in (NUMBER, STAMP)), 0)
    cells = _trimmed(cells, len(layout.names))
    return len(cells) == len(layout.names) and kind(cells[first].strip()) != WORD


def _trimmed(cells: list[str], width: int) -> list[str]:
    """Cells without the empty ones that separators at the end of the line make."""
    while len(cells) > width and not cells[-1].strip():
        cells = cells[:-1]
    return cells


def _mended(cells: list[str], line: str, layout: Layout) -> list[str]:
    """A line without what follows its last value: separators, or a comment."""
    width = len(layout.names)
    cells = _trimmed(cells, width)
    if len(cells) != width and "#" in line:
        bare = line.partition("#")[0]
        cells = bare.split() if layout.separator is None else next(csv.reader([bare], delimiter=layout.separator), [])
        cells = _trimmed(cells, width)
    return cells


def _without_repeats(kept: list[int], rows: list[list[str]], lines: list[str], layout: Layout, notes: list[str]) -> list[int]:
    """Rows without headers that come again, as in logs that were joined, and without what stands above those."""
    repeated = frozenset(layout.repeated)
    if not repeated:
        return kept
    again = [place for place, row in enumerate(kept) if lines[row].strip(" \t\r\n\ufeff") in repeated]
    if not again:
        return kept
    dropped = set()
    for place in again:
        dropped.add(place)
        above = place - 1
        while above >= 0 and above not in dropped and not _valued(rows[kept[above]], layout):
            dropped.add(above)
            above -= 1
    line = kept[again[0]] + layout.first_line
    others = sorted(dropped - set(again))
    lost = (
        f" ({len(others)} lines above it, from line {kept[others[0]] + layout.first_line} on, are passed over)" if others else ""
    )
    notes.append(
        f"the header comes again at line {line}, as where logs were joined; the rows below it go on from those above{lost}"
    )
    return [row for place, row in enumerate(kept) if place not in dropped]


def _without_footer(kept: list[int], rows: list[list[str]], lines: list[str], layout: Layout, notes: list[str]) -> list[int]:
    """Rows without the lines of words below the table."""
    end = len(kept)
    while end > max(1, len(kept) - LONGEST_FOOTER) and not _valued(rows[kept[end - 1]], layout):
        end -= 1
    below = kept[end:]
    while end < len(kept) and not FOOTER.match(lines[kept[end]]):
        end += 1
    if end < len(kept):
        first, last = kept[end] + layout.first_line, kept[-1] + layout.first_line
        which = f"lines {first} to {last} below the table are" if last > first else f"line {first} below the table is"
        notes.append(f"{which} passed over")
    # Rows of nothing but separators, as spreadsheets keep them below the last one.
    while end > 1 and not any(cell.strip() for cell in rows[kept[end - 1]]):
        end -= 1
    return kept[:end] if below or end < len(kept) else kept


def _refuse_line(where: str, cells: list[str], names: Sequence[str], cut: bool) -> None:
    """Refuse a line with too few or too many values."""
    if cut and len(cells) < len(names):
        found = f"{len(cells)} of {len(names)} values and then the end of the file, which looks half-written"
        raise wrong(where, found, "a complete last line (delete it or copy the file again)")
    raise wrong(where, f"{len(cells)} value{'s' * (len(cells) != 1)}", f"{len(names)} ({listed(names)})")
