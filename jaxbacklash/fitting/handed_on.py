"""Windows whose start has stuck begin again where the window before has ended, or the first of a record where its samples lead.

A window is fitted from where the smoothed data put the link. Where the link is knocked about in its play, a start a little
off may meet the other edge first, and no small step leads back: one window of many then misses by far, and pulls the
parameters with it. The windows beside it know better where the link was. A record's first window has none before it, and its
start was read off the end of a spline, where that is worst: curves through its first samples are tried instead.
"""

from __future__ import annotations

import dataclasses
import itertools

import equinox as eqx
import numpy as np

from ..shooting.levenberg import Levenberg, Minimum, minimise
from ..shooting.multiple_shooting import weighed
from ..shooting.problem import Problem, Unknowns
from .setup import read_through

WORSE, MATTERS, FEW = 5.0, 0.01, 0.05
"""A window has stuck that misses by so many times the median square; it matters where such windows hold that share of all misfit,
and is an exception as long as they are no more than that share of all."""
ASIDE, LOOK = 6.0, 5
"""A window may have stuck that misses by so many standard deviations of what noise makes of a sum of squares; whether it has is
looked at for so many steps."""
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
        begin = begun(found, led_anew(problem, found, stuck)) if stuck.size else better_led(problem, found, how)
        if begin is None:
            break
        again = minimise(problem, begin, how)
        taken += int(again.stats["steps"])
        if not float(again.stats["cost"]) < float(found.stats["cost"]):
            break
        found = again
    return found, taken


def stuck_windows(problem: Problem, found: Minimum) -> np.ndarray:
    """Windows that have stuck where the one before has not, or that none comes before, none where they are not what matters."""
    squares = squares_of(problem, found)
    bad = exceptions(problem, squares, WORSE)
    if np.sum(squares[bad]) < MATTERS * np.sum(squares):
        return np.zeros(0, int)
    # Where a link is that is not in the record cannot be read off it.
    first = ~follows(problem) & (problem.system.observed != "T")
    return np.flatnonzero(bad & (led(problem, bad) | first))


def better_led(problem: Problem, found: Minimum, how: Levenberg) -> Unknowns | None:
    """Where a search begins anew whose few windows that miss by more than noise explains go on better from where those before
    them have ended; None where they do not.

    One of two hundred that meets the wrong edge may miss by no more than twice what the others do: little of all misfit, and
    yet many times the evidence that an effect has to bring. Others only move further than the rest under what is missing, so
    a look comes first.
    """
    samples = np.sum(np.asarray(problem.windows.weight) > 0.0, axis=1)
    spread = np.sqrt(2.0 / max(1.0, float(np.median(samples[samples > 0])))) if np.any(samples) else np.inf
    bad = exceptions(problem, squares_of(problem, found), 1.0 + ASIDE * spread)
    doubtful = np.flatnonzero(bad & led(problem, bad))
    if not doubtful.size:
        return None
    look = minimise(problem, begun(found, led_anew(problem, found, doubtful)), dataclasses.replace(how, limit=LOOK))
    return look.value if float(look.stats["cost"]) < float(found.stats["cost"]) else None


def exceptions(problem: Problem, squares: np.ndarray, worse: float) -> np.ndarray:
    """Which windows (W,) miss by ``worse`` times the median square, none where they are many or one misses by no number."""
    bad = np.zeros(squares.size, bool)
    full = np.flatnonzero(np.sum(np.asarray(problem.windows.weight) > 0.0, axis=1) > 0)
    if full.size and np.all(np.isfinite(squares[full])):
        bad[full] = squares[full] > worse * np.median(squares[full])
    return bad if np.sum(bad) <= FEW * full.size else np.zeros(squares.size, bool)


def led(problem: Problem, bad: np.ndarray) -> np.ndarray:
    """Which windows (W,) go on from one that is not ``bad``."""
    return np.asarray(follows(problem) & ~np.concatenate([[True], bad[:-1]]))


def led_anew(problem: Problem, found: Minimum, stuck: np.ndarray) -> np.ndarray:
    """Starts (n, W) with those of ``stuck`` windows where the ones before have ended, or where the samples lead."""
    on = follows(problem)[stuck]
    starts = led_in(problem, found, stuck[~on])
    starts[:, stuck[on]] = np.asarray(found.stats["predicted"].end)[stuck[on] - 1].T
    return starts


def led_in(problem: Problem, found: Minimum, first: np.ndarray) -> np.ndarray:
    """Starts (n, W) in which those of the ``first`` windows of records are the best that curves through their samples lead to."""
    w = problem.windows
    starts = np.array(found.value.starts)
    if not first.size:
        return starts
    length = w.measured.shape[1]
    link = np.asarray(w.measured)[first]
    if problem.system.observed == "z" and w.intervals and not w.by_force:  # else its base is at rest
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
