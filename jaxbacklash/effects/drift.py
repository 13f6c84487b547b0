"""Slow changes of the joint, linear in the record's own time t [s]."""

from __future__ import annotations

from typing import ClassVar

import jax.numpy as jnp

from ..mechanics import AbstractEffect, Instant, Play
from ..parameters import Scalar, param


class GapDrift(AbstractEffect):
    r"""The play wears or closes, :math:`b(t) = b\,(1 + r t)`."""

    joints: ClassVar[tuple[str, ...]] = ("play",)

    r: Scalar = param(unit="1/s", null=0.0, scale=1e-3)

    def reshape(self, play: Play, t: Scalar, x: Scalar) -> Play:
        return Play(play.backlash * (1.0 + self.r * t), play.centre)


class StiffnessDrift(AbstractEffect):
    r"""The contact stiffness drifts, :math:`k(t) = k\,(1 + r t)`, so :math:`T = -k r t\,\delta` beside the contact spring."""

    joints: ClassVar[tuple[str, ...]] = ("play", "spring")

    r: Scalar = param(unit="1/s", null=0.0, scale=1e-3)

    def drift(self, t: Scalar) -> Scalar:
        return 1.0 + self.r * t

    def torque(self, now: Instant) -> Scalar:
        return -(self.r * now.t) * (now.stiffness * now.deflection)


class DampingDrift(AbstractEffect):
    r"""The damping drifts, :math:`c(t) = c\,(1 + r t)`, so :math:`T = -c r t\,\dot z` beside the damper."""

    alike: ClassVar[dict[str, str]] = {
        "friction_drift": "swings of several sizes, early and late: friction takes from small ones more",
        "stiffness_drift": "free swings, early and late: their period or their decay changes",
    }

    r: Scalar = param(unit="1/s", null=0.0, scale=1e-3)

    def torque(self, now: Instant) -> Scalar:
        return -(self.r * now.t) * (now.damping * now.dz)


class FrictionDrift(AbstractEffect):
    r"""Dry friction drifts, whichever there is: all of it is :math:`1 + r t` times what its laws state, and never below zero.

    Only beside a law of dry friction does it anything.
    """

    alike: ClassVar[dict[str, str]] = {"damping_drift": DampingDrift.alike["friction_drift"]}

    r: Scalar = param(unit="1/s", null=0.0, scale=1e-3)

    def rubs(self, t: Scalar) -> Scalar:
        return jnp.maximum(1.0 + self.r * t, 0.0)
