"""Samples averaged in cells, so that a long record is a few thousand rows: a cell is a stretch of one pass."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

TO_A_PASS = 40
"""Cells to a pass, at most."""
AT_ONCE = 100_000
"""Samples that a function is evaluated at together."""
MOST_ROWS = 12_000
"""Cells of all passes together."""


@dataclass(frozen=True)
class Cells:
    """Which samples go together: ``order`` (M,) of the samples used, ``begins`` (R,) of each cell in it, ``size`` (R,), the
    ``group`` (R,) that the cell's rows err with, and into how many ``parts`` what they are cut along was divided."""

    order: np.ndarray
    begins: np.ndarray
    size: np.ndarray
    group: np.ndarray
    parts: int

    def mean(self, values: np.ndarray) -> np.ndarray:
        """The mean of values (N,) or (N, K) in each cell."""
        sums = np.add.reduceat(values[self.order], self.begins, axis=0)
        return sums / (self.size if values.ndim == 1 else self.size[:, None])

    def mean_of(self, function: Callable[[np.ndarray], np.ndarray], values: np.ndarray) -> np.ndarray:
        """The mean in each cell of a function of values (N,), which makes (N, K) of them: a part of the samples at a time."""
        ends = np.append(self.begins[1:], self.order.size)
        whole, first = [], 0
        while first < self.begins.size:
            last = max(first + 1, int(np.searchsorted(ends, self.begins[first] + AT_ONCE, side="right")))
            start = int(self.begins[first])
            rows = function(values[self.order[start : ends[last - 1]]])
            whole.append(np.add.reduceat(rows, self.begins[first:last] - start, axis=0))
            first = last
        return np.concatenate(whole) / self.size[:, None]

    @property
    def weights(self) -> np.ndarray:
        """Weight of each cell: its size where it is small, and no more for a long rest in one place."""
        return self.size / (self.size + np.median(self.size))


def cells(group: np.ndarray, along: np.ndarray, used: np.ndarray) -> Cells:
    """Cells of equal parts along each group.

    Parameters
    ----------
    group : (N,) whole numbers: of which samples err together
    along : (N,) what is cut into parts within a group: the angle, or the time
    used : (N,) which samples count
    """
    index = np.flatnonzero(used)
    own, place = group[index], along[index]
    count = np.unique(own).size
    parts = int(np.clip(MOST_ROWS // max(count, 1), 1, TO_A_PASS))
    low, high = float(place.min()), float(place.max())
    part = np.minimum((parts * (place - low) / max(high - low, 1e-300)).astype(int), parts - 1)
    key = own.astype(np.int64) * parts + part
    order = np.argsort(key, kind="stable")
    begins = np.flatnonzero(np.append(True, np.diff(key[order]) != 0))
    size = np.diff(np.append(begins, key.size))
    return Cells(index[order], begins, size.astype(float), own[order][begins], parts)
