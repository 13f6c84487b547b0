"""Springs beside the contact spring, or changes of it."""

from __future__ import annotations

from typing import Any, ClassVar

import jax.numpy as jnp
import numpy as np

from ..mechanics import AbstractEffect, Instant, Play, Wave
from ..parameters import Scalar, param
from .scales import orders, pressed


class CubicStiffness(AbstractEffect):
    r"""Hardening (or softening) contact, :math:`T = -k_3 \delta^3` with the deflection beyond the play."""

    joints: ClassVar[tuple[str, ...]] = ("play", "spring")

    k3: Scalar = param(unit="N m/rad^3", null=0.0, scale=1e6)

    def torque(self, now: Instant) -> Scalar:
        return -self.k3 * now.deflection**3


class ContactExponent(AbstractEffect):
    r"""Contact that hardens with a power of its deflection, :math:`T = -k\,\delta\,(|\delta| / d_0)^{p - 1}` in all (Hertz: 3/2).

    The law exerts what that differs by from the contact spring. k is the stiffness of the contact where it is pressed in by
    :math:`d_0`, a stated length.
    """

    alike: ClassVar[dict[str, str]] = {
        "cubic_stiffness": "contacts from grazing to the deepest that there are: a power shows at once, the cube later",
        "gap_spring": "motion inside the play, where a contact carries nothing",
    }
    joints: ClassVar[tuple[str, ...]] = ("play", "spring")

    p: Scalar = param(unit="1", null=1.0, lower=0.5, upper=4.0, scale=0.1)
    d0: Scalar = param(unit="rad", default=0.01, lower=1e-9, fixed=True, label="deflection at which the stiffness is k")

    @classmethod
    def guesses(cls, system: Any, motion: Any | None = None) -> list[AbstractEffect]:
        return [cls(d0=pressed(system, motion))]

    def torque(self, now: Instant) -> Scalar:
        share = jnp.where(now.deflection == 0.0, 1.0, jnp.abs(now.deflection) / self.d0)
        return -(now.stiffness * now.drifted * now.deflection) * jnp.expm1((self.p - 1.0) * jnp.log(share))


class AsymmetricStiffness(AbstractEffect):
    r"""Contact stiffness :math:`k(1+a)` above the play and :math:`k(1-a)` below: :math:`T = -a k |\delta|` beside the spring.

    Where k drifts, both sides drift with it.
    """

    joints: ClassVar[tuple[str, ...]] = ("play", "spring")

    a: Scalar = param(unit="1", null=0.0, lower=-1.0, upper=1.0, scale=0.01)

    def torque(self, now: Instant) -> Scalar:
        return -self.a * (now.stiffness * now.drifted * jnp.abs(now.deflection))


class GapSpring(AbstractEffect):
    r"""A spring inside and outside the play, :math:`T = -k_1 (z - z_0)` (the paper's CASE 2 has it with z0 = 0).

    A preload beside it does what :math:`z_0` does.
    """

    joints: ClassVar[tuple[str, ...]] = ("play", "free")
    yields: ClassVar[dict[str, str]] = {"z0": "preload"}

    k1: Scalar = param(unit="N m/rad", null=0.0, lower=0.0, scale=100.0)
    z0: Scalar = param(unit="rad", default=0.0, scale=1e-3)

    def torque(self, now: Instant) -> Scalar:
        return -self.k1 * (now.z - self.z0)


class AsymmetricGap(AbstractEffect):
    r"""The play is centred at :math:`z_0`, not at zero."""

    joints: ClassVar[tuple[str, ...]] = ("play",)

    z0: Scalar = param(unit="rad", null=0.0, scale=1e-3)

    def reshape(self, play: Play, t: Scalar, x: Scalar) -> Play:
        return Play(play.backlash, play.centre + self.z0)


class TransmissionError(AbstractEffect):
    r"""A gear's kinematic error, which moves the middle of the play as the base turns: :math:`z_0 = e \sin(M x + \psi)`."""

    alike: ClassVar[dict[str, str]] = {
        "torque_ripple": "a base that turns while the link is inside the play, where the error only moves the edges",
        "asymmetric_gap": "a base that turns through a whole period of the error",
    }
    joints: ClassVar[tuple[str, ...]] = ("play",)
    wave: ClassVar[Wave | None] = Wave("e", "psi", "M", "x")

    e: Scalar = param(unit="rad", null=0.0, scale=1e-3)
    M: Scalar = param(unit="1", default=20.0, lower=1.0, scale=1.0, label="periods in a turn")
    psi: Scalar = param(unit="1", default=0.0, scale=0.1)

    @classmethod
    def guesses(cls, system: Any, motion: Any | None = None) -> list[AbstractEffect]:
        return [cls(1e-3, order, phase) for order in orders(motion, 1.0, "x") for phase in (0.0, 0.5 * np.pi)]

    def reshape(self, play: Play, t: Scalar, x: Scalar) -> Play:
        return Play(play.backlash, play.centre + self.e * jnp.sin(self.M * x + self.psi))
