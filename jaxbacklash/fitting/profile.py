"""Profile likelihood: how far a parameter can move before the misfit, minimised over everything else, has grown too much."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

import equinox as eqx
import numpy as np

from ..shooting.levenberg import Levenberg, minimise
from ..shooting.problem import Problem, Unknowns
from .estimates import NORMAL_95, Estimate


def with_profiles(
    problem: Problem,
    unknowns: Unknowns,
    estimates: dict[str, Estimate],
    free: Sequence[str],
    stderr: dict[str, float],
    progress: Callable[[str, float], None],
) -> dict[str, Estimate]:
    """The estimates with 95 % intervals from the profile likelihood where a value was found."""
    found = dict(estimates)
    for j, name in enumerate(free):
        if estimates[name].value is None or not np.isfinite(stderr[name]):
            continue
        progress(f"profile of {name}", 0.86 + 0.1 * j / len(free))
        found[name] = dataclasses.replace(estimates[name], profile95=interval(problem, unknowns, j, stderr[name]))
    return found


def interval(problem: Problem, unknowns: Unknowns, j: int, stderr: float) -> tuple[float, float]:
    """95 % interval of free parameter ``j``: where twice the cost has risen by 3.84 (1.96 squared) above its minimum.

    Parameters
    ----------
    problem, unknowns : a problem at its minimum
    j : index of the parameter among the free ones
    stderr : its standard error, in its own unit, to know where to look
    """
    # At a tighter stop than a fit's: differences of the cost are what counts here.
    solver = Levenberg(atol=1e-5)
    scale = float(np.sum(problem.directions[:, j]))
    centre = float(np.sum(np.where(problem.directions[:, j] != 0.0, problem.parameters(unknowns.theta), 0.0)))
    others = np.arange(problem.shrink.size) != j
    held = eqx.tree_at(lambda p: (p.directions, p.shrink), problem, (problem.directions * others, problem.shrink & others))

    def cost(shift: float) -> float:
        base = problem.base + problem.directions[:, j] * (unknowns.theta[j] + shift / scale)
        moved = eqx.tree_at(lambda p: p.base, held, base)
        start = Unknowns(unknowns.theta * others, unknowns.starts, unknowns.coefficients)
        return 2.0 * float(minimise(moved, start, solver).stats["cost"])

    from scipy.optimize import brentq  # a seventh of a second to import, and few fits need it

    least = cost(0.0)

    def excess(shift: float) -> float:
        return cost(shift) - least - NORMAL_95**2

    ends = []
    for sign in (-1.0, 1.0):
        reach = NORMAL_95 * stderr
        for _ in range(6):
            if excess(sign * reach * 1.15) > 0.0:
                break
            reach *= 1.5
        ends.append(sign * brentq(lambda s, sign=sign: excess(sign * s), 0.0, 1.15 * reach, xtol=0.01 * stderr))
    return centre + ends[0], centre + ends[1]
