"""Friction that gives before it slips: laws with a memory, near neighbours of one another.

Each state is the torque as a fraction of its sliding level, so that the law is linear in its strength ``Fc``, and a state
left free at zero strength moves nothing. As the strength goes to zero the presliding distance does too and the state would
follow the sign of the speed at once: it follows at `FASTEST` at most, which fixed steps can take.
"""

from __future__ import annotations

from typing import Any, ClassVar

import jax.numpy as jnp

from ..mechanics import AbstractEffect, Instant
from ..parameters import Scalar, param
from .friction import CoulombGround, CoulombJoint, Stribeck
from .scales import natural_frequency, presliding, sliding_speeds

FASTEST = 1000.0
"""Largest rate [1/s] at which a state follows. Met only in fast sliding, where the state has settled already."""


def _flow(speed: Scalar, sigma: Scalar, level: Scalar) -> Scalar:
    """Speed [rad/s] in units of the presliding distance level / sigma, 1/s, limited to `FASTEST`."""
    return jnp.clip(speed * (sigma / jnp.maximum(level, 1e-9 * sigma)), -FASTEST, FASTEST)


class Dahl(AbstractEffect):
    r"""Presliding hysteresis, :math:`T = -s,\ \dot s = \sigma \dot z (1 - (s/F_c)\,\mathrm{sgn}\,\dot z)` (Dahl, 1968).

    Written with :math:`|\dot z|`, :math:`\dot s = \sigma(\dot z - |\dot z| s / F_c)`, which needs no regularised sign.
    """

    Fc: Scalar = param(unit="N m", null=0.0, lower=0.0, scale=1.0)
    sigma: Scalar = param(unit="N m/rad", default=1000.0, lower=0.0, scale=1000.0)
    states: ClassVar[tuple[str, ...]] = ("s",)
    reach: ClassVar[float] = 1.0
    family: ClassVar[str | None] = "hysteresis"

    @classmethod
    def guesses(cls, system: Any, motion: Any | None = None) -> list[AbstractEffect]:
        return [cls(Fc=1.0, sigma=1.0 / distance) for distance in presliding(system)]

    def simpler(self) -> list[AbstractEffect]:
        return [CoulombJoint(self.Fc), CoulombGround(self.Fc)]

    def torque(self, now: Instant) -> Scalar:
        return -self.Fc * now.rubbed * now.state[0]

    def rate(self, now: Instant) -> tuple[Scalar, ...]:
        flow = _flow(now.dz, self.sigma, self.Fc)
        return (flow - jnp.abs(flow) * now.state[0],)

    def start(self, now: Instant) -> tuple[Scalar, ...]:
        return (jnp.clip(10.0 * now.dz, -1.0, 1.0),)


FARTHEST = 5.0
"""How many times larger or smaller than its level in motion friction at rest counts in full."""


def _tempered(ratio: Scalar) -> Scalar:
    """A ratio > 0 as it is up to `FARTHEST` and down to its inverse, and beyond them by its logarithm, slope and all: a fit that
    has gone too far must see the way back."""
    size = jnp.maximum(ratio, 1.0 / jnp.maximum(ratio, 1e-9))
    tempered = jnp.where(size > FARTHEST, FARTHEST * (1.0 + jnp.log(jnp.maximum(size, FARTHEST) / FARTHEST)), size)
    return jnp.where(ratio >= 1.0, tempered, 1.0 / tempered)


class Lugre(AbstractEffect):
    r"""LuGre friction, :math:`T = -(\sigma_0 s + \sigma_1 \dot s + \sigma_2 \dot z)` (Canudas de Wit et al., 1995).

    The bristle gives :math:`\dot s = \dot z - \sigma_0 |\dot z| s / g` with
    :math:`g = F_c + (F_s - F_c) e^{-(\dot z / v_s)^2}`. :math:`F_s` counts as it is within
    :math:`F_c / 5 \ldots 5 F_c` and by the logarithm of what exceeds that, so that the law vanishes with :math:`F_c` alone;
    left at zero it is :math:`F_c`, and below it friction grows with speed. :math:`\sigma_2` is one with the joint's damper and
    therefore never fitted.
    """

    sigma0: Scalar = param(unit="N m/rad", default=4000.0, lower=1e-6, scale=1000.0)
    sigma1: Scalar = param(unit="N m s/rad", default=1.0, lower=0.0, scale=1.0)
    sigma2: Scalar = param(unit="N m s/rad", null=0.0, lower=0.0, fixed=True, label="viscous part, as the damper")
    Fc: Scalar = param(unit="N m", null=0.0, lower=0.0, scale=1.0)
    Fs: Scalar = param(unit="N m", default=0.0, lower=0.0, scale=1.0)
    vs: Scalar = param(unit="rad/s", default=0.1, lower=1e-6, scale=0.1)
    states: ClassVar[tuple[str, ...]] = ("s",)
    reach: ClassVar[float] = FARTHEST
    family: ClassVar[str | None] = "hysteresis"

    @classmethod
    def guesses(cls, system: Any, motion: Any | None = None) -> list[AbstractEffect]:
        relaxing, speed = 0.06 / natural_frequency(system), sliding_speeds(motion)[0]
        return [cls(sigma0=1.0 / d, sigma1=relaxing / d, Fc=1.0, Fs=1.5, vs=speed) for d in presliding(system)]

    def simpler(self) -> list[AbstractEffect]:
        at_rest = jnp.where(self.Fs > 0.0, self.Fs, self.Fc)
        return [CoulombJoint(self.Fc), CoulombGround(self.Fc), Dahl(self.Fc, self.sigma0), Stribeck(self.Fc, at_rest, self.vs)]

    def torque(self, now: Instant) -> Scalar:
        # The state is sigma0 s / Fc.
        damped = (self.sigma1 / jnp.maximum(self.sigma0, 1e-6)) * self.rate(now)[0]
        return -self.Fc * now.rubbed * (now.state[0] + damped) - self.sigma2 * now.dz

    def rate(self, now: Instant) -> tuple[Scalar, ...]:
        # Below Fc as well as above: a bound at Fs = Fc would hide from a fit that crossed it which way leads back.
        extra = _tempered(jnp.where(self.Fs > 0.0, self.Fs / jnp.maximum(self.Fc, 1e-9), 1.0)) - 1.0
        level = 1.0 + extra * jnp.exp(-((now.dz / jnp.maximum(self.vs, 1e-6)) ** 2))
        flow = _flow(now.dz, self.sigma0, self.Fc)
        return (flow - jnp.abs(flow) * now.state[0] / level,)

    def start(self, now: Instant) -> tuple[Scalar, ...]:
        return (jnp.clip(10.0 * now.dz, -1.0, 1.0),)


class BoucWen(AbstractEffect):
    r"""Bouc-Wen hysteresis (Bouc, 1967; Wen, 1976), :math:`T = -s` with :math:`|s|` at most :math:`F_c`.

    :math:`\dot s = \sigma (\dot z - |s/F_c|^n (\beta |\dot z|\,\mathrm{sgn}\,s + (1 - \beta) \dot z))`;
    :math:`n = \beta = 1` is Dahl's law.
    """

    sigma: Scalar = param(unit="N m/rad", default=1000.0, lower=0.0, scale=1000.0)
    Fc: Scalar = param(unit="N m", null=0.0, lower=0.0, scale=1.0)
    n: Scalar = param(unit="1", default=1.5, lower=1.0, upper=5.0, scale=0.5)
    beta: Scalar = param(unit="1", default=0.75, lower=0.0, upper=1.0, scale=0.1)
    states: ClassVar[tuple[str, ...]] = ("s",)
    reach: ClassVar[float] = 1.0
    family: ClassVar[str | None] = "hysteresis"

    @classmethod
    def guesses(cls, system: Any, motion: Any | None = None) -> list[AbstractEffect]:
        return [cls(1.0 / distance, 1.0, 1.5, 0.75) for distance in presliding(system)]

    def simpler(self) -> list[AbstractEffect]:
        return [CoulombJoint(self.Fc), CoulombGround(self.Fc), Dahl(self.Fc, self.sigma)]

    def torque(self, now: Instant) -> Scalar:
        return -self.Fc * now.rubbed * now.state[0]

    def rate(self, now: Instant) -> tuple[Scalar, ...]:
        (s,) = now.state
        flow = _flow(now.dz, self.sigma, self.Fc)
        # Beyond its physical range the power of the state stops growing: a fit's trial states must not run away.
        full = jnp.exp(self.n * jnp.log(jnp.clip(jnp.abs(s), 1e-9, 1.5)))
        return (flow - full * (self.beta * jnp.abs(flow) * jnp.sign(s) + (1.0 - self.beta) * flow),)

    def start(self, now: Instant) -> tuple[Scalar, ...]:
        return (jnp.clip(10.0 * now.dz, -1.0, 1.0),)
