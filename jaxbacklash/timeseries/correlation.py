"""Correlation sum and correlation dimension (Grassberger and Procaccia, 1983)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from .embedding import embed
from .neighbours import references
from .region import Region, straight_part

REFERENCES = 600
TARGETS = 20000
RADII = 40
LEAST_RISE = 1.5  # of log C: a factor of 4.5 in pairs
LEAST_PAIRS = 30
LARGEST = 0.15  # pairs beyond this share feel the attractor's size


@dataclass(frozen=True, eq=False)
class Correlation:
    """Correlation sums ``sums`` (M, R) at ``radii`` (R,) [standard deviations] in ``dimensions`` (M,), ``regions`` (M,) their
    straight parts, and ``dimension`` the correlation dimension with its ``spread`` over the larger embeddings; None with ``why``
    where no scaling region exists or the slope keeps growing with the embedding."""

    dimensions: np.ndarray
    radii: np.ndarray
    sums: np.ndarray
    regions: tuple[Region | None, ...]
    dimension: float | None
    spread: float | None
    why: str


def correlation(
    series: np.ndarray, dimensions: range, delay: int, theiler: int, rng: np.random.Generator
) -> Correlation:
    """Correlation sums in several embeddings and the dimension they agree on.

    Counts pairs through two trees, never all pairs one by one, and takes off those within the Theiler window (Theiler,
    1986). The dimension is the mean slope of the straight parts in the three largest embeddings if they agree within 15 %.

    Parameters
    ----------
    series : (N,) with standard deviation 1
    dimensions : numbers of delay coordinates
    delay, theiler : samples
    rng : chooses reference points, and targets of a series with more than `TARGETS`
    """
    radii = np.geomspace(0.005, 3.0, RADII)
    sums, regions, used = [], [], []
    for m in dimensions:
        points = embed(series, m, delay)
        if len(points) < 4 * theiler + 200:
            break
        at = references(len(points), REFERENCES, rng)
        to = references(len(points), TARGETS, rng)
        counts = cKDTree(points[at]).count_neighbors(cKDTree(points[to]), radii).astype(float)
        close, excluded = _close_in_time(points, at, to, theiler, radii)
        pairs = at.size * to.size - excluded
        share = np.maximum(counts - close, 0.0) / pairs
        sums.append(share)
        used.append(m)
        inside = np.flatnonzero((share * pairs > LEAST_PAIRS) & (share < LARGEST))
        region = None
        if inside.size >= 5:
            region = straight_part(np.log(radii[inside]), np.log(share[inside]), LEAST_RISE)
        if region is not None:
            first = int(inside[0])
            region = Region(region.first + first, region.last + first, region.slope, region.intercept)
        regions.append(region)
    slopes = [region.slope for region in regions[-3:] if region is not None]
    value = spread = None
    if len(slopes) < 2:
        why = "the correlation sums have no straight part"
    else:
        value, spread = float(np.mean(slopes)), float(np.std(slopes))
        why = ""
        if max(slopes) - min(slopes) > 0.15 * value:
            why = f"the slope grows with the embedding, from {slopes[0]:.2f} to {slopes[-1]:.2f}: it is no dimension"
            value = spread = None
    return Correlation(np.array(used), radii, np.array(sums), tuple(regions), value, spread, why)


def _close_in_time(
    points: np.ndarray, at: np.ndarray, to: np.ndarray, theiler: int, radii: np.ndarray
) -> tuple[np.ndarray, int]:
    """Pairs within the Theiler window: how many within each radius (R,), and how many in all."""
    histogram, total = np.zeros(radii.size + 1), 0
    is_target = np.zeros(len(points), dtype=bool)
    is_target[to] = True
    for lag in range(-theiler, theiler + 1):
        here = at[(at + lag >= 0) & (at + lag < len(points))]
        here = here[is_target[here + lag]]
        apart = np.sqrt(np.sum((points[here] - points[here + lag]) ** 2, axis=1))
        histogram += np.bincount(np.searchsorted(radii, apart), minlength=radii.size + 1)
        total += here.size
    return np.cumsum(histogram)[:-1], total
