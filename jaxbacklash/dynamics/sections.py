r"""Sections of a motion: once a period of the drive (stroboscopic), or wherever a plane is crossed (Poincare).

A stroboscopic section of a periodic motion is a few points, of a chaotic one a fractal. A Poincare section at an edge of the play
shows the speeds of impact.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np

from ..excitation import AbstractExcitation
from ..frames import dataframe
from ..simulation import Trajectory, simulate
from ..system import System
from .courses import begins
from .follow import follow
from .plan import Plan

Array = Any


class Section(NamedTuple):
    """Points of a section: ``t`` (K,) [s], ``z`` and ``dz`` (K,) [rad, rad/s] at those times."""

    t: np.ndarray
    z: np.ndarray
    dz: np.ndarray

    def __str__(self) -> str:
        return f"{self.t.size} points of a section" + (f" from {self.t[0]:.5g} to {self.t[-1]:.5g} s" if self.t.size else "")

    def to_dataframe(self) -> Any:
        """The points as a `pandas.DataFrame` along ``t`` [s]: ``z`` and ``dz``."""
        return dataframe({"t": self.t, "z": self.z, "dz": self.dz}, "t")


def stroboscopic(
    system: System, drive: AbstractExcitation, *, points: int = 1000, skip: int = 100, y0: float = 0.0, dy0: float = 0.0,
    period: float | None = None,
) -> Section:  # fmt: skip
    """Positions and speeds at whole periods of the drive, after ``skip`` periods of transient.

    Exact steps are taken where the system allows them. ``period`` [s] must be given for a drive that has none of its own.

    Returns
    -------
    `Section`: ``t``, ``z`` and ``dz``, (points,) each

    Raises
    ------
    BadInput
        The drive has no period and none is given.

    Examples
    --------
    >>> system, force = jb.dynamics.PaperCase(1).build({})
    >>> jb.dynamics.stroboscopic(system, force, points=20).z.shape
    (20,)
    """
    plan = Plan(skip + max(points, 20), skip, points)
    one = jnp.ones(1)
    found, _ = follow(system, drive, y0 * one, dy0 * one, plan, period=period)
    length = period if period is not None else 2.0 * np.pi / float(drive.omega)  # type: ignore[attr-defined]
    whole = np.arange(plan.periods - points + 1, plan.periods + 1)
    return Section(float(begins(drive)) + whole * length, np.asarray(found.p)[:, 0], np.asarray(found.v)[:, 0])


def poincare(
    system: System, drive: AbstractExcitation, *, plane: float, direction: int = 0, duration: float, rate: float = 500.0,
    skip: float = 0.0, y0: float | None = None, dy0: float | None = None,
) -> Section:  # fmt: skip
    """Where the relative motion z crosses ``plane`` [rad], from a simulation by located steps.

    Parameters
    ----------
    plane : level of z [rad]; half the play is the edge of the contact
    direction : 1 upwards, -1 downwards, 0 both
    duration, rate : of the simulation [s, Hz]; two crossings between samples are not seen
    skip : time of transient that does not count [s]
    y0, dy0 : start of the link [rad, rad/s]

    Returns
    -------
    Section
        times from the cubic through positions and speeds of the neighbouring samples

    Examples
    --------
    >>> system, force = jb.dynamics.PaperCase(1).build({})
    >>> found = jb.dynamics.poincare(system, force, plane=1.0, direction=1, duration=200.0, rate=20.0)
    >>> bool((found.dz > 0.0).all())
    True
    """
    return crossings(simulate(system, drive, duration=duration, rate=rate, y0=y0, dy0=dy0), plane, direction, skip)


def crossings(path: Trajectory, plane: float, direction: int = 0, skip: float = 0.0) -> Section:
    """The crossings of a simulated motion; see `poincare`."""
    t, z = np.asarray(path.t), np.asarray(path.z) - plane
    dz = np.asarray(path.dy) - np.broadcast_to(np.asarray(path.drive.dx), t.shape)
    here = (z[:-1] < 0.0) != (z[1:] < 0.0)
    upwards = z[1:] > z[:-1]
    if direction:
        here &= upwards == (direction > 0)
    k = np.flatnonzero(here & (t[:-1] >= skip))
    h = t[k + 1] - t[k]
    a, b, c, d = z[k], h * dz[k], z[k + 1], h * dz[k + 1]
    c2, c3 = 3.0 * (c - a) - 2.0 * b - d, b + d - 2.0 * (c - a)
    low, high = np.zeros(k.size), np.ones(k.size)
    for _ in range(50):  # bisection cannot leave the bracket, whatever the cubic does
        middle = 0.5 * (low + high)
        before = (a + middle * (b + middle * (c2 + middle * c3)) < 0.0) == (a < 0.0)
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    s = 0.5 * (low + high)
    speed = (b + s * (2.0 * c2 + 3.0 * s * c3)) / h
    return Section(t[k] + s * h, np.full(k.size, plane), speed)
