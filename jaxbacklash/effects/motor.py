r"""The motor of a drive, and the laws that act at its port.

.. math:: J_m \ddot\theta = \tau - c_m \dot\theta + T / N + \sum_k \tau_k(\theta, \dot\theta)

:math:`\theta` turns N times for a turn of the link, :math:`\tau` is the torque of its windings, T what the joint takes from it
(`jaxbacklash.system`). The laws here feel the motor's own angle and speed, before the gear. Where the torque was not measured a
`Servo` makes it, of the position that it was told.
"""

from __future__ import annotations

from typing import Any, ClassVar

import equinox as eqx
import jax.numpy as jnp

from ..mechanics import AbstractEffect, Instant, Wave
from ..parameters import Scalar, param
from .friction import direction
from .scales import orders


class Motor(eqx.Module):
    r"""The motor of a drive: inertia, viscous friction, and turns of the motor for a turn of the link (known)."""

    motor_inertia: Scalar = param(unit="kg m^2", lower=0.0, required=True, label="inertia of the motor")
    motor_damping: Scalar = param(unit="N m s/rad", null=0.0, lower=0.0, required=True, label="viscous friction of the motor")
    ratio: Scalar = param(unit="1", default=1.0, fixed=True, label="turns of the motor for a turn of the link")

    @property
    def pace(self) -> Scalar:
        """How fast what makes its torque reacts [rad/s], which steps have to resolve."""
        return 0.0

    def pushed(self, given: Scalar, th: Scalar, dth: Scalar) -> Scalar:
        """Torque at the motor [N m] at angle ``th`` and speed ``dth`` [rad, rad/s], of what it is ``given``: that torque."""
        return given


class Servo(Motor):
    r"""A motor that follows a position command u of the link: :math:`\tau = K_p (u - \theta / N) - K_d \dot\theta`.

    :math:`K_p` acts on the error of the link's position, :math:`K_d` on the motor's speed, as its viscous friction does, so that
    it stands for both. Without a torque, all inertias, gains and torques can be multiplied by one number without changing the
    motion.
    """

    motor_damping: Scalar = param(unit="N m s/rad", null=0.0, lower=0.0, fixed=True, label="viscous friction of the motor")
    Kp: Scalar = param(unit="N m/rad", lower=0.0, label="servo gain Kp")
    Kd: Scalar = param(unit="N m s/rad", null=0.0, lower=0.0, label="servo gain Kd, motor friction in it")

    @property
    def pace(self) -> Scalar:
        return jnp.maximum(jnp.sqrt(self.Kp / (self.ratio * self.motor_inertia)), self.Kd / self.motor_inertia)

    def pushed(self, given: Scalar, th: Scalar, dth: Scalar) -> Scalar:
        return self.Kp * (given - th / self.ratio) - self.Kd * dth


class LimitedServo(Servo):
    r"""A servo whose torque stays within :math:`\pm t_\mathrm{max}`; where that is met the motor's own friction shows."""

    motor_damping: Scalar = param(unit="N m s/rad", null=0.0, lower=0.0, label="viscous friction of the motor")
    Kd: Scalar = param(unit="N m s/rad", null=0.0, lower=0.0, label="servo gain Kd")
    tmax: Scalar = param(unit="N m", lower=0.0, label="largest servo torque")

    def pushed(self, given: Scalar, th: Scalar, dth: Scalar) -> Scalar:
        return jnp.clip(super().pushed(given, th, dth), -self.tmax, self.tmax)


class CoulombMotor(AbstractEffect):
    r"""Dry friction of the motor, :math:`T = -T_c\,\mathrm{sgn}(\dot\theta)`; at rest it holds up to :math:`T_c`."""

    Tc: Scalar = param(unit="N m", null=0.0, lower=0.0, scale=0.01)
    width: Scalar = param(unit="rad/s", default=1e-2, lower=0.0, fixed=True, label="regularisation of the sign")
    port: ClassVar[str] = "motor"
    slides: ClassVar[bool] = True

    def dry(self, now: Instant) -> Scalar:
        return self.Tc * now.rubbed * jnp.ones_like(now.dth)

    def torque(self, now: Instant) -> Scalar:
        return -self.dry(now) * direction(now.dth, now.slip_th, self.width)


class Cogging(AbstractEffect):
    r"""Ripple of the motor's own torque, :math:`T = A \sin(P \theta + \varphi)`, P periods in a turn of the motor."""

    A: Scalar = param(unit="N m", null=0.0, scale=0.01)
    P: Scalar = param(unit="1", default=12.0, lower=1.0, scale=1.0, label="periods in a turn of the motor")
    phi: Scalar = param(unit="1", default=0.0, scale=0.1)
    port: ClassVar[str] = "motor"
    wave: ClassVar[Wave | None] = Wave("A", "phi", "P", "y", whole=True)

    @classmethod
    def guesses(cls, system: Any, motion: Any | None = None) -> list[AbstractEffect]:
        return [cls(0.01, order, phase) for order in orders(None, 1.0) for phase in (0.0, 0.5 * jnp.pi)]

    def torque(self, now: Instant) -> Scalar:
        return self.A * jnp.sin(self.P * now.th + self.phi)
