"""Springs that relax under load: rubber couplings, belts, plastic gears."""

from __future__ import annotations

from typing import Any, ClassVar

import jax.numpy as jnp
import numpy as np

from ..mechanics import AbstractEffect, Instant
from ..parameters import Scalar, param
from .scales import natural_frequency
from .stiffness import GapSpring

QUICKEST = 1e-3
"""Shortest relaxation time [s]: what relaxes sooner is one with the joint's damper."""
FIRST, LAST, RUNGS = 0.3, 30.0, 7
"""Relaxation times that are tried, in units of the time in which the link swings by a radian of phase."""


class Relaxation(AbstractEffect):
    r"""A spring and a damper in a row across the joint, :math:`T = -s,\ \dot s = k_r \dot z - s / \tau_r` (Maxwell, 1867).

    The state is the damper's speed, :math:`w = s / (k_r \tau_r)`, so that the law is linear in its strength. Beside a motion
    that is slow against :math:`\tau_r` it is a damper, beside one that is quick a spring.
    """

    kr: Scalar = param(unit="N m/rad", null=0.0, lower=0.0, scale=1000.0)
    tau_r: Scalar = param(unit="s", default=0.1, lower=QUICKEST, scale=0.1)
    alike: ClassVar[dict[str, str]] = {
        "gap_spring": "motion that is slow against the relaxation time, in which a spring holds and this gives",
        "dahl": "swings of several sizes at one frequency: what relaxes is the same share of each",
        "bouc_wen": "swings of several sizes at one frequency: what relaxes is the same share of each",
    }
    states: ClassVar[tuple[str, ...]] = ("w",)

    @classmethod
    def guesses(cls, system: Any, motion: Any | None = None) -> list[AbstractEffect]:
        omega = natural_frequency(system)
        size = 0.1 * float(system.inertia) * omega**2
        return [cls(size, max(share / omega, QUICKEST)) for share in np.geomspace(FIRST, LAST, RUNGS)]

    def simpler(self) -> list[AbstractEffect]:
        return [GapSpring(self.kr)]

    def torque(self, now: Instant) -> Scalar:
        return -self.kr * self.tau_r * now.state[0]

    def rate(self, now: Instant) -> tuple[Scalar, ...]:
        return ((now.dz - now.state[0]) / jnp.maximum(self.tau_r, QUICKEST),)
