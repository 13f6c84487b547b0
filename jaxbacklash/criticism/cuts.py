"""Where a trajectory is cut that a tied search cannot follow through.

Dry friction that all but holds the link leaves ties that no step gets across: a little more of anything, and the link comes free
a moment earlier or later. The few windows where that happens are let go, each with a start of its own; all the others stay one
trajectory, which tells so much more of small effects than free windows do.
"""

from __future__ import annotations

import equinox as eqx
import numpy as np

from ..fitting.levenberg import Levenberg, Minimum, minimise
from ..fitting.problem import Problem, Unknowns
from ..fitting.score import kept_residuals
from ..fitting.search import TIES, tie_windows
from ..fitting.setup import first_guess
from .workbench import PATIENCE, Trial, Workbench

OFF = 25.0
"""A window that a tie makes miss by so much more, in squares of the noise, is one the search does not get through: where the
model is right a tie costs one or two."""
WORST = 0.03
"""Share of the worst miss from which on a window is let go in the same round: what one tie holds up bends those around it."""
ROUNDS = 8
SHARE = 0.25
"""Largest share of the ties that may be cut: beyond it free windows tell nearly as much."""


def cut_free(bench: Workbench, free: Trial) -> np.ndarray | None:
    """Which windows remain tied to the next, (W,) ones and zeros, where a tied search from a model's free windows sticks.

    Rounds of a short tied search from the free fit, after each of which the windows that it could not carry are let go.

    Returns
    -------
    None where the search gets nowhere by that, or where too little would remain tied
    """
    problem, _ = bench.problem(bench.effects(free), free.system)
    begin = Unknowns(first_guess(problem).theta, free.unknowns.starts, free.unknowns.coefficients)
    alone, _ = _misses(problem, minimise(problem, begin, Levenberg(limit=1)))
    whole = np.asarray(bench.windows.tie)
    ties = whole.copy()
    for _ in range(ROUNDS):
        problem = eqx.tree_at(lambda p: p.windows.tie, problem, ties)
        tied, solution, _ = tie_windows(problem, begin, TIES[0], limit=PATIENCE)
        own, jumps = _misses(tied, solution)
        excess = own - alone
        least = max(OFF, WORST * float(max(np.max(excess), np.max(jumps))))
        behind, torn = excess > least, jumps > 0.5 * least
        if not np.all(np.isfinite(own)) or not np.any(behind | torn):
            break
        ties = np.where(torn | behind | np.roll(behind, -1), 0.0, ties)
        if np.sum(whole - ties) > SHARE * np.sum(whole):
            return None
    return None if np.array_equal(ties, whole) else ties


def _misses(problem: Problem, solution: Minimum) -> tuple[np.ndarray, np.ndarray]:
    """Each window's sum of squares, (W,), and that of its tie to the next, in units of the noise."""
    squares = [np.asarray(r) ** 2 for r in kept_residuals(problem, solution.value, solution.stats["predicted"])]
    motion, measured, ties = (np.sum(s, axis=1) for s in squares)
    return motion + measured, ties
