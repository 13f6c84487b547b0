r"""A start for the fit: weak-form regression of the equation of motion on the raw samples.

The equation is multiplied by a smooth bump :math:`\varphi` of half-width a and integrated by parts, so that derivatives
fall on the bump: :math:`\int \varphi'' y = \int \varphi\,(F - k\,\delta_b(z))/J + (c/J) \int \varphi' z`. For a given play the rest is
linear; the play itself comes from a grid and a local refinement. Noise near the corner biases the result a little,
which the fit by simulation removes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import optimize, signal

from ..records import Record

HALF_WIDTH = 0.05
"""Half-width of the bump [s]: shorter amplifies noise, longer blurs the contacts."""


@dataclass(frozen=True)
class Start:
    """Values to start from; a quantity the model does not have is None. ``misfit`` is the residual's share, 0 to 1."""

    inertia: float
    backlash: float | None
    stiffness: float | None
    damping: float
    misfit: float


def estimate(record: Record, *, inertia: float | None, play: bool = True, spring: bool = True) -> Start:
    """Estimate inertia (when it is None), play, stiffness and damping from one record.

    Parameters
    ----------
    record : base-motion, force-driven or free-decay record
    inertia : known inertia J [kg m^2]; None to estimate it, which needs a measured force
    play : the joint has a play
    spring : the joint has a stiffness at all
    """
    weak = _WeakForm(record)
    fixed_inertia = inertia if inertia is not None else None

    def solve(half_play: float) -> tuple[float, np.ndarray]:
        columns = [weak.damping()]
        if spring:
            columns.append(weak.integrate(_dead_zone(weak.z, half_play)))
        if fixed_inertia is None:
            columns.append(weak.acceleration)
            right = weak.force
        else:
            right = weak.force - fixed_inertia * weak.acceleration
        matrix = np.stack(columns, axis=1)
        scale = np.linalg.norm(matrix, axis=0)
        scale[scale == 0.0] = 1.0
        solution = np.linalg.lstsq(matrix / scale, right, rcond=None)[0] / scale
        residual = right - matrix @ solution
        return float(residual @ residual) / float(right @ right + 1e-300), solution

    half = 0.0
    if spring and play:
        reach = float(np.max(np.abs(weak.z)))
        grid = reach * np.linspace(0.01, 0.97, 72)
        misfits = [solve(h)[0] for h in grid]
        k = int(np.argmin(misfits))
        low, high = grid[max(k - 1, 0)], grid[min(k + 1, grid.size - 1)]
        half = float(optimize.minimize_scalar(lambda h: solve(h)[0], bounds=(low, high), method="bounded").x)
    misfit, solution = solve(half)
    found = inertia if inertia is not None else max(float(solution[-1]), 1e-9)
    stiffness = max(float(solution[1]), 1e-6 * found) if spring else None
    damping = max(float(solution[0]), 1e-4 * (stiffness * found) ** 0.5 if stiffness else 0.0)
    return Start(found, 2.0 * half if spring and play else None, stiffness, damping, min(misfit, 1.0))


def _dead_zone(z: np.ndarray, half_play: float) -> np.ndarray:
    return z - np.clip(z, -half_play, half_play)


class _WeakForm:
    """The record seen through the bump: one number a position of the bump, positions a quarter half-width apart."""

    def __init__(self, record: Record) -> None:
        dt = record.dt
        reach = int(np.clip(round(HALF_WIDTH / dt), 8, record.samples // 6))
        tau = np.arange(-reach, reach + 1) / reach
        base = 1.0 - tau**2
        self._bump = base**4
        self._bump1 = -8.0 * tau * base**3 / (reach * dt)
        self._bump2 = (48.0 * tau**2 * base**2 - 8.0 * base**3) / (reach * dt) ** 2
        self._stride = max(1, reach // 4)
        channels = record.channels
        zero = np.zeros(record.samples)
        x = channels.get("x", zero)
        self.z = channels["z"] if "z" in channels else channels["y"] - x
        y = channels["y"] if "y" in channels else self.z + x
        self.acceleration = self._against(self._bump2, y)
        self.force = self._against(self._bump, channels.get("F", zero))

    def damping(self) -> np.ndarray:
        return -self._against(self._bump1, self.z)

    def integrate(self, torque: np.ndarray) -> np.ndarray:
        return self._against(self._bump, torque)

    def _against(self, bump: np.ndarray, values: np.ndarray) -> np.ndarray:
        return signal.oaconvolve(values, bump[::-1], mode="valid")[:: self._stride]
