"""Dry friction. The sign function is regularised over a stated speed, its ``width``."""

from __future__ import annotations

from typing import ClassVar

import jax.numpy as jnp

from ..mechanics import AbstractEffect, Instant
from ..parameters import Scalar, param


def smooth_sign(v: Scalar, width: Scalar) -> Scalar:
    r"""Sign of ``v`` with the jump spread over :math:`|v| < w`: exact outside, once differentiable.

    ``v`` and ``width`` in rad/s, any shape. Below the width the law is a stiff damper with slope 1.5 / width, so a
    joint that should stick creeps at up to the width.
    """
    s = jnp.clip(v / width, -1.0, 1.0)
    return s * (1.5 - 0.5 * s * s)


class CoulombJoint(AbstractEffect):
    r"""Dry friction in the joint, :math:`T = -T_c\,\mathrm{sgn}(\dot z)`."""

    Tc: Scalar = param(unit="N m", null=0.0, lower=0.0, scale=1.0)
    width: Scalar = param(unit="rad/s", default=1e-3, lower=0.0, fixed=True, label="regularisation of the sign")

    def torque(self, now: Instant) -> Scalar:
        return -self.Tc * smooth_sign(now.dz, self.width)


class CoulombGround(AbstractEffect):
    r"""Dry friction between link and ground, :math:`T = -T_c\,\mathrm{sgn}(\dot y)`."""

    Tc: Scalar = param(unit="N m", null=0.0, lower=0.0, scale=1.0)
    width: Scalar = param(unit="rad/s", default=1e-3, lower=0.0, fixed=True, label="regularisation of the sign")
    port: ClassVar[str] = "ground"

    def torque(self, now: Instant) -> Scalar:
        return -self.Tc * smooth_sign(now.dy, self.width)


class Dahl(AbstractEffect):
    r"""Presliding hysteresis, :math:`T = -s,\ \dot s = \sigma \dot z (1 - (s/F_c)\,\mathrm{sgn}\,\dot z)` (Dahl, 1968).

    Written with :math:`|\dot z|`, :math:`\dot s = \sigma(\dot z - |\dot z| s / F_c)`, which needs no regularised sign.
    """

    Fc: Scalar = param(unit="N m", null=0.0, lower=0.0, scale=1.0)
    sigma: Scalar = param(unit="N m/rad", default=1000.0, lower=0.0, scale=1000.0)
    states: ClassVar[tuple[str, ...]] = ("s",)
    family: ClassVar[str | None] = "hysteresis"

    def torque(self, now: Instant) -> Scalar:
        # The state is the fraction s / Fc, so that the law is linear in Fc and regular at its null value.
        return -self.Fc * now.state[0]

    def rate(self, now: Instant) -> tuple[Scalar, ...]:
        (s,) = now.state
        stiffness = self.sigma / jnp.maximum(self.Fc, 1e-9 * self.sigma)
        return (stiffness * (now.dz - jnp.abs(now.dz) * s),)

    def start(self, now: Instant) -> tuple[Scalar, ...]:
        return (jnp.clip(10.0 * now.dz, -1.0, 1.0),)
