"""Windows whose start has stuck begin again where the window before has ended.

A window is fitted from where the smoothed data put the link. Where the link is knocked about in its play, a start a little
off may meet the other edge first, and no small step leads back: one window of many then misses by far, and pulls the
parameters with it. The windows beside it know better where the link was.
"""

from __future__ import annotations

import equinox as eqx
import numpy as np

from .levenberg import Levenberg, Minimum, minimise
from .shooting import Problem

WORSE, MATTERS, FEW = 20.0, 0.05, 0.05
"""A window has stuck that misses by so many times the median square; it matters where such windows hold that share of all misfit,
and is an exception as long as they are no more than that share of all."""
ROUNDS = 4


def handed_on(problem: Problem, found: Minimum, how: Levenberg) -> tuple[Minimum, int]:
    """A fit of free windows, searched once more from better starts as long as a few of its windows hold much of the misfit, and
    the steps that took.

    Parameters
    ----------
    problem : as it was searched
    found : where the search ended
    how : how it went, and goes on
    """
    taken = 0
    for _ in range(ROUNDS):
        stuck = stuck_windows(problem, found)
        if not stuck.size:
            break
        starts = np.array(found.value.starts)
        starts[:, stuck] = np.asarray(found.stats["predicted"].end)[stuck - 1].T
        again = minimise(problem, eqx.tree_at(lambda u: u.starts, found.value, starts), how)
        taken += int(again.stats["steps"])
        if not float(again.stats["cost"]) < float(found.stats["cost"]):
            break
        found = again
    return found, taken


def stuck_windows(problem: Problem, found: Minimum) -> np.ndarray:
    """Windows that have stuck where the one before has not, none where they are not what matters."""
    w = problem.windows
    missed = (np.asarray(found.stats["predicted"].motion) - np.asarray(w.measured)) * np.asarray(w.weight)
    with np.errstate(over="ignore", invalid="ignore"):  # a motion that ran away is no exception
        squares = np.sum(missed**2, axis=1)
    full = np.flatnonzero(np.sum(np.asarray(w.weight) > 0.0, axis=1) > 0)
    if not full.size or not np.all(np.isfinite(squares[full])):
        return np.zeros(0, int)
    bad = np.zeros(squares.size, bool)
    bad[full] = squares[full] > WORSE * np.median(squares[full])
    if np.sum(bad) > FEW * full.size or np.sum(squares[bad]) < MATTERS * np.sum(squares):
        return np.zeros(0, int)
    follows = np.concatenate([[False], np.asarray(w.tie)[:-1] > 0.0])
    return np.flatnonzero(bad & follows & ~np.concatenate([[True], bad[:-1]]))
