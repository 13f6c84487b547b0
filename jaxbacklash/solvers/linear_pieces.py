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
from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp

Array = Any

REACH = 2.4
"""Longest leg in radians of the branch's own frequency: the crossing is then found to 2e-4, its effect to the cube of that."""
TURN = 1.0
"""Longest leg in radians of the drive."""
FADE = 0.1
"""Longest leg in units of 2 / damping."""
HALLEY = 3
LOST = 1e-3
"""Distance from the edge [half plays] at the last point of the search, beyond which the leg ends short of the edge."""
THIRD = 1.0 / 3.0  # a division takes ten times as long as a product
MISS = 0.1
"""Most that the search for an edge may be off, as a share of a leg."""
NEAR = 3e-4
"""A motion that turns back this close to an edge [half plays] is judged at its turning point by the exact solution."""


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
    """The homogeneous solution after a while: ``p = c p0 + s v0``, ``v = r v0 - k p0``."""

    c: Array
    s: Array
    r: Array
    k: Array

    def __call__(self, p: Array, v: Array) -> tuple[Array, Array]:
        return self.c * p + self.s * v, self.r * v - self.k * p


class Branch(NamedTuple):
    """One branch, ready to be stepped along: its damping, stiffness, squared frequency, and its forced solution.

    The forced solution is ``middle + c cos(theta) + s sin(theta)``, in the upper contact ``held`` above that; ``reach`` is the
    longest leg, ``ahead`` what a leg of that length does to the free motion, ``turn_cos`` and ``turn_sin`` what it does to the
    phase of the drive.
    """

    damping: Array
    stiffness: Array
    square: Array
    middle: Array
    held: Array
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


def branches(system: LinearPieces) -> Branch:
    """The play, and the upper contact (the lower one mirrors it: its edge is taken off before, see `leg`), as one `Branch`
    with another axis in front: computed so, and cut where they are used, they are half the work for a compiler."""
    lanes = max(jnp.ndim(number) for number in jax.tree.leaves(system))
    return _branch(system, jnp.arange(2.0).reshape((2,) + (1,) * lanes))


def _branch(system: LinearPieces, contact: Array) -> Branch:
    damping = system.damping + contact * system.contact_damping
    stiffness = system.stiffness + contact * system.contact_stiffness
    omega = system.omega
    bend = stiffness - omega**2
    size = system.amplitude / (bend**2 + (damping * omega) ** 2)
    soft = stiffness == 0.0
    # Without a spring a load has no forced solution at rest; `recognise` keeps such systems away from here.
    middle = jnp.where(soft, 0.0, system.load / jnp.where(soft, 1.0, stiffness))
    held = contact * system.contact_stiffness / jnp.where(soft, 1.0, stiffness)
    square = stiffness - 0.25 * damping**2
    reach = jnp.minimum(TURN / omega, REACH / jnp.sqrt(jnp.maximum(jnp.abs(square), 1e-300)))
    reach = jnp.minimum(reach, 2.0 * FADE / jnp.maximum(damping, 1e-300))
    return Branch(
        damping, stiffness, square, middle, held, bend * size, damping * omega * size, reach,
        _flow(damping, square, stiffness, reach), *_rotate(omega * reach),
    )  # fmt: skip


def _series(x: Array, first: int, terms: int) -> Array:
    """Sum of ``(-x)^n first! / (first + 2 n)!``: the cosine (first 0) and sine over argument (first 1) of sqrt(x)."""
    total = jnp.full_like(x, 1.0 / math.prod(range(first + 1, first + 2 * terms + 1)) * (-1) ** terms)
    for n in range(terms - 1, -1, -1):
        total = total * x + (-1) ** n / math.prod(range(first + 1, first + 2 * n + 1))
    return total


def _exponential(x: Array, terms: int = 7) -> Array:
    """exp(-x) for x up to `FADE`."""
    total = jnp.full_like(x, (-1) ** terms / math.factorial(terms))
    for n in range(terms - 1, -1, -1):
        total = total * x + (-1) ** n / math.factorial(n)
    return total


def _flow(damping: Array, square: Array, stiffness: Array, u: Array) -> Flow:
    half = 0.5 * damping
    fade = _exponential(half * u)
    q = square * u * u
    cosine, sine = fade * _series(q, 0, 11), fade * u * _series(q, 1, 11)
    return Flow(cosine + half * sine, sine, cosine - half * sine, stiffness * sine)


def _forced(on: Branch, cos: Array, sin: Array) -> tuple[Array, Array]:
    """The branch's forced solution apart from its middle, and its derivative by the phase of the drive."""
    return on.c * cos + on.s * sin, on.s * cos - on.c * sin


def _rotate(angle: Array) -> tuple[Array, Array]:
    """Cosine and sine of an angle up to `TURN`."""
    square = angle * angle
    return _series(square, 0, 8), angle * _series(square, 1, 7)


class Septic(NamedTuple):
    """A polynomial on 0 ... 1 with value and three derivatives given at both ends."""

    c0: Array
    c1: Array
    c2: Array
    c3: Array
    c4: Array
    c5: Array
    c6: Array
    c7: Array

    @classmethod
    def through(cls, start: tuple[Array, ...], end: tuple[Array, ...]) -> Septic:
        a, b, c, d = start[0], start[1], 0.5 * start[2], 0.5 * THIRD * start[3]
        # What the cubic from the start leaves to be reached at the end.
        p, q = end[0] - (a + b + c + d), end[1] - (b + 2.0 * c + 3.0 * d)
        r, s = 0.5 * end[2] - (c + 3.0 * d), 0.5 * THIRD * end[3] - d
        return cls(
            a, b, c, d,
            35.0 * p - 15.0 * q + 5.0 * r - s, -84.0 * p + 39.0 * q - 14.0 * r + 3.0 * s,
            70.0 * p - 34.0 * q + 13.0 * r - 3.0 * s, -20.0 * p + 10.0 * q - 4.0 * r + s,
        )  # fmt: skip

    def at(self, x: Array) -> Array:
        return _horner(x, self)

    def slope(self, x: Array) -> Array:
        return _horner(x, [n * c for n, c in enumerate(self)][1:])

    def bend(self, x: Array) -> Array:
        return _horner(x, [n * (n - 1) * c for n, c in enumerate(self)][2:])

    def jerk(self, x: Array) -> Array:
        return _horner(x, [n * (n - 1) * (n - 2) * c for n, c in enumerate(self)][3:])


def _horner(x: Array, coefficients: Sequence[Array]) -> Array:
    total = coefficients[-1]
    for c in reversed(coefficients[:-1]):
        total = total * x + c
    return total


def leg(system: LinearPieces, both: Branch, now: Motion) -> Motion:
    """Take every lane to the next edge of the play, as far as its reach, or to the end of the time it has left.

    The tangent vector is carried by the exact derivative of the flow, the jump at an edge included (saltation: the speed's
    part changes by what the contact's damping adds, times the position's part).
    """
    touching = now.side != 0.0
    on = jax.tree.map(lambda pair: jnp.where(touching, pair[1], pair[0]), both)
    omega = system.omega
    # In contact the spring's end is at the edge: side * contact stiffness is a load of the branch.
    push = now.side * system.contact_stiffness
    middle = on.middle + now.side * on.held
    shift, turn = _forced(on, now.cos, now.sin)
    free = now.p - middle - shift, now.v - omega * turn

    # A look as far as the reach, even where less time is left: its numbers are the same for every leg.
    step = on.reach
    pace = omega * step

    def derivatives(free: tuple[Array, Array], forced: tuple[Array, Array]) -> tuple[Array, ...]:
        """Position of a free and a forced part together, and three derivatives by the share of the leg."""
        (p, v), (shift, turn) = free, forced
        a = -on.damping * v - on.stiffness * p
        b = -on.damping * a - on.stiffness * v
        first, second = pace * turn, pace * pace * shift
        return (
            middle + (p + shift), step * v + first, step * step * a - second,
            step * step * step * b - pace * pace * first,
        )  # fmt: skip

    begin = derivatives(free, (shift, turn))
    end = derivatives(on.ahead(*free), _turn(shift, turn, on.turn_cos, on.turn_sin))
    leaves, grazes, share, way = _first_exit(Septic.through(begin, end), begin, end, now)
    u = share * step
    there = u <= now.left
    u = jnp.where(there, u, now.left)

    cos, sin = _turn(now.cos, -now.sin, *_rotate(omega * u))
    sin = -sin
    shift, turn = _forced(on, cos, sin)
    flow = _flow(on.damping, on.square, on.stiffness, u)
    p, v = flow(*free)
    p, v = middle + (p + shift), v + omega * turn
    dp, dv = flow(now.dp, now.dv)

    # The search misses the edge by a little; what is left of the way is a Taylor step.
    a = system.load + push - on.damping * v - on.stiffness * p + system.amplitude * cos
    b = -omega * system.amplitude * sin - on.damping * a - on.stiffness * v
    gap = p - jnp.where(touching, now.side, way)
    leaves = there & (leaves | (grazes & (gap * way > 0.0)))
    c = -omega * omega * system.amplitude * cos - on.damping * b - on.stiffness * a
    late = _miss(gap, v, (a, b, c), way, MISS * step)
    late = jnp.where(leaves, late, 0.0)
    da = -on.damping * dv - on.stiffness * dp
    db = -on.damping * da - on.stiffness * dv
    dc = -on.damping * db - on.stiffness * da
    drift = omega * late
    ahead = Motion(
        p + _taylor(late, v, a, b, c), v + _taylor(late, a, b, c), dp + _taylor(late, dv, da, db, dc),
        dv + _taylor(late, da, db, dc),
        jnp.where(leaves, jnp.where(touching, 0.0, way), now.side),
        cos - drift * (sin + 0.5 * drift * cos), sin + drift * (cos - 0.5 * drift * sin), now.left - u - late,
    )  # fmt: skip
    jump = jnp.where(leaves, jnp.where(touching, -1.0, 1.0) * system.contact_damping, 0.0)
    return ahead._replace(dv=ahead.dv - jump * ahead.dp)


def _turn(along: Array, across: Array, cos: Array, sin: Array) -> tuple[Array, Array]:
    """A forced solution and its derivative by the phase, after the phase has turned."""
    return along * cos + across * sin, across * cos - along * sin


def _taylor(t: Array, *rates: Array) -> Array:
    """What is gained in a short time, from the rate and its derivatives."""
    total = rates[-1]
    for n in range(len(rates) - 1, 0, -1):
        total = rates[n - 1] + t * total * (1.0 / (n + 1))
    return t * total


def _miss(gap: Array, v: Array, rates: tuple[Array, Array, Array], way: Array, most: Array) -> Array:
    """Time from here to where the Taylor series of the motion meets the edge and the speed has the sign ``way``, no more than
    ``most``: the parabola's root, then two steps of Newton's with the slope there, since a motion that grazes has none here."""
    a, b, _ = rates
    below = v + way * jnp.sqrt(jnp.maximum(v * v - 2.0 * a * gap, 0.0))
    late = _within(-2.0 * gap / jnp.where(below == 0.0, 1.0, below), -most, most)
    slope = v + late * (a + 0.5 * late * b)
    share = 1.0 / jnp.where(slope == 0.0, 1.0, slope)
    for _ in range(2):
        late = late - share * (gap + _taylor(late, v, *rates))
    return _within(late, -most, most)


def _first_exit(path: Septic, begin: tuple[Array, ...], end: tuple[Array, ...], now: Motion) -> tuple[Array, ...]:
    """Whether the branch is left within the leg, whether it may be left where the motion turns, at which share the leg ends,
    and the way out: the sign of the speed with which the branch is left."""
    touching = now.side != 0.0
    (_, v0, a0, _), (p1, v1, a1, _) = begin, end
    turns = v0 * v1 < 0.0
    # Speed that ends with its sign may have had the other in between: the acceleration then has changed its sign. Where that
    # is so the leg is cut at the turn of the acceleration, so that each part has one extremum at most.
    dips = (v0 * v1 > 0.0) & (v0 * a0 < 0.0) & (v1 * a1 > 0.0)
    above, below = jnp.where(turns, v0, a0), jnp.where(turns, v1, a1)
    here = jnp.where(turns | dips, above / jnp.where(turns | dips, above - below, 1.0), 1.0)
    slope, bend, jerk = path.slope(here), path.bend(here), path.jerk(here)
    cut = dips & (slope * v0 < 0.0)
    # The extremum: where a parabola laid on the speed there has its root, with a slope against the speed at the start.
    heading = jnp.sign(v0)
    root = jnp.sqrt(jnp.maximum(bend * bend - 2.0 * jerk * slope, 0.0))
    below = bend - heading * root
    peak = _within(here - 2.0 * slope / jnp.where(below == 0.0, 1.0, below), 0.0, 1.0)
    top = path.at(peak)
    # g = m - n p is the distance to the edge, positive on the branch.
    m = jnp.where(touching, -1.0, 1.0)
    room = m - jnp.where(touching, -now.side, heading) * top
    # A leg that begins at a turning point is not judged there again.
    grazes = (turns | cut) & (jnp.abs(room) < NEAR) & (peak > 0.01) & ~(now.side * heading > 0.0)
    beyond = (turns | cut) & ((room < 0.0) | grazes)
    last = jnp.where(beyond, peak, jnp.where(cut, here, 1.0))
    at_last = jnp.where(beyond, top, jnp.where(cut, path.at(here), p1))
    n = jnp.where(touching, -now.side, jnp.where(beyond, heading, jnp.sign(at_last)))
    g0, g1 = m - n * path.c0, m - n * at_last
    leaves = (g1 < 0.0) & ~grazes
    # The parabola through distance and speed at the start and the distance at the end has one root.
    slope = -n * path.c1 * last
    curve = g1 - g0 - slope
    root = jnp.sqrt(jnp.maximum(slope * slope - 4.0 * curve * g0, 0.0))
    away = slope > 0.0
    above, below = jnp.where(away, slope + root, 2.0 * g0), jnp.where(away, -2.0 * curve, root - slope)
    x = last * _within(above / jnp.where(below == 0.0, 1.0, below), 0.0, 1.0)
    # A turning point on the way tells more than the start: the parabola with its top there, through the start of the leg where
    # the edge lies before it, else through the end.
    after = (turns | cut) & ~beyond
    far = jnp.where(after, m - n * top, g0)
    known = leaves & (far > 0.0) & (after | (beyond & (-g1 < g0)))
    drop = jnp.sqrt(jnp.where(after, far, -g1) / jnp.where(known, far - g1, 1.0))
    x = jnp.where(known, jnp.where(after, peak + drop * (last - peak), last * (1.0 - drop)), x)
    low, high = jnp.where(after, peak, 0.0), last
    for _ in range(HALLEY):
        g, slope, bend = m - n * path.at(x), -n * path.slope(x), -n * path.bend(x)
        low, high = jnp.where(g > 0.0, x, low), jnp.where(g > 0.0, high, x)
        better = x - _halley(g, slope, bend)
        x = jnp.where((better >= low) & (better <= high), better, 0.5 * (low + high))
    # Where the search has not come near, the leg ends at the last point known to be on the branch, and the next one goes on.
    lost = leaves & (jnp.abs(g) > LOST) & (low > 0.0)
    return leaves & ~lost, grazes, jnp.where(lost, low, jnp.where(leaves, x, last)), n


def _halley(value: Array, slope: Array, bend: Array) -> Array:
    """What is to be taken off for the root: cubic convergence for one division."""
    below = 2.0 * slope * slope - value * bend
    return 2.0 * value * slope / jnp.where(below == 0.0, 1.0, below)


def _within(x: Array, low: Any, high: Any) -> Array:
    """``x`` in its bounds; a choice of one of two numbers is one machine instruction, unlike a clip that passes NaN on."""
    x = jnp.where(x > low, x, low)
    return jnp.where(x < high, x, high)


@partial(jax.jit, inline=True)  # diffrax traces a step twice
def travel(system: LinearPieces, now: Motion, most: Array) -> Motion:
    """Legs until no lane has time left, or ``most`` legs are spent."""
    both = branches(system)

    def more(carry: tuple[Any, Motion]) -> Any:
        count, now = carry
        return (count < most) & jnp.any(now.left > 0.0)

    def go(carry: tuple[Any, Motion]) -> tuple[Any, Motion]:
        count, now = carry
        return count + 1, leg(system, both, now)

    return jax.lax.while_loop(more, go, (0, now))[1]
