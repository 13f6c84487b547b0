"""Structure behind the link that moves by itself."""

from __future__ import annotations

from typing import Any, ClassVar

import jax.numpy as jnp
import numpy as np

from ..mechanics import AbstractEffect, Instant, Kink, canonical_name
from ..parameters import Scalar, param
from .scales import natural_frequency, swing

LOWEST, HIGHEST, STEPS = 0.5, 7.0, 16
"""Frequencies at which something behind the link may swing, in units of the link's own in contact, which a fit without it may
have taken for the upper one of two: below that it swings with the joint as one, far above it is one with the link."""
BEHIND, PLAYS = (2.0, 1.0, 4.0), (0.05, 0.2)
"""The same for a link behind a second play, whose contact sets no one frequency, the likeliest first; and sizes of that play, as
shares of the root mean square of the link's motion: larger ones are hardly crossed."""


class FlexibleLink(AbstractEffect):
    r"""A second inertia behind the link: :math:`J_2 \ddot y_2 = -T,\ T = k_2 (y_2 - y) + c_2 (\dot y_2 - \dot y)`.

    The two states are its angle and speed relative to the link's, seen from the ground: :math:`y_2` and
    :math:`\dot y_2`. At :math:`J_2 = 0` with :math:`k_2 / J_2` kept the effect vanishes.
    """

    J2: Scalar = param(unit="kg m^2", null=0.0, lower=0.0, scale=0.1)
    k2: Scalar = param(unit="N m/rad", default=0.0, lower=0.0, scale=1000.0)
    c2: Scalar = param(unit="N m s/rad", default=0.0, lower=0.0, scale=1.0)
    states: ClassVar[tuple[str, ...]] = ("y2", "dy2")
    port: ClassVar[str] = "ground"
    rings: ClassVar[bool] = True

    @classmethod
    def guesses(cls, system: Any, motion: Any | None = None) -> list[AbstractEffect]:
        # A tenth of the link's inertia on springs of a ladder of frequencies: the frequency is not seen at null.
        small, own = 0.1 * float(system.inertia), natural_frequency(system)
        return [cls(small, small * w * w, 0.1 * small * w) for w in own * np.geomspace(LOWEST, HIGHEST, STEPS)]

    def scaled(self, factor: float) -> FlexibleLink:
        # A smaller inertia that swings at the same frequency, as well damped.
        return FlexibleLink(factor * self.J2, factor * self.k2, factor * self.c2)

    def torque(self, now: Instant) -> Scalar:
        y2, dy2 = now.state
        return self.k2 * (y2 - now.y) + self.c2 * (dy2 - now.dy)

    def rate(self, now: Instant) -> tuple[Scalar, ...]:
        _, dy2 = now.state
        return dy2, -self.torque(now) / jnp.maximum(self.J2, 1e-9)

    def start(self, now: Instant) -> tuple[Scalar, ...]:
        return now.y, now.dy


class SecondPlay(AbstractEffect):
    r"""A second link behind a joint with play of its own, :math:`J_2 \ddot y_2 = -T`.

    :math:`T = k_2\,\delta(y_2 - y) + c_2 (\dot y_2 - \dot y)` with the dead zone :math:`\delta` of the TOTAL play :math:`b_2`,
    around :math:`y_2 = y`: the damper always acts, as in the first joint. The states are those of `FlexibleLink`, which this is
    at :math:`b_2 = 0`. It is no law that `refine` looks for: the search tells laws that remember by following them along the
    measured motion, and a link that is thrown between two edges is soon elsewhere.
    """

    J2: Scalar = param(unit="kg m^2", null=0.0, lower=0.0, scale=0.1)
    k2: Scalar = param(unit="N m/rad", default=0.0, lower=0.0, scale=1000.0)
    c2: Scalar = param(unit="N m s/rad", default=0.0, lower=0.0, scale=1.0)
    b2: Scalar = param(unit="rad", default=0.0, lower=0.0, scale=0.01, label="total play of the second joint")
    states: ClassVar[tuple[str, ...]] = ("y2", "dy2")
    port: ClassVar[str] = "ground"
    catalogued: ClassVar[bool] = False
    plays: ClassVar[str] = "b2"
    absorbs: ClassVar[tuple[str, ...]] = ("flexible_link",)
    alike: ClassVar[dict[str, str]] = {
        "flexible_link": "swings of several sizes: a play shows less of itself the larger they are"
    }

    @classmethod
    def guesses(cls, system: Any, motion: Any | None = None) -> list[AbstractEffect]:
        small, own, typical = 0.1 * float(system.inertia), natural_frequency(system), swing(motion)
        speeds = [own * ratio for ratio in BEHIND]
        return [cls(small, small * w * w, 0.1 * small * w, share * typical) for w in speeds for share in PLAYS]

    def scaled(self, factor: float) -> SecondPlay:
        return SecondPlay(factor * self.J2, factor * self.k2, factor * self.c2, self.b2)

    def torque(self, now: Instant) -> Scalar:
        y2, dy2 = now.state
        behind, half = y2 - now.y, 0.5 * self.b2
        beyond = jnp.abs(behind) > half if now.beyond is None else now.beyond[canonical_name(self)]
        return self.k2 * jnp.where(beyond, behind - jnp.sign(behind) * half, 0.0) + self.c2 * (dy2 - now.dy)

    def kink(self, now: Instant, ddz: Scalar, ddy: Scalar) -> tuple[Kink, ...]:
        (y2, dy2), (_, ddy2) = now.state, self.rate(now)
        behind, half = (y2 - now.y, dy2 - now.dy, ddy2 - ddy), 0.5 * self.b2
        return (behind[0] - half, *behind[1:]), (-behind[0] - half, -behind[1], -behind[2])

    def rate(self, now: Instant) -> tuple[Scalar, ...]:
        return now.state[1], -self.torque(now) / jnp.maximum(self.J2, 1e-9)

    def start(self, now: Instant) -> tuple[Scalar, ...]:
        return now.y, now.dy
