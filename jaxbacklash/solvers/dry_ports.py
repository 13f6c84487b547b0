r"""A panel of a drive with dry friction at some of its ports: joint, ground and motor slide, come to rest, stick, break away.

The same way as `dry` goes for a link on a prescribed base, for two coordinates. Friction at port p feels the speed
:math:`a_p \dot q` and acts back through the same row,

.. math:: \ddot q = M^{-1} \Big(Q - \sum_p a_p^\top \lambda_p\Big),\qquad \lambda_p \in c_p\,\mathrm{Sgn}(a_p \dot q),

and at ports that are at rest, :math:`a_p \dot q = 0`, the same holds of the accelerations: they minimise

.. math:: \tfrac12 \ddot q^\top M \ddot q - Q^\top \ddot q + \sum_p c_p |a_p \ddot q|,

and a port sticks whose :math:`a_p \ddot q` is zero there. That is decided where a step begins and kept to the step's end: the
first event ahead, an edge of the play or a speed that comes to zero. What the prediction misses is put right afterwards.

Source: Moreau, Unilateral contact and dry friction in finite freedom dynamics (1988), on friction as such a least problem.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

import jax
import jax.numpy as jnp

from .dry import SOON, STILL
from .panels import AGAIN, SHARES, WEIGHTS, Cubic, Edges, Scalar, State, Switching, _add, _first_kink, base_ahead, lasts, settled


class Sliding(Switching, Protocol):
    """What a panel needs of a drive with dry friction at the ports ``slides``."""

    @property
    def slides(self) -> tuple[str, ...]: ...
    @property
    def has_play(self) -> bool: ...
    @property
    def rows(self) -> dict[str, tuple[Scalar, ...]]: ...
    @property
    def mobility(self) -> tuple[Scalar, ...]: ...

    def held_off(self, t: Scalar, state: State, drive: Any, side: Scalar | None) -> tuple[State, dict[str, Scalar]]: ...


class Ports(NamedTuple):
    """Ports that rub: their ``rows`` over the coordinates, and the inverse inertia of each coordinate."""

    rows: tuple[tuple[Scalar, ...], ...]
    mobility: tuple[Scalar, ...]

    def felt(self, p: int, motion: Sequence[Scalar]) -> Scalar:
        """What port ``p`` feels of the coordinates' places, speeds or accelerations."""
        return sum(a * v for a, v in zip(self.rows[p], motion))

    def meets(self, p: int, q: int) -> Scalar:
        """Acceleration at port ``p`` for a unit of torque at port ``q``."""
        return sum(a * w * b for a, w, b in zip(self.rows[p], self.mobility, self.rows[q]))

    def pushed(self, p: int, motion: Sequence[Scalar], torque: Scalar) -> list[Scalar]:
        """The accelerations (or speeds) with a torque (or impulse) at port ``p`` taken from them."""
        return [v - w * a * torque for v, w, a in zip(motion, self.mobility, self.rows[p])]


class Mode(NamedTuple):
    """How a drive moves on: by port the direction of sliding, 0 where it sticks, and whether it sticks."""

    slip: tuple[Scalar, ...]
    held: tuple[Scalar, ...]

    @property
    def several(self) -> Scalar:
        """Whether two ports or more stick: then two coordinates do not move at all."""
        return sum(h.astype(int) for h in self.held) > 1

    def sliding(self, ports: Ports, free: Sequence[Scalar], capacity: Sequence[Scalar]) -> list[Scalar]:
        """Accelerations with the friction of those that slide."""
        moving = list(free)
        for p, (slip, most) in enumerate(zip(self.slip, capacity)):
            moving = ports.pushed(p, moving, most * slip)
        return moving

    def stopped(self, ports: Ports, motion: Sequence[Scalar]) -> list[Scalar]:
        """Speeds or accelerations without what ports that stick do not allow."""
        for p, held in enumerate(self.held):
            taken = ports.pushed(p, motion, ports.felt(p, motion) / ports.meets(p, p))
            motion = [jnp.where(held, new, old) for new, old in zip(taken, motion)]
        return [jnp.where(self.several, 0.0, v) for v in motion] if len(self.held) > 1 else list(motion)

    def accelerations(self, ports: Ports, free: Sequence[Scalar], capacity: Sequence[Scalar]) -> list[Scalar]:
        """Accelerations of the coordinates [rad/s^2]."""
        return self.stopped(ports, self.sliding(ports, free, capacity))


def _mode(
    ports: Ports, free: Sequence[Scalar], capacity: Sequence[Scalar], speeds: Sequence[Scalar], met: Sequence[Any], soon: Scalar
) -> Mode:
    """The mode in which a drive with these speeds at its ports goes on; ``met`` speeds count as zero."""
    # What is decided here is decided for a whole step: no derivative goes through it.
    ports, free, capacity, speeds = jax.lax.stop_gradient((ports, list(free), list(capacity), list(speeds)))
    count = len(speeds)
    every = range(count)
    signs = [jnp.sign(v) for v in speeds]
    moving = list(free)
    for p in every:
        moving = ports.pushed(p, moving, capacity[p] * signs[p])
    still = [met[p] | (jnp.abs(speeds[p]) <= STILL + soon * jnp.abs(ports.felt(p, moving))) for p in every]
    for p in every:  # what slides goes on sliding, what is at rest is open
        moving = [jnp.where(still[p], back, v) for back, v in zip(ports.pushed(p, moving, -capacity[p] * signs[p]), moving)]
    found, held = _least_action(ports, moving, [jnp.where(s, c, 0.0) for s, c in zip(still, capacity)])
    held = [still[p] & (capacity[p] > 0.0) & held[p] for p in every]
    slip = [jnp.where(held[p], 0.0, jnp.where(still[p], jnp.sign(ports.felt(p, found)), signs[p])) for p in every]
    return Mode(tuple(slip), tuple(held))


def _least_action(ports: Ports, free: Sequence[Scalar], most: Sequence[Scalar]) -> tuple[list[Scalar], list[Scalar]]:
    """Accelerations of two coordinates with friction of at most ``most`` at ports that are at rest, and which ports stick.

    The minimum lies where all stick, where one does, or where none does and each slides one way: the least of these is it.
    """
    every = range(len(most))

    def action(found: Sequence[Scalar]) -> Scalar:
        own = sum(v * (0.5 * v - f) / w for v, f, w in zip(found, free, ports.mobility))
        return own + sum(c * jnp.abs(ports.felt(p, found)) for p, c in enumerate(most))

    zero, one = jnp.zeros_like(free[0]), jnp.ones_like(free[0], dtype=bool)
    tried: list[tuple[list[Scalar], list[Scalar]]] = [([zero for _ in free], [one for _ in every])]
    for p in every:
        along = (-ports.rows[p][1], ports.rows[p][0])  # the accelerations that this port does not feel
        push = sum(d * f / w for d, f, w in zip(along, free, ports.mobility))
        against = sum(most[q] * jnp.abs(ports.felt(q, along)) for q in every if q != p)
        size = sum(d * d / w for d, w in zip(along, ports.mobility))
        far = jnp.sign(push) * jnp.maximum(jnp.abs(push) - against, 0.0) / size
        tried.append(([d * far for d in along], [one if q == p else ~one for q in every]))
    for signs in itertools.product((-1.0, 1.0), repeat=len(most)):
        moving = list(free)
        for p, sign in enumerate(signs):
            moving = ports.pushed(p, moving, sign * most[p])
        tried.append((moving, [~one for _ in every]))
    (best, held), least = tried[0], action(tried[0][0])
    for found, sticks in tried[1:]:
        size = action(found)
        better = size < least
        best = [jnp.where(better, new, old) for new, old in zip(found, best)]
        held = [jnp.where(better, new, old) for new, old in zip(sticks, held)]
        least = jnp.where(better, size, least)
    return best, held


def advance_ports(system: Sliding, t: Scalar, state: State, drive_at: Any, base: Cubic, h: Scalar) -> State:
    """Advance the state over one panel; the arguments are those of `panels.advance`."""
    soon = SOON * h
    least = AGAIN * h if system.plays else 0.0
    names = system.slides
    ports = Ports(tuple(system.rows[name] for name in names), system.mobility)
    count = len(ports.mobility)
    edges = Edges.over(system, t, base_ahead(system, state, base), h) if system.has_play else None

    def see(at: Scalar, state: State, side: Scalar | None) -> tuple[State, list[Scalar], list[Scalar]]:
        rates, capacity = system.held_off(t + at, state, drive_at(at), side)
        return rates, [rates[2 * i + 1] for i in range(count)], [capacity[name] for name in names]

    def relative(state: State, tau: Scalar) -> tuple[Scalar, Scalar]:
        x, dx = system.base(state, base.at(tau), base.slope(tau))
        return state[0] - x, state[1] - dx

    def with_speeds(state: State, speeds: Sequence[Scalar]) -> State:
        mechanical = [v for i in range(count) for v in (state[2 * i], speeds[i])]
        return (*mechanical, *state[2 * count :])

    def region(z: Scalar, at: Scalar) -> Any:
        return None if edges is None else edges.side(z, at)

    def slopes(state: State, found: Sequence[Scalar], rates: State) -> State:
        mechanical = [v for i in range(count) for v in (state[2 * i + 1], found[i])]
        return (*mechanical, *rates[2 * count :])

    def across(found: Sequence[Scalar], tau: Scalar) -> Scalar:
        """Relative acceleration at the joint."""
        return found[0] - system.bend(slopes(state, found, state), base.bend(tau))

    def piece(carry: Any, last: Any) -> Any:
        state, begin, met, side = carry
        rest = h - begin
        if system.plays and side is not None:  # the side was that of all that is left
            z, dz = relative(state, begin)
            side = jnp.where(last, side, region(z + least * dz, begin + least))
        rates, free, capacity = see(begin, state, side)
        speeds = [state[2 * i + 1] for i in range(count)]
        mode = _mode(ports, free, capacity, [ports.felt(p, speeds) for p in range(len(names))], met, soon)
        speeds = mode.stopped(ports, speeds)
        state = with_speeds(state, speeds)
        found = mode.accelerations(ports, free, capacity)
        (z, dz), ddz = relative(state, begin), across(found, begin)
        kinks = system.kinks(t + begin, state, drive_at(begin), side, ddz, found[0])
        kink = _first_kink(kinks, rest, least)
        at_ports = [(ports.felt(p, speeds), ports.felt(p, found)) for p in range(len(names))]
        edge = rest if edges is None else edges.first_crossing(begin, z, dz, ddz, rest, least)
        event, met = _first_event(at_ports, mode, jnp.minimum(edge, kink), rest, soon)
        step, met = jnp.where(last, rest, event), tuple(m & ~last for m in met)
        half = 0.5 * step
        if side is not None:
            side = jnp.where(last, side, region(z + half * (dz + 0.5 * half * ddz), begin + half))
        here = settled(system, side, kinks, half)

        def stage(carry: Any, at: Any) -> Any:
            slope, total, *_ = carry
            share, weight = at
            tried = _add(state, slope, share * step)
            rates, free, capacity = see(begin + share * step, tried, here)
            slope = slopes(tried, mode.accelerations(ports, free, capacity), rates)
            return (slope, _add(total, slope, weight), free, capacity), None

        k1 = slopes(state, found, rates)
        (slope, total, *end), _ = jax.lax.scan(stage, (k1, k1, free, capacity), (SHARES, WEIGHTS))
        state = _add(state, total, step / 6.0)
        begin = begin + step
        state = _put_right(ports, state, mode, (free, capacity), end, step, met)
        half = 0.5 * (h - begin)
        z, dz = relative(state, begin)
        ddz = across([slope[2 * i + 1] for i in range(count)], begin)
        return (state, begin, met, region(z + half * (dz + 0.5 * half * ddz), begin + half)), None

    no = jnp.zeros_like(state[0], dtype=bool)
    begun: Any = (state, jnp.zeros_like(state[0]), tuple(no for _ in names), region(relative(state, 0.0)[0], 0.0))
    (state, *_), _ = jax.lax.scan(piece, begun, lasts(system))
    return state


def _first_event(
    at_ports: Sequence[tuple[Scalar, Scalar]], mode: Mode, other: Scalar, rest: Scalar, soon: Scalar
) -> tuple[Scalar, tuple[Scalar, ...]]:
    """Time to the first event ahead, that of an edge or kink at ``other`` among them, or half of what is left; and by port
    whether it is that its speed comes to zero. ``at_ports`` holds speed and acceleration."""
    stops = []
    for (speed, acceleration), held in zip(at_ports, mode.held):
        slowing = (speed * acceleration < 0.0) & ~held
        time = -speed / jnp.where(slowing, acceleration, 1.0)
        stops.append(jnp.where(slowing & (time > soon) & (time < rest), time, rest))
    event = other
    for stop in stops:
        event = jnp.minimum(event, stop)
    found = event < rest
    return jnp.where(found, event, 0.5 * rest), tuple(found & (stop <= event) for stop in stops)


def _put_right(
    ports: Ports, state: State, mode: Mode, start: Sequence[Any], end: Sequence[Any], step: Scalar, met: Sequence[Any]
) -> State:
    """The state at the end of a step as it would be had the step ended where its mode did."""
    count = len(ports.mobility)
    places, speeds = [state[2 * i] for i in range(count)], [state[2 * i + 1] for i in range(count)]
    sliding, before = mode.sliding(ports, *end), mode.sliding(ports, *start)
    moving = mode.stopped(ports, sliding)
    for p, (slip, held) in enumerate(zip(mode.slip, mode.held)):
        own, most, most_before = ports.meets(p, p), end[1][p], start[1][p]
        # A port that sticks alone breaks away where its hold runs out, on a straight line from start to end. Where several
        # stick the next step lets go of what cannot be held: late by less than a step, at a pull that has only just begun.
        hold, hold_before = ports.felt(p, sliding) / own, ports.felt(p, before) / own
        lack, spare = jnp.abs(hold) - most, most_before - jnp.abs(hold_before)
        broke = held & ~mode.several & (lack > 0.0)
        since = jnp.where(broke, step * lack / jnp.where(broke, lack + jnp.maximum(spare, 0.0), 1.0), 0.0)
        gain = jnp.sign(hold) * lack * since / 2.0
        speeds = ports.pushed(p, speeds, -gain)
        places = ports.pushed(p, places, -gain * since / 3.0)
        # One that slides has turned: friction held it, or turned with it, from there on, those that stick sticking on.
        answer = mode.stopped(ports, [w * a for w, a in zip(ports.mobility, ports.rows[p])])
        own = ports.felt(p, answer)
        own = jnp.where(own > 0.0, own, 1.0)
        speed, passed = ports.felt(p, speeds), ports.felt(p, moving)
        turned = (met[p] | (speed * slip < 0.0)) & (passed * slip < 0.0)
        since = jnp.where(turned, speed / jnp.where(turned, passed, 1.0), 0.0)
        pull = passed / own + most * slip
        after = jnp.where(jnp.abs(pull) <= most, 0.0, pull + most * slip)
        gain = (after - passed / own) * since
        speeds = [v + gain * u for v, u in zip(speeds, answer)]
        places = [q + 0.5 * gain * since * u for q, u in zip(places, answer)]
    mechanical = [v for i in range(count) for v in (places[i], speeds[i])]
    return (*mechanical, *state[2 * count :])
