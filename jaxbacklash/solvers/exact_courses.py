r"""Exact motion between the edges of the play under a drive that is a polynomial from knot to knot.

.. math:: p'' + d_b p' + \kappa_b p = e_b + f(t),

on the three branches of the play, with :math:`f` a polynomial of fifth degree on each piece of a `Course`: a measured base
motion through its spline, a chirp through its own. The Taylor series of the solution follows from the equation, coefficient by
coefficient, whatever the signs of stiffness and damping, and a leg is so short that `TERMS` of them are all that doubles can
hold. On that same polynomial the edge is then found to rounding. A leg ends at an edge, a knot, or after its reach.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

import diffrax
import equinox as eqx
import jax
import jax.numpy as jnp

from .exact_periods import Phase, rates

Array = Any

TERMS = 18
REACH = 1.0
"""Longest leg over the sum of damping and natural frequency of its branch: 1 / 18! is less than rounding."""
DEGREE = 5
SEARCH = 16
"""Newton steps, with bisection where one would leave its bracket; three suffice but at a grazing contact."""
LEGS = 8
"""Most legs a piece of the drive may take on average, and as many again for every unit of time in reaches."""


class Course(eqx.Module):
    """A drive in pieces of equal length ``dt``, the first from ``t0``: ``x`` and ``force`` (n, 6) hold the coefficients of
    1, u, ..., u^5 with u from 0 to 1 over a piece. ``repeats``: after the last piece comes the first."""

    t0: Array
    dt: Array
    x: Array
    force: Array
    repeats: bool = eqx.field(static=True, default=False)


class Joint(NamedTuple):
    """The oscillator's numbers over lanes, lengths in half plays: damping [1/time] and stiffness [1/time^2] in the play and
    what a contact adds to them, a constant acceleration, and the acceleration for a unit of x, of x'' and of force."""

    damping: Array
    contact_damping: Array
    stiffness: Array
    contact_stiffness: Array
    load: Array
    by_x: Array
    by_bend: Array
    by_force: Array


class Motion(NamedTuple):
    """Where the lanes are: position, speed, tangent vector, side; piece of the drive and share of it, and where to stop."""

    p: Array
    v: Array
    dp: Array
    dv: Array
    side: Array
    piece: Array
    share: Array
    last: Array
    stop: Array

    @property
    def underway(self) -> Array:
        return (self.piece < self.last) | ((self.piece == self.last) & (self.share < self.stop))


class Along(diffrax.ODETerm):
    """The vector field in periods; ``args`` is `Joint`, `Course` and the length of a period over lanes."""

    def __init__(self) -> None:
        super().__init__(self._field)

    @staticmethod
    def _field(t: Any, y: Phase, args: tuple[Joint, Course, Array]) -> Phase:
        joint, course, period = args
        contact = jnp.abs(y.side)
        damping = joint.damping + contact * joint.contact_damping
        stiffness = joint.stiffness + contact * joint.contact_stiffness
        piece, share = _place(course, t * period)
        push = joint.load + y.side * joint.contact_stiffness + _input(joint, course, piece, share)[0] / course.dt**2
        return rates(y, period, push, damping, stiffness)


class ExactCourse(diffrax.AbstractSolver):
    """Exact motion from edge to edge along a `Course`, for as long as a step lasts; time runs in periods."""

    legs: int = eqx.field(static=True, default=LEGS)

    term_structure: ClassVar[Any] = Along
    interpolation_cls: ClassVar[Callable[..., Any]] = diffrax.LocalLinearInterpolation

    def order(self, terms: Any) -> int:
        return TERMS - 1

    def init(self, terms: Any, t0: Any, t1: Any, y0: Any, args: Any) -> None:
        return None

    def func(self, terms: Any, t0: Any, y0: Any, args: Any) -> Any:
        return terms.vf(t0, y0, args)

    def step(self, terms: Any, t0: Any, t1: Any, y0: Phase, args: Any, solver_state: Any, made_jump: Any) -> Any:
        joint, course, period = args
        y1 = advance_course(joint, course, y0, t0 * period, t1 * period, self.legs)
        return y1, None, {"y0": y0, "y1": y1}, None, diffrax.RESULTS.successful


def advance_course(joint: Joint, course: Course, y: Phase, begin: Any, end: Any, legs: int = LEGS) -> Phase:
    """The lanes taken from time ``begin`` to ``end``, counted from the course's own t0 and scalars or one a lane."""
    one = jnp.ones_like(y.p)
    (piece, share), (last, stop) = _place(course, begin * one), _place(course, end * one)
    now = Motion(y.p, y.v, y.dp, y.dv, y.side, piece, share, last, stop)
    spans = jnp.max((last - piece + 1) * (1.0 + course.dt / jnp.minimum(_reach(joint, 0.0), _reach(joint, 1.0))))
    most = jnp.asarray(jnp.ceil(legs * spans), dtype=int)

    def more(carry: tuple[Array, Motion]) -> Array:
        count, now = carry
        return (count < most) & jnp.any(now.underway)

    _, now = jax.lax.while_loop(more, lambda c: (c[0] + 1, leg(joint, course, c[1])), (jnp.zeros((), dtype=int), now))
    size = jnp.sqrt(now.dp**2 + now.dv**2)
    late = jnp.maximum(y.unresolved, jnp.where(now.underway, 1.0, 0.0))
    return Phase(now.p, now.v, now.dp / size, now.dv / size, y.growth + jnp.log(size), now.side, late)


def _place(course: Course, t: Array) -> tuple[Array, Array]:
    """Piece and share of it at a time since the course's start; beyond the ends the outer pieces are carried on."""
    position = t / course.dt
    piece = jnp.floor(position).astype(int)
    if not course.repeats:
        piece = jnp.clip(piece, 0, course.x.shape[0] - 1)
    return piece, position - piece


def _reach(joint: Joint, contact: Any) -> Array:
    damping = joint.damping + contact * joint.contact_damping
    stiffness = joint.stiffness + contact * joint.contact_stiffness
    return REACH / jnp.maximum(damping + jnp.sqrt(jnp.abs(stiffness)), 1e-300)


def _input(joint: Joint, course: Course, piece: Array, share: Array) -> list[Array]:
    """Taylor coefficients of the drive's acceleration times dt^2 about a place, in shares of a piece."""
    here = piece % course.x.shape[0]
    x, force = course.x[here], course.force[here]
    square = course.dt**2
    f = [square * (joint.by_x * x[..., n] + joint.by_force * force[..., n]) for n in range(DEGREE + 1)]
    for n in range(DEGREE - 1):
        f[n] = f[n] + joint.by_bend * ((n + 2) * (n + 1)) * x[..., n + 2]
    for k in range(DEGREE):  # the polynomial about the share: Horner's scheme, once for each coefficient
        for n in range(DEGREE - 1, k - 1, -1):
            f[n] = f[n] + share * f[n + 1]
    return f


def _polynomial(a: list[Array], u: Array) -> tuple[Array, Array, Array]:
    """Value, slope and second derivative at ``u``."""
    value, slope, bend = a[-1], jnp.zeros_like(u), jnp.zeros_like(u)
    for c in a[-2::-1]:
        bend = bend * u + slope
        slope = slope * u + value
        value = value * u + c
    return value, slope, 2.0 * bend


def leg(joint: Joint, course: Course, now: Motion) -> Motion:
    """Take every lane to the next edge of the play, the next knot, as far as its reach, or to where it is to stop."""
    touching = now.side != 0.0
    contact = jnp.where(touching, 1.0, 0.0)
    damping = (joint.damping + contact * joint.contact_damping) * course.dt
    stiffness = (joint.stiffness + contact * joint.contact_stiffness) * course.dt**2
    force = _input(joint, course, now.piece, now.share)
    force[0] = force[0] + course.dt**2 * (joint.load + now.side * joint.contact_stiffness)
    path, beside = [now.p, course.dt * now.v], [now.dp, course.dt * now.dv]
    for n in range(TERMS - 2):
        given = force[n] if n <= DEGREE else 0.0
        below = 1.0 / ((n + 1) * (n + 2))
        path.append(below * (given - (n + 1) * damping * path[n + 1] - stiffness * path[n]))
        beside.append(-below * ((n + 1) * damping * beside[n + 1] + stiffness * beside[n]))
    limit = jnp.where(now.piece == now.last, now.stop, 1.0)
    ahead = jnp.where(now.underway, limit - now.share, 0.0)
    span = jnp.minimum(ahead, _reach(joint, contact) / course.dt)
    leaves, u, beyond = _first_exit(path, now.side, span)
    p, slope, _ = _polynomial(path, u)
    dp, dslope, _ = _polynomial(beside, u)
    # The tangent jumps where the damping does (saltation): what it adds times the position's part.
    jump = jnp.where(leaves, jnp.where(touching, -1.0, 1.0) * joint.contact_damping, 0.0)
    arrived = ~leaves & (span == ahead)
    onward = arrived & (now.piece < now.last)
    return now._replace(
        p=jnp.where(leaves, jnp.where(touching, now.side, beyond), p), v=slope / course.dt,
        dp=dp, dv=dslope / course.dt - jump * dp, side=jnp.where(leaves, beyond, now.side),
        piece=jnp.where(onward, now.piece + 1, now.piece),
        share=jnp.where(onward, 0.0, jnp.where(arrived & now.underway, now.stop, now.share + u)),
    )  # fmt: skip


def _first_exit(path: list[Array], side: Array, span: Array) -> tuple[Array, Array, Array]:
    """Whether the branch is left within ``span``, where (else ``span``), and the side that follows.

    A leg is shorter than a sixth of its branch's period, so that the path turns once in it at most.
    """
    touching = side != 0.0
    v0 = path[1]
    p1, v1, _ = _polynomial(path, span)
    turns = v0 * v1 < 0.0
    # The distance to the edge is m - n p, positive on the branch.
    m = jnp.where(touching, -1.0, 1.0)
    outside = m - jnp.where(touching, -side, jnp.sign(p1)) * p1 < 0.0

    def search() -> tuple[Array, Array, Array]:
        def climb(_: Any, carry: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
            x, low, high = carry
            _, slope, bend = _polynomial(path, x)
            before = slope * v0 > 0.0
            low, high = jnp.where(before, x, low), jnp.where(before, high, x)
            return _inside(x - slope / jnp.where(bend == 0.0, 1e-300, bend), low, high), low, high

        guess = span * v0 / jnp.where(turns, v0 - v1, 1.0)
        peak, _, _ = jax.lax.fori_loop(0, SEARCH, climb, (jnp.where(turns, guess, 0.0), jnp.zeros_like(span), span))
        heading = jnp.sign(v0)
        over = turns & (m - jnp.where(touching, -side, heading) * _polynomial(path, peak)[0] < 0.0)
        n = jnp.where(touching, -side, jnp.where(over, heading, jnp.sign(p1)))

        def close_in(_: Any, carry: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
            x, low, high = carry
            p, slope, _ = _polynomial(path, x)
            on = m - n * p > 0.0
            low, high = jnp.where(on, x, low), jnp.where(on, high, x)
            return _inside(x + (m - n * p) / jnp.where(slope == 0.0, 1e-300, n * slope), low, high), low, high

        low, high = jnp.where(turns & ~over, peak, 0.0), jnp.where(over, peak, span)
        x, _, _ = jax.lax.fori_loop(0, SEARCH, close_in, (0.5 * (low + high), low, high))
        leaves = over | outside
        return leaves, jnp.where(leaves, x, span), jnp.where(touching, 0.0, n)

    def none() -> tuple[Array, Array, Array]:
        return jnp.zeros_like(turns), span, jnp.zeros_like(span)

    return jax.lax.cond(jnp.any(turns | outside), search, none)


def _inside(x: Array, low: Array, high: Array) -> Array:
    return jnp.where((x >= low) & (x <= high), x, 0.5 * (low + high))
