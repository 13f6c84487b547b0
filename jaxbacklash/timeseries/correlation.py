"""Correlation sum and correlation dimension (Grassberger and Procaccia, 1983)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ..side_by_side import side_by_side
from .embedding import embed, vectors
from .neighbours import references
from .region import POINTS, Region

REFERENCES = 600
TARGETS = 20000
RADII = 40
LEAST_RISE = 1.5  # of log C: a factor of 4.5 in pairs
LEAST_PAIRS = 30
FLAT = (0.05, 0.10, 0.15)  # rms of the local slopes about their mean, as a share of it
GROWS = 0.10  # of the mean slope, over the three largest embeddings
LARGEST = 0.15  # pairs beyond this share feel the attractor's size


@dataclass(frozen=True, eq=False)
class Correlation:
    """Correlation sums ``sums`` (M, R) at ``radii`` (R,) [standard deviations] in ``dimensions`` (M,), ``regions`` (M,) the
    lines through the plateau of the larger ones, and ``dimension`` the correlation dimension with the ``spread`` of the slopes on
    it; None with ``why`` where there is no plateau, as where the slope keeps growing with the embedding."""

    dimensions: np.ndarray
    radii: np.ndarray
    sums: np.ndarray
    regions: tuple[Region | None, ...]
    dimension: float | None
    spread: float | None
    why: str


def correlation(series: np.ndarray, dimensions: range, delay: int, theiler: int, rng: np.random.Generator) -> Correlation:
    """Correlation sums in several embeddings and the dimension they agree on.

    Counts pairs through two trees, never all pairs one by one, and takes off those within the Theiler window (Theiler,
    1986). The dimension is the mean local slope of the three largest embeddings where it is flat and they agree; its ``spread``
    is how far the slopes there lie apart (rms).

    Parameters
    ----------
    series : (N,) with standard deviation 1
    dimensions : numbers of delay coordinates
    delay, theiler : samples
    rng : chooses reference points, and targets of a series with more than `TARGETS`
    """
    radii = np.geomspace(0.005, 3.0, RADII)
    asked = []
    for m in dimensions:
        count = vectors(series.size, m, delay)
        if count < 4 * theiler + 200:
            break
        asked.append((m, references(count, REFERENCES, rng), references(count, TARGETS, rng)))

    def counted(one: tuple[int, np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        m, at, to = one
        points = embed(series, m, delay)
        counts = cKDTree(points[at]).count_neighbors(cKDTree(points[to]), radii).astype(float)
        close, excluded = _close_in_time(points, at, to, theiler, radii)
        pairs = at.size * to.size - excluded
        share = np.maximum(counts - close, 0.0) / pairs
        return share, (share * pairs > LEAST_PAIRS) & (share < LARGEST)

    found = side_by_side(counted, asked)
    sums, told = np.array([share for share, _ in found]), np.array([enough for _, enough in found])
    regions, value, spread, why = _plateau(np.log(radii), sums, told)
    return Correlation(np.array([m for m, *_ in asked]), radii, sums, regions, value, spread, why)


def _plateau(
    log_radii: np.ndarray, sums: np.ndarray, told: np.ndarray
) -> tuple[tuple[Region | None, ...], float | None, float | None, str]:
    """The radii over which the slopes are flat and the larger embeddings agree, and what they say.

    Of all stretches of at least five radii over which each of the three largest sums rises by `LEAST_RISE`, the one with the
    largest rise whose local slopes, all three sums together, keep to their mean within 5 % (rms), else 10, else 15 %. Where the
    mean slope changes by more than a tenth from the smallest embedding of the three to the largest there is no dimension.
    """
    none: tuple[Region | None, ...] = (None,) * len(sums)
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.log(sums)
        local = np.gradient(logs, log_radii, axis=1) if len(sums) else logs
    last = slice(max(0, len(sums) - 3), len(sums))
    inside = np.flatnonzero(np.all(told[last], axis=0)) if len(sums) > 1 else np.array([], dtype=int)
    # A slope at the rim looks at a neighbour outside.
    inside = inside[1:-1]
    stretches = [
        (first, end) for k, first in enumerate(inside) for end in inside[k + POINTS - 1 :]
        if np.min(logs[last, end] - logs[last, first]) >= LEAST_RISE
    ]  # fmt: skip
    if not stretches:
        return none, None, None, "the correlation sums have no straight part"
    rises = np.array([np.mean(logs[last, end] - logs[last, first]) for first, end in stretches])
    parts = [local[last, first : end + 1] for first, end in stretches]
    means, unlike = np.array([part.mean() for part in parts]), np.array([part.std() for part in parts])
    grows = np.array([np.ptp(part.mean(axis=1)) for part in parts])
    for share in FLAT:
        flat = (unlike <= share * means) & (grows <= GROWS * means)
        if flat.any():
            first, end = stretches[int(np.argmax(np.where(flat, rises, -np.inf)))]
            part = local[last, first : end + 1]
            lines = tuple(_line(log_radii, one, first, end) for one in logs[last])
            return none[len(lines) :] + lines, float(part.mean()), float(part.std()), ""
    ends = parts[int(np.argmin(unlike / means))].mean(axis=1)
    why = f"the slope does not settle: from {ends[0]:.2f} to {ends[-1]:.2f} with the embedding"
    return none, None, None, why


def _line(log_radii: np.ndarray, logs: np.ndarray, first: int, end: int) -> Region:
    """The line through one sum over the plateau."""
    rows = slice(first, end + 1)
    slope, intercept = np.polyfit(log_radii[rows], logs[rows], 1)
    return Region(int(first), int(end), float(slope), float(intercept))


def _close_in_time(points: np.ndarray, at: np.ndarray, to: np.ndarray, theiler: int, radii: np.ndarray) -> tuple[np.ndarray, int]:
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
