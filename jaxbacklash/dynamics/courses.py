r"""Drives as polynomials between knots, for the exact steps: measured samples as they are, signals by a spline of their own.

A measured base motion is the cubic between its samples that `Sampled` is everywhere else. A chirp, a multisine or any other
smooth signal becomes the quintic through its values, rates and second derivatives at knots so close that it is off by no more
than `CLOSE` of its largest value.
"""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ..errors import BadInput
from ..excitation import AbstractExcitation, AbstractSignal, Harmonic, Rest, Sampled
from ..solvers.exact_courses import DEGREE, Course

Array = Any

CLOSE = 1e-11
FEWEST_PIECES, MOST_PIECES = 64, 1 << 17
"""A drive that wants more is not smooth."""


def begins(drive: AbstractExcitation) -> Any:
    """The time at which a motion under this drive begins [s]: that of the first sample, else zero."""
    return drive.t0 if isinstance(drive, Sampled) else 0.0


def check_length(drive: AbstractExcitation, duration: float) -> None:
    """Refuse a run that outlasts a measured drive.

    Raises
    ------
    BadInput
        The run lasts ``duration`` [s], the samples do not.
    """
    if isinstance(drive, Sampled):
        known = float(drive.dt) * (len(drive.x) - 1)
        if duration > known * (1.0 + 1e-9):
            raise BadInput(f"the measured drive lasts {known:.6g} s, the run {duration:.6g} s: wanted fewer or shorter periods")


def course(drive: AbstractExcitation, duration: float) -> Course | str:
    """The drive over ``duration`` [s] from its beginning as polynomials, or why that cannot be."""
    own = [np.ndim(leaf) for name, leaf in vars(drive).items() if name not in drive.series and leaf is not None]
    if any(own):
        return "the drive differs from cell to cell"
    if isinstance(drive, Rest):
        nothing = jnp.zeros((1, DEGREE + 1))
        return Course(jnp.zeros(()), jnp.asarray(float(duration)), nothing, nothing, repeats=True)
    if isinstance(drive, Sampled):
        return _through_samples(drive)
    if isinstance(drive, AbstractSignal):
        return _through_knots(drive, duration)
    return f"a {type(drive).__name__} is not known between its samples"


def _through_samples(drive: Sampled) -> Course:
    x, dx, force = (np.asarray(a, dtype=float) for a in (drive.x, drive.dx, drive.force))
    cubic = _cubic(x, float(drive.dt) * dx)
    if drive.dforce is None:
        along = np.stack([force[:-1], force[1:] - force[:-1], *(0.0 * force[:-1],) * 4], axis=1)
    else:
        along = _cubic(force, float(drive.dt) * np.asarray(drive.dforce, dtype=float))
    # Lengths come in powers of two, so that records of other lengths run the same program; no run reaches what is filled in.
    filled = ((0, (1 << (len(cubic) - 1).bit_length()) - len(cubic)), (0, 0))
    moved, pushed = (jnp.asarray(np.pad(part, filled)) for part in (cubic, along))
    return Course(jnp.asarray(drive.t0, dtype=float), jnp.asarray(drive.dt, dtype=float), moved, pushed)


def _cubic(value: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Coefficients (K, 6) of the cubics on 0 ... 1 through values and rates at K + 1 samples."""
    a, b, c, d = value[:-1], rate[:-1], value[1:], rate[1:]
    return np.stack([a, b, 3.0 * (c - a) - 2.0 * b - d, b + d - 2.0 * (c - a), 0.0 * a, 0.0 * a], axis=1)


def _through_knots(drive: AbstractSignal, duration: float) -> Course | str:
    repeats = isinstance(drive, Harmonic)
    length = 2.0 * np.pi / float(drive.omega) if isinstance(drive, Harmonic) else duration
    pieces = FEWEST_PIECES
    while pieces <= MOST_PIECES:
        dt = length / pieces
        value, rate, bend = (np.asarray(v) for v in _signal(drive, dt * np.arange(pieces + 1)))
        quintic = _hermite(value, dt * rate, dt * dt * bend)
        between = np.asarray(_signal(drive, dt * (np.arange(pieces + 1) + 0.5))[0])[:-1]
        error = np.abs(quintic @ 0.5 ** np.arange(DEGREE + 1) - between).max()
        wanted = CLOSE * np.abs(value).max()
        if error <= wanted:
            own, nothing = jnp.asarray(quintic), jnp.zeros((pieces, DEGREE + 1))
            x, force = (nothing, own) if drive.as_force else (own, nothing)
            return Course(jnp.zeros(()), jnp.asarray(dt), x, force, repeats=repeats)
        # The error of a smooth signal falls with the sixth power of the spacing.
        pieces *= 1 << max(1, int(np.ceil(np.log2(error / wanted) / 6.0 - 0.1)))
    return "the drive is not smooth"


@jax.jit
def _signal(drive: AbstractSignal, t: Array) -> tuple[Array, Array, Array]:
    """Value, rate and second derivative of a signal at times t (K,)."""

    def rate(s: Array) -> Array:
        return jax.jvp(drive.signal, (s,), (jnp.ones_like(s),))[1]

    def one(s: Array) -> tuple[Array, Array, Array]:
        return drive.signal(s), *jax.jvp(rate, (s,), (jnp.ones_like(s),))

    return jax.vmap(one)(t)


def _hermite(value: np.ndarray, rate: np.ndarray, bend: np.ndarray) -> np.ndarray:
    """Coefficients (K, 6) of the quintics on 0 ... 1 through values, rates and second derivatives at K + 1 knots."""
    a, b, c = value[:-1], rate[:-1], 0.5 * bend[:-1]
    x, y, z = value[1:] - a - b - c, rate[1:] - b - 2.0 * c, 0.5 * bend[1:] - c
    return np.stack([a, b, c, 10.0 * x - 4.0 * y + z, -15.0 * x + 7.0 * y - 2.0 * z, 6.0 * x - 3.0 * y + z], axis=1)
