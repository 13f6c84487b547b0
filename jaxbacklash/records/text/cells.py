"""What a cell of a text table is: a number, none where one should be, a stamp of time, or words; and lines cut into cells."""

from __future__ import annotations

import csv
import re

from ..header_units import is_unit

NUMBER, STAMP, MISSING, WORD = "nsm-"
"""Kinds of a cell, one letter each, so that a line's kinds are a text."""

_NONE = """
- -- --- ---- *** ? nan -nan nan() -nan(ind) 1.#qnan 1.#ind -1.#ind nat <na> null none nil n/a na n.a. missing invalid
#n/a #nv #value! #div/0! #num! #ref! overflow ovfl over ol o.l o/l
"""
ABSENT = frozenset(["", *_NONE.split()])
"""What programs write where there is no value, in small letters."""

BLANKS = " \u00a0\u2009\u202f"
"""A blank, one that does not break, and two thin ones: marks of thousands in some languages."""

_TEXT_MARKS = frozenset("'=")
_NOT_PLAIN = re.compile('["\r\n]')
"""What makes a line one for the csv module, which takes five times as long as `str.split`."""
_DIGITS = re.compile(
    r"[-+\u2212]?(?:"
    r"(?:\d+(?:[.,]\d+|\.)?|[.,]\d+)(?:[eEdD][-+\u2212]?\d+)?"  # 1.5D-03; the commonest comes first
    r"|\d{1,3}(?:[ '\u2019.,\u00a0\u2009\u202f]\d{3})+(?:[.,]\d+)?"  # 1 234,5
    r")"
)
_INFINITE = re.compile(r"[-+]?(?:inf(?:inity)?|1\.#inf)", re.IGNORECASE)
_STAMP = re.compile(
    r"\d{1,4}([-/.])\d{1,2}\1\d{1,4}(?:[T ,;_-].*)?"  # 2025-11-12 10:03:29, 12.11.2025
    r"|\d{1,2}[- ][A-Za-z]{3,4}\.?[- ]\d{2,4}.*"  # 12-Nov-2025
    r"|[-+]?\d{1,3}:\d{1,2}(?:[:.,]\d+){0,2}(?: ?[AaPp]\.?[Mm]\.?|Z)?"  # 10:03:29.002
    r"|\d{8}T\d{4,6}.*"
)
_WITH_UNIT = re.compile(r"([-+\u2212]?(?:\d+\.?|\d*[.,]\d+)(?:[eEdD][-+\u2212]?\d+)?)\s*([^\d\s.,;:'\"].*)")


def kind(cell: str) -> str:
    """The kind of a cell that is stripped of blanks: `NUMBER`, `STAMP`, `MISSING` or `WORD`."""
    # Spreadsheets mark numbers that are kept as text: '0.5 or ="0.5".
    cell = cell.strip("'=\"") if cell[:1] in _TEXT_MARKS else cell
    if _DIGITS.fullmatch(cell):
        return NUMBER
    if cell.lower() in ABSENT:
        return MISSING
    if _INFINITE.fullmatch(cell):
        return NUMBER
    if _STAMP.fullmatch(cell):
        return STAMP
    return NUMBER if number_and_unit(cell) else WORD


def kinds(cells: list[str]) -> str:
    """The kinds of the cells of a line."""
    return "".join(map(kind, cells))


def number_and_unit(cell: str) -> tuple[str, str] | None:
    """The two halves of a cell such as "1.5 ms"; None for any other cell."""
    found = _WITH_UNIT.fullmatch(cell)
    return (found[1], found[2]) if found and is_unit(found[2]) else None


def split(line: str, separator: str | None) -> list[str]:
    """The cells of a line, stripped of blanks; quotes keep a cell with a separator inside together.

    ``separator`` None stands for any run of blanks.
    """
    line = line.rstrip("\r\n")
    if separator is None:
        if '"' not in line:
            return line.split()
        line, separator = line.replace("\t", " ").strip(), " "
    elif separator == "|":
        line = unframed(line)
    if line and not _NOT_PLAIN.search(line):
        return [cell.strip() for cell in line.split(separator)]
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])]
    except csv.Error:
        return [line]


def unframed(line: str) -> str:
    """A line between bars without the bars at its ends."""
    bare = line.strip()
    return bare[1:].removesuffix("|") if bare.startswith("|") else line


def spread(cells: list[str], width: int) -> list[str]:
    """Cells brought to a width: empty ones at the end are added or, as far as they are empty, cut."""
    while len(cells) > width and not cells[-1]:
        cells = cells[:-1]
    return cells + [""] * (width - len(cells))
