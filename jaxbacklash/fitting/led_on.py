"""Where a law remembers: windows begun anew with what the one before has left in memory.

What is remembered is in no record. A guess of it may be so far off, and a fit that let its windows go may have left such jumps in
it, that no search closes the gap, or that it loses other windows over it. But a law forgets: what the window before ends with is
nearer, whatever that one began with. A record's first window has none before it: it begins where its samples lead, at rest.
"""

from __future__ import annotations

import numpy as np

from ..shooting.levenberg import Levenberg, Minimum, minimise
from ..shooting.problem import Problem, Unknowns
from .handed_on import WORSE, begun, led_in, squares_of
from .setup import at_rest

LEADS, GAIN = 8, 0.01
"""How often windows are begun anew at most, what one remembers reaching one more each time; and the share of half the sum of
squares that this has to gain to go on."""


def led_on(problem: Problem, begin: Unknowns, follows: np.ndarray) -> Unknowns:
    """The same unknowns with better starts, as they are where nothing is remembered or no start does better.

    Parameters
    ----------
    problem : its parameters frozen, its windows tied as they are going to be scored
    begin : where a search of the starts would begin
    follows : (W,) whether each window goes on from the one before it, tied or not
    """
    if begin.starts.shape[0] == 2:
        return begin
    best = _run(problem, begin)
    led = _first_led_in(problem, best, ~follows)
    at = best if led is best.value else _run(problem, led)
    for _ in range(LEADS):
        before, at = at, _run(problem, _passed_on(at, follows))
        best = min(best, before, at, key=_cost)
        if not _cost(at) < (1.0 - GAIN) * _cost(before):
            break
    return best.value


def _run(problem: Problem, begin: Unknowns) -> Minimum:
    return minimise(problem, begin, Levenberg(limit=1))


def _cost(run: Minimum) -> float:
    return float(np.nan_to_num(run.stats["cost"], nan=np.inf))


def _first_led_in(problem: Problem, at: Minimum, first: np.ndarray) -> Unknowns:
    """First windows that clearly miss begun where their samples lead, with nothing to remember but that."""
    w = problem.windows
    samples = np.sum(np.asarray(w.weight) > 0.0, axis=1)
    bad = np.flatnonzero(first & ~(squares_of(problem, at) <= WORSE * samples))
    if not bad.size or problem.system.observed == "T":
        return at.value
    starts = led_in(problem, at, bad)
    starts[2:, bad] = at_rest(w, problem.system, starts[0], starts[1])[2:, bad]
    return begun(at, starts)


def _passed_on(at: Minimum, follows: np.ndarray) -> Unknowns:
    """What each window remembers is what the one before ends with; the motion is in the record, and stays."""
    starts, ends = np.array(at.value.starts), np.asarray(at.stats["predicted"].end)[:-1].T
    passed = follows[1:] & np.all(np.isfinite(ends), axis=0)
    starts[2:, 1:] = np.where(passed, ends[2:], starts[2:, 1:])
    return begun(at, starts)
