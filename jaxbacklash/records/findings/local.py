"""What a sample should be by its neighbours, and runs of equal flags: the arithmetic that several checks share."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

SURPRISE_OF_NOISE = 1.39
"""Standard deviation of `surprise` under white noise of standard deviation 1."""

MEDIAN = 0.6745
"""Median of the size of white noise of standard deviation 1."""

EVERY = 65536
"""Samples from which a level is taken: its error is under a percent, and a long record costs no more."""
_PIECE = 16384
"""Samples that are worked on at once."""
MULTIPLES = 200
"""Times what a channel is counted in up to which its steps are looked at: larger ones are near some multiple of anything."""
RANKS, SHARE = (0, 1, 2, 4, 8, 16), 200
"""Places among the sorted steps, and the share of them, up to which one is tried as what a channel is counted in."""


def surprise(values: np.ndarray) -> np.ndarray:
    """How far each sample lies from the cubic through the two before and the two after it.

    Parameters
    ----------
    values : array of shape (N,), N >= 5, at even steps

    Returns
    -------
    array of shape (N,)
        In the unit of the values, 0 for the first and the last two. White noise of standard deviation s gives 1.39 s; a single
        sample off by S gives S (1, -4, 6, -4, 1)/6 around it, and a lasting shift by S gives S (1, -3, 3, -1)/6.
    """
    out = np.zeros_like(values)
    # In pieces that stay in the processor's cache: three times as fast over a million samples.
    for first in range(0, values.size - 4, _PIECE):
        part = values[first : first + _PIECE + 4]
        out[first + 2 : first + part.size - 2] = part[2:-2] - (4.0 * (part[1:-3] + part[3:-1]) - part[:-4] - part[4:]) / 6.0
    return out


def within(values: np.ndarray, limit: float) -> int:
    """How many values (N,) are less than ``limit`` in size."""
    return int(np.count_nonzero((values < limit) & (values > -limit)))


def level(surprises: np.ndarray) -> float:
    """Standard deviation of a channel's noise by the median of its surprises; too high where the motion is coarsely sampled."""
    some = surprises[:: max(1, surprises.size // EVERY)]
    return float(np.median(np.abs(some))) / (MEDIAN * SURPRISE_OF_NOISE)


def around(size: np.ndarray, rows: np.ndarray, near: int = 4, far: int = 20, share: float = 0.8) -> np.ndarray:
    """What is usual around some rows: the quantile ``share`` of ``size`` (N,) at ``near`` to ``far`` rows to either side."""
    offsets = np.concatenate([np.arange(-far, -near + 1), np.arange(near, far + 1)])
    at = rows[:, None] + offsets
    # Beyond an end of the record the other side is looked at twice.
    at = np.where((at < 2) | (at >= size.size - 2), 2 * rows[:, None] - at, at)
    return np.quantile(size[np.clip(at, 2, max(size.size - 3, 2))], share, axis=1)


def runs(flags: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First rows and lengths of the runs of True in an array of shape (N,)."""
    if not flags.size:
        return np.zeros(0, dtype=int), np.zeros(0, dtype=int)
    inner = np.flatnonzero(flags[1:] != flags[:-1]) + 1
    edges = np.concatenate([np.zeros(int(flags[0]), dtype=int), inner, np.full(int(flags[-1]), flags.size)])
    return edges[::2], edges[1::2] - edges[::2]


def common_step(steps: np.ndarray) -> float | None:
    """The step of which the smaller ones of ``steps`` (N,), all above 0, are multiples; None where there is none."""
    if not steps.size:
        return None
    smallest = float(steps.min())
    if _are_multiples(steps[steps < MULTIPLES * smallest], smallest, steps.size):
        return smallest
    # Further ones are tried, since a bridged sample or two are no multiples, and in fast motion single counts are rare.
    steps = np.sort(steps)
    for rank in (*RANKS, steps.size // SHARE):
        count = float(steps[min(rank, steps.size - 1)])
        if _are_multiples(steps[: np.searchsorted(steps, MULTIPLES * count)], count, steps.size):
            return count
    return None


def _are_multiples(small: np.ndarray, count: float, size: int) -> bool:
    """Whether small steps, of ``size`` steps in all, are enough and nearly all multiples of ``count``."""
    if small.size < min(16, size):
        return False
    times = small / count
    return bool(np.count_nonzero(np.abs(times - np.rint(times)) < 0.1) / small.size > 0.9)


def listed_rows(rows: np.ndarray | list[int], most: int = 6) -> str:
    """Rows (from 0) as a person counts them: "row 12", "rows 12, 31 and 40", "rows 12, 31 and 8 more"."""
    names = [str(int(row) + 1) for row in rows[:most]]
    if len(rows) == 1:
        return f"row {names[0]}"
    if len(rows) > most:
        return f"rows {', '.join(names)} and {len(rows) - most} more"
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
