"""Springs beside the contact spring, or changes of it."""

from __future__ import annotations

from typing import ClassVar

import jax.numpy as jnp

from ..mechanics import AbstractEffect, Instant, Play
from ..parameters import Scalar, param


class CubicStiffness(AbstractEffect):
    r"""Hardening (or softening) contact, :math:`T = -k_3 \delta^3` with the deflection beyond the play."""

    joints: ClassVar[tuple[str, ...]] = ("play", "spring")

    k3: Scalar = param(unit="N m/rad^3", null=0.0, scale=1e6)

    def torque(self, now: Instant) -> Scalar:
        return -self.k3 * now.deflection**3


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

    def reshape(self, play: Play, t: Scalar) -> Play:
        return Play(play.backlash, play.centre + self.z0)
