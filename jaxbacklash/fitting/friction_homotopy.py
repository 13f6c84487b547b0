"""Dry friction with a width: the first stages of a homotopy that leads a search to dry friction.

Whether a link that friction holds comes loose at some moment is decided by a hair, and where it is decided the misfit has a
corner. A search stands still there, though beyond the next corner it would go on. Friction whose sign turns over a range of
speed, its width, holds nothing quite and has no corners; with ever smaller widths the trajectory goes over into that of dry
friction. `jaxbacklash.fitting.continuation` says which widths a fit goes through.
"""

from __future__ import annotations

from dataclasses import replace

import equinox as eqx
import numpy as np

from ..parameters import values
from ..shooting.problem import Problem
from .setup import relative


def with_friction_widths(problem: Problem, widths: dict[str, float]) -> Problem:
    """The same problem, its dry friction with the sign turning over ``widths`` [rad/s], by name of the law.

    A user's own law that states no ``width`` has its sign turn over a range of its own.
    """
    names = list(values(problem.system))
    base = np.array(problem.base, dtype=float)
    for law, width in widths.items():
        if f"{law}.width" in names:
            base[names.index(f"{law}.width")] = width
    # Smooth at both ports: so is friction that is only judged, and no other program is compiled.
    widened = eqx.tree_at(lambda p: p.base, problem, base)
    return replace(widened, system=replace(problem.system, smoothed=tuple(problem.system.rows)))


def sliding_speeds(problem: Problem) -> dict[str, float]:
    """Root mean square of the measured speed [rad/s] at which each law of dry friction slides, by its name."""
    w = problem.windows
    seen = np.any(np.asarray(w.weight) > 0.0, axis=1)
    y, dy, *motor = np.asarray(w.starts)
    if problem.system.motor is not None:
        ratio = float(problem.base[list(values(problem.system)).index("ratio")])
        speed = {"ground": dy, "joint": dy - motor[1] / ratio, "motor": motor[1]}
    else:
        speed = {"ground": dy, "joint": relative(w, y, dy)[1]}
    laws = problem.system.effects.items()
    return {name: float(np.sqrt(np.mean(speed[law.port][seen] ** 2))) for name, law in laws if law.slides}
