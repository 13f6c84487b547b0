r"""A start for the fit: weak-form regression of the equation of motion on the raw samples.

The equation is multiplied by a smooth bump :math:`\varphi` of half-width a and integrated by parts, so that derivatives
fall on the bump: :math:`\int \varphi'' y = \int \varphi\,(F - k\,\delta_b(z))/J + (c/J) \int \varphi' z`. For a given
play the rest is linear; the play itself comes from a grid and a local refinement. Noise near the corner biases the result
a little, which the fit by simulation removes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import equinox as eqx
import numpy as np

from ..mechanics import AbstractEffect, Instant
from ..pointwise import exerted
from ..records import Record
from ..signals import choose_intervals, fit_spline, span
from .averaged import Averaged

ROOM = 500_000
"""Samples of several plays that are looked at together at most."""
ZOOMS, NEAR = 3, 16
"""How often the best play and its neighbours are looked at more closely, and how many sizes of it each time: what is left between
two of them is a ten-thousandth of the largest deflection."""


@dataclass(frozen=True)
class Start:
    """Values to start from; a quantity the model does not have is None.

    ``effects`` are those given, with their strengths estimated where the torque is linear in one; ``misfit`` is the
    residual's share, 0 to 1.
    """

    inertia: float
    backlash: float | None
    stiffness: float | None
    damping: float
    misfit: float
    effects: tuple[AbstractEffect, ...] = ()


def estimate(
    record: Record,
    *,
    inertia: float | None,
    play: bool = True,
    spring: bool = True,
    effects: Sequence[AbstractEffect] = (),
    plays: int = 72,
) -> Start:
    """Estimate inertia (when it is None), play, stiffness, damping and strengths of effects from one record.

    Parameters
    ----------
    record : base-motion, force-driven or free-decay record
    inertia : known inertia J [kg m^2]; None to estimate it, which needs a measured force
    play : the joint has a play
    spring : the joint has a stiffness at all
    plays : sizes of the play that are tried before the best of them is refined
    effects : effects of the model; those without internal states whose torque vanishes with one strength take part
    """
    weak = _WeakForm(record)
    if inertia is None and spring:
        inertia = weak.mass()
    strengths = [(effect, name) for effect in effects if (name := _strength(effect)) is not None]

    damping_column = weak.damping()
    reach = float(np.max(np.abs(weak.z)))
    units = [_unit(effect, name) for effect, name in strengths]
    steady = [weak.steady(unit, reach) for unit in units]

    right = weak.force if inertia is None else weak.force - inertia * weak.acceleration

    def columns(halves: np.ndarray) -> np.ndarray:
        """The columns (K, C, R) of the regressions at half plays (K,)."""
        found = [damping_column]
        if spring:
            found.append(weak.average(_dead_zone(weak.z, halves[:, None])))
        if inertia is None:
            found.append(weak.acceleration)
        for unit, known in zip(units, steady):
            found.append(-np.stack([weak.torque(unit, half) for half in halves]) if known is None else -known)
        return np.stack([np.broadcast_to(column, (halves.size, right.size)) for column in found], axis=1)

    def solve(half_play: float) -> tuple[float, np.ndarray]:
        matrix = columns(np.array([half_play]))[0].T
        scale = np.linalg.norm(matrix, axis=0)
        scale[scale == 0.0] = 1.0
        solution = np.linalg.lstsq(matrix / scale, right, rcond=None)[0] / scale
        residual = right - matrix @ solution
        return float(residual @ residual) / float(right @ right + 1e-300), solution

    half = 0.0
    if spring and play:
        together = max(1, ROOM // weak.z.size)

        def best_of(grid: np.ndarray) -> int:
            parts = (grid[k : k + together] for k in range(0, grid.size, together))
            return int(np.argmin(np.concatenate([_misfits(columns(part), right) for part in parts])))

        grid = reach * np.linspace(0.01, 0.97, plays)
        k = best_of(grid)
        for _ in range(ZOOMS):
            grid = np.linspace(grid[max(k - 1, 0)], grid[min(k + 1, grid.size - 1)], NEAR)
            k = best_of(grid)
        half = float(grid[k])
    misfit, solution = solve(half)
    # Strengths relative to the contact stiffness or to the damping need these to be known.
    weak.joint = max(float(solution[1]), 1e-9) if spring else 1.0, max(float(solution[0]), 1e-9)
    misfit, solution = solve(half)
    rest = iter(solution[2 if spring else 1 :])
    found = inertia if inertia is not None else max(float(next(rest)), 1e-9)
    stiffness = max(float(solution[1]), 1e-6 * found) if spring else None
    damping = max(float(solution[0]), 1e-4 * (stiffness * found) ** 0.5 if stiffness else 0.0)
    return Start(
        found,
        2.0 * half if spring and play else None,
        stiffness,
        damping,
        min(misfit, 1.0),
        tuple(_started(effect, strengths, rest) for effect in effects),
    )


def _misfits(columns: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Shares of the right side (R,) that K regressions on ``columns`` (K, C, R) leave, by their normal equations, all at once:
    near enough to choose."""
    normal = columns @ np.swapaxes(columns, 1, 2)
    scale = np.sqrt(np.diagonal(normal, axis1=1, axis2=2))
    scale = np.where(scale == 0.0, 1.0, scale)
    inverse = np.linalg.pinv(normal / (scale[:, :, None] * scale[:, None, :]), rcond=1e-14, hermitian=True)
    solution = (inverse @ (columns @ right / scale)[:, :, None])[:, :, 0] / scale
    residual = right - (solution[:, None, :] @ columns)[:, 0]
    found: np.ndarray = np.sum(residual**2, axis=1) / (np.sum(right**2) + 1e-300)
    return found


def _strength(effect: AbstractEffect) -> str | None:
    """The one parameter with which the torque of a law without internal states vanishes, if there is one."""
    if effect.states or type(effect).torque is AbstractEffect.torque:
        return None
    null = [f.name for f in fields(effect) if "spec" in f.metadata and f.metadata["spec"].null is not None]
    return null[0] if len(null) == 1 else None


def _unit(effect: AbstractEffect, name: str) -> AbstractEffect:
    return _with(effect, name, 1.0)


def _with(effect: AbstractEffect, name: str, value: float) -> AbstractEffect:
    return eqx.tree_at(lambda e: getattr(e, name), effect, np.asarray(value))


def _started(effect: AbstractEffect, strengths: list[tuple[AbstractEffect, str]], rest: Any) -> AbstractEffect:
    for known, name in strengths:
        if known is effect:
            spec = next(f.metadata["spec"] for f in fields(effect) if f.name == name)
            value = float(np.clip(next(rest), spec.lower, spec.upper))
            return _with(effect, name, value)
    return effect


def _dead_zone(z: np.ndarray, half_play: float | np.ndarray) -> np.ndarray:
    return z - np.clip(z, -half_play, half_play)


class _WeakForm(Averaged):
    """A record with the columns of the regression."""

    def __init__(self, record: Record) -> None:
        super().__init__(record)
        self.z = record.channels["z"] if "z" in record.channels else self.y - self.x
        self._record = record
        self.joint = 1.0, 1.0  # stiffness and damping
        self._speeds: tuple[np.ndarray, np.ndarray] | None = None

    def damping(self) -> np.ndarray:
        return -self.average(self.z, 1)

    def mass(self, knots: int = 12) -> float:
        """The inertia beside a restoring force of any shape, broken lines over quantiles of z, and linear damping (Masri and
        Caughey, Journal of Applied Mechanics 46 (1979) 433): a straight spring in place of one that hardens bends it even below
        nothing."""
        places = np.unique(np.quantile(self.z, np.linspace(0.0, 1.0, knots)))
        shapes = self.average(np.stack([np.interp(self.z, places, unit) for unit in np.eye(places.size)]))
        matrix = np.column_stack([self.acceleration, self.damping(), *shapes])
        scale = np.linalg.norm(matrix, axis=0)
        scale[scale == 0.0] = 1.0
        found = float(np.linalg.lstsq(matrix / scale, self.force, rcond=None)[0][0] / scale[0])
        return max(found, 1e-9)

    def torque(self, effect: AbstractEffect, half_play: float) -> np.ndarray:
        """Torque of an effect on the measured motion under the bump; its speeds are smoothed."""
        return self.average(self._pointwise(effect, half_play, self.joint))

    def steady(self, effect: AbstractEffect, reach: float) -> np.ndarray | None:
        """The same where nothing of the joint shows in it, None where something does; ``reach`` is the largest deflection."""
        first, other = (self._pointwise(effect, share * reach, (size, size)) for share, size in ((0.1, 1.0), (0.6, 2.0)))
        return self.average(first) if np.array_equal(first, other) else None

    def _pointwise(self, effect: AbstractEffect, half_play: float, joint: tuple[float, float]) -> np.ndarray:
        dy, dx = self._smooth_speeds()
        deflection = _dead_zone(self.z, half_play)
        contact = (np.abs(self.z) > half_play).astype(float)
        moved = self._record.t, self.y, dy, self.x, dx, self.z, dy - dx, deflection, contact
        now = Instant(*moved, np.asarray(joint[0]), np.ones(()), damping=np.asarray(joint[1]))
        return exerted(effect, now)

    def _smooth_speeds(self) -> tuple[np.ndarray, np.ndarray]:
        if self._speeds is None:
            t, window = self._record.t, span(self._record.dt)
            spline = [
                fit_spline(t, v, t[0], window / choose_intervals(t, v, window)) if np.any(v) else None for v in (self.y, self.x)
            ]
            dy, dx = (np.zeros_like(self.y) if f is None else f(t, 1) for f in spline)
            self._speeds = dy, dx
        return self._speeds
