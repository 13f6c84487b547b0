"""How much a sample tells about a later one, and the delay at which it first tells least (Fraser and Swinney, 1986)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree
from scipy.special import digamma

from ..side_by_side import side_by_side
from .scales import correlation_time, mean_period

NEIGHBOURS = 6
PAIRS = 3000  # pairs of samples a lag is judged by
ERROR = 0.02  # standard error of the information with so many pairs [nat]
COARSE = 12.0  # samples a swing below which lags are not averaged
LAGS = 48  # lags that are looked at, at most


@dataclass(frozen=True, eq=False)
class Delay:
    """A delay for the reconstruction: ``samples``, and ``why`` it was taken. ``lags`` (L,) samples, ``information`` (L,) nat."""

    samples: int
    why: str
    lags: np.ndarray
    information: np.ndarray


def mutual_information(a: np.ndarray, b: np.ndarray, neighbours: int = NEIGHBOURS) -> float:
    """Mutual information of two samples [nat], by the first estimator of Kraskov, Stoegbauer and Grassberger (2004).

    Counts neighbours instead of filling the cells of a histogram, so no cell width has to be chosen and small samples are not
    biased upwards.

    Parameters
    ----------
    a, b : (n,) paired values; equal values (an encoder's counts) should be spread over a count first
    neighbours : k of the estimator
    """
    points = np.stack([a, b], axis=1)
    distance = cKDTree(points).query(points, k=neighbours + 1, p=np.inf)[0][:, -1]
    inside = np.nextafter(distance, 0.0)
    total = 0.0
    for values in (a, b):
        ordered = np.sort(values)
        near = np.searchsorted(ordered, values + inside, "right") - np.searchsorted(ordered, values - inside, "left")
        total += float(np.mean(digamma(np.maximum(near, 1))))
    return float(digamma(neighbours) + digamma(a.size)) - total


def choose_delay(series: np.ndarray, rng: np.random.Generator) -> Delay:
    """The delay at the first minimum of the average mutual information.

    Rule: 1 if the autocorrelation is below 1/e after one sample already, as for maps; else the first lag whose information,
    averaged over three lags in a finely sampled series, is no higher than at any later lag up to half as far again, and
    rises afterwards by more than its error. A shallow minimum is easily passed over, and coordinates a half swing apart
    repeat each other; so where no clear minimum lies within a third of a swing, the delay is a quarter of a swing, or the time in
    which the autocorrelation falls to 1/e if that is shorter.

    Parameters
    ----------
    series : (N,)
    rng : draws the pairs, when the series has more than `PAIRS`, and the grain that parts equal values

    Returns
    -------
    Delay
    """
    memory, period = correlation_time(series), mean_period(series)
    longest = max(4, min(series.size // 20, int(max(period, 2 * memory)) if memory > 1 else 12))
    lags = np.unique(np.round(np.linspace(1, longest, min(LAGS, longest))).astype(int))
    parted = _parted(series, rng)
    starts = series.size - lags
    pairs = [(np.arange(n) if n <= PAIRS else rng.choice(n, PAIRS, replace=False), lag) for n, lag in zip(starts, lags)]
    told = lambda pair: mutual_information(parted[pair[0]], parted[pair[0] + pair[1]])  # noqa: E731
    information = np.array(side_by_side(told, pairs))
    if memory <= 1:
        return Delay(1, "the autocorrelation is gone after one sample", lags, information)
    smooth = information
    if period > COARSE:  # else three lags are a good part of a swing
        smooth = np.convolve(np.pad(information, 1, mode="edge"), np.ones(3) / 3.0, mode="valid")
    for k in range(1, lags.size - 1):
        ahead = smooth[k + 1 : max(k + 2, int(np.searchsorted(lags, 1.5 * lags[k] + 1, "right")))]
        rises = smooth[k + 1 :].max() > smooth[k] + ERROR
        if lags[k] <= max(2.0, period / 3.0) and smooth[k] <= min(smooth[k - 1], ahead.min()) and rises:
            return Delay(int(lags[k]), "first minimum of the average mutual information", lags, information)
    fallen, quarter = memory, max(1, round(period / 4.0))
    which = "a quarter of a swing" if quarter < fallen else "where the autocorrelation has fallen to 1/e"
    why = f"the mutual information has no clear minimum within a third of a swing; taken instead: {which}"
    return Delay(int(min(fallen, quarter)), why, lags, information)


def _parted(series: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Equal values spread over one count, or over a rounding error: neighbours can only be counted among different values."""
    ordered = np.unique(series)
    # Where values repeat often they are counts of a sensor, and the count is the smallest step between them.
    step = float(np.min(np.diff(ordered), initial=np.inf)) if 20 * ordered.size < 10 * series.size else 0.0
    width = step if np.isfinite(step) and step > 0.0 else 1e-9 * float(np.std(series))
    return series + width * rng.uniform(-0.5, 0.5, series.size)
