"""What a sample should be by its neighbours, and runs of equal flags: the arithmetic that several checks share."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

POSITIONS = ("x", "y", "z")
"""Channels of things that have mass, and so neither jump nor stand out for a single sample; forces may."""

SURPRISE_OF_NOISE = 1.39
"""Standard deviation of `surprise` under white noise of standard deviation 1."""

_EVERY = 65536
"""Samples from which a level is taken: its error is under a percent, and a long record costs no more."""


def surprise(values: np.ndarray) -> np.ndarray:
    """How far each sample lies from the cubic through the two before and the two after it.

    Parameters
    ----------
    values : array of shape (N,), N >= 5, at even steps

    Returns
    -------
    array of shape (N,)
        In the unit of the values, 0 for the first and the last two. White noise of standard deviation s gives 1.39 s; a single
        sample off by S gives S (1, -4, 6, -4, 1)/6 around it, and a lasting shift by S gives S (-1, 3, -3, 1)/6.
    """
    out = np.zeros_like(values)
    out[2:-2] = values[2:-2] - (4.0 * (values[1:-3] + values[3:-1]) - values[:-4] - values[4:]) / 6.0
    return out


def level(surprises: np.ndarray) -> float:
    """Standard deviation of a channel's noise by the median of its surprises; too high where the motion is coarsely sampled."""
    some = surprises[:: max(1, surprises.size // _EVERY)]
    return float(np.median(np.abs(some))) / (0.6745 * SURPRISE_OF_NOISE)


def around(size: np.ndarray, rows: np.ndarray, near: int = 4, far: int = 20, share: float = 0.8) -> np.ndarray:
    """What is usual around some rows: the quantile ``share`` of ``size`` (N,) at ``near`` to ``far`` rows to either side."""
    offsets = np.concatenate([np.arange(-far, -near + 1), np.arange(near, far + 1)])
    at = rows[:, None] + offsets
    # Beyond an end of the record the other side is looked at twice.
    at = np.where((at < 2) | (at >= size.size - 2), 2 * rows[:, None] - at, at)
    return np.quantile(size[np.clip(at, 2, max(size.size - 3, 2))], share, axis=1)


def runs(flags: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First rows and lengths of the runs of True in an array of shape (N,)."""
    edges = np.flatnonzero(np.diff(flags.astype(np.int8), prepend=np.int8(0), append=np.int8(0)))
    return edges[::2], edges[1::2] - edges[::2]


def quantum(values: np.ndarray) -> float:
    """The smallest step between samples that is no rounding of double precision; 0 for a constant."""
    steps = np.abs(np.diff(values))
    steps = steps[steps > 1e-13 * np.abs(values).max(initial=0.0)]
    return float(steps.min(initial=np.inf)) if steps.size else 0.0


def listed_rows(rows: np.ndarray | list[int], most: int = 6) -> str:
    """Rows (from 0) as a person counts them: "row 12", "rows 12, 31 and 40", "rows 12, 31, ... (14 of them)"."""
    names = [str(int(row) + 1) for row in rows[:most]]
    if len(rows) == 1:
        return f"row {names[0]}"
    if len(rows) > most:
        return f"rows {', '.join(names)}, ... ({len(rows)} of them)"
    return f"rows {', '.join(names[:-1])} and {names[-1]}"


def bridge(values: np.ndarray, rows: Sequence[int] | np.ndarray) -> np.ndarray:
    """Values whose samples at ``rows`` (from 0) are replaced by a cubic through the two good ones on either side."""
    rows = np.unique(np.asarray(rows, dtype=int))
    good = np.ones(values.size, dtype=bool)
    good[rows] = False
    kept = np.flatnonzero(good)
    out = values.copy()
    if kept.size < 4 or not rows.size:
        return out
    first = np.clip(np.searchsorted(kept, rows) - 2, 0, kept.size - 4)
    knots = kept[first[:, None] + np.arange(4)]
    # Lagrange's form of the cubic through four points, for all rows at once.
    total = np.zeros(rows.size)
    for i in range(4):
        term = values[knots[:, i]]
        for j in range(4):
            if j != i:
                term = term * (rows - knots[:, j]) / (knots[:, i] - knots[:, j])
        total += term
    out[rows] = total
    return out
