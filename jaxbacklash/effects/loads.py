"""Loads on the link that do not come from the joint's contact: weight, a constant torque."""

from __future__ import annotations

from typing import ClassVar

import jax.numpy as jnp

from ..mechanics import AbstractEffect, Instant
from ..parameters import Scalar, param


class Gravity(AbstractEffect):
    r"""Weight of the link, :math:`T = +G \sin y`, :math:`G = m g L`: positive upright, negative hanging (paper, 3.3)."""

    G: Scalar = param(unit="N m", null=0.0, scale=10.0)
    port: ClassVar[str] = "ground"

    def torque(self, now: Instant) -> Scalar:
        return self.G * jnp.sin(now.y)


class LinearGravity(AbstractEffect):
    r"""The paper's linearised weight, :math:`T = +G y = J C y` (paper, 3.3)."""

    G: Scalar = param(unit="N m", null=0.0, scale=10.0)
    port: ClassVar[str] = "ground"
    catalogued: ClassVar[bool] = False

    def torque(self, now: Instant) -> Scalar:
        return self.G * now.y


class Preload(AbstractEffect):
    r"""A constant torque, :math:`T = T_0`."""

    T0: Scalar = param(unit="N m", null=0.0, scale=1.0)
    port: ClassVar[str] = "ground"

    def torque(self, now: Instant) -> Scalar:
        return self.T0 * jnp.ones_like(now.y)
