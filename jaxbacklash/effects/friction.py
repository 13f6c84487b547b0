"""Dry friction: set-valued at rest, a jump with the sign of the speed in motion.

Runs with located steps (`simulate`, the fit) take the jump as it is: steps end where the speed is zero, and there the link
sticks until the torque that would hold it exceeds what friction can give. Where a bare moment is all that is known, and
for the adaptive referee, the sign is spread over a stated speed, the effect's ``width``.
"""

from __future__ import annotations

from typing import Any, ClassVar

import jax.numpy as jnp

from ..mechanics import AbstractEffect, Instant
from ..parameters import Scalar, param
from .scales import sliding_speeds


def smooth_sign(v: Scalar, width: Scalar) -> Scalar:
    r"""Sign of ``v`` with the jump spread over :math:`|v| < w`: exact outside, once differentiable.

    ``v`` and ``width`` in rad/s, any shape. Below the width the law is a stiff damper with slope 1.5 / width, so a
    joint that should stick creeps at up to the width.
    """
    s = jnp.clip(v / width, -1.0, 1.0)
    return s * (1.5 - 0.5 * s * s)


def direction(speed: Scalar, known: Scalar | None, width: Scalar) -> Scalar:
    """Direction of sliding, -1 to 1: the known one, else the smoothed sign of the speed [rad/s] over ``width``."""
    return smooth_sign(speed, width) if known is None else known


class CoulombJoint(AbstractEffect):
    r"""Dry friction in the joint, :math:`T = -T_c\,\mathrm{sgn}(\dot z)`; at rest it holds any torque up to :math:`T_c`."""

    Tc: Scalar = param(unit="N m", null=0.0, lower=0.0, scale=1.0)
    width: Scalar = param(unit="rad/s", default=1e-3, lower=0.0, fixed=True, label="regularisation of the sign")
    slides: ClassVar[bool] = True
    joints: ClassVar[tuple[str, ...]] = ("play", "spring")

    def dry(self, now: Instant) -> Scalar:
        return self.Tc * now.rubbed * jnp.ones_like(now.dz)

    def torque(self, now: Instant) -> Scalar:
        return -self.dry(now) * direction(now.dz, now.slip_z, self.width)


class CoulombGround(AbstractEffect):
    r"""Dry friction between link and ground, :math:`T = -T_c\,\mathrm{sgn}(\dot y)`; at rest it holds up to :math:`T_c`."""

    Tc: Scalar = param(unit="N m", null=0.0, lower=0.0, scale=1.0)
    width: Scalar = param(unit="rad/s", default=1e-3, lower=0.0, fixed=True, label="regularisation of the sign")
    port: ClassVar[str] = "ground"
    slides: ClassVar[bool] = True

    def dry(self, now: Instant) -> Scalar:
        return self.Tc * now.rubbed * jnp.ones_like(now.dy)

    def torque(self, now: Instant) -> Scalar:
        return -self.dry(now) * direction(now.dy, now.slip_y, self.width)


class Stribeck(AbstractEffect):
    r"""Dry friction that falls with speed, :math:`T = -(T_c + (T_s - T_c) e^{-(\dot z / v_s)^2})\,\mathrm{sgn}(\dot z)`.

    :math:`T_s` holds at rest, :math:`T_c` remains in fast sliding (Stribeck's curve in the form of Armstrong-Helouvry,
    1991). It vanishes where both are zero; with :math:`T_s = T_c` it is Coulomb friction and the speed :math:`v_s` is open.
    """

    Tc: Scalar = param(unit="N m", null=0.0, lower=0.0, scale=1.0)
    Ts: Scalar = param(unit="N m", null=0.0, lower=0.0, scale=1.0)
    vs: Scalar = param(unit="rad/s", default=0.1, lower=1e-6, scale=0.1)
    width: Scalar = param(unit="rad/s", default=1e-3, lower=0.0, fixed=True, label="regularisation of the sign")
    slides: ClassVar[bool] = True
    absorbs: ClassVar[tuple[str, ...]] = ("coulomb_joint",)
    family: ClassVar[str | None] = "dry friction"

    @classmethod
    def guesses(cls, system: Any, motion: Any | None = None) -> list[AbstractEffect]:
        return [cls(1.0, 2.0, vs) for vs in sliding_speeds(motion)]

    def dry(self, now: Instant) -> Scalar:
        curve = self.Tc + (self.Ts - self.Tc) * jnp.exp(-((now.dz / jnp.maximum(self.vs, 1e-6)) ** 2))
        return now.rubbed * curve

    def torque(self, now: Instant) -> Scalar:
        return -self.dry(now) * direction(now.dz, now.slip_z, self.width)


class LoadFriction(AbstractEffect):
    r"""Dry friction of a mesh, as large as the load makes it: :math:`T = -\mu |k \delta|\,\mathrm{sgn}(\dot z)`."""

    alike: ClassVar[dict[str, str]] = {
        "coulomb_joint": "motion inside the play, where a mesh that carries nothing does not rub",
        "stribeck": "motion inside the play, where a mesh that carries nothing does not rub",
        "hunt_crossley": "contacts as deep at several speeds: friction does not grow with the speed",
        "contact_damping": "contacts as deep at several speeds: friction does not grow with the speed",
    }

    mu: Scalar = param(unit="1", null=0.0, lower=0.0, upper=1.0, scale=0.1)
    width: Scalar = param(unit="rad/s", default=1e-3, lower=0.0, fixed=True, label="regularisation of the sign")
    slides: ClassVar[bool] = True
    beside: ClassVar[bool] = True
    joints: ClassVar[tuple[str, ...]] = ("play", "spring")

    def dry(self, now: Instant) -> Scalar:
        return self.mu * now.rubbed * jnp.abs(now.stiffness * now.drifted * now.deflection)

    def torque(self, now: Instant) -> Scalar:
        return -self.dry(now) * direction(now.dz, now.slip_z, self.width)
