"""A record's motion with its speeds and acceleration, for pictures of where the joint was and which torque it carried."""

from __future__ import annotations

import numpy as np

from ..pointwise import along
from ..records import Record
from ..signals import choose_intervals, fit_spline, span
from ..system import System

INSIDE = slice(10, -10)
"""Samples that are drawn where derivatives count: at its two ends a spline's curvature is little more than noise."""


class Motion:
    """A record's motion with speeds and acceleration from smoothing splines; ``z``, ``dz``, ... have shape (N,)."""

    def __init__(self, record: Record, observed: str) -> None:
        t, window = record.t, span(record.dt)
        zero = np.zeros(record.samples)
        measured = record.channels[observed]
        self.x, self.dx = zero, zero
        if "x" in record.channels:
            spline = fit_spline(t, record.channels["x"], t[0], window / choose_intervals(t, record.channels["x"], window))
            self.x, self.dx = spline(t), spline(t, 1)
        y = measured + self.x if observed == "z" else measured
        link = fit_spline(t, y, t[0], window / choose_intervals(t, y, window))
        self.t, self.force = t, record.channels.get("F", zero)
        self.y, self.dy, self.ddy = link(t), link(t, 1), link(t, 2)
        self.z = measured if observed == "z" else measured - self.x
        self.dz = self.dy - self.dx

    def restoring_torque(self, system: System) -> np.ndarray:
        """Torque that brings the link back to the play's middle, -joint torque at rest [N m], shape (N,)."""
        said = along(system, self.t, self.y, self.dy, self.x, self.dx, self.force)
        return said.torque - said.joint + self.force - float(system.inertia) * self.ddy - float(system.damper.damping) * self.dz


def joint_law(system: System, z: np.ndarray) -> np.ndarray:
    """Torque that the model's joint returns at rest [N m] over ``z`` (M,)."""
    return -along(system, 0.0, z, 0.0, 0.0, 0.0).joint
