r"""An oscillator that is linear between the edges of its play, solved exactly from one edge to the next.

.. math:: p'' + d_b p' + \kappa_b p = e_b + A \cos\theta, \qquad \theta' = \Omega,

on three branches: the play, :math:`|p| < 1`, and a contact on either side. This is the dimensionless form (2.14) of the paper
with a little more: a spring across the play, a constant load and damping of the contact. CASE 1, CASE 2, base motion and the
linear two-link all become it, in units of the half play.

One *leg* takes every lane exactly to its next edge, or as far as its reach. Lanes keep their own time, so that a lane
that meets many edges just takes more legs and none is ever met twice within one. Nothing here is a Python branch on values:
the same code serves scalars, thousands of lanes on a CPU or all lanes on a GPU, and its derivative by `jax.jvp` is the
derivative of the flow.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp

Array = Any

REACH = 1.5
"""Longest leg in radians of the branch's own frequency: the crossing is then found to 3e-4, its effect to the square of that."""
TURN = 0.7
"""Longest leg in radians of the drive."""
FADE = 0.1
"""Longest leg in units of 2 / damping."""
NEWTON = 2
MISS = 5e-3
"""Most that the search for an edge may be off, as a share of a leg."""


class LinearPieces(eqx.Module):
    """The oscillator's numbers, each a scalar or an array over lanes.

    Attributes: ``damping`` and ``contact_damping``, the damping in the play and what a contact adds to it [1/time];
    ``stiffness`` and ``contact_stiffness``, the same for the stiffness [1/time^2]; ``load`` a constant acceleration;
    ``amplitude`` A of the drive's acceleration; ``omega`` its angular frequency. Lengths are in half plays.
    """

    damping: Array
    contact_damping: Array
    stiffness: Array
    contact_stiffness: Array
    load: Array
    amplitude: Array
    omega: Array


class Flow(NamedTuple):
    """The homogeneous solution after a while: ``p = c p0 + s v0``, ``v = -k s p0 + r v0``."""

    c: Array
    s: Array
    r: Array
    k: Array

    def __call__(self, p: Array, v: Array) -> tuple[Array, Array]:
        return self.c * p + self.s * v, self.r * v - self.k * self.s * p


class Branch(NamedTuple):
    """One branch, ready to be stepped along: half its damping, stiffness, squared frequency, and its forced solution.

    The forced solution is ``middle + c cos(theta) + s sin(theta)``; ``reach`` is the longest leg, ``ahead`` what a leg of
    that length does to the free motion, ``turn_cos`` and ``turn_sin`` what it does to the phase of the drive.
    """

    half: Array
    stiffness: Array
    square: Array
    middle: Array
    c: Array
    s: Array
    reach: Array
    ahead: Flow
    turn_cos: Array
    turn_sin: Array


class Motion(NamedTuple):
    """Where the lanes are: position, speed, one tangent vector, side (-1, 0, 1), phase of the drive, and time left."""

    p: Array
    v: Array
    dp: Array
    dv: Array
    side: Array
    cos: Array
    sin: Array
    left: Array


def branches(system: LinearPieces) -> tuple[Branch, Branch]:
    """The play, and the upper contact (the lower one mirrors it: its edge is taken off before, see `leg`)."""
    return _branch(system, 0.0), _branch(system, 1.0)


def _branch(system: LinearPieces, contact: float) -> Branch:
    damping = system.damping + contact * system.contact_damping
    stiffness = system.stiffness + contact * system.contact_stiffness
    omega = system.omega
    bend = stiffness - omega**2
    size = system.amplitude / (bend**2 + (damping * omega) ** 2)
    soft = stiffness == 0.0
    # Without a spring a load has no forced solution at rest; `recognise` keeps such systems away from here.
    middle = jnp.where(soft, 0.0, system.load / jnp.where(soft, 1.0, stiffness))
    square = stiffness - 0.25 * damping**2
    reach = jnp.minimum(TURN / omega, REACH / jnp.sqrt(jnp.maximum(jnp.abs(square), 1e-300)))
    reach = jnp.minimum(reach, 2.0 * FADE / jnp.maximum(damping, 1e-300))
    half = 0.5 * damping
    ahead = _flow(half, square, stiffness, reach)
    return Branch(
        half, stiffness, square, middle, bend * size, damping * omega * size, reach, ahead, *_rotate(omega, reach)
    )


def _series(x: Array, first: int, terms: int) -> Array:
    """Sum of ``(-x)^n first! / (first + 2 n)!``: the cosine (first 0) and sine over argument (first 1) of sqrt(x)."""
    total = jnp.full_like(x, 1.0 / math.prod(range(first + 1, first + 2 * terms + 1)) * (-1) ** terms)
    for n in range(terms - 1, -1, -1):
        total = total * x + (-1) ** n / math.prod(range(first + 1, first + 2 * n + 1))
    return total


def _exponential(x: Array, terms: int = 6) -> Array:
    """exp(-x) for x up to `FADE`."""
    total = jnp.full_like(x, (-1) ** terms / math.factorial(terms))
    for n in range(terms - 1, -1, -1):
        total = total * x + (-1) ** n / math.factorial(n)
    return total


def _flow(half: Array, square: Array, stiffness: Array, u: Array) -> Flow:
    fade = _exponential(half * u)
    q = square * u * u
    cosine, sine = fade * _series(q, 0, 9), fade * u * _series(q, 1, 8)
    return Flow(cosine + half * sine, sine, cosine - half * sine, stiffness)


def _forced(on: Branch, omega: Array, cos: Array, sin: Array) -> tuple[Array, Array]:
    """Position and speed of the branch's forced solution, apart from its middle."""
    return on.c * cos + on.s * sin, omega * (on.s * cos - on.c * sin)


def _rotate(omega: Array, u: Array) -> tuple[Array, Array]:
    """Cosine and sine of the drive's turn over a leg."""
    angle = omega * u
    square = angle * angle
    return _series(square, 0, 6), angle * _series(square, 1, 5)


class Quintic(NamedTuple):
    """A polynomial on 0 ... 1 with value, slope and curvature given at both ends."""

    c0: Array
    c1: Array
    c2: Array
    c3: Array
    c4: Array
    c5: Array

    @classmethod
    def through(cls, start: tuple[Array, Array, Array], end: tuple[Array, Array, Array]) -> Quintic:
        (a, b, c), (p, q, r) = start, end
        c = 0.5 * c
        x, y, z = p - a - b - c, q - b - 2.0 * c, 0.5 * r - c
        return cls(a, b, c, 10.0 * x - 4.0 * y + z, -15.0 * x + 7.0 * y - 2.0 * z, 6.0 * x - 3.0 * y + z)

    def at(self, x: Array) -> Array:
        return self.c0 + x * (self.c1 + x * (self.c2 + x * (self.c3 + x * (self.c4 + x * self.c5))))

    def slope(self, x: Array) -> Array:
        return self.c1 + x * (2.0 * self.c2 + x * (3.0 * self.c3 + x * (4.0 * self.c4 + x * (5.0 * self.c5))))

    def bend(self, x: Array) -> Array:
        return 2.0 * self.c2 + x * (6.0 * self.c3 + x * (12.0 * self.c4 + x * (20.0 * self.c5)))


def leg(system: LinearPieces, play: Branch, contact: Branch, now: Motion) -> Motion:
    """Take every lane to the next edge of the play, as far as its reach, or to the end of the time it has left.

    The tangent vector is carried by the exact derivative of the flow, the jump at an edge included (saltation: the speed's
    part changes by what the contact's damping adds, times the position's part).
    """
    touching = now.side != 0.0
    on = jax.tree.map(lambda a, b: jnp.where(touching, b, a), play, contact)
    omega = system.omega
    # In contact the spring's end is at the edge: side * contact stiffness is a load of the branch.
    push = now.side * system.contact_stiffness
    middle = on.middle + push / jnp.where(touching, on.stiffness, 1.0)
    forced = _forced(on, omega, now.cos, now.sin)
    free = now.p - middle - forced[0], now.v - forced[1]

    def put(flow: Flow, cos: Array, sin: Array) -> tuple[Array, Array]:
        p, v = flow(*free)
        shift = _forced(on, omega, cos, sin)
        return middle + shift[0] + p, shift[1] + v

    def bend(p: Array, v: Array, cos: Array) -> Array:
        return system.load + push - 2.0 * on.half * v - on.stiffness * p + system.amplitude * cos

    # A look as far as the reach, even where less time is left: its numbers are the same for every leg.
    cos, sin = _turn(now, on.turn_cos, on.turn_sin)
    p, v = put(on.ahead, cos, sin)
    step = on.reach
    path = Quintic.through((now.p, step * now.v, step**2 * bend(now.p, now.v, now.cos)), (p, step * v, step**2 * bend(p, v, cos)))
    leaves, share, beyond = _first_exit(path, now, p, v)
    u = jnp.where(leaves, share, 1.0) * step
    leaves = leaves & (u <= now.left)
    u = jnp.minimum(u, now.left)

    cos, sin = _turn(now, *_rotate(omega, u))
    flow = _flow(on.half, on.square, on.stiffness, u)
    p, v = put(flow, cos, sin)
    dp, dv = flow(now.dp, now.dv)

    # The search misses the edge by a little; what is left of the way is a Taylor step, so that its error is cubed.
    a = bend(p, v, cos)
    late = _miss(p - jnp.where(touching, now.side, beyond), v, a, MISS * step)
    late = jnp.where(leaves, late, 0.0)
    drift = -omega * system.amplitude * sin
    da = -2.0 * on.half * dv - on.stiffness * dp
    ahead = Motion(
        p + late * (v + 0.5 * late * a), v + late * (a + 0.5 * late * (drift - 2.0 * on.half * a - on.stiffness * v)),
        dp + late * (dv + 0.5 * late * da), dv + late * (da - 0.5 * late * (2.0 * on.half * da + on.stiffness * dv)),
        jnp.where(leaves, beyond, now.side),
        cos - late * omega * (sin + 0.5 * late * omega * cos), sin + late * omega * (cos - 0.5 * late * omega * sin),
        now.left - u - late,
    )  # fmt: skip
    jump = jnp.where(leaves, jnp.where(touching, -1.0, 1.0) * system.contact_damping, 0.0)
    return ahead._replace(dv=ahead.dv - jump * ahead.dp)


def _miss(gap: Array, v: Array, a: Array, most: Array) -> Array:
    """Time from here to where ``gap + v t + a t^2 / 2`` is zero, two Newton steps from now and no more than ``most``."""
    late = jnp.zeros_like(gap)
    for _ in range(2):
        slope = v + a * late
        late = late - (gap + late * (v + 0.5 * late * a)) / jnp.where(slope == 0.0, 1e-300, slope)
        late = jnp.clip(late, -most, most)
    return late


def _turn(now: Motion, cos: Array, sin: Array) -> tuple[Array, Array]:
    return now.cos * cos - now.sin * sin, now.sin * cos + now.cos * sin


def _first_exit(path: Quintic, now: Motion, p1: Array, v1: Array) -> tuple[Array, Array, Array]:
    """Whether the branch is left within the path, at which share of it, and the side that follows."""
    touching = now.side != 0.0
    turns = now.v * v1 < 0.0
    # An extremum inside: where the slope, taken as straight, is zero, and one Newton step on the slope.
    straight = now.v / jnp.where(turns, now.v - v1, 1.0)
    bend = path.bend(straight)
    peak = jnp.clip(straight - path.slope(straight) / jnp.where(bend == 0.0, 1.0, bend), 0.0, 1.0)
    top = path.at(peak)
    # g = m - n p is the distance to the edge, positive on the branch.
    heading = jnp.sign(now.v)
    m = jnp.where(touching, -1.0, 1.0)
    beyond = turns & (m - jnp.where(touching, -now.side, heading) * top < 0.0)
    n = jnp.where(touching, -now.side, jnp.where(beyond, heading, jnp.sign(p1)))
    end, at_end = jnp.where(beyond, peak, 1.0), jnp.where(beyond, top, p1)
    g0, g1 = m - n * path.c0, m - n * at_end
    leaves = g1 < 0.0
    # The parabola through distance and speed at the start and the distance at the end has one root.
    slope = -n * path.c1 * end
    curve = g1 - g0 - slope
    root = jnp.sqrt(jnp.maximum(slope * slope - 4.0 * curve * g0, 0.0))
    away = slope > 0.0
    above, below = jnp.where(away, slope + root, 2.0 * g0), jnp.where(away, -2.0 * curve, root - slope)
    x = end * jnp.clip(above / jnp.where(below == 0.0, 1.0, below), 0.0, 1.0)
    low, high = jnp.zeros_like(x), end
    for _ in range(NEWTON):
        g, slope = m - n * path.at(x), -n * path.slope(x)
        low, high = jnp.where(g > 0.0, x, low), jnp.where(g > 0.0, high, x)
        better = x - g / jnp.where(slope == 0.0, -1.0, slope)
        x = jnp.where((better >= low) & (better <= high), better, 0.5 * (low + high))
    return leaves, x, jnp.where(touching, 0.0, n)


def travel(system: LinearPieces, now: Motion, most: Array, stride: int = 4) -> Motion:
    """Legs until no lane has time left, or ``most`` legs are spent; ``stride`` legs are taken between two looks."""
    play, contact = branches(system)

    def more(carry: tuple[Any, Motion]) -> Any:
        count, now = carry
        return (count < most) & jnp.any(now.left > 0.0)

    def go(carry: tuple[Any, Motion]) -> tuple[Any, Motion]:
        count, now = carry
        return count + stride, jax.lax.fori_loop(0, stride, lambda _, m: leg(system, play, contact, m), now)

    _, now = jax.lax.while_loop(more, go, (0, now))
    return now
