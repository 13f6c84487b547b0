"""A problem whose dry friction is spread over a range of speed, for a search that has stuck at the corners of the dry one.

Whether a link that friction holds comes loose at some moment is decided by a hair, and where it is decided the misfit has a
corner. A search stands still there, though beyond the next corner it would go on. Friction whose sign turns over a range of
speed holds nothing quite and has no corners; narrowed step by step, it leads to a trajectory that dry friction can follow.
"""

from __future__ import annotations

from dataclasses import replace

import equinox as eqx
import numpy as np

from ..parameters import values
from .problem import Problem, Unknowns
from .search import TIES, tie_windows

NARROWER = ((0.03, 0.01, 0.003, 0.001, 0.0003), (0.3, 0.1, 0.03, 0.01, 0.003))
"""The range in which the sign turns, one after the other, in parts of the speed at which friction slides: two ways, the first
near what it is to lead to, the other from farther off."""
STEPS = 20
"""Steps of the search at each of them: it need not arrive."""


def softened(problem: Problem, widths: dict[str, float]) -> Problem:
    """The same problem, its dry friction with the sign turning over ``widths`` [rad/s], by name of the law.

    A user's own law that states no ``width`` softens its sign in its own way.
    """
    names = list(values(problem.system))
    base = np.array(problem.base, dtype=float)
    for law, width in widths.items():
        if f"{law}.width" in names:
            base[names.index(f"{law}.width")] = width
    # Spread at both ports: so is friction that is only judged, and no other program is compiled.
    spread = eqx.tree_at(lambda p: p.base, problem, base)
    return replace(spread, system=replace(problem.system, smoothed=("joint", "ground")))


def through_softened(problem: Problem, unknowns: Unknowns, speeds: dict[str, float], way: int) -> Unknowns:
    """Where a tied search through softened friction leads, from where it has stuck.

    Parameters
    ----------
    problem : with dry friction in its system
    unknowns : where its search stands
    speeds : at which each law of dry friction slides, root mean square [rad/s], by its name
    way : which of the two it takes
    """
    for share in NARROWER[way]:
        soft = softened(problem, {law: share * speed for law, speed in speeds.items()})
        unknowns = tie_windows(soft, unknowns, TIES[0], limit=STEPS)[1].value
    return unknowns
