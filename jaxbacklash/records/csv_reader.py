"""Text tables: a header line of names, then one line of numbers per sample.

Commas, semicolons, tabs or blanks may separate the values; decimal commas are understood where the separator is not the
comma. Lines that begin with # are comments. NumPy's reader does the work when every value is a number; a second, slower
reading names the line and column that are wrong, and copes with text in columns that nobody asked for.
"""

import codecs
import csv
import itertools
import math
from collections.abc import Collection, Iterable
from pathlib import Path
from typing import NamedTuple, TextIO

import numpy as np

from .checks import listed, wrong

SNIFFED_BYTES = 65536


class Layout(NamedTuple):
    """How the text is written: what the first lines tell."""

    encoding: str
    separator: str | None  # None: any run of blanks
    decimal_comma: bool
    names: list[str]
    first_line: int  # lines before the first line of values


def read_csv(path: Path, wanted: Collection[str]) -> dict[str, np.ndarray]:
    """The columns of a text table.

    Parameters
    ----------
    path : Path
    wanted : collection of str
        Columns that must hold finite numbers; others may hold anything.

    Returns
    -------
    dict of arrays of shape (N,)
        float64, or text for a column not wanted that is not all numbers.

    Raises
    ------
    BadInput
        Naming the line and column that cannot be read, or what is wrong with the file as a whole.
    """
    layout = _sniff(path)
    try:
        with open(path, encoding=layout.encoding, errors="replace") as file:
            values = np.loadtxt(_lines_of_values(file, layout), delimiter=layout.separator, comments="#", ndmin=2)
    except ValueError:
        return _read_slowly(path, layout, wanted)
    strict = [number for number, name in enumerate(layout.names) if name in wanted]
    if values.shape[1] != len(layout.names) or not np.isfinite(values[:, strict]).all():
        return _read_slowly(path, layout, wanted)
    return {name: np.ascontiguousarray(column) for name, column in zip(layout.names, values.T, strict=True)}


def _sniff(path: Path) -> Layout:
    """What the first lines tell; refuses a file that is no table."""
    with open(path, "rb") as file:
        head = file.read(SNIFFED_BYTES)
    encoding = _encoding(head, path)
    with open(path, encoding=encoding, errors="replace") as file:
        comment = None
        for number, line in enumerate(file, start=1):
            if line.startswith("#"):
                comment = line
            elif line.strip():
                header_line = number
                break
        else:
            raise wrong(str(path), "only blank lines or comments", "a header line and numbers")
        separator = next((mark for mark in "\t;," if mark in line), None)
        names, first_line = _cells(line, separator), header_line
        if all(_is_number(name, separator != ",") for name in names):
            # numpy.savetxt writes its header as a comment: take the last comment if it has a name for each value.
            commented = _cells((comment or "").lstrip("# "), separator)
            if len(commented) != len(names) or any(_is_number(name, True) for name in commented):
                wanted = "a header line with the names of the columns such as t,x,z"
                raise wrong(f"{path} line {header_line}", "numbers", wanted)
            names, first_line, sample = commented, header_line - 1, line
        else:
            sample = next((each for each in file if each.strip() and not each.startswith("#")), "")
    if not sample:
        raise wrong(str(path), "a header line and no values below it", "one line of numbers per sample")
    # pandas writes its index under an empty name, spreadsheets end each line with a separator.
    names = [name or f"column {column}" for column, name in enumerate(names, start=1)]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise wrong(f"{path} line {first_line}", f'the column name "{twice}" more than once', "each name once")
    return Layout(encoding, separator, separator != "," and "," in sample, names, first_line)


def _encoding(head: bytes, path: Path) -> str:
    """The encoding that the first bytes show; refuses an empty or a binary file."""
    if head.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    if not head.strip():
        raise wrong(str(path), "an empty file", "a header line and numbers")
    if any(byte < 32 and byte not in b"\t\n\r\f\v\x1a" for byte in head):
        raise wrong(str(path), "binary data", "text (a .npz or .mat file must keep its suffix)")
    try:
        # Not final: the cut may go through a character.
        codecs.utf_8_decode(head, "strict", False)
    except UnicodeDecodeError:
        return "latin-1"
    return "utf-8-sig"


def _lines_of_values(file: TextIO, layout: Layout) -> Iterable[str]:
    """What follows the header, with decimal points."""
    for _ in itertools.islice(file, layout.first_line):
        continue
    return (line.replace(",", ".") for line in file) if layout.decimal_comma else file


def _cells(line: str, separator: str | None) -> list[str]:
    """The values of one line."""
    if separator is None:
        return line.split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])]


def _number(cell: str, comma: bool) -> float:
    """A cell as a number; ValueError if it is none. A comment may follow it."""
    cell = cell.partition("#")[0]
    return float(cell.replace(",", ".") if comma else cell)


def _is_number(cell: str, comma: bool) -> bool:
    try:
        _number(cell, comma)
    except ValueError:
        return False
    return True


def _read_slowly(path: Path, layout: Layout, wanted: Collection[str]) -> dict[str, np.ndarray]:
    """The columns read line by line, so that a refusal can name the line."""
    names = layout.names
    strict = [(column, name) for column, name in enumerate(names) if name in wanted]
    comma = layout.separator != ","
    rows: list[list[str]] = []
    numbers: list[list[float]] = []
    with open(path, encoding=layout.encoding, errors="replace") as file:
        for line_number, line in enumerate(file, start=1):
            if line_number <= layout.first_line or not line.strip() or line.startswith("#"):
                continue
            cells = _cells(line, layout.separator)
            while len(cells) > len(names) and not cells[-1]:
                cells.pop()
            if len(cells) != len(names):
                _refuse_line(f"{path} line {line_number}", cells, names, cut=not line.endswith("\n"))
            rows.append(cells)
            place = f"{path} line {line_number}, column"
            numbers.append([_strict_number(cells[column], f"{place} {name}", comma) for column, name in strict])
    read = dict(zip([name for _, name in strict], np.array(numbers, dtype=float).reshape(len(rows), len(strict)).T))
    texts = {name: [cells[column] for cells in rows] for column, name in enumerate(names) if name not in read}
    loose = {name: _loose_column(column, comma) for name, column in texts.items() if any(column)}
    return {name: (read | loose)[name] for name in names if name in read or name in loose}


def _strict_number(cell: str, where: str, comma: bool) -> float:
    """A cell as a finite number, or a refusal."""
    try:
        value = _number(cell, comma)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        found = f'"{cell[:40]}"' if cell else "an empty cell"
        kind = "a finite number" if _is_number(cell, comma) else "a number"
        raise wrong(where, found, kind)
    return value


def _loose_column(cells: list[str], comma: bool) -> np.ndarray:
    """A column nobody asked for: numbers with NaN for empty cells if it can be, else text."""
    try:
        return np.array([_number(cell, comma) if cell else math.nan for cell in cells])
    except ValueError:
        return np.array(cells)


def _refuse_line(where: str, cells: list[str], names: list[str], cut: bool) -> None:
    """Refuse a line with too few or too many values."""
    if cut and len(cells) < len(names):
        found = f"{len(cells)} of {len(names)} values and then the end of the file, which looks half-written"
        raise wrong(where, found, "a complete last line (delete it or copy the file again)")
    raise wrong(where, f"{len(cells)} value{'s' * (len(cells) != 1)}", f"{len(names)} ({listed(names)})")
