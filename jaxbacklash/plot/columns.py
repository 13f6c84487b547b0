"""One small picture for each column of a file, as `look` shows it."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from ..records.description import ColumnFacts
from .drawing import Where, empty, panels, picture
from .style import MEASURED, SHORT, with_unit
from .thinning import envelope


@picture
def column_over_rows(facts: ColumnFacts, begins: int, *, ax: Where = None) -> list[Axes]:
    """A column over its rows, whole above and, below, the stretch in which it moves most.

    Parameters
    ----------
    facts : the column
    begins : number that the file gives its first row (1, or the line)
    ax : where to draw; on one axes, all rows
    """
    values = facts.column.values
    if values.dtype.kind != "f" or not np.isfinite(values).any():
        return empty(ax, "No numbers to draw.")
    axes = panels(ax, 1, 2, height=SHORT, width_ratios=(2, 1))
    whole = axes[0]
    rows = np.arange(values.size) + float(begins)
    at, low, high = envelope(rows, values)
    whole.fill_between(at, low, high, color=MEASURED, lw=0.8)
    across = "line of the file" if begins > 1 else "row"
    whole.set(ylabel=with_unit(facts.role or facts.name, facts.unit or "as in the file"), xlabel=across)
    whole.set_xlim(rows[0], rows[-1])
    if len(axes) == 1:
        return axes
    close = axes[1]
    whole.set_title("all rows", loc="left")
    first, last = _busiest(values)
    close.plot(rows[first:last], values[first:last], color=MEASURED, marker=".", ms=3, lw=0.8)
    close.set_title("where it moves most, row by row", loc="left")
    close.set(xlim=(rows[first], rows[last - 1]), xlabel=across)
    return axes


def _busiest(values: np.ndarray, length: int = 100) -> tuple[int, int]:
    """The stretch of ``length`` rows in which a column varies most."""
    if values.size <= length:
        return 0, values.size
    pieces = values[: values.size // length * length].reshape(-1, length)
    known = np.where(np.isfinite(pieces), pieces, np.nan)
    with np.errstate(invalid="ignore"):
        spread = np.array([np.ptp(piece[np.isfinite(piece)]) if np.isfinite(piece).any() else 0.0 for piece in known])
    first = int(np.argmax(spread)) * length
    return first, first + length
