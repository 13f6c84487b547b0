"""Windows whose start has stuck begin again where the window before has ended, or the first of a record where its samples lead.

A window is fitted from where the smoothed data put the link. Where the link is knocked about in its play, a start a little
off may meet the other edge first, and no small step leads back: one window of many then misses by far, and pulls the
parameters with it. The windows beside it know better where the link was. A record's first window has none before it, and its
start was read off the end of a spline, where that is worst: curves through its first samples are tried instead.
"""

from __future__ import annotations

import itertools

import equinox as eqx
import numpy as np

from .levenberg import Levenberg, Minimum, minimise
from .setup import read_through
from .shooting import Problem, Unknowns, weighed

WORSE, MATTERS, FEW = 5.0, 0.01, 0.05
"""A window has stuck that misses by so many times the median square; it matters where such windows hold that share of all misfit,
and is an exception as long as they are no more than that share of all."""
ROUNDS = 4
CURVES, STRETCHES = (1, 2, 3), (2, 4, 8)
"""Degrees of the curves that are laid through the first samples of a window, and the parts of it that they are laid through."""


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
        on = follows(problem)[stuck]
        starts = led_in(problem, found, stuck[~on])
        starts[:, stuck[on]] = np.asarray(found.stats["predicted"].end)[stuck[on] - 1].T
        again = minimise(problem, begun(found, starts), how)
        taken += int(again.stats["steps"])
        if not float(again.stats["cost"]) < float(found.stats["cost"]):
            break
        found = again
    return found, taken


def stuck_windows(problem: Problem, found: Minimum) -> np.ndarray:
    """Windows that have stuck where the one before has not, or that none comes before, none where they are not what matters."""
    squares = squares_of(problem, found)
    full = np.flatnonzero(np.sum(np.asarray(problem.windows.weight) > 0.0, axis=1) > 0)
    if not full.size or not np.all(np.isfinite(squares[full])):
        return np.zeros(0, int)
    bad = np.zeros(squares.size, bool)
    bad[full] = squares[full] > WORSE * np.median(squares[full])
    if np.sum(bad) > FEW * full.size or np.sum(squares[bad]) < MATTERS * np.sum(squares):
        return np.zeros(0, int)
    on = follows(problem)
    leads = on & ~np.concatenate([[True], bad[:-1]])
    # Where a link is that is not in the record cannot be read off it.
    first = ~on & (problem.system.observed != "T")
    return np.flatnonzero(bad & (leads | first))


def led_in(problem: Problem, found: Minimum, first: np.ndarray) -> np.ndarray:
    """Starts (n, W) in which those of the ``first`` windows of records are the best that curves through their samples lead to."""
    w = problem.windows
    starts = np.array(found.value.starts)
    if not first.size:
        return starts
    length = w.measured.shape[1]
    link = np.asarray(w.measured)[first]
    if problem.system.observed == "z":
        link = link + np.asarray(found.stats["predicted"].input)[first, :length]
    t = float(w.panel) * w.every * np.arange(length)
    least = np.full(first.size, np.inf)
    for degree, part in itertools.product(CURVES, STRETCHES):
        samples = length // part
        if samples <= degree + 1:
            continue
        tried = np.array(found.value.starts)
        tried[:2, first] = np.polynomial.polynomial.polyfit(t[:samples], link[:, :samples].T, degree)[:2]
        tried[:, first] = read_through(w, tried, problem.system)[:, first]
        squares = squares_of(problem, minimise(problem, begun(found, tried), Levenberg(limit=1)))[first]
        squares = np.nan_to_num(squares, nan=np.inf)
        better = squares < least
        starts[:, first[better]], least = tried[:, first[better]], np.minimum(squares, least)
    return starts


def squares_of(problem: Problem, found: Minimum) -> np.ndarray:
    """Sum of the squares of what each window misses by, in units of the noise (W,)."""
    w = problem.windows
    missed = np.asarray(weighed(np.asarray(found.stats["predicted"].motion) - np.asarray(w.measured), np.asarray(w.weight)))
    with np.errstate(over="ignore", invalid="ignore"):  # a motion that ran away is no exception
        return np.asarray(np.sum(missed**2, axis=1))


def follows(problem: Problem) -> np.ndarray:
    """Whether each window goes on from the one before it (W,)."""
    return np.concatenate([[False], np.asarray(problem.windows.tie)[:-1] > 0.0])


def begun(found: Minimum, starts: np.ndarray) -> Unknowns:
    """The unknowns of a fit with other starts (n, W)."""
    return eqx.tree_at(lambda u: u.starts, found.value, starts)
