"""A diffrax solver whose step is any number of whole drive periods of a linear-piecewise oscillator, exact up to rounding.

Time runs in periods of the drive, so that lanes with other frequencies keep step. All lanes advance in one compiled inner loop;
there is nothing for diffrax to do between a step's two ends but to keep what was asked for.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

import diffrax
import equinox as eqx
import jax.numpy as jnp

from .linear_pieces import LinearPieces, Motion, travel

Array = Any

LEGS = 400
"""Most legs a period may take; a lane that needs more has met its edges too often and counts as unresolved."""


class Phase(NamedTuple):
    """State of the lanes at a moment of the drive: position and speed, a tangent vector of unit length and the logarithm of
    what it has grown by, the side of the play (-1, 0, 1), and 1 where the legs did not suffice."""

    p: Array
    v: Array
    dp: Array
    dv: Array
    growth: Array
    side: Array
    unresolved: Array


def rates(y: Phase, period: Array, push: Array, damping: Array, stiffness: Array) -> Phase:
    """Rates of change, time in periods, of a motion and its tangent vector between two edges; ``push`` is the force at rest."""
    zero = jnp.zeros_like(y.p)
    return Phase(
        period * y.v, period * (push - damping * y.v - stiffness * y.p),
        period * y.dv, -period * (damping * y.dv + stiffness * y.dp), zero, zero, zero,
    )  # fmt: skip


class Pieces(diffrax.ODETerm):
    """The vector field of the oscillator in periods of its drive; ``args`` is the pair of `LinearPieces` and phase [rad]."""

    def __init__(self) -> None:
        super().__init__(self._field)

    @staticmethod
    def _field(t: Any, y: Phase, args: tuple[LinearPieces, Array]) -> Phase:
        s, phase = args
        contact = jnp.abs(y.side)
        damping, stiffness = s.damping + contact * s.contact_damping, s.stiffness + contact * s.contact_stiffness
        period = 2.0 * jnp.pi / s.omega
        force = s.load + y.side * s.contact_stiffness + s.amplitude * jnp.cos(2.0 * jnp.pi * t + phase)
        return rates(y, period, force, damping, stiffness)


class ExactPeriods(diffrax.AbstractSolver):
    """Exact motion from one edge of the play to the next, for as long as a step lasts."""

    legs: int = eqx.field(static=True, default=LEGS)

    term_structure: ClassVar[Any] = Pieces
    interpolation_cls: ClassVar[Callable[..., Any]] = diffrax.LocalLinearInterpolation

    def order(self, terms: Any) -> int:
        return 5  # of the search for an edge; the motion itself is exact

    def init(self, terms: Any, t0: Any, t1: Any, y0: Any, args: Any) -> None:
        return None

    def func(self, terms: Any, t0: Any, y0: Any, args: Any) -> Any:
        return terms.vf(t0, y0, args)

    def step(self, terms: Any, t0: Any, t1: Any, y0: Phase, args: Any, solver_state: Any, made_jump: Any) -> Any:
        y1 = advance_periods(args[0], args[1], y0, t0, t1 - t0, self.legs)
        return y1, None, {"y0": y0, "y1": y1}, None, diffrax.RESULTS.successful


def advance_periods(system: LinearPieces, phase: Array, y: Phase, begin: Any, periods: Any, legs: int = LEGS) -> Phase:
    """The lanes some periods later; ``begin`` is the time in periods, ``phase`` that of the drive at time zero [rad]."""
    angle = 2.0 * jnp.pi * (begin - jnp.floor(begin)) + phase
    cos, sin = jnp.broadcast_to(jnp.cos(angle), y.p.shape), jnp.broadcast_to(jnp.sin(angle), y.p.shape)
    left = periods * 2.0 * jnp.pi / system.omega * jnp.ones_like(y.p)
    most = jnp.asarray(jnp.ceil(legs * periods), dtype=int)
    now = travel(system, Motion(y.p, y.v, y.dp, y.dv, y.side, cos, sin, left), most)
    size = jnp.sqrt(now.dp**2 + now.dv**2)
    late = jnp.maximum(y.unresolved, jnp.where(now.left > 0.0, 1.0, 0.0))
    return Phase(now.p, now.v, now.dp / size, now.dv / size, y.growth + jnp.log(size), now.side, late)


def begin(p: Array, v: Array) -> Phase:
    """Lanes that start at ``p``, ``v`` (in half plays, and half plays a unit of time), their tangent vector along ``p``."""
    zero = jnp.zeros_like(p)
    side = jnp.where(p > 1.0, 1.0, jnp.where(p < -1.0, -1.0, 0.0))
    return Phase(p, v, jnp.ones_like(p), zero, zero, side, zero)
