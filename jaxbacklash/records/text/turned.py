"""Tables that lie on their side: one line for each channel, its name first and then its samples."""

from __future__ import annotations

import numpy as np

from ..checks import wrong
from ..header_units import split_unit
from ..table import Column, Table
from .by_cell import read_cells
from .cells import NUMBER, WORD
from .layout import Layout
from .numbers import read_numbers

MOST_CHANNELS, FEWEST_SAMPLES = 40, 64
"""A table of no more lines than this, each of at least as many numbers, lies on its side: no record is so short and so wide."""


def lies_on_its_side(layout: Layout) -> bool:
    """Whether lines are channels: a name and then numbers, many more than there are lines."""
    wide = len(layout.kinds) > FEWEST_SAMPLES and set(layout.kinds[1:]) <= {NUMBER, "-"} and layout.kinds[0] in (WORD, NUMBER)
    return wide and layout.whole and 1 < len(layout.sample) <= MOST_CHANNELS and layout.header_line is None


def read_turned(layout: Layout, decimal: str | None) -> Table:
    """The channels of such a table; see `read_text`.

    Raises
    ------
    BadInput
        A cell is no number, or lines are of unequal length.
    """
    cells, lines, notes = read_cells(layout)
    rows = list(zip(*cells, strict=True))
    named = layout.kinds[0] == WORD
    names = [row[0].strip() if named else f"column {place}" for place, row in enumerate(rows, 1)]

    def place(sample: int) -> str:
        return f"{layout.source.path}, sample {sample + 1}"

    values, behind, more, mark = read_numbers([row[named:] for row in rows], names, decimal, place)
    bad = next((number for number, each in enumerate(values) if each.dtype.kind == "U"), None)
    if bad is not None:
        raise wrong(f"{layout.source.path} line {lines[bad]}", "words among the values of a channel", "numbers")
    units = [split_unit(name)[1] or unit for name, unit in zip(names, behind, strict=True)]
    note = f"each line is taken for a channel: {len(names)} channels of {values[0].size} samples"
    return Table(
        columns=tuple(
            Column(name, np.ascontiguousarray(each), unit) for name, each, unit in zip(names, values, units, strict=True)
        ),
        format="csv",
        details=layout.details(mark, 0),
        notes=(*(each for each in layout.notes if "no line of names" not in each), *notes, *more, note),
        rate_hz=layout.rate_hz,
    )
