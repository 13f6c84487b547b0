"""Near points in the space of delay vectors that are not near merely because they follow one another in time."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

BLOCK = 2048  # queries at once: bounds the memory whatever the length of the series
ABSENT = -1


def references(points: int, limit: int, rng: np.random.Generator) -> np.ndarray:
    """Which points are looked at: all of them, or one from each of ``limit`` equal stretches of time, at a random place.

    Parameters
    ----------
    points : how many there are
    limit : how many to keep at most
    rng : decides the places

    Returns
    -------
    increasing indices, shape (min(points, limit),)
    """
    if points <= limit:
        return np.arange(points)
    edges = np.linspace(0, points, limit + 1)
    return np.minimum((edges[:-1] + rng.uniform(0.0, 1.0, limit) * np.diff(edges)).astype(int), points - 1)


def nearest(
    tree: cKDTree, queries: np.ndarray, at: np.ndarray, count: int, theiler: int, *, p: float = 2.0
) -> tuple[np.ndarray, np.ndarray]:
    """The nearest neighbours of points of the same series, those within the Theiler window left out.

    The tree is asked for more and more neighbours until enough lie outside the window, so a finely sampled flow costs little
    more than a map, and no pair is looked at that is not near (Theiler, 1986).

    Parameters
    ----------
    tree : of the points (M, m)
    queries : (R, m) points whose neighbours are wanted
    at : (R,) their indices in the series
    count : neighbours wanted
    theiler : neighbours j with abs(i - j) <= theiler are left out
    p : norm, 2 or infinity

    Returns
    -------
    distances, indices of shape (R, count), nearest first; inf and -1 where a point has fewer
    """
    distances = np.full((at.size, count), np.inf)
    indices = np.full((at.size, count), ABSENT)
    points = tree.n
    # No more than 2 theiler + 1 neighbours lie within the window: with so many to spare, all are found.
    most = min(points, count + 2 * theiler + 1)
    for begin in range(0, at.size, BLOCK):
        open_rows = np.arange(begin, min(begin + BLOCK, at.size))
        asked = min(most, 2 * count + 6)
        while open_rows.size:
            rows_at_once = max(1, BLOCK * 64 // asked)
            still = []
            for start in range(0, open_rows.size, rows_at_once):
                rows = open_rows[start : start + rows_at_once]
                found, where = tree.query(queries[rows], k=asked, p=p)
                found, where = found.reshape(rows.size, -1), where.reshape(rows.size, -1)
                allowed = (np.abs(where - at[rows, None]) > theiler) & np.isfinite(found)
                enough = allowed.sum(axis=1) >= count
                done = enough | (asked >= most)
                # Where a row has enough, its first `count` allowed entries are the answer, already in order.
                taken = allowed & (np.cumsum(allowed, axis=1) <= count)
                distances[rows[enough]] = found[enough][taken[enough]].reshape(-1, count)
                indices[rows[enough]] = where[enough][taken[enough]].reshape(-1, count)
                for short in np.flatnonzero(done & ~enough):
                    has = int(taken[short].sum())
                    distances[rows[short], :has] = found[short][taken[short]]
                    indices[rows[short], :has] = where[short][taken[short]]
                still.append(rows[~done])
            open_rows = np.concatenate(still)
            asked = min(most, 4 * asked)
    return distances, indices
