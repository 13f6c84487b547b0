"""Which stretches of a long record deserve a closer look."""

from __future__ import annotations

from typing import Any

import numpy as np

from .drawing import column

NEIGHBOURS = 2  # windows shown on either side of the one that a zoom is about
LONGEST_ZOOM = 4000  # samples; beyond it dots would only be a smear


def window_bounds(t: np.ndarray, window_starts: Any) -> np.ndarray:
    """Sample indices (K + 1,) at which windows begin, and the end; one window when no starts are given."""
    starts = column(window_starts)
    half = 0.5 * (t[1] - t[0])
    inner = np.searchsorted(t, starts[np.isfinite(starts)] - half)
    return np.unique(np.concatenate([[0], inner[inner < t.size], [t.size]]))


def window_misfit(difference: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Root mean square of each window (K,), in the unit of ``difference`` (N,); NaN where samples are too few."""
    finite = np.isfinite(difference)
    power = np.add.reduceat(np.where(finite, difference, 0.0) ** 2, edges[:-1])
    count = np.add.reduceat(finite.astype(float), edges[:-1])
    # A stump of a window at the end of the record would win by chance.
    usable = count >= max(2.0, 0.5 * float(np.median(count)))
    return np.where(usable, np.sqrt(power / np.maximum(count, 1.0)), np.nan)


def worst_and_typical(misfit: np.ndarray) -> tuple[int, int]:
    """Which window is missed most, and which is nearest to the median window, not beside the other if there is a choice."""
    if not np.any(np.isfinite(misfit)):  # nothing to rank: show the middle of the record
        return (misfit.size - 1) // 2, (misfit.size - 1) // 2
    worst = int(np.nanargmax(misfit))
    off = np.abs(misfit - np.nanmedian(misfit))
    apart = np.where(np.abs(np.arange(misfit.size) - worst) > 2 * NEIGHBOURS, off, np.nan)
    return worst, int(np.nanargmin(apart if np.any(np.isfinite(apart)) else off))


def stretch_around(index: int, edges: np.ndarray) -> slice:
    """Samples of a window and its neighbours; of a very long window, its beginning."""
    first = max(0, min(index - NEIGHBOURS, edges.size - 2 - 2 * NEIGHBOURS))
    last = min(edges.size - 1, first + 2 * NEIGHBOURS + 1)
    start, end = int(edges[first]), int(edges[last])
    if end - start > LONGEST_ZOOM:
        start, end = int(edges[index]), min(int(edges[index + 1]), int(edges[index]) + LONGEST_ZOOM)
    return slice(start, max(end, start + 2))
