"""The way through smooth friction that the search on free windows takes; it goes with that search."""

from __future__ import annotations

from .friction_homotopy import with_friction_widths as softened
from .problem import Problem, Unknowns
from .search import TIES, tie_windows

NARROWER = ((0.03, 0.01, 0.003, 0.001, 0.0003), (0.3, 0.1, 0.03, 0.01, 0.003))
"""The range in which the sign turns, one after the other, in parts of the speed at which friction slides: two ways, the first
near what it is to lead to, the other from farther off."""
STEPS = 20
"""Steps of the search at each of them: it need not arrive."""


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
