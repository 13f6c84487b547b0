"""Slow changes of the joint, linear in the record's own time t [s]."""

from __future__ import annotations

from typing import ClassVar

from ..mechanics import AbstractEffect, Instant, Play
from ..parameters import Scalar, param


class GapDrift(AbstractEffect):
    r"""The play wears or closes, :math:`b(t) = b\,(1 + r t)`."""

    joints: ClassVar[tuple[str, ...]] = ("play",)

    r: Scalar = param(unit="1/s", null=0.0, scale=1e-3)

    def reshape(self, play: Play, t: Scalar) -> Play:
        return Play(play.backlash * (1.0 + self.r * t), play.centre)


class StiffnessDrift(AbstractEffect):
    r"""The contact stiffness drifts, :math:`k(t) = k\,(1 + r t)`, so :math:`T = -k r t\,\delta` beside the contact spring."""

    joints: ClassVar[tuple[str, ...]] = ("play", "spring")

    r: Scalar = param(unit="1/s", null=0.0, scale=1e-3)

    def drift(self, t: Scalar) -> Scalar:
        return 1.0 + self.r * t

    def torque(self, now: Instant) -> Scalar:
        return -(self.r * now.t) * (now.stiffness * now.deflection)
