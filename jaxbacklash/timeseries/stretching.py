"""Stretching curves: how neighbours on the attractor part with time (Rosenstein et al., 1993; Kantz, 1994)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.spatial import cKDTree

from .embedding import embed
from .neighbours import nearest, references
from .region import Region, straight_part

REFERENCES = 2000
BALL = 8  # neighbours whose distances Kantz's curve averages
TIMES = 120
SWINGS = 14  # how long neighbours are followed
LEAST_RISE = 0.7  # a factor of two: less is no scaling
BELOW = 0.35  # how far below the mean distance of unrelated points a scaling region must end
BLOCKS, RESAMPLES = 25, 200


@dataclass(frozen=True, eq=False)
class Stretching:
    """Mean logarithm of the distance of neighbours after so many samples.

    ``lags`` (K,) samples; ``rosenstein``, ``kantz`` (K,) curves [log of standard deviations]; ``plateau`` the same for unrelated
    points; ``smooth`` (K,) Kantz's curve averaged over a swing, ``region`` its straight part, None where there is none;
    ``slope`` per sample with ``interval`` from resampling stretches of the series; ``rosenstein_slope`` over the same part;
    ``dimension`` used.
    """

    lags: np.ndarray
    rosenstein: np.ndarray
    kantz: np.ndarray
    smooth: np.ndarray
    plateau: float
    region: Region | None
    slope: float | None
    interval: tuple[float, float] | None
    rosenstein_slope: float | None
    dimension: int

    @property
    def stays_near(self) -> bool:
        """Whether neighbours are still much nearer than unrelated points at the end, as in regular motion."""
        return bool(np.mean(self.rosenstein[-max(3, self.lags.size // 5) :]) < self.plateau - 1.0)


def stretching(
    series: np.ndarray, dimension: int, delay: int, theiler: int, period: float, rng: np.random.Generator
) -> Stretching:
    """Follow near neighbours in time.

    Rosenstein's curve is the mean logarithm of the distance to the nearest neighbour, Kantz's the mean over points of the
    logarithm of the mean distance to a small ball of neighbours; both measure distances between delay vectors and leave out
    neighbours within the Theiler window. The curve is averaged over one swing, over which distances pulsate. For the rule by
    which the straight part is chosen see `region.straight_part`; it must also end clear of saturation.

    Parameters
    ----------
    series : (N,) with standard deviation 1
    dimension, delay, theiler : of the delay vectors; samples
    period : samples of a swing
    rng : chooses the reference points, one from each of `REFERENCES` stretches
    """
    points = embed(series, dimension, delay)
    longest = int(min(max(12.0, SWINGS * period), len(points) // 3))
    last = len(points) - 1 - longest
    at = references(last + 1, REFERENCES, rng)
    tree = cKDTree(points[: last + 1])
    _, where = nearest(tree, points[at], at, BALL, theiler)
    whole = where[:, -1] >= 0
    at, where = at[whole], where[whole]
    lags = np.unique(np.round(np.linspace(0, longest, min(TIMES, longest + 1))).astype(int))
    one, ball = np.empty((2, at.size, lags.size))
    for k, lag in enumerate(lags):
        apart = np.sqrt(np.sum((points[at + lag][:, None] - points[where + lag]) ** 2, axis=2) / dimension)
        one[:, k] = np.log(np.maximum(apart[:, 0], 1e-8))
        ball[:, k] = np.log(np.maximum(apart.mean(axis=1), 1e-8))
    other = rng.permutation(at)
    plateau = float(np.mean(np.log(np.sqrt(np.sum((points[at] - points[other]) ** 2, axis=1) / dimension) + 1e-8)))
    rosenstein, kantz = one.mean(axis=0), ball.mean(axis=0)
    wide = max(1, round(period / max(1.0, float(lags[1] - lags[0])))) if lags.size > 1 and period > 4 else 1
    smooth = uniform_filter1d(kantz, wide, mode="nearest") if 1 < wide < lags.size // 3 else kantz
    low = int(np.searchsorted(lags, 0.5 * period)) if wide > 1 else 1  # the filter's edge
    ends = np.flatnonzero(smooth > min(plateau, smooth[-max(3, lags.size // 6) :].mean()) - BELOW)
    high = int(ends[0]) if ends.size else lags.size
    region = straight_part(lags[low:high].astype(float), smooth[low:high], LEAST_RISE) if high > low else None
    if region is None:
        return Stretching(lags, rosenstein, kantz, smooth, plateau, None, None, None, None, dimension)
    region = Region(region.first + low, region.last + low, region.slope, region.intercept)
    part = slice(region.first, region.last + 1)
    slopes = _resampled(lags[part], ball[:, part], rng)
    interval = tuple(float(end) for end in np.quantile(slopes, (0.025, 0.975)))
    alone = float(np.polyfit(lags[part], rosenstein[part], 1)[0])
    return Stretching(lags, rosenstein, kantz, smooth, plateau, region, region.slope, interval, alone, dimension)  # type: ignore[arg-type]


def _resampled(lags: np.ndarray, curves: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Slopes of the mean curve when stretches of the series are drawn anew, shape (RESAMPLES,)."""
    centred = lags - lags.mean()
    slopes = curves @ (centred / np.sum(centred**2))
    blocks = np.array([part.mean() for part in np.array_split(slopes, min(BLOCKS, slopes.size))])
    return blocks[rng.integers(0, blocks.size, (RESAMPLES, blocks.size))].mean(axis=1)
