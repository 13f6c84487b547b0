"""Short runs of missing values bridged, only on request: `--resample`."""

from __future__ import annotations

import warnings

import numpy as np

from .checks import wrong
from .rows_used import RowsUsed

LONGEST = 5
"""Missing samples in a row that are bridged: what a spline through the neighbours still follows at ten samples a swing."""


def bridged(t: np.ndarray, channels: dict[str, np.ndarray], rows: RowsUsed, where: str) -> dict[str, np.ndarray]:
    """The channels with runs of at most `LONGEST` NaN filled along a cubic spline through their neighbours; warns of the rows.

    Parameters
    ----------
    t : array of shape (N,), s
    channels : dict of arrays of shape (N,)
    rows : RowsUsed
        Tells the rows and lines of the file.
    where : str
        The file, for the sentences.

    Raises
    ------
    BadInput
        When a run is longer.
    """
    whole = {}
    for name, values in channels.items():
        missing = np.isnan(values)
        if not missing.any() or values.size != t.size:
            whole[name] = values
            continue
        first, last = _runs(missing)
        long = np.flatnonzero(last - first + 1 > LONGEST)
        if long.size:
            run = long[0]
            count = int(last[run] - first[run] + 1)
            found = f"{count} missing values in a row from {rows.place(int(first[run]))} on"
            raise wrong(f"{where}, column {name}", found, f"at most {LONGEST} in a row, even with --resample")
        from scipy.interpolate import CubicSpline  # a sixth of a second to import, and few records need it

        filled = values.copy()
        filled[missing] = CubicSpline(t[~missing], values[~missing])(t[missing])
        whole[name] = filled
        places = ", ".join(rows.place(int(row)) for row in first[:3])
        more = f" and {first.size - 3} more" if first.size > 3 else ""
        count = int(missing.sum())
        warnings.warn(f"{where}, column {name}: {count} missing values are bridged, at {places}{more}.", stacklevel=3)
    return whole


def _runs(flags: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and last index of each run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(np.int8), [0]))))
    return edges[::2], edges[1::2] - 1
