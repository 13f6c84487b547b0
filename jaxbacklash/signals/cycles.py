r"""A smoothing spline with knots a whole number of cycles apart.

The Fourier transform of a quintic B-spline with knots L cycles apart is :math:`\mathrm{sinc}^6(f L)`, f in 1/cycle: zero
to sixth order at every harmonic of the carrier. A least-squares fit with such splines is blind to harmonics and keeps
everything slower than half a cycle per cycle, whatever the frequency does meanwhile.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .bsplines import BSplines, LeastSquares, curve
from .smoothing import DEGREE

MOST_ROWS = 200_000
"""Samples beyond which several are averaged into one before the fit, so that a long fast record fits in memory."""


@dataclass(frozen=True)
class SlowCurve:
    """A fitted spline, real or complex: ``curve(t, order)`` gives value or derivative at times t [s]."""

    knots: np.ndarray
    coefficients: np.ndarray

    def __call__(self, t: np.ndarray, order: int = 0) -> np.ndarray:
        return curve(t, self.knots, self.coefficients, DEGREE, order)


class CycleSpline:
    """Least-squares quintic splines whose knots follow a phase.

    Parameters
    ----------
    t : uniform sample times [s], shape (N,)
    phase : of the carrier [rad], rising, shape (N,)
    cycles : distance of the knots in cycles
    """

    def __init__(self, t: np.ndarray, phase: np.ndarray, cycles: float = 1.0) -> None:
        turns = (phase - phase[0]) / (2.0 * np.pi * cycles)
        whole = np.arange(0, max(2, int(np.floor(turns[-1])) + 1))
        inner = np.interp(whole, turns, t)
        # Knots closer than a few samples would see single samples, not cycles.
        inner = inner[np.concatenate([[True], np.diff(inner) > 4.0 * (t[1] - t[0])])]
        first, last = inner[1] - inner[0], inner[-1] - inner[-2]
        reach = int(np.ceil((t[-1] - inner[-1]) / last - 1e-9))
        before = inner[0] - first * np.arange(DEGREE, 0, -1)
        after = inner[-1] + last * np.arange(1, max(reach, 0) + DEGREE + 1)
        self.knots = np.concatenate([before, inner, after])
        self._group = max(1, -(-t.size // MOST_ROWS))
        self._t, self._samples = t, t.size
        splines = BSplines(self._pooled(t), self.knots, DEGREE)
        # The outermost splines may hold few samples: a whisper of ridge keeps them defined.
        self._through = LeastSquares(splines, 1e-9 * float(np.median(splines.gram[-1])))

    def fit(self, values: np.ndarray) -> SlowCurve:
        """The slow curve through real or complex samples (N,)."""
        return SlowCurve(self.knots, self._through(self._pooled(values)))

    def smoothed(self, values: np.ndarray) -> np.ndarray:
        """The slow curve through real or complex samples (N,), at the samples."""
        if self._group > 1:
            return self.fit(values)(self._t)
        return self._through.splines.of(self._through(values))

    def _pooled(self, values: np.ndarray) -> np.ndarray:
        if self._group == 1:
            return values
        whole = self._samples // self._group * self._group
        return values[:whole].reshape(-1, self._group).mean(axis=1)
