"""Loads on the link that do not come from the joint's contact: weight, a constant torque, a drive's ripple."""

from __future__ import annotations

from typing import Any, ClassVar

import jax.numpy as jnp
import numpy as np

from ..mechanics import AbstractEffect, Instant
from ..parameters import Scalar, param
from .scales import orders

LEAST_ORDER = 4.0
"""Repetitions a turn below which a ripple cannot be told from gravity."""


class Gravity(AbstractEffect):
    r"""Weight of the link, :math:`T = +G \sin y`, :math:`G = m g L`: positive upright, negative hanging (paper, 3.3)."""

    G: Scalar = param(unit="N m", null=0.0, scale=10.0)
    port: ClassVar[str] = "ground"
    motions: ClassVar[tuple[str, ...]] = ("turning",)

    def torque(self, now: Instant) -> Scalar:
        return self.G * jnp.sin(now.y)


class LinearGravity(AbstractEffect):
    r"""The paper's linearised weight, :math:`T = +G y = J C y` (paper, 3.3)."""

    G: Scalar = param(unit="N m", null=0.0, scale=10.0)
    port: ClassVar[str] = "ground"
    motions: ClassVar[tuple[str, ...]] = ("turning",)
    catalogued: ClassVar[bool] = False

    def torque(self, now: Instant) -> Scalar:
        return self.G * now.y


class Preload(AbstractEffect):
    r"""A constant torque, :math:`T = T_0`."""

    T0: Scalar = param(unit="N m", null=0.0, scale=1.0)
    port: ClassVar[str] = "ground"

    def torque(self, now: Instant) -> Scalar:
        return self.T0 * jnp.ones_like(now.y)


class TorqueRipple(AbstractEffect):
    r"""Ripple of a drive, :math:`T = A \sin(N y + \varphi)`: cogging, or the teeth of a harmonic drive.

    The order N is at least 4: below that the ripple cannot be told from gravity. A and :math:`\varphi` are one amplitude
    with either sign and a phase.
    """

    A: Scalar = param(unit="N m", null=0.0, scale=1.0)
    N: Scalar = param(unit="1", default=20.0, lower=LEAST_ORDER, scale=1.0)
    phi: Scalar = param(unit="1", default=0.0, scale=0.1)
    port: ClassVar[str] = "ground"

    @classmethod
    def guesses(cls, system: Any, motion: Any | None = None) -> list[AbstractEffect]:
        # A link that swings by a tenth of a radian tells orders some fifteen apart; a phase is a sum of two.
        return [cls(1.0, order, phase) for order in orders(motion, LEAST_ORDER) for phase in (0.0, 0.5 * np.pi)]

    def torque(self, now: Instant) -> Scalar:
        return self.A * jnp.sin(self.N * now.y + self.phi)
