"""Loads on the link that do not come from the joint's contact: weight, a constant torque, a drive's ripple."""

from __future__ import annotations

from typing import Any, ClassVar

import jax.numpy as jnp
import numpy as np

from ..mechanics import AbstractEffect, Instant, Wave
from ..parameters import Scalar, param
from .scales import LABORATORY, natural_frequency, orders

LEAST_ORDER = 4.0
"""Repetitions a turn below which a ripple cannot be told from gravity."""


class Gravity(AbstractEffect):
    r"""Weight of the link, :math:`T = +G \sin(y + \varphi_0)`, :math:`G = m g L`: positive upright, negative hanging.

    :math:`\varphi_0` is how far the zero of the encoder is off the vertical, where that is not 0 as in the paper (3.3).
    """

    alike: ClassVar[dict[str, str]] = {
        "preload": "a swing of the link over which its weight changes: by twenty degrees, or from two places",
        "torque_ripple": "a swing of the link that is wider than the ripple is long",
        "gap_spring": "a motion of the base and the link together, in which a spring across the joint does not bend",
    }

    wave: ClassVar[Wave | None] = Wave("G", "phi0", None, "y")

    G: Scalar = param(unit="N m", null=0.0, scale=10.0)
    phi0: Scalar = param(unit="rad", usual=0.0, scale=0.1)
    port: ClassVar[str] = "ground"
    motions: ClassVar[tuple[str, ...]] = ("turning",)

    def forms(self) -> list[AbstractEffect]:
        return [Gravity(self.G * np.cos(self.phi0)) if float(self.phi0) else Gravity(self.G, 0.01)]

    def simpler(self) -> list[AbstractEffect]:
        # Seen from far off the vertical the weight hardly changes over a swing.
        return [Preload(self.G * np.sin(self.phi0))] if float(self.phi0) else []

    def torque(self, now: Instant) -> Scalar:
        return self.G * jnp.sin(now.y + self.phi0)


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
    wave: ClassVar[Wave | None] = Wave("A", "phi", "N", "y")

    @classmethod
    def guesses(cls, system: Any, motion: Any | None = None) -> list[AbstractEffect]:
        # A link that swings by a tenth of a radian tells orders some fifteen apart; a phase is a sum of two.
        return [cls(1.0, order, phase) for order in orders(motion, LEAST_ORDER) for phase in (0.0, 0.5 * np.pi)]

    def torque(self, now: Instant) -> Scalar:
        return self.A * jnp.sin(self.N * now.y + self.phi)


class Disturbance(AbstractEffect):
    r"""A hum or an unbalance that nobody recorded, :math:`T = A \sin(\omega t + \varphi)`, whatever the link does.

    It resembles nothing that goes with the joint's motion, but in a record whose drive has that frequency too.
    """

    A: Scalar = param(unit="N m", null=0.0, scale=1.0)
    omega: Scalar = param(unit="1/s", default=LABORATORY, lower=0.0, scale=1.0, label="angular frequency")
    phi: Scalar = param(unit="1", default=0.0, scale=0.1)
    port: ClassVar[str] = "ground"
    wave: ClassVar[Wave | None] = Wave("A", "phi", "omega", "t")

    @classmethod
    def guesses(cls, system: Any, motion: Any | None = None) -> list[AbstractEffect]:
        return [cls(1.0, natural_frequency(system), phase) for phase in (0.0, 0.5 * np.pi)]

    def torque(self, now: Instant) -> Scalar:
        return self.A * jnp.sin(self.omega * now.t + self.phi)
