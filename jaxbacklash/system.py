r"""A system: an inertia, a joint, and a named set of effects, :math:`J \ddot y = F + \sum_k \tau_k`.

Its base moves as prescribed, or it is the motor of a drive, a coordinate like the link:
:math:`J_m \ddot\theta = \tau - c_m \dot\theta + T / N + \ldots`, with :math:`x = \theta / N` behind a gear. What a law feels and
where its torque goes is its port: a row over the coordinates (`System.rows`), the same both ways.

Everything dynamic in a `System` is a scalar parameter, so that one compiled program serves all its values. The state
is a flat tuple ``(y, dy, internal states of the effects in the order of their names)``, of a drive
``(y, dy, th, dth, ...)``.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import equinox as eqx
import jax.numpy as jnp

from . import sensors as sensors  # where there is a system, the catalogue is whole: these, and the effects
from .effects.contact import Contact, Damper, Spring, corner
from .effects.motor import Motor
from .mechanics import AbstractEffect, Drive, Instant, Kink, Play, Region, canonical_name
from .mechanics import catalogue as catalogue
from .parameters import Scalar, param

State = tuple[Scalar, ...]


class System(eqx.Module):
    """One link behind a joint.

    Attributes: ``inertia`` J [kg m^2]; ``contact`` a `Contact` with play, a `Spring` without, or None; ``damper``;
    ``effects`` by canonical name; ``observed`` the measured channel: ``"z"``, ``"y"``, or ``"T"`` for the torque the
    joint transmits from the link to its base, or of a drive those of ``"motor"`` and ``"link"`` that have an encoder, with a
    blank between; ``smoothed`` ports whose dry friction has its sign smoothed even where steps
    are located, which is quicker and enough for friction that is only asked for its derivative at zero; ``motor`` the `Motor` of
    a drive, None where the base moves as prescribed.
    """

    inertia: Scalar = param(unit="kg m^2", lower=0.0, required=True, label="inertia of the link")
    contact: Contact | Spring | None = eqx.field(metadata={"bare": True})
    damper: Damper = eqx.field(metadata={"bare": True})
    effects: dict[str, AbstractEffect] = eqx.field(default_factory=dict, metadata={"bare": True})
    observed: str = eqx.field(default="z", static=True)
    smoothed: tuple[str, ...] = eqx.field(default=(), static=True)
    motor: Motor | None = eqx.field(default=None, metadata={"bare": True})

    def with_effects(self, *effects: AbstractEffect) -> System:
        """The same system with effects added, or replaced where one of the same name was there."""
        added = {canonical_name(effect): effect for effect in effects}
        return with_effects(self, {**self.effects, **added})

    def without(self, *names: str) -> System:
        """The same system with effects taken out by name."""
        kept = {name: effect for name, effect in self.effects.items() if name not in names}
        return with_effects(self, kept)

    @property
    def mechanical(self) -> int:
        """How many states are positions and speeds of coordinates: 2 for a link on a prescribed base, 4 for a drive."""
        return 2 if self.motor is None else 4

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the measured channels."""
        return tuple(self.observed.split())

    @property
    def rows(self) -> dict[str, tuple[Scalar, ...]]:
        """What each port feels of the coordinates (link, and motor of a drive); its torque acts through the same row."""
        if self.motor is None:
            return {"joint": (1.0,), "ground": (1.0,)}
        return {"joint": (1.0, -1.0 / self.motor.ratio), "ground": (1.0, 0.0), "motor": (0.0, 1.0)}

    @property
    def mobility(self) -> tuple[Scalar, ...]:
        """Inverse inertia of each coordinate [1/(kg m^2)]."""
        return (1.0 / self.inertia,) if self.motor is None else (1.0 / self.inertia, 1.0 / self.motor.motor_inertia)

    @property
    def reduced_inertia(self) -> Scalar:
        """Inertia that swings on the contact [kg m^2]: that of the link, against the motor's seen through the gear in a drive."""
        return self.inertia if self.motor is None else 1.0 / sum(a * a * w for a, w in zip(self.rows["joint"], self.mobility))

    @property
    def pace(self) -> Scalar:
        """How fast it reacts [rad/s]: swinging on its contact, or as the servo of its motor does. Steps have to resolve this."""
        swing = 0.0 if self.contact is None else jnp.sqrt(jnp.maximum(self.contact.stiffness, 1e-12) / self.reduced_inertia)
        return swing if self.motor is None else jnp.maximum(swing, self.motor.pace)

    def on_its_base(self) -> System:
        """The joint of a drive with its motor as the base that moves as prescribed, laws of the motor left out; else as it is."""
        if self.motor is None:
            return self
        kept = {name: effect for name, effect in self.effects.items() if effect.port != "motor"}
        return System(self.inertia, self.contact, self.damper, kept, "y", self.smoothed)

    @property
    def state_names(self) -> tuple[str, ...]:
        """Names of the state: y, dy, of a drive th, dth, and ``effect.state`` for internal states."""
        hidden = (f"{name}.{s}" for name in sorted(self.effects) for s in self.effects[name].states)
        return (*("y", "dy", "th", "dth")[: self.mechanical], *hidden)

    @property
    def reach(self) -> tuple[float, ...]:
        """How large each state can become in size, in the order of `state_names`."""
        own = (effect for _, effect in sorted(self.effects.items()))
        return (*[math.inf] * self.mechanical, *(effect.reach for effect in own for _ in effect.states))

    @property
    def has_play(self) -> bool:
        return isinstance(self.contact, Contact)

    @property
    def slides(self) -> tuple[str, ...]:
        """Ports at which dry friction can hold link or motor, ``"joint"`` before ``"ground"`` before ``"motor"``.

        Not the joint where the transmitted torque is observed: that of a joint that sticks is not a function of the state, so
        the sign of the speed stays smoothed there. Friction at the ground is no part of that torque.
        """
        ports = {effect.port for effect in self.effects.values() if effect.slides}
        able = ("ground",) if self.observed == "T" else ("joint", "ground", "motor")
        return tuple(port for port in able if port in ports and port not in self.smoothed)

    @property
    def switches(self) -> bool:
        """True when steps should be located: there is a play, or dry friction, or a law with a play of its own."""
        return self.has_play or bool(self.slides) or bool(self.plays)

    @property
    def plays(self) -> tuple[str, ...]:
        """Laws with a play of their own."""
        return tuple(name for name, effect in sorted(self.effects.items()) if effect.plays)

    @property
    def play_moves(self) -> bool:
        """Whether the edges of the play may move with time or with the base."""
        return any(type(effect).reshape is not AbstractEffect.reshape for effect in self.effects.values())

    def edges(self, t: Scalar, x: Scalar = 0.0) -> tuple[Scalar, Scalar]:
        """Lower and upper edge of the play at time ``t`` with the base at ``x`` [rad]."""
        play = self._play(t, x)
        return play.centre - 0.5 * play.backlash, play.centre + 0.5 * play.backlash

    def rates(self, t: Scalar, state: State, drive: Drive, side: Scalar | None = None) -> State:
        """Time derivative of the state.

        ``side`` -1, 0 or 1 says on which side of the play the link is (a located region, sharp corner); without
        it the region follows from z and the corner is smoothed over ``contact.width``. Dry friction is smoothed over the
        ``width`` of its effect; `sliding` leaves it open.
        """
        return self._rates(self.instant(t, state, drive, side), state, drive)

    def sliding(self, t: Scalar, state: State, drive: Drive, side: Scalar | None) -> tuple[State, tuple[Scalar, Scalar]]:
        """`rates` without dry friction, and the acceleration that it can take from the link at joint and ground."""
        rates, capacity = self.held_off(t, state, drive, side)
        return rates, (capacity["joint"] / self.inertia, capacity["ground"] / self.inertia)

    def held_off(self, t: Scalar, state: State, drive: Drive, side: Scalar | None) -> tuple[State, dict[str, Scalar]]:
        """`rates` without dry friction, and by port the torque that it can hold there [N m]."""
        free: dict[str, Any] = {
            f"slip_{of}": 0.0 for of, port in (("z", "joint"), ("y", "ground"), ("th", "motor")) if port in self.slides
        }
        now = replace(self.instant(t, state, drive, side), **free)
        capacity: dict[str, Any] = dict.fromkeys(self.rows, jnp.zeros_like(now.y))
        for name, own in self._own_states(state):
            effect = self.effects[name]
            if effect.slides and effect.port in self.slides:
                capacity[effect.port] = capacity[effect.port] + effect.dry(now.seen_by(own))
        return self._rates(now, state, drive), capacity

    def _rates(self, now: Instant, state: State, drive: Drive) -> State:
        torque, joint = self.torques(now, state)
        hidden = tuple(r for name, own in self._own_states(state) for r in self.effects[name].rate(now.seen_by(own)))
        link = (drive.force + torque) / self.inertia
        if self.motor is None:
            return (state[1], link, *hidden)
        # What the joint gives to the link it takes from the motor, through the gear.
        made = self.motor.pushed(0.0 if drive.torque is None else drive.torque, now.th, now.dth)
        push = made + self._on_motor(now, state) - joint / self.motor.ratio
        return (state[1], link, state[3], push / self.motor.motor_inertia, *hidden)

    def _on_motor(self, now: Instant, state: State) -> Scalar:
        """Torque of all laws at the motor's port [N m], its viscous friction among them."""
        assert self.motor is not None
        laws = ((self.effects[name], own) for name, own in self._own_states(state) if self.effects[name].port == "motor")
        return sum((law.torque(now.seen_by(own)) for law, own in laws), -self.motor.motor_damping * now.dth)

    def base(self, state: State, x: Scalar, dx: Scalar) -> tuple[Scalar, Scalar]:
        """Place and speed of the joint's base [rad, rad/s]: ``x``, ``dx`` as prescribed, or the motor's behind its gear."""
        return (x, dx) if self.motor is None else (state[2] / self.motor.ratio, state[3] / self.motor.ratio)

    def bend(self, rates: State, prescribed: Scalar) -> Scalar:
        """Acceleration of the joint's base [rad/s^2] where the state changes by these ``rates``."""
        return prescribed if self.motor is None else rates[3] / self.motor.ratio

    def kinks(
        self, t: Scalar, state: State, drive: Drive, side: Scalar | None, ddz: Scalar, ddy: Scalar
    ) -> dict[str, tuple[Kink, ...]]:
        """By law, quantities at whose zeros it has a kink, where relative motion and link are accelerated by ``ddz`` and ``ddy``
        [rad/s^2]."""
        now = self.instant(t, state, drive, side)
        return {name: self.effects[name].kink(now.seen_by(own), ddz, ddy) for name, own in self._own_states(state)}

    def transmitted(self, t: Scalar, state: State, drive: Drive, side: Scalar | None = None) -> Scalar:
        """Torque the link exerts on its base through the joint [N m]."""
        _, joint = self.torques(self.instant(t, state, drive, side), state)
        return -joint

    def output(self, t: Scalar, state: State, drive: Drive) -> Scalar:
        """The measured channel, after what the measuring chain does to it; of a drive one value a channel, (C,)."""
        if self.motor is not None:
            seen = {"motor": state[2], "link": state[0]}
            return jnp.stack([seen[name] for name in self.channels])
        if self.observed == "T":
            value = self.transmitted(t, state, drive)
        else:
            value = state[0] - drive.x if self.observed == "z" else state[0]
        return self.observe(value, state[self.mechanical :])

    def observe(self, value: Scalar, hidden: State = ()) -> Scalar:
        """What the measuring chain makes of the channel that it measures, ``hidden`` the internal states of all effects."""
        return observe(self.effects, value, hidden)

    def lag(self, t: Scalar = 0.0) -> Scalar | None:
        """Delay of the measured channel behind the input at time ``t`` [s], None when nothing in the system delays it."""
        lags = [lag for effect in self.effects.values() if (lag := effect.lag(t)) is not None]
        return sum(lags) if lags else None

    def passed(self, t: Scalar, h: Scalar) -> tuple[Scalar, Scalar]:
        """When the motion took place that the measured channel shows at ``t``, and how much of it passes in ``h`` there [s]."""
        begin, end = self.lag(t), self.lag(t + h)
        return (t, h) if begin is None else (t - begin, h - (end - begin))

    def rest(self, t: Scalar, y: Scalar, dy: Scalar, drive: Drive) -> State:
        """State of a link found at ``y``, ``dy`` when nothing is known of the internal states; of a drive in the middle of its
        play."""
        gear = () if self.motor is None else (self.motor.ratio * y, self.motor.ratio * dy)
        bare = (y, dy, *gear, *(jnp.zeros_like(y) for _ in self.state_names[self.mechanical :]))
        now = self.instant(t, bare, drive, None)
        hidden = (s for name in sorted(self.effects) for s in self.effects[name].start(now))
        return (y, dy, *gear, *hidden)

    def instant(self, t: Scalar, state: State, drive: Drive, side: Scalar | None = None) -> Instant:
        """What the effects see at one moment (their own internal states are filled in one by one)."""
        y, dy = state[0], state[1]
        x, dx = self.base(state, drive.x, drive.dx)
        z, dz = y - x, dy - dx
        side, beyond = side if isinstance(side, Region) else (side, None)
        deflection, contact = self._deflection(t, z, x, side)
        stiffness = jnp.zeros_like(z) if self.contact is None else self.contact.stiffness
        drifted: Any = 1.0
        rubbed: Any = 1.0
        for name in sorted(self.effects):
            drifted, rubbed = drifted * self.effects[name].drift(t), rubbed * self.effects[name].rubs(t)
        return Instant(
            t, y, dy, x, dx, z, dz, deflection, contact, stiffness, self.inertia, drifted=drifted,
            damping=self.damper.damping, rubbed=rubbed, dseen=dy if self.observed == "y" else dz, side=side, beyond=beyond,
            **({} if self.motor is None else {"th": state[2], "dth": state[3]}),
        )  # fmt: skip

    def torques(self, now: Instant, state: State) -> tuple[Scalar, Scalar]:
        """All torque on the link but the driving force, and the part of it that acts through the joint [N m]."""
        joint: Any = self.bare_torque(now)
        ground: Any = 0.0
        for name, own in self._own_states(state):
            effect = self.effects[name]
            if effect.port == "motor":
                continue
            torque = effect.torque(now.seen_by(own))
            if effect.port == "joint":
                joint = joint + torque
            else:
                ground = ground + torque
        return joint + ground, joint

    def bare_torque(self, now: Instant) -> Scalar:
        """Torque on the link of the joint without any effect [N m]."""
        return -now.stiffness * now.deflection - self.damper.damping * now.dz

    def _play(self, t: Scalar, x: Scalar) -> Play:
        assert isinstance(self.contact, Contact)
        play = Play(self.contact.backlash)
        for name in sorted(self.effects):
            play = self.effects[name].reshape(play, t, x)
        return play

    def _deflection(self, t: Scalar, z: Scalar, x: Scalar, side: Scalar | None) -> tuple[Scalar, Scalar]:
        if self.contact is None:
            return jnp.zeros_like(z), jnp.zeros_like(z)
        if isinstance(self.contact, Spring):
            return z, jnp.ones_like(z)
        low, high = self.edges(t, x)
        if side is not None:
            up, down = side > 0, side < 0
            deflection = jnp.where(up, z - high, jnp.where(down, z - low, 0.0))
            return deflection, jnp.where(up | down, 1.0, 0.0)
        above, in_upper = corner(z - high, self.contact.width)
        below, in_lower = corner(low - z, self.contact.width)
        return above - below, in_upper + in_lower

    def _own_states(self, state: State) -> list[tuple[str, State]]:
        own, at = [], self.mechanical
        for name in sorted(self.effects):
            count = len(self.effects[name].states)
            own.append((name, state[at : at + count]))
            at += count
        return own


def with_effects(system: System, effects: dict[str, AbstractEffect]) -> System:
    """A system like this one with these effects by canonical name, and no others."""
    return System(system.inertia, system.contact, system.damper, effects, system.observed, system.smoothed, system.motor)


def observe(effects: dict[str, AbstractEffect], value: Scalar, hidden: State = ()) -> Scalar:
    """What effects by name, those of the measuring chain, make of the channel that is measured; ``hidden`` are their states."""
    at = 0
    for name in sorted(effects):
        own = hidden[at : at + len(effects[name].states)]
        value, at = effects[name].observe(value, own) if own else effects[name].observe(value), at + len(own)
    return value
