r"""A smoothing model of a measured motion: a quintic spline with equal knots, fitted by least squares.

A quintic spline with spacing h reproduces a sine of angular frequency w to about (w h)^6 / 30240, so a few knots a
period suffice, and it gives rates without differencing samples.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from .bsplines import BSplines, LeastSquares
from .remembered import remembered

DEGREE = 5
SPAN, SPAN_SAMPLES = 0.1, 16
"""Length over which knots are counted [s], and the fewest samples in it: of five, as in 0.1 s at 50 Hz, a quintic spline with a
knot a sample leaves none free, and follows the noise."""
NEGLIGIBLE = 1e-6
"""Share of a signal's size below which a misfit of the spline does not count."""
FOLLOWED = 0.5
"""Share of a signal's size that a spline may miss and still follow it."""
CANDIDATES = tuple(round(1.26**k) for k in range(32))
"""Knot intervals per window that are tried."""
KEPT = 200_000
"""Samples up to which factored equations are kept for the next signal: those of longer records would fill the memory."""


@dataclass(frozen=True)
class SmoothMotion:
    """A fitted spline. ``coefficients`` has shape (intervals + 5,); ``spacing`` [s]; ``noise`` the residual's std."""

    t0: float
    spacing: float
    coefficients: np.ndarray
    noise: float

    def __call__(self, t: np.ndarray, order: int = 0) -> np.ndarray:
        """Value or derivative of the given order at times ``t`` [s]."""
        # The slopes of a sum of splines with equal knots are differences of its coefficients.
        slopes = np.diff(self.coefficients, order) / self.spacing**order
        return BSplines.equal(t, self.t0, self.spacing, slopes.size, DEGREE - order).of(slopes)

    def refined(self, parts: int) -> np.ndarray:
        """Coefficients of the same spline with every interval divided into ``parts``; the first ones are of the same start."""
        mask = np.ones(1)
        for _ in range(DEGREE + 1):
            mask = np.convolve(mask, np.ones(parts))
        spread = np.zeros((self.coefficients.size - 1) * parts + 1)
        spread[::parts] = self.coefficients
        # A spline of the coarse knots is a sum of fine ones (two-scale relation), the first of which begins where it does.
        return np.convolve(spread, mask / parts**DEGREE)[DEGREE * (parts - 1) :]


def span(dt: float) -> float:
    """Length over which knots are counted [s] in a signal with sample spacing ``dt`` [s]: `SPAN`, or `SPAN_SAMPLES` samples."""
    return max(SPAN, SPAN_SAMPLES * dt)


def knots(t0: float, spacing: float, count: int) -> np.ndarray:
    """Equal knots that carry ``count`` quintic B-splines, the first interval in use beginning at ``t0``."""
    return t0 + spacing * (np.arange(count + DEGREE + 1) - DEGREE)


def fit_spline(t: np.ndarray, values: np.ndarray, t0: float, spacing: float) -> SmoothMotion:
    """Least-squares quintic spline with a given knot spacing.

    Parameters
    ----------
    t, values : samples, shape (N,), t in s
    t0 : where the first knot interval begins, at most ``t[0]``
    spacing : distance of the knots [s]
    """
    dt = (t[-1] - t[0]) / (t.size - 1)
    factored = _least_squares if t.size <= KEPT else _least_squares.__wrapped__
    through = factored(t.size, round((t[0] - t0) / dt, 6), round(spacing / dt, 9))
    coefficients = through(values)
    residual = values - through.splines.of(coefficients)
    noise = float(np.sqrt(np.sum(residual**2) / max(t.size - coefficients.size, 1)))
    return SmoothMotion(t0, spacing, coefficients, noise)


@lru_cache(maxsize=32)
def _least_squares(samples: int, first: float, spacing: float) -> LeastSquares:
    """The factored normal equations, in units of the sample spacing.

    The channels of a record share their sample times, so each spacing is factored once for all of them.
    """
    t = first + np.arange(samples)
    count = int(np.floor(t[-1] / spacing + 1e-9)) + 1 + DEGREE
    splines = BSplines.equal(t, 0.0, spacing, count, DEGREE)
    # The last intervals may hold few samples: a whisper of ridge keeps them defined.
    return LeastSquares(splines, 1e-10 * float(splines.gram[-1].max()))


@remembered
def choose_intervals(t: np.ndarray, values: np.ndarray, window: float, *, longest: int = 20_000) -> int:
    """Knot intervals per window such that the spline does not smooth the signal away.

    The spacing with the smallest Akaike criterion fits best; half as many knots again are taken, since a smoother at
    its own optimum biases what is fitted behind it and a finer one costs only a few percent of precision.

    Parameters
    ----------
    t, values : samples, shape (N,)
    window : length of a window [s]; the result divides it
    longest : at most this many samples from the middle of the record are looked at
    """
    if t.size > longest:
        first = (t.size - longest) // 2
        t, values = t[first : first + longest], values[first : first + longest]
    dt = (t[-1] - t[0]) / (t.size - 1)
    most = max(1, int(window / (2.0 * dt) + 1e-9))
    candidates = sorted({min(most, one) for one in CANDIDATES})
    best, lowest, bottom, rising, followed = candidates[0], np.inf, np.inf, 0, False
    # A signal without noise would ask for ever more knots; a millionth of its size is as good as exact.
    floor = (NEGLIGIBLE * np.std(values)) ** 2
    for intervals in candidates:
        fitted = fit_spline(t, values, t[0], window / intervals)
        free = t.size - fitted.coefficients.size
        if free < 16:
            break
        criterion = t.size * np.log(max(fitted.noise**2 * free / t.size + floor, 1e-300)) + 2.0 * fitted.coefficients.size
        followed = followed or fitted.noise < FOLLOWED * np.std(values)
        if criterion < lowest:
            best, lowest = intervals, criterion
        if intervals >= DEGREE:  # below, a large slow motion may hide a small fast one
            rising = rising + 1 if criterion > bottom else 0
            bottom = min(bottom, criterion)
        # Where so few knots follow nothing yet, a criterion that rises tells nothing of more of them.
        if rising == 3 and followed:
            break
    return int(min(most, np.ceil(1.5 * best)))


def is_smooth(t: np.ndarray, values: np.ndarray, window: float) -> bool:
    """True when far fewer spline coefficients than samples follow the signal: not for steps or broadband noise.

    Parameters
    ----------
    t, values : samples, shape (N,)
    window : length over which knot counts are chosen [s]
    """
    dt = (t[-1] - t[0]) / (t.size - 1)
    intervals = choose_intervals(t, values, window)
    share = fit_spline(t, values, t[0], window / intervals).noise / max(float(np.std(values)), 1e-300)
    # What no spline follows better than a few coefficients do is broadband noise, not a smooth signal with some noise on it.
    return share < (0.3 if intervals < 0.75 * window / (2.0 * dt) else 1e-3)
