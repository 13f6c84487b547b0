"""Dampers beside the one that always acts: in contact only, growing with the contact, or with speed."""

from __future__ import annotations

from typing import ClassVar

import jax.numpy as jnp

from ..mechanics import AbstractEffect, Instant
from ..parameters import Scalar, param


class ContactDamping(AbstractEffect):
    r"""A damper of the contact, :math:`T = -c_c \dot z` in contact and nothing in the play (the contact of Kelvin and Voigt).

    The torque jumps at the edge of the play, where located steps end.
    """

    joints: ClassVar[tuple[str, ...]] = ("play",)

    cc: Scalar = param(unit="N m s/rad", null=0.0, lower=0.0, scale=1.0)

    def torque(self, now: Instant) -> Scalar:
        return -self.cc * now.contact * now.dz


class HuntCrossley(AbstractEffect):
    r"""Contact damping that grows with the contact, :math:`T = -\chi |\delta| \dot z` (Hunt and Crossley, 1975)."""

    joints: ClassVar[tuple[str, ...]] = ("play", "spring")

    chi: Scalar = param(unit="N m s/rad^2", null=0.0, lower=0.0, scale=100.0)

    def torque(self, now: Instant) -> Scalar:
        return -self.chi * jnp.abs(now.deflection) * now.dz


class QuadraticDrag(AbstractEffect):
    r"""Drag of the link in a fluid at high Reynolds number, :math:`T = -q |\dot y| \dot y`."""

    q: Scalar = param(unit="N m s^2/rad^2", null=0.0, lower=0.0, scale=1.0)
    port: ClassVar[str] = "ground"

    def torque(self, now: Instant) -> Scalar:
        return -self.q * jnp.abs(now.dy) * now.dy
