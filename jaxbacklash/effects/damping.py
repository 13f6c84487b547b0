"""Dampers beside the one that always acts: in contact only, growing with the contact, or with speed."""

from __future__ import annotations

from typing import ClassVar

import jax.numpy as jnp

from ..mechanics import AbstractEffect, Instant, Kink
from ..parameters import Scalar, param


def pushing(damper: Scalar, now: Instant, pulls: Scalar) -> Scalar:
    """Torque of a contact's damper [N m]: as it is where the contact ``pulls``, else as far as it leaves the spring a push."""
    spring = -now.stiffness * now.drifted * now.deflection
    above = (now.deflection if now.side is None else now.side) > 0.0
    limited = jnp.where(above, jnp.minimum(damper, -spring), jnp.maximum(damper, -spring))
    return jnp.where(pulls > 0.5, damper, limited)


class ContactDamping(AbstractEffect):
    r"""A damper of the contact, :math:`T = -c_c \dot z` in contact and nothing in the play (the contact of Kelvin and Voigt).

    The torque jumps at the edge of the play, where located steps end. A contact that never ``pulls`` lets go where its damper
    would hold the link back more than its spring pushes.
    """

    joints: ClassVar[tuple[str, ...]] = ("play",)

    cc: Scalar = param(unit="N m s/rad", null=0.0, lower=0.0, scale=1.0)
    pulls: Scalar = param(unit="1", default=1.0, lower=0.0, upper=1.0, fixed=True, label="0: the contact never pulls")

    def torque(self, now: Instant) -> Scalar:
        return pushing(-self.cc * now.contact * now.dz, now, self.pulls)

    def forms(self) -> list[AbstractEffect]:
        return [ContactDamping(self.cc, 1.0 - self.pulls)]

    def kink(self, now: Instant, ddz: Scalar, ddy: Scalar) -> tuple[Kink, ...]:
        k = now.stiffness * now.drifted
        lets_go = now.contact * (self.pulls < 0.5)
        return ((lets_go * (k * now.deflection + self.cc * now.dz), k * now.dz + self.cc * ddz, 0.0),)


class HuntCrossley(AbstractEffect):
    r"""Contact damping that grows with the contact, :math:`T = -\chi |\delta| \dot z` (Hunt and Crossley, 1975).

    ``pulls`` is that of `ContactDamping`.
    """

    joints: ClassVar[tuple[str, ...]] = ("play", "spring")

    chi: Scalar = param(unit="N m s/rad^2", null=0.0, lower=0.0, scale=100.0)
    pulls: Scalar = param(unit="1", default=1.0, lower=0.0, upper=1.0, fixed=True, label="0: the contact never pulls")

    def torque(self, now: Instant) -> Scalar:
        return pushing(-self.chi * jnp.abs(now.deflection) * now.dz, now, self.pulls)

    def forms(self) -> list[AbstractEffect]:
        return [HuntCrossley(self.chi, 1.0 - self.pulls)]

    def kink(self, now: Instant, ddz: Scalar, ddy: Scalar) -> tuple[Kink, ...]:
        outwards, lets_go = self.chi * jnp.sign(now.deflection), now.contact * (self.pulls < 0.5)
        return ((lets_go * (now.stiffness * now.drifted + outwards * now.dz), outwards * ddz, 0.0),)


class QuadraticDrag(AbstractEffect):
    r"""Drag of the link in a fluid at high Reynolds number, :math:`T = -q |\dot y| \dot y`."""

    q: Scalar = param(unit="N m s^2/rad^2", null=0.0, lower=0.0, scale=1.0)
    port: ClassVar[str] = "ground"

    def torque(self, now: Instant) -> Scalar:
        return -self.q * jnp.abs(now.dy) * now.dy
