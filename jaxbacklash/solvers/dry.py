r"""A panel of a system with dry friction: the link slides, comes to rest, sticks and breaks away.

At rest friction is set-valued: the link sticks to what it rubs on while the torque that holds it lies within friction's
capacity, and moves with it exactly. In motion friction is a torque against the speed. As in `panels.advance` a panel is two
Runge-Kutta steps, each with its direction of sliding decided where it begins. They meet at the first event ahead: an edge
of the play, or a speed that comes to zero. What the prediction misses is put right afterwards: a step that went on for
:math:`\epsilon` after the speed had turned gets the change of acceleration times :math:`\epsilon` at its end, and a link
that should have broken away the speed it would have by then. The correction carries the event's derivative as well, and it
serves where a panel has more events than one.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

import jax
import jax.numpy as jnp

from ..mechanics import Kink
from .panels import AGAIN, SHARES, WEIGHTS, Cubic, Edges, Playing, Scalar, State, _add, _first_kink, lasts, settled

SOON = 1e-4
"""Share of a panel within which an event counts as met: a fraction of a microsecond."""
STILL = 1e-9
"""Speed that counts as rest [rad/s]."""


class Sliding(Playing, Protocol):
    """What a panel needs of a system with dry friction at some of the ports ``slides``, ``"joint"`` and ``"ground"``."""

    @property
    def slides(self) -> tuple[str, ...]: ...

    @property
    def has_play(self) -> bool: ...

    def kinks(
        self, t: Scalar, state: State, drive: Any, side: Scalar | None, ddz: Scalar, ddy: Scalar
    ) -> dict[str, tuple[Kink, ...]]: ...

    @property
    def plays(self) -> tuple[str, ...]: ...

    def base(self, state: State, x: Scalar, dx: Scalar) -> tuple[Scalar, Scalar]: ...

    def bend(self, rates: State, prescribed: Scalar) -> Scalar: ...

    def rates(self, t: Scalar, state: State, drive: Any, side: Scalar | None = None) -> State: ...

    def sliding(self, t: Scalar, state: State, drive: Any, side: Scalar | None) -> tuple[State, tuple[Scalar, Scalar]]: ...


class Moment(NamedTuple):
    """Accelerations [rad/s^2] at one moment: of the link without dry friction, what friction can take from it at joint and
    ground, and of the base."""

    free: Scalar
    joint: Scalar
    ground: Scalar
    base: Scalar


class Mode(NamedTuple):
    """How the link moves on: direction of sliding at joint and ground (0 where it sticks), and whether it sticks there."""

    slip_z: Scalar
    slip_y: Scalar
    held_z: Scalar
    held_y: Scalar

    def acceleration(self, now: Moment) -> Scalar:
        """Acceleration of the link [rad/s^2]."""
        moving = now.free - now.joint * self.slip_z - now.ground * self.slip_y
        return jnp.where(self.held_z, now.base, jnp.where(self.held_y, 0.0, moving))

    def holding(self, now: Moment) -> tuple[Scalar, Scalar]:
        """What friction has to hold where the link sticks, and the most that it can [rad/s^2]."""
        at_joint, at_ground = now.free - now.base - now.ground * self.slip_y, now.free - now.joint * self.slip_z
        return jnp.where(self.held_z, at_joint, at_ground), jnp.where(self.held_z, now.joint, now.ground)


def _mode(slides: tuple[str, ...], now: Moment, dz: Scalar, dy: Scalar, met: tuple[Any, Any], soon: Scalar) -> Mode:
    """The mode in which a link of these speeds goes on, the joint first where both could hold; ``met`` speeds count as zero."""
    no = jnp.zeros_like(dz, dtype=bool)
    slip_z, slip_y = jnp.sign(dz), jnp.sign(dy)
    still_y = held_z = held_y = no
    if "ground" in slides:
        still_y = met[1] | (jnp.abs(dy) <= STILL + soon * jnp.abs(now.free - now.joint * slip_z - now.ground * slip_y))
        slip_y = jnp.where(still_y, jnp.sign(now.base), slip_y)  # where it would be carried
    if "joint" in slides:
        pull = now.free - now.base - now.ground * slip_y
        still_z = met[0] | (jnp.abs(dz) <= STILL + soon * jnp.abs(pull - now.joint * slip_z))
        held_z = still_z & (now.joint > 0.0) & (jnp.abs(pull) <= now.joint)
        slip_z = jnp.where(held_z, 0.0, jnp.where(still_z, jnp.sign(pull), slip_z))
    if "ground" in slides:
        pull = now.free - now.joint * slip_z
        held_y = still_y & ~held_z & (now.ground > 0.0) & (jnp.abs(pull) <= now.ground)
        slip_y = jnp.where(held_y, 0.0, jnp.where(still_y & ~held_z, jnp.sign(pull), slip_y))
    return Mode(slip_z, slip_y, held_z, held_y)


def _turned(speed: Scalar, slip: Scalar, before: Scalar, pull: Scalar, capacity: Scalar, met: Any) -> tuple[Scalar, Scalar]:
    """What to add to speed and position at the end of a step whose speed came to zero, at ``met`` or unforeseen.

    ``before`` and ``pull`` are the accelerations relative to what the link rubs on, with and without this friction.
    """
    turned = (met | (speed * slip < 0.0)) & (before * slip < 0.0)
    since = jnp.where(turned, speed / jnp.where(turned, before, 1.0), 0.0)
    after = jnp.where(jnp.abs(pull) <= capacity, 0.0, pull + capacity * slip)
    gain = (after - before) * since
    return gain, 0.5 * gain * since


def advance_dry(system: Sliding, t: Scalar, state: State, drive_at: Any, base: Cubic, h: Scalar) -> State:
    """Advance the state over one panel; the arguments are those of `panels.advance`."""
    edges = Edges.over(system, t, base, h) if system.has_play else None
    soon = SOON * h
    least = AGAIN * h if system.plays else 0.0
    # On a base at rest both frictions oppose one speed and are one.
    resting = (base.b == 0.0) & (base.c == 0.0) & (base.d == 0.0)

    def see(at: Scalar, state: State, side: Scalar | None) -> tuple[State, Moment]:
        rates, (joint, ground) = system.sliding(t + at, state, drive_at(at), side)
        if len(system.slides) == 2:
            joint, ground = jnp.where(resting, joint + ground, joint), jnp.where(resting, 0.0, ground)
        return rates, Moment(rates[1], joint, ground, base.bend(at))

    def region(z: Scalar, at: Scalar) -> Any:
        return None if edges is None else edges.side(z, at)

    def piece(carry: Any, last: Any) -> Any:
        state, begin, met, side = carry
        rest = h - begin
        z, dz = state[0] - base.at(begin), state[1] - base.slope(begin)
        if system.plays and side is not None:  # the side was that of all that is left
            side = jnp.where(last, side, region(z + least * dz, begin + least))
        first, start = see(begin, state, side)
        mode = _mode(system.slides, start, dz, state[1], met, soon)
        dy = jnp.where(mode.held_z, base.slope(begin), jnp.where(mode.held_y, 0.0, state[1]))
        dz = dy - base.slope(begin)
        state = (state[0], dy, *state[2:])
        acceleration = mode.acceleration(start)
        ddz = acceleration - start.base
        kinks = system.kinks(t + begin, state, drive_at(begin), side, ddz, acceleration)
        kink = _first_kink(kinks, rest, least)
        edge = rest if edges is None else edges.first_crossing(begin, z, dz, ddz, rest, least)
        event, met = _first_event(system.slides, (dz, dy), (ddz, acceleration), jnp.minimum(edge, kink), rest, soon)
        step, met = jnp.where(last, rest, event), tuple(m & ~last for m in met)
        half = 0.5 * step
        if side is not None:
            side = jnp.where(last, side, region(z + half * (dz + 0.5 * half * ddz), begin + half))
        here = settled(system, side, kinks, half)

        def stage(carry: Any, at: Any) -> Any:
            slope, total, _ = carry
            share, weight = at
            tried = _add(state, slope, share * step)
            rates, moment = see(begin + share * step, tried, here)
            slope = (tried[1], mode.acceleration(moment), *rates[2:])
            return (slope, _add(total, slope, weight), moment), None

        k1 = (dy, acceleration, *first[2:])
        (_, total, end), _ = jax.lax.scan(stage, (k1, k1, start), (SHARES, WEIGHTS))
        state = _add(state, total, step / 6.0)
        begin = begin + step
        state = _put_right(system.slides, state, mode, (start, end), base.slope(begin), step, met)
        half = 0.5 * (h - begin)
        z, dz = state[0] - base.at(begin), state[1] - base.slope(begin)
        side = region(z + half * (dz + 0.5 * half * (mode.acceleration(end) - end.base)), begin + half)
        return (state, begin, met, side), None

    no = jnp.zeros_like(state[0], dtype=bool)
    # Loops, here and over the stages, not copies: with many laws the compiler makes ten times the work of their derivative.
    begun: Any = (state, jnp.zeros_like(state[0]), (no, no), region(state[0] - base.a, 0.0))
    (state, *_), _ = jax.lax.scan(piece, begun, lasts(system))
    return state


def _first_event(
    slides: tuple[str, ...], speeds: tuple[Scalar, Scalar], accelerations: tuple[Scalar, Scalar], switch: Scalar, rest: Scalar,
    soon: Scalar,
) -> tuple[Scalar, tuple[Scalar, Scalar]]:  # fmt: skip
    """Time to the first event ahead, that of the next ``switch`` of the law among them, or half of what is left, and whether it
    is that the joint's or the link's speed is zero."""

    def stop(speed: Scalar, acceleration: Scalar) -> Scalar:
        slowing = speed * acceleration < 0.0
        time = -speed / jnp.where(slowing, acceleration, 1.0)
        return jnp.where(slowing & (time > soon) & (time < rest), time, rest)

    stop_z, stop_y = rest, rest
    if "joint" in slides:
        stop_z = stop(speeds[0], accelerations[0])
    if "ground" in slides:
        stop_y = stop(speeds[1], accelerations[1])
    event = jnp.minimum(switch, jnp.minimum(stop_z, stop_y))
    found = event < rest
    return jnp.where(found, event, 0.5 * rest), (found & (stop_z <= event), found & (stop_y <= event))


def _put_right(
    slides: tuple[str, ...], state: State, mode: Mode, moments: tuple[Moment, Moment], dx: Scalar, step: Scalar,
    met: tuple[Scalar, Scalar],
) -> State:  # fmt: skip
    """The state at the end of a step as it would be had the step ended where its mode did."""
    y, dy = state[0], state[1]
    start, end = moments
    acceleration = mode.acceleration(end)
    held, most = mode.holding(end)
    held0, most0 = mode.holding(start)
    # A link that sticks breaks away where its hold runs out, on a straight line from start to end.
    lack, spare = jnp.abs(held) - most, most0 - jnp.abs(held0)
    broke = (mode.held_z | mode.held_y) & (lack > 0.0)
    since = jnp.where(broke, step * lack / jnp.where(broke, lack + jnp.maximum(spare, 0.0), 1.0), 0.0)
    gain = jnp.sign(held) * lack * since / 2.0
    y, dy = y + gain * since / 3.0, dy + gain
    if "joint" in slides:
        pull = end.free - end.base - end.ground * mode.slip_y
        gain, shift = _turned(dy - dx, mode.slip_z, acceleration - end.base, pull, end.joint, met[0])
        y, dy = y + shift, dy + gain
    if "ground" in slides:
        slip = jnp.where(mode.held_z, 0.0, mode.slip_y)
        gain, shift = _turned(dy, slip, acceleration, end.free - end.joint * mode.slip_z, end.ground, met[1])
        y, dy = y + shift, dy + gain
    return (y, dy, *state[2:])
