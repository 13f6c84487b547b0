"""Series with the same linear properties and otherwise random, and the test against them (Theiler et al., 1992)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.fft import next_fast_len
from scipy.spatial import cKDTree

from ..side_by_side import side_by_side
from .embedding import embed
from .neighbours import nearest, references
from .tangent import fit_maps

ITERATIONS = 60
LONGEST = 10000  # samples the test uses
REFERENCES = 400


@dataclass(frozen=True, eq=False)
class SurrogateTest:
    """Prediction error of the series beside that of its surrogates, in standard deviations.

    ``kind``; ``count``; ``statistic`` of the series; ``surrogates`` (count,); ``p_value`` of the one-sided rank test: a
    deterministic series is better predicted than its surrogates; ``samples`` used after the ends were matched.
    """

    kind: str
    count: int
    statistic: float
    surrogates: np.ndarray
    p_value: float
    samples: int


def fourier(series: np.ndarray, count: int, rng: np.random.Generator) -> np.ndarray:
    """Surrogates (count, N) with the spectrum of the series and random phases: Gaussian linear noise."""
    amplitude = np.abs(np.fft.rfft(series - series.mean()))
    phase = rng.uniform(0.0, 2.0 * np.pi, (count, amplitude.size))
    if series.size % 2 == 0:
        phase[:, -1] = 0.0
    return np.fft.irfft(amplitude * np.exp(1j * phase), series.size) + series.mean()


def aaft(series: np.ndarray, count: int, rng: np.random.Generator) -> np.ndarray:
    """Amplitude-adjusted surrogates (count, N): the values of the series in the order of a Fourier surrogate of its Gaussian
    twin (Theiler et al., 1992)."""
    ranks = np.argsort(np.argsort(series))
    gaussian = np.sort(rng.standard_normal(series.size))[ranks]
    return np.sort(series)[np.argsort(np.argsort(fourier(gaussian, count, rng), axis=1), axis=1)]


def iaaft(series: np.ndarray, count: int, rng: np.random.Generator, iterations: int = ITERATIONS) -> np.ndarray:
    """Surrogates (count, N) with the values of the series and, as nearly as can be, its spectrum (Schreiber and Schmitz,
    1996)."""
    ordered = np.sort(series)
    amplitude = np.abs(np.fft.rfft(series))
    present = rng.permuted(np.tile(series, (count, 1)), axis=1)
    before = None
    for _ in range(iterations):
        spectrum = np.fft.rfft(present)
        size = np.abs(spectrum)
        spectrum *= amplitude / np.where(size > 0.0, size, 1.0)
        order = np.argsort(np.fft.irfft(spectrum, series.size), axis=1)
        if before is not None and np.array_equal(order, before):
            break
        before = order
        np.put_along_axis(present, order, np.broadcast_to(ordered, present.shape), axis=1)
    return present


KINDS = {"fourier": fourier, "aaft": aaft, "iaaft": iaaft}


def matched_ends(series: np.ndarray, share: float = 0.1) -> slice:
    """The stretch, at least 1 - ``share`` of the series, whose ends fit together in value and slope.

    A Fourier transform takes the series as one turn of a circle; a step where the ends meet would give surrogates high
    frequencies that the series has not, and false rejections. The length is one that transforms quickly.
    """
    n = series.size
    slack = max(2, int(share * n))
    starts = np.arange(0, slack // 2)
    deviation, steps = np.std(series), np.diff(series)
    best, found = np.inf, slice(0, n)
    for length in range(n - slack, n - slack // 2 + 1, max(1, slack // 60)):
        length = min(next_fast_len(length, real=True), n - int(starts[-1]) - 2)
        ends = starts + length
        gap = np.abs(series[starts] - series[ends]) / deviation + np.abs(steps[starts] - steps[ends]) / np.std(steps)
        k = int(np.argmin(gap))
        if gap[k] < best:
            best, found = float(gap[k]), slice(int(starts[k]), int(starts[k]) + length)
    return found


def surrogate_test(
    series: np.ndarray, dimension: int, delay: int, theiler: int, rng: np.random.Generator, *, kind: str = "iaaft",
    count: int = 39,
) -> SurrogateTest:  # fmt: skip
    """Is the series better predicted by its own past than linear noise seen through a static curve would be?

    The statistic is the rms error of local affine predictions one delay ahead, with settings that do not depend on the
    outcome: the same dimension, delay and number of neighbours for the series and all surrogates.

    Parameters
    ----------
    series : (N,); of a longer one, the middle `LONGEST` samples are used
    dimension, delay, theiler : of the delay vectors; samples
    rng : of surrogates and reference points
    kind : "iaaft", "aaft" or "fourier"
    count : surrogates; p is at least 1 / (count + 1)
    """
    if series.size > LONGEST:
        begin = (series.size - LONGEST) // 2
        series = series[begin : begin + LONGEST]
    series = series[matched_ends(series)]
    made = KINDS[kind](series, count, rng)
    at = references(series.size - dimension * delay, REFERENCES, rng)
    near = 6 * dimension + 6
    own, *others = side_by_side(lambda one: _error(one, dimension, delay, theiler, at, near), (series, *made))
    values = np.array(others)
    p = (1.0 + np.sum(values <= own)) / (count + 1.0)
    return SurrogateTest(kind, count, own, values, float(p), series.size)


def _error(series: np.ndarray, dimension: int, delay: int, theiler: int, at: np.ndarray, near: int) -> float:
    series = (series - series.mean()) / series.std()
    points = embed(series, dimension, delay)
    usable = len(points) - delay
    at = at[at < usable]
    _, where = nearest(cKDTree(points[:usable]), points[at], at, near, theiler)
    whole = where[:, -1] >= 0
    _, predicted = fit_maps(points, at[whole], where[whole], delay)
    return float(np.sqrt(np.mean((predicted - points[at[whole] + delay, -1]) ** 2)))
