"""Excel workbooks through openpyxl: each sheet as a text table, so that headers, rows of units and preambles are understood in
the same way wherever they stand."""

from __future__ import annotations

import contextlib
import dataclasses
import datetime
import tempfile
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TextIO

from jaxbacklash.errors import BadInput

from ..checks import MIN_SAMPLES, listed, wrong
from ..table import Column, Table
from ..text import read_text
from .arrays import tidy, with_bare_names
from .guard import guarded, library

MAX_UNPACKED = 1 << 30
"""Bytes of the sheets once unpacked; a million rows of ten columns have half of that."""
MAX_CELLS = 40_000_000
"""Cells looked at, empty ones too: more than a full sheet of thirty columns. One cell far to the right makes a row wide."""
ERRORS = ("#N/A", "#DIV/0!", "#VALUE!", "#REF!", "#NAME?", "#NUM!", "#NULL!")
DAMAGED = "a file that is damaged or no Excel workbook"
WANTED = "a workbook saved as .xlsx, or the sheet as .csv"


def read(path: Path, decimal: str | None = None) -> Table:
    """The columns of a workbook.

    Parameters
    ----------
    path : Path
    decimal : str or None
        "." or ",": what it means where a number written as text can be read in two ways.

    Returns
    -------
    Table
        Columns by their header; "sheet/column" where more than one sheet holds a table. Dates become text in ISO form, times of
        day "HH:MM:SS.ffffff", spans of time seconds. What stands for an error becomes NaN.

    Raises
    ------
    BadInput
        openpyxl is missing, the file is damaged or too large, a formula has no stored result, or no sheet holds a table.
    """
    openpyxl = library("openpyxl", "openpyxl", path, "an Excel workbook", ", or save the sheet as .csv")
    tables: dict[str, Table] = {}
    why: dict[str, BadInput] = {}
    with guarded(path, DAMAGED, WANTED):
        _bound_unpacked(path)
        with _open(openpyxl, path, results=True) as book:
            for sheet in book.worksheets:
                try:
                    table = _sheet(sheet, path, decimal)
                except BadInput as bad:
                    why[sheet.title] = bad
                    continue
                if table is not None:
                    tables[sheet.title] = table
        if not tables and not why:
            raise wrong(str(path), "empty sheets", "a table in one of them")
        if not tables:
            _refuse_formulas(openpyxl, path, next(iter(why)))
            raise next(iter(why.values()))
        for title, table in tables.items():
            if any(_has_gaps(column) for column in table.columns):
                _refuse_formulas(openpyxl, path, title)
    left_out = {tidy(title): f"a sheet without a table ({bad})" for title, bad in why.items()}
    most = max(table.rows for table in tables.values())
    for title in [title for title, table in tables.items() if table.rows < MIN_SAMPLES <= most]:
        left_out[tidy(title)] = f"a sheet with no more than {tables.pop(title).rows} rows"
    return dataclasses.replace(_joined(tables), left_out=left_out)


@contextlib.contextmanager
def _open(openpyxl: Any, path: Path, results: bool) -> Iterator[Any]:
    """The workbook, with the results of formulas or the formulas themselves; whatever the suffix of the file."""
    with (
        open(path, "rb") as file,
        contextlib.closing(openpyxl.load_workbook(file, read_only=True, data_only=results, keep_links=False)) as book,
    ):
        yield book


def _bound_unpacked(path: Path) -> None:
    """Refuse an archive that unpacks to more than a sheet can hold."""
    with zipfile.ZipFile(path) as archive:
        size = sum(one.file_size for one in archive.infolist())
    if size > MAX_UNPACKED:
        raise wrong(str(path), f"{size / 1e9:.4g} GB of sheets once unpacked", f"at most {MAX_UNPACKED / 1e9:.2g} GB")


def _sheet(sheet: Any, path: Path, decimal: str | None) -> Table | None:
    """One sheet's table; None where it is empty. Line numbers are those of the sheet's rows."""
    sheet.reset_dimensions()  # what a program wrote there need not be true
    where = f"{path} sheet {tidy(sheet.title)}"
    with tempfile.TemporaryDirectory() as folder:
        lines = Path(folder) / "sheet.tsv"
        with open(lines, "w", encoding="utf-8", newline="") as file:
            if not _write(sheet, file, where):
                return None
        try:
            return read_text(lines, decimal=decimal)
        except BadInput as bad:
            sentence = str(bad).replace(f"{lines} line", f"{where}, row").replace(str(lines), where)
            raise BadInput(sentence, remedy=bad.remedy) from bad


def _write(sheet: Any, file: TextIO, where: str) -> bool:
    """Write a sheet as lines of cells with tabs between them; whether there was any cell."""
    width, empty, seen, any_cell = 0, 0, 0, False
    for row in sheet.iter_rows(values_only=True):
        seen += max(len(row), width)
        if seen > MAX_CELLS:
            raise wrong(where, f"more than {MAX_CELLS} cells", "a record with fewer columns, or the sheet as .csv")
        cells = [_text(cell) for cell in row]
        while cells and not cells[-1]:
            cells.pop()
        if not cells:
            empty += 1  # sheets are often formatted far below their last row
            continue
        any_cell = True
        width = max(width, len(cells))
        file.write("\n" * empty + "\t".join(cells + [""] * (width - len(cells))) + "\n")
        empty = 0
    return any_cell


def _text(cell: Any) -> str:
    """A cell as text that the reader of text tables understands."""
    if cell is None:
        return ""
    if isinstance(cell, bool):
        return str(int(cell))
    if isinstance(cell, float | int):
        # An exponent keeps "1.234" from being read as 1234.
        return f"{cell!r}e0" if "." in repr(cell) and "e" not in repr(cell) else repr(cell)
    if isinstance(cell, datetime.datetime):
        return cell.isoformat(timespec="microseconds")
    if isinstance(cell, datetime.timedelta):
        return repr(cell.total_seconds())
    if isinstance(cell, datetime.time | datetime.date):
        return cell.isoformat()
    text = tidy(str(cell))
    return "nan" if text in ERRORS else text


def _has_gaps(column: Column) -> bool:
    return bool((column.values != column.values).any() if column.values.dtype.kind == "f" else (column.values == "").any())


def _refuse_formulas(openpyxl: Any, path: Path, title: str) -> None:
    """Refuse a sheet in which cells are empty because a program wrote formulas without computing them."""
    with (
        _open(openpyxl, path, results=True) as results,
        _open(openpyxl, path, results=False) as formulas,
    ):
        for row, (found, written) in enumerate(zip(_rows(results[title]), _rows(formulas[title]), strict=False), start=1):
            for number, (value, text) in enumerate(zip(found, written, strict=False)):
                if value is None and isinstance(text, str) and text.startswith("="):
                    cell = f"{openpyxl.utils.get_column_letter(number + 1)}{row}"
                    what = f"the formula {text[:40]} without its result in cell {cell}"
                    wanted = "results (open the workbook in a spreadsheet program and save it again)"
                    raise wrong(f"{path} sheet {tidy(title)}", what, wanted)


def _rows(sheet: Any) -> Iterator[tuple]:
    sheet.reset_dimensions()
    return sheet.iter_rows(values_only=True)


def _joined(tables: dict[str, Table]) -> Table:
    """One table of all sheets."""
    if len(tables) == 1:
        ((title, table),) = tables.items()
        details = {"sheet": title} | {key.replace("line", "row"): value for key, value in table.details.items() if "line" in key}
        return dataclasses.replace(table, format="xlsx", details=details, notes=tuple(map(_of_rows, table.notes)))
    columns = []
    for title, table in tables.items():
        columns += [dataclasses.replace(column, name=f"{tidy(title)}/{column.name}") for column in table.columns]
    notes = [f"sheet {tidy(title)}: {_of_rows(note)}" for title, table in tables.items() for note in table.notes]
    rates = {table.rate_hz for table in tables.values()}
    rate = next(iter(rates)) if len(rates) == 1 else None
    return Table(with_bare_names(columns), "xlsx", {"sheets": listed(tables)}, tuple(notes), rate)


def _of_rows(note: str) -> str:
    """A note about lines of text, as one about rows of a sheet."""
    return note.replace("lines ", "rows ").replace("line ", "row ")
