r"""The contract between a physical effect and the system it acts in. Start reading here.

One link, one joint with play. The link's absolute motion is :math:`y`, the base motion :math:`x` is prescribed, the
joint feels :math:`z = y - x`. Every effect adds a torque to

.. math:: J \ddot y = F(t) + \sum_k \tau_k(t, y, \dot y, x, \dot x, s_k), \qquad \dot s_k = \mathrm{rate}_k(\ldots)

or changes the play itself, or how the motion is measured. An effect overrides only what it changes.
"""

from __future__ import annotations

import dataclasses
import math
import re
from dataclasses import dataclass, replace
from typing import Any, ClassVar, NamedTuple

import equinox as eqx
import jax.numpy as jnp

from .parameters import Scalar


class Drive(eqx.Module):
    """What drives the system at one moment: base motion ``x`` [rad], its rate ``dx``, and ``force`` on the link [N m].

    ``dforce`` is the rate of the force where it is known; without it the force is a straight line between panel edges.
    ``torque`` at the motor of a drive [N m] and its rate ``dtorque``; without a rate the torque is held from one panel edge to
    the next, as a controller holds it. Of a motor with a servo ``torque`` is what that is told, the position command [rad].
    """

    x: Scalar = 0.0
    dx: Scalar = 0.0
    force: Scalar = 0.0
    dforce: Scalar | None = None
    torque: Scalar | None = None
    dtorque: Scalar | None = None


Kink = tuple[Scalar, Scalar, Scalar]
"""A quantity, its rate and the rate of that, the number 0.0 where it does not matter."""


class Region(NamedTuple):
    """Where a step takes place: ``side`` of the play, -1, 0 or 1, and by name whether laws with a play of their own are
    ``beyond`` it."""

    side: Scalar
    beyond: dict[str, Scalar]


@dataclass(frozen=True)
class Play:
    """The free play at one moment: its total size and the middle of it, both in rad."""

    backlash: Scalar
    centre: Scalar = 0.0


@dataclass(frozen=True)
class Instant:
    """What an effect can see at one moment.

    Attributes: time ``t`` [s]; absolute motion ``y``, ``dy`` of the link, base motion ``x``, ``dx``, relative motion
    ``z``, ``dz`` [rad, rad/s]; ``deflection`` of the contact beyond the play [rad] and ``contact``, 1 in contact and
    0 in the play (between the two only inside a smoothed corner); the joint's ``stiffness`` [N m/rad], the link's
    ``inertia`` [kg m^2]; ``state``, the effect's own internal states, in the order of its ``states``; ``slip_z`` and
    ``slip_y``, the direction (-1, 0, 1) in which joint and link slide where a solver has settled it, None where the sign of
    the speed must be taken, smoothed; ``drifted``, what the contact's stiffness is now, as a multiple of ``stiffness``;
    ``damping`` of the joint's damper [N m s/rad]; ``rubbed``, what dry friction is now, as a multiple of what its laws state;
    ``dseen``, rate of the motion that is measured, z' or y' [rad/s]; ``side`` of the play, -1, 0 or 1, where a solver has
    settled it, None where it is the sign of the deflection; ``th``, ``dth`` motion of the motor of a drive [rad, rad/s], and
    ``slip_th`` the direction in which it slides, as of the others; ``beyond``, by the name of a law that ``plays`` whether of the
    quantities of its `kink` one is above zero, where a solver has settled it.
    """

    t: Scalar
    y: Scalar
    dy: Scalar
    x: Scalar
    dx: Scalar
    z: Scalar
    dz: Scalar
    deflection: Scalar
    contact: Scalar
    stiffness: Scalar
    inertia: Scalar
    state: tuple[Scalar, ...] = ()
    slip_z: Scalar | None = None
    slip_y: Scalar | None = None
    drifted: Scalar = 1.0
    damping: Scalar = 0.0
    rubbed: Scalar = 1.0
    dseen: Scalar = 0.0
    side: Scalar | None = None
    th: Scalar = 0.0
    dth: Scalar = 0.0
    slip_th: Scalar | None = None
    beyond: dict[str, Scalar] | None = None

    def seen_by(self, state: tuple[Scalar, ...]) -> Instant:
        """The same moment with one effect's internal states filled in."""
        return replace(self, state=state)


@dataclass(frozen=True)
class Wave:
    """A law that is a sine of a coordinate, by the names of its parameters.

    Attributes: ``strength`` that the sine is multiplied with; ``phase``; ``frequency`` with which the coordinate is multiplied,
    None where that is one; ``over``, the coordinate: ``"t"``, ``"y"`` (at the motor's port the motor's own angle) or ``"x"``;
    ``whole``, whether the frequency is a whole number, of periods in a turn. Frequency and phase are read off the spectrum of the
    torque that is missing over that coordinate.
    """

    strength: str
    phase: str
    frequency: str | None
    over: str
    whole: bool = False


class AbstractEffect(eqx.Module):
    """A physical effect: a law with parameters, neutral in everything it does not override.

    Class attributes: ``states`` names of internal states; ``reach`` how large these can become, where the law bounds what it
    remembers; ``port`` where the torque acts, ``"joint"`` (between link and base, so it is part of the transmitted torque),
    ``"ground"`` (between link and surroundings) or ``"motor"`` (on the motor of a drive); ``family`` a name shared by laws that
    data often cannot tell apart; ``catalogued`` False keeps a law out of the search for missing effects; ``slides`` True for dry
    friction, whose torque is ``dry`` against the direction of sliding at its port; ``rings`` True where its states go on by
    themselves for long, linear in where they began; ``beside`` True for friction in the joint that stands beside another law of
    it, where else there is one; ``plays`` the name of its parameter that is the total of a play of its own, between the link
    and its first state, a place whose speed is the second: the edges are its kinks, met as often as those of the joint;
    ``absorbs`` names of simpler laws that this one contains, so that it takes their place instead of standing beside them
    (parameters of one name are then the same); ``yields`` parameters that the presence of another effect makes superfluous, and
    that effect's name: held beside it; ``motions`` of a link for which the law makes sense, ``"turning"`` and ``"sliding"``;
    ``joints`` in which it does something that the joint does not do already, ``"play"``, ``"spring"`` and ``"free"``; ``alike``
    names of laws for which it is taken, or they for it, each with what a record must hold to tell the two; ``wave`` for a law
    that is a sine of a coordinate.
    """

    states: ClassVar[tuple[str, ...]] = ()
    reach: ClassVar[float] = math.inf
    port: ClassVar[str] = "joint"
    family: ClassVar[str | None] = None
    catalogued: ClassVar[bool] = True
    slides: ClassVar[bool] = False
    rings: ClassVar[bool] = False
    beside: ClassVar[bool] = False
    plays: ClassVar[str] = ""
    absorbs: ClassVar[tuple[str, ...]] = ()
    yields: ClassVar[dict[str, str]] = {}
    motions: ClassVar[tuple[str, ...]] = ("turning", "sliding")
    joints: ClassVar[tuple[str, ...]] = ("play", "spring", "free")
    alike: ClassVar[dict[str, str]] = {}
    wave: ClassVar[Wave | None] = None

    @classmethod
    def guesses(cls, system: Any, motion: Any | None = None) -> list[AbstractEffect]:
        """Points from which a fit of this effect to a joint like ``system`` may start, the likeliest first.

        ``motion`` is that of the record it is to be found in, where there is one: arrays t [s], y, dy, x, dx [rad, rad/s].
        The default is the null value, or a small strength where the null leaves shape parameters undetermined.
        """
        described = {f.name: f.metadata["spec"] for f in dataclasses.fields(cls) if "spec" in f.metadata}
        shaped = any(spec.null is None and not spec.fixed for spec in described.values())
        strengths = {n: s.scale for n, s in described.items() if shaped and s.null is not None and s.scale}
        return [cls(**strengths)]

    def simpler(self) -> list[AbstractEffect]:
        """Laws with fewer parameters that this one contains or comes near to, each at the values that are nearest to this one's.

        The default are those that it `absorbs`, parameters of one name being the same.
        """
        own = {f.name: getattr(self, f.name) for f in dataclasses.fields(self) if "spec" in f.metadata}
        laws = [catalogue()[name] for name in self.absorbs]
        return [law(**{f.name: own[f.name] for f in dataclasses.fields(law) if f.name in own}) for law in laws]

    def forms(self) -> list[AbstractEffect]:
        """The same law in its other forms, an option set or a shape held, each at the values that are nearest to this one's."""
        return []

    def scaled(self, factor: float) -> AbstractEffect:
        """The same law ``factor`` times as strong: along a given motion it exerts ``factor`` times the torque."""
        described = {f.name: f.metadata["spec"] for f in dataclasses.fields(self) if "spec" in f.metadata}
        nulls = {n: s.null for n, s in described.items() if s.null is not None and not s.fixed}
        return dataclasses.replace(self, **{n: null + factor * (getattr(self, n) - null) for n, null in nulls.items()})

    def torque(self, now: Instant) -> Scalar:
        """Torque on the link, or on the motor [N m], dry friction included (in the direction ``now`` knows, else smoothed)."""
        return jnp.zeros_like(now.y)

    def dry(self, now: Instant) -> Scalar:
        """Size, >= 0, of the dry friction against the speed seen by the port, at rest the most it can hold [N m]."""
        return jnp.zeros_like(now.y)

    def kink(self, now: Instant, ddz: Scalar, ddy: Scalar) -> tuple[Kink, ...]:
        """Quantities at whose zeros the torque has a kink that no edge of the play makes: steps end there.

        Each with its rate and the rate of that, where relative motion and link are accelerated by ``ddz`` and ``ddy`` [rad/s^2].
        """
        return ()

    def rate(self, now: Instant) -> tuple[Scalar, ...]:
        """Time derivatives of the internal states, in the order of ``states``."""
        return ()

    def start(self, now: Instant) -> tuple[Scalar, ...]:
        """Internal states of a link found at this moment when nothing more is known."""
        return tuple(jnp.zeros_like(now.y) for _ in self.states)

    def reshape(self, play: Play, t: Scalar, x: Scalar) -> Play:
        """The play as this effect leaves it, at time ``t`` [s] and with the base at ``x`` [rad]."""
        return play

    def drift(self, t: Scalar) -> Scalar:
        """The contact stiffness now, as a multiple of the joint's; the torque that the change makes is this effect's own."""
        return 1.0

    def rubs(self, t: Scalar) -> Scalar:
        """Dry friction now, >= 0, as a multiple of what its laws state."""
        return 1.0

    def observe(self, value: Scalar, state: tuple[Scalar, ...] = ()) -> Scalar:
        """The measured channel as this effect leaves it; an effect with internal states is given them."""
        return value

    def lag(self, t: Scalar) -> Scalar | None:
        """How far the measured channel lags behind the input channel at time ``t`` of the record [s], a constant or in proportion
        to the time; None when the effect adds no lag."""
        return None


def canonical_name(effect: AbstractEffect | type[AbstractEffect]) -> str:
    """The name used by the command line, the JSON and the reports: ``TorqueRipple`` is ``torque_ripple``."""
    cls = effect if isinstance(effect, type) else type(effect)
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", cls.__name__).lower()


def told_apart(one: str, other: str) -> str | None:
    """What a record must hold to tell two laws, by their names, from each other; None where neither is said to be like the other.

    Examples
    --------
    >>> from jaxbacklash.mechanics import told_apart
    >>> told_apart("sensor_delay", "clock_drift")
    'a longer record: the lag of another clock grows, a delay stays'
    """
    laws = catalogue()
    return next((laws[a].alike[b] for a, b in ((one, other), (other, one)) if a in laws and b in laws[a].alike), None)


def motion_of(translational: bool) -> str:
    """How a link moves, as `AbstractEffect.motions` names it: ``"sliding"`` for a translating mass, else ``"turning"``."""
    return "sliding" if translational else "turning"


def catalogue() -> dict[str, type[AbstractEffect]]:
    """Every law known so far by canonical name, a user's own classes included; nothing else is registered.

    Examples
    --------
    >>> [name for name in jb.catalogue() if "friction" in (jb.catalogue()[name].__doc__ or "")]
    ['coulomb_ground', ...]
    """
    found: dict[str, type[AbstractEffect]] = {}
    queue: list[Any] = list(AbstractEffect.__subclasses__())
    while queue:
        cls = queue.pop(0)
        queue += cls.__subclasses__()
        if not cls.__name__.startswith("Abstract"):
            found[canonical_name(cls)] = cls
    return dict(sorted(found.items()))
