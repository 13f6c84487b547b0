r"""A panel: a short step over which the drive is a cubic, split where the link meets an edge of the play.

Between switches the law is smooth, so fourth-order Runge-Kutta keeps its order if no step straddles a switch. Each
panel is two steps; when the link crosses an edge inside the panel, the two meet there, else they meet in the middle. A second
play (a law that ``plays``) has edges of its own, and a third step for them.
The crossing is predicted from :math:`z, \dot z, \ddot z` at the start of the panel, against edges that may move. A miss by
:math:`\epsilon` in time costs :math:`k v \epsilon^2 / 2J` in speed, since the law of the region is carried on over the miss;
:math:`\epsilon` is of third order in the step, so the whole stays of fourth order for laws that are continuous at the edge.
"""

from __future__ import annotations

import functools
import itertools
from typing import Any, NamedTuple, Protocol

import jax
import jax.numpy as jnp
import numpy as np

from ..mechanics import Kink, Region

AGAIN = 5e-3
"""Share of a panel within which an event is one with that at which the last step has ended: the prediction may miss by that."""
Scalar = Any
State = tuple[Scalar, ...]
SHARES, WEIGHTS = np.array([0.5, 0.5, 1.0]), np.array([2.0, 2.0, 1.0])
"""Stages 2 to 4 of the classical Runge-Kutta step: share of the step at which they are taken, and weight."""


class Cubic(NamedTuple):
    """A scalar over one panel, :math:`u(\\tau) = a + b\\tau + c\\tau^2 + d\\tau^3`."""

    a: Scalar
    b: Scalar
    c: Scalar
    d: Scalar

    @classmethod
    def hermite(cls, u0: Scalar, du0: Scalar, u1: Scalar, du1: Scalar, h: Scalar) -> Cubic:
        """The cubic with values and slopes given at both ends of a panel of length ``h``."""
        mean = (u1 - u0) / h
        return cls(u0, du0, (3.0 * mean - 2.0 * du0 - du1) / h, (du0 + du1 - 2.0 * mean) / h**2)

    @classmethod
    def between(cls, u0: Scalar, du0: Scalar | None, u1: Scalar, du1: Scalar | None, h: Scalar) -> Cubic:
        """`hermite` where the slopes are known, else the straight line."""
        return cls.linear(u0, u1, h) if du0 is None else cls.hermite(u0, du0, u1, du1, h)

    @classmethod
    def linear(cls, u0: Scalar, u1: Scalar, h: Scalar) -> Cubic:
        """The straight line between two samples."""
        return cls(u0, (u1 - u0) / h, 0.0 * u0, 0.0 * u0)

    def at(self, tau: Scalar) -> Scalar:
        return self.a + tau * (self.b + tau * (self.c + tau * self.d))

    def slope(self, tau: Scalar) -> Scalar:
        return self.b + tau * (2.0 * self.c + 3.0 * tau * self.d)

    def bend(self, tau: Scalar) -> Scalar:
        """The second derivative."""
        return 2.0 * self.c + 6.0 * tau * self.d


class Playing(Protocol):
    """A system with a play, whose edges may move."""

    @property
    def play_moves(self) -> bool: ...

    def edges(self, t: Scalar, x: Scalar) -> tuple[Scalar, Scalar]: ...


class Switching(Playing, Protocol):
    """What a panel needs of a system: its rates in a known region, and where the regions end."""

    @property
    def has_play(self) -> bool: ...

    def rates(self, t: Scalar, state: State, drive: Any, side: Scalar | None = None) -> State: ...

    def kinks(
        self, t: Scalar, state: State, drive: Any, side: Scalar | None, ddz: Scalar, ddy: Scalar
    ) -> dict[str, tuple[Kink, ...]]: ...

    @property
    def plays(self) -> tuple[str, ...]: ...

    def base(self, state: State, x: Scalar, dx: Scalar) -> tuple[Scalar, Scalar]: ...

    def bend(self, rates: State, prescribed: Scalar) -> Scalar: ...


def _add(state: State, rates: State, step: Scalar) -> State:
    return tuple(s + step * r for s, r in zip(state, rates))


def rk4(rates: Any, t: Scalar, state: State, h: Scalar, first: State | None = None) -> State:
    """One classical Runge-Kutta step of ``rates(t, state)``; ``first`` is the slope at the start when it is known."""
    k1 = rates(t, state) if first is None else first
    k2 = rates(t + 0.5 * h, _add(state, k1, 0.5 * h))
    k3 = rates(t + 0.5 * h, _add(state, k2, 0.5 * h))
    k4 = rates(t + h, _add(state, k3, h))
    return tuple(s + (h / 6.0) * (a + 2.0 * (b + c) + d) for s, a, b, c, d in zip(state, k1, k2, k3, k4))


def rk4_in_turns(rates: Any, t: Scalar, state: State, h: Scalar, first: State) -> State:
    """As `rk4`, with ``rates`` written once beside ``first``."""

    def stage(carry: Any, at: Any) -> Any:
        slope, total = carry
        share, weight = at
        slope = rates(t + share * h, _add(state, slope, share * h))
        return (slope, _add(total, slope, weight)), None

    (_, total), _ = jax.lax.scan(stage, (first, first), (SHARES, WEIGHTS))
    return _add(state, total, h / 6.0)


def _first_crossing(gap: Scalar, speed: Scalar, acceleration: Scalar, h: Scalar, least: Scalar = 0.0) -> Scalar:
    """First time in (least, h) at which ``gap + speed t + acceleration t^2 / 2`` is zero, or ``h`` if it never is."""
    square = speed**2 - 2.0 * acceleration * gap
    # The square root of a guarded value keeps derivatives finite in lanes without a crossing.
    root = jnp.sqrt(jnp.where(square > 0.0, square, 1.0))
    best = h
    for denominator in (-speed + root, -speed - root):
        safe = jnp.where(jnp.abs(denominator) > 1e-30, denominator, 1.0)
        time = 2.0 * gap / safe
        valid = (square > 0.0) & (time > least) & (time < h) & (jnp.abs(denominator) > 1e-30)
        best = jnp.where(valid & (time < best), time, best)
    return best


class Edges(NamedTuple):
    """The edges of the play over one panel, each its place at the start, its speed and half its acceleration there: they move
    where the play wears, or a gear's error shifts it."""

    low: tuple[Scalar, Scalar, Scalar]
    high: tuple[Scalar, Scalar, Scalar]

    @classmethod
    def over(cls, system: Playing, t: Scalar, base: Cubic, h: Scalar) -> Edges:
        """The edges of a system from ``t`` on, the base moving as ``base``: parabolas through three moments of a panel."""
        begin = system.edges(t, base.a)
        if not system.play_moves:
            return cls(*((edge, 0.0, 0.0) for edge in begin))
        middle, end = (system.edges(t + part * h, base.at(part * h)) for part in (0.5, 1.0))
        return cls(*(_parabola(*moving, h) for moving in zip(begin, middle, end)))

    def side(self, z: Scalar, tau: Scalar) -> Scalar:
        """On which side of the play the link is at ``z``: 1 above, -1 below, 0 inside."""
        (low, *_), (high, *_) = (_moved(edge, tau) for edge in self)
        return jnp.where(z > high, 1.0, jnp.where(z < low, -1.0, 0.0))

    def first_crossing(self, tau: Scalar, z: Scalar, dz: Scalar, ddz: Scalar, rest: Scalar, least: Scalar = 0.0) -> Scalar:
        """Time from ``tau`` on, ``least`` at least, to the first meeting with an edge, or ``rest`` if there is none before."""
        ahead = []
        for place, speed, half in (_moved(edge, tau) for edge in self):
            ahead.append(_first_crossing(z - place, dz - speed, ddz - 2.0 * half, rest, least))
        return jnp.minimum(*ahead)


def _parabola(begin: Scalar, middle: Scalar, end: Scalar, h: Scalar) -> tuple[Scalar, Scalar, Scalar]:
    early, late = middle - begin, end - middle
    return begin, (3.0 * early - late) / h, 2.0 * (late - early) / h**2


def _moved(edge: tuple[Scalar, Scalar, Scalar], tau: Scalar) -> tuple[Scalar, Scalar, Scalar]:
    """An edge after a time ``tau``: a number that is no array says that it stays where it is."""
    place, speed, half = edge
    if isinstance(speed, float):
        return edge
    return place + tau * (speed + tau * half), speed + 2.0 * tau * half, half


def base_ahead(system: Switching, state: State, base: Cubic) -> Cubic:
    """How the joint's base goes on over a panel: as prescribed, or the motor of a drive straight on."""
    x, dx = system.base(state, base.a, base.b)
    return base if x is base.a else Cubic(x, dx, 0.0 * x, 0.0 * x)


def _first_kink(kinks: dict[str, tuple[Kink, ...]], h: Scalar, least: Scalar = 0.0) -> Scalar:
    """First time in (least, h) at which one of some quantities with these values, rates and rates of those is zero, or ``h`` if
    none ever is."""
    best = h
    for kink in itertools.chain.from_iterable(kinks.values()):
        value, rate, bend = kink
        if not isinstance(bend, float):
            best = jnp.minimum(best, _first_crossing(*kink, h, least))
            continue
        ahead = value * rate < 0.0  # a number that is no array says that the rate stays as it is
        best = jnp.minimum(best, jnp.where(ahead, -value / jnp.where(ahead, rate, 1.0), h))
    return best


def lasts(system: Switching) -> Scalar:
    """For each step of a panel whether it is the last: of two, and of one more for each law with a play of its own."""
    steps = 2 + len(system.plays)
    return jnp.arange(steps) == steps - 1


def settled(system: Switching, side: Any, kinks: dict[str, tuple[Kink, ...]], half: Scalar) -> Any:
    """The region of a step, by where it is after ``half`` of it: the ``side`` of the play, and with it those of laws that have
    one of their own."""
    beyond = {}
    for name in system.plays:
        ahead = [value + half * (rate + 0.5 * half * bend) for value, rate, bend in kinks[name]]
        beyond[name] = functools.reduce(jnp.maximum, ahead) > 0.0
    return Region(side, beyond) if beyond else side


def advance(system: Switching, t: Scalar, state: State, drive_at: Any, base: Cubic, h: Scalar) -> State:
    """Advance the state over one panel.

    Parameters
    ----------
    system : the laws and the edges of the play
    t : time at the start of the panel [s]
    state : ``(y, dy, ...)`` at the start
    drive_at : function of the time since the start of the panel, giving the drive that ``system.rates`` wants
    base : base motion x over the panel [rad], where that is prescribed
    h : length of the panel [s]
    """
    x, dx = system.base(state, base.a, base.b)
    edges = Edges.over(system, t, base_ahead(system, state, base), h)
    z, dz = state[0] - x, state[1] - dx
    side = edges.side(z, 0.0)
    first = system.rates(t, state, drive_at(0.0), side)
    ddz = first[1] - system.bend(first, 2.0 * base.c)

    crossing = edges.first_crossing(0.0, z, dz, ddz, h)
    crossing = jnp.minimum(crossing, _first_kink(system.kinks(t, state, drive_at(0.0), side, ddz, first[1]), h))
    split = jnp.where(crossing < h, crossing, 0.5 * h)

    half = 0.5 * split
    side = edges.side(z + half * (dz + 0.5 * half * ddz), half)
    middle = rk4(lambda s, q: system.rates(t + s, q, drive_at(s), side), 0.0, state, split, first)

    rest = h - split
    x, dx = system.base(middle, base.at(split), base.slope(split))
    z, dz = middle[0] - x, middle[1] - dx
    half = 0.5 * rest
    side = edges.side(z + half * (dz + 0.5 * half * ddz), split + half)
    return rk4(lambda s, q: system.rates(t + s, q, drive_at(s), side), split, middle, rest)


def advance_in_turns(system: Switching, t: Scalar, state: State, drive_at: Any, base: Cubic, h: Scalar) -> State:
    """As `advance`, in loops over the two steps, or more with plays of laws, and their stages: slower where the laws are few, and
    where they are many with internal states among them the compiler, for which every stage is as much work as all laws, takes
    half as long."""
    edges = Edges.over(system, t, base_ahead(system, state, base), h) if system.has_play else None
    least = AGAIN * h if system.plays else 0.0  # an event where a step begins is that at which the last one ended

    def relative(state: State, tau: Scalar) -> tuple[Scalar, Scalar]:
        x, dx = system.base(state, base.at(tau), base.slope(tau))
        return state[0] - x, state[1] - dx

    def side_of(z: Scalar, at: Scalar) -> Any:
        return None if edges is None else edges.side(z, at)

    def step(carry: Any, last: Any) -> Any:
        state, begin, side = carry
        rest, (z, dz) = h - begin, relative(state, begin)
        if system.plays and edges is not None:  # the side was that of all that is left
            side = jnp.where(last, side, edges.side(z + least * dz, begin + least))
        first = system.rates(t + begin, state, drive_at(begin), side)
        ddz = first[1] - system.bend(first, base.bend(begin))
        crossing = rest if edges is None else edges.first_crossing(begin, z, dz, ddz, rest, least)
        kinks = system.kinks(t + begin, state, drive_at(begin), side, ddz, first[1])
        crossing = jnp.minimum(crossing, _first_kink(kinks, rest, least))
        length = jnp.where(last, rest, jnp.where(crossing < rest, crossing, 0.5 * rest))
        half = 0.5 * length
        if edges is not None:
            side = jnp.where(last, side, edges.side(z + half * (dz + 0.5 * half * ddz), begin + half))
        region = settled(system, side, kinks, half)
        state = rk4_in_turns(lambda s, q: system.rates(t + s, q, drive_at(s), region), begin, state, length, first)
        begin = begin + length
        (z, dz), half = relative(state, begin), 0.5 * (h - begin)
        return (state, begin, side_of(z + half * (dz + 0.5 * half * ddz), begin + half)), None

    begun: Any = (state, jnp.zeros_like(state[0]), side_of(relative(state, 0.0)[0], 0.0))
    (state, *_), _ = jax.lax.scan(step, begun, lasts(system))
    return state


def advance_smooth(system: Switching, t: Scalar, state: State, drive_at: Any, h: Scalar) -> State:
    """Advance over one panel of a system without switches, or with smoothed corners: two plain Runge-Kutta steps."""
    for k in (0.0, 0.5):
        state = rk4(lambda s, q: system.rates(t + s, q, drive_at(s)), k * h, state, 0.5 * h)
    return state


def advance_smooth_in_turns(system: Switching, t: Scalar, state: State, drive_at: Any, h: Scalar) -> State:
    """As `advance_smooth`, in loops for the reason of `advance_in_turns`."""

    def step(state: State, begin: Scalar) -> tuple[State, None]:
        rates = lambda s, q: system.rates(t + s, q, drive_at(s))  # noqa: E731
        return rk4_in_turns(rates, begin, state, 0.5 * h, rates(begin, state)), None

    return jax.lax.scan(step, state, jnp.stack([0.0 * h, 0.5 * h]))[0]
