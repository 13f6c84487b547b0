"""`read_text`: a text table as a `Table`."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..table import Column, Table
from .by_cell import read_cells
from .layout import find_layout
from .numbers import read_numbers
from .opening import open_text
from .plain import read_plain
from .turned import lies_on_its_side, read_turned

X_OF_LABVIEW = "X_Value"
"""The first column of LabVIEW's files; where X_Columns is No it is empty, and Delta_X above the table says what it would hold."""


def read_text(path: Path, skip: int = 0, decimal: str | None = None) -> Table:
    """The columns of a text table.

    Parameters
    ----------
    path : Path
        An existing file; packed by gzip or not, whatever its suffix.
    skip : int
        Lines at the beginning to pass over unseen.
    decimal : str or None
        "." or ",": what it means where a comma or a point can be read in two ways. None refuses such a file.

    Returns
    -------
    Table
        Columns in the order of the file, with NaN where a cell holds no number, and text where a column is no column of
        numbers. `Table.lines` gives the line of each row where rows do not follow each other.

    Raises
    ------
    BadInput
        Naming the line and column that cannot be read, or what is wrong with the file as a whole.

    Examples
    --------
    >>> read_text(Path("rec.csv")).names  # doctest: +SKIP
    ['Time [s]', 'x [deg]', 'z [deg]']
    """
    layout = find_layout(open_text(path), skip)
    if lies_on_its_side(layout):
        return read_turned(layout, decimal)
    units, notes = list(layout.units), list(layout.notes)
    lines: np.ndarray | None
    plain = read_plain(layout, decimal)
    if plain is not None:
        matrix, mark, lines = plain
        columns = list(np.ascontiguousarray(matrix.T))
    else:
        cells, lines, more = read_cells(layout)
        numbers = lines

        def place(row: int) -> str:
            return f"{path} line {numbers[row]}"

        columns, behind, also, mark = read_numbers(cells, layout.names, decimal, place, layout.separator != ",")
        units = [unit or other for unit, other in zip(units, behind, strict=True)]
        notes += more + also
        if np.array_equal(lines, np.arange(layout.first_line, layout.first_line + lines.size)):
            lines = None
    if layout.names[0] == X_OF_LABVIEW and layout.rate_hz and columns[0].dtype.kind == "f" and np.isnan(columns[0]).all():
        columns[0] = np.arange(columns[0].size) / layout.rate_hz
        notes.append(f"the empty column {X_OF_LABVIEW} is filled with times at the rate that the file states")
    return Table(
        columns=tuple(map(Column, layout.names, columns, units)),
        format="csv",
        details=layout.details(mark, skip),
        notes=tuple(notes),
        rate_hz=layout.rate_hz,
        first_line=layout.first_line,
        lines=lines,
    )
