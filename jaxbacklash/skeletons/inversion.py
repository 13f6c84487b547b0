r"""From complex amplitudes to play, stiffness and damping, with errors that allow for correlated residuals.

Along the carrier the equation of motion reads, point by point and term by term,

.. math:: J\,\ddot Y = F - k\,D_h - c\,\dot Z,

capital letters being complex amplitudes and :math:`D_h` that of the deflection :math:`\delta_h(z)`. The ratio
:math:`D_h/Z` is the describing function of the waveform that was measured; for a sine it is N(h/A). For a given half play
the rest is linear; the half play comes from a search. A simpler form stands beside it: ``sine`` takes N(h/A). The paper's
straight line is `describing_function.axis_crossing`.

With the measured waveform this is the equation of motion in weak form, the Morlet atoms (or the splines of the analytic
signal) being the test functions: that is why it can be as good as a fit. It needs one frequency at a time, where a fit does not.

Residuals of neighbouring points are anything but independent: amplitudes overlap in time, and what is wrong with the model
is wrong for long stretches. Errors therefore come from leaving out whole stretches of the record in turn (jackknife), and
intervals from Student's t with as many degrees of freedom as stretches allow.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..regression.least import least_between
from .describing_function import dead_zone, describing_function
from .fundamental import Fundamental

BLOCK = 8
"""Least points in a stretch of the jackknife: four cycles, past which amplitudes share no sample with most of their weight."""
MOST_BLOCKS, FEWEST_BLOCKS = 20, 5
WAYS = ("waveform", "sine")


@dataclass(frozen=True)
class Terms:
    """The terms of the equation of motion as amplitudes (M,), and what makes the deflection's.

    ``position``, ``velocity`` of z; ``acceleration`` of y; ``torque`` F and all known loads; ``z`` the samples at ``t`` (N,).
    """

    along: Fundamental
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    torque: np.ndarray
    t: np.ndarray
    z: np.ndarray

    def deflection(self, half_play: float, centre: float, way: str = "waveform") -> np.ndarray:
        """Amplitude of the deflection, complex (M,)."""
        if way == "waveform":
            return self.along.of(dead_zone(self.z, half_play, centre))
        size = np.maximum(np.abs(self.position), 1e-300)
        return self.position * describing_function(size, half_play)


@dataclass(frozen=True)
class Inversion:
    """Half play, stiffness, damping and, where it was unknown, inertia (``values``), and their ``covariance``.

    ``centre`` of the play in z; ``blocks`` stretches that the errors come from; ``misfit`` the residual's share of the
    torque (rms); ``peak`` the largest distance of z from the centre that was kept; ``drift`` what the values change by from
    the lower half of amplitudes to the upper, and ``drift_stderr`` its error.
    """

    values: np.ndarray
    covariance: np.ndarray
    centre: float
    blocks: int
    misfit: float
    peak: float
    drift: np.ndarray
    drift_stderr: np.ndarray

    @property
    def stderr(self) -> np.ndarray:
        """Standard errors, in the order of ``values``."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))

    @property
    def reach(self) -> float:
        """Half width of a 95 % interval in standard errors: Student's t."""
        from scipy.special import stdtrit  # heavy to load, and a record that cannot be judged does without

        return float(stdtrit(max(self.blocks - 1, 1), 0.975))


def invert(
    terms: Terms, keep: np.ndarray, *, inertia: float | None, way: str = "waveform", centre: float | None = None
) -> Inversion | None:
    """Find half play, stiffness and damping (and inertia, when it is None) from the points in ``keep`` (M,).

    Parameters
    ----------
    terms : amplitudes along the carrier
    keep : points that count
    inertia : J [kg m^2]; None needs a measured force
    way : ``"waveform"`` or ``"sine"``
    centre : middle of the play in z; None: where the contacts push as much one way as the other

    Returns
    -------
    None where fewer points are kept than five stretches need
    """
    index = np.flatnonzero(keep)
    blocks = min(MOST_BLOCKS, index.size // BLOCK)
    if blocks < FEWEST_BLOCKS:
        return None
    kept = terms.z[np.interp(terms.t, terms.along.t, keep.astype(float)) > 0.5]
    peak = float(np.quantile(np.abs(kept - np.median(kept)), 0.995))
    regression = _Regression(terms, index, inertia)

    def middle(half: float) -> float:
        return _balance(kept, half) if centre is None else centre

    def misfit(half: float) -> float:
        return regression.solve(terms.deflection(half, middle(half), way))[0]

    grid = peak * np.linspace(0.0, 0.95, 20)
    best = int(np.argmin([misfit(half) for half in grid]))
    low, high = grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)]
    half = least_between(misfit, low, high, 1e-5 * peak)
    at = middle(half)
    _, solution, residual = regression.solve(terms.deflection(half, at, way))
    jacobian = regression.jacobian(half, at, solution[0], 1e-3 * peak, way)
    share = float(np.sqrt(np.mean(residual**2) / np.mean(regression.right**2)))
    values = np.concatenate([[half], solution])
    covariance, _ = jackknife(jacobian, residual, blocks)
    drift, error = _halves(jacobian, residual, np.abs(terms.position[index]), blocks)
    return Inversion(values, covariance, at, blocks, share, peak, drift, error)


def linearised(
    terms: Terms, keep: np.ndarray, found: Inversion, inertia: float | None
) -> tuple[np.ndarray, np.ndarray, Callable[[np.ndarray], np.ndarray]]:
    """The regression around its solution: Jacobian (2 n, q) in the order of ``values``, residual (2 n,), and the function that
    makes such a real column from amplitudes (M,)."""
    regression = _Regression(terms, np.flatnonzero(keep), inertia)
    jacobian = regression.jacobian(found.values[0], found.centre, found.values[1], 1e-3 * found.peak)
    residual = regression.solve(terms.deflection(found.values[0], found.centre))[2]
    return jacobian, residual, regression.real


class _Regression:
    """The weighted complex regression at a given half play, as a real one of twice the rows."""

    def __init__(self, terms: Terms, index: np.ndarray, inertia: float | None) -> None:
        self._terms, self._index = terms, index
        self._others = [terms.velocity] + ([terms.acceleration] if inertia is None else [])
        known = terms.torque - (inertia or 0.0) * terms.acceleration
        # Errors of the method grow with the torque, those of the noise do not: weights between the two.
        size = np.abs(terms.torque[index]) + (inertia or 0.0) * np.abs(terms.acceleration[index])
        self._weight = 1.0 / (size + 0.1 * float(np.max(size)) + 1e-300)
        self.right = self.real(known)

    def matrix(self, *first: np.ndarray) -> np.ndarray:
        """Real columns (2 n, q): those given, then velocity and, where it is unknown, inertia."""
        return np.stack([self.real(column) for column in (*first, *self._others)], axis=1)

    def jacobian(self, half: float, centre: float, stiffness: float, step: float, way: str = "waveform") -> np.ndarray:
        """What the torque changes by with half play, stiffness, damping (and inertia), (2 n, q)."""
        low, high = max(half - step, 0.0), half + step
        above, below = (self._terms.deflection(at, centre, way) for at in (high, low))
        return self.matrix(stiffness * (above - below) / (high - low), self._terms.deflection(half, centre, way))

    def solve(self, deflection: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Residual sum of squares, (stiffness, damping, [inertia]), residual (2 n,)."""
        matrix = self.matrix(deflection)
        scale = np.linalg.norm(matrix, axis=0)
        scale[scale == 0.0] = 1.0
        solution = np.linalg.lstsq(matrix / scale, self.right, rcond=None)[0] / scale
        residual = self.right - matrix @ solution
        return float(residual @ residual), solution, residual

    def real(self, column: np.ndarray) -> np.ndarray:
        """A column as the regression sees it: amplitudes (M,) at the points that count, weighted, real parts first (2 n,)."""
        both = column[self._index] * self._weight
        return np.concatenate([both.real, both.imag])


def jackknife(jacobian: np.ndarray, residual: np.ndarray, blocks: int) -> tuple[np.ndarray, np.ndarray]:
    """Covariance (q, q) from leaving out each of ``blocks`` stretches in turn, one Gauss-Newton step each, and the step (q,)
    that all of them together would make, zero at the minimum.

    Rows are real parts of all points and then their imaginary parts, in order of time.
    """
    scale = np.linalg.norm(jacobian, axis=0)
    scale[scale == 0.0] = 1.0
    unit = jacobian / scale
    of = np.tile(np.arange(residual.size // 2) * blocks // (residual.size // 2), 2)
    gram, gradient = unit.T @ unit, unit.T @ residual
    steps = []
    for block in range(blocks):
        out = of == block
        part = unit[out]
        steps.append(np.linalg.lstsq(gram - part.T @ part, gradient - part.T @ residual[out], rcond=1e-12)[0])
    spread = np.array(steps) - np.mean(steps, axis=0)
    covariance = (blocks - 1) / blocks * (spread.T @ spread) / np.outer(scale, scale)
    return covariance, np.linalg.lstsq(gram, gradient, rcond=1e-12)[0] / scale


def _halves(jacobian: np.ndarray, residual: np.ndarray, amplitude: np.ndarray, blocks: int) -> tuple[np.ndarray, np.ndarray]:
    """How far the values from the upper half of amplitudes lie above those from the lower, and the standard error of that."""
    upper = np.tile(amplitude > np.median(amplitude), 2)
    (var_up, up), (var_low, low) = (
        jackknife(jacobian[side], residual[side], max(FEWEST_BLOCKS, blocks // 2)) for side in (upper, ~upper)
    )
    return up - low, np.sqrt(np.diag(var_up) + np.diag(var_low))


def _balance(z: np.ndarray, half: float) -> float:
    """The middle of the play about which the mean deflection of the samples is zero."""
    centre = float(np.median(z))
    for _ in range(12):
        deflected = dead_zone(z, half, centre)
        outside = float(np.mean(deflected != 0.0))
        if outside == 0.0:
            break
        step = float(np.mean(deflected)) / outside
        centre += step
        if abs(step) < 1e-7 * (half + 1e-300):
            break
    return centre
