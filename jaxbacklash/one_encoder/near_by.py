"""The way to the neighbourhood of a drive of which one side is not seen: by segments of its record.

Where one side is hidden a search may end with a window whose hidden start lies beyond an edge that it should not have crossed.
So a segment is fitted a few steps at a time, each time from hidden starts that the filter finds anew with the model found so far
(`carried`); where that does not lead to the noise, with looser ties at first. A try that leaves more
than noise is followed by one on another segment from where it came to, and by others from what the filter finds likeliest of
many parameters drawn at random. `jaxbacklash.fitting.search` asks, and goes on with the whole record.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..parameters import values
from ..shooting.information import freedom
from ..shooting.levenberg import Minimum
from ..shooting.problem import Problem, Unknowns
from .carried import filtered

BRISK, TURNS, FEW = 3e-3, 3, 15
"""Weight of the ties with which a segment is brought near, how often from starts found anew, and the steps of each: of the
weights from 1e-3 to 1e-2 that with which most of twelve random rigs came to the noise in two turns."""
TIES, MANY = (1e-3, 1e-2), 60
"""Weights of the ties where that did not lead to the noise, and the steps of each fit."""
LINK_TURNS = 24
"""Turns in which second links are found: the windows may be at the noise before the parameters are where they belong."""
TRIES = 5
"""Beginnings at most."""
DRAWN, KEPT_BEST = (96, 32, 32, 32), 4
"""How many parameters are drawn in each turn, and the best of them near to which the next are drawn."""
ROAM = {"inertia": 1.6, "backlash": 10.0, "stiffness": 12.0, "damping": 5.0}
NEARBY = {"inertia": 1.5, "backlash": 2.0, "stiffness": 3.0, "damping": 2.0}
"""Factors by which parameters are drawn where nothing is known of the joint, and where something is."""


@dataclass(frozen=True)
class Means:
    """What the search works with: ``segment`` cuts the best or next best part out of a problem with its first guess; ``fitted``
    fits one with ties of a weight from unknowns in at most so many steps; ``enough`` is the reduced chi-square near the noise."""

    segment: Callable[[Problem, Unknowns, int], tuple[Problem, Unknowns] | None]
    fitted: Callable[[Problem, float, Unknowns, int], Minimum]
    enough: float


def near_by(
    problem: Problem,
    guess: Unknowns,
    free: Sequence[str],
    rng: np.random.Generator,
    progress: Callable[[str, float], None],
    means: Means,
    tries: int = TRIES,
) -> tuple[Unknowns, int]:
    """Unknowns of the whole record near the minimum, and the steps that led there.

    Parameters
    ----------
    problem : of a drive with one encoder
    guess : where to begin
    free : names of the free parameters
    rng : of other parameters to begin from
    progress : told the stage in words and the share of the work done
    means : how a part is cut out and fitted
    tries : how many beginnings at most
    """
    best, least, steps, roams = guess.theta, np.inf, 0, "motor" not in problem.system.channels
    for attempt in range(tries):
        progress(f"looking for the side that is not seen, try {attempt + 1}", 0.05 + 0.4 * attempt / tries)
        part, start = means.segment(problem, guess, attempt % 2) or (problem, guess)
        # A motor that is not seen has no other start; else the second try begins where the first came to, the others elsewhere.
        if attempt == 1 and not roams:
            start = _carried_on(part, np.asarray(best))
        elif attempt or roams:
            start = _carried_on(part, likeliest(part, free, rng, ROAM if roams else NEARBY))
        ended, taken = _tightened(part, start, means)
        steps += taken
        left = _left(ended, part)
        if left < least:
            best, least = ended.value.theta, left
        if left < means.enough:
            break
    return _carried_on(problem, np.asarray(best)), steps


def in_turns(problem: Problem, guess: Unknowns, means: Means) -> tuple[Unknowns, int]:
    """Unknowns near the minimum of a joint with second links that nothing shows, and the steps that led there.

    In turns the windows are fitted, with ties that are tightened, and the hidden starts found anew by the filter: while a second
    link is in its play nothing shows where it is, so that a start on the wrong side stays there. Arguments as of `near_by`.
    """
    least, best, steps, start = np.inf, guess, 0, guess
    for _ in range(LINK_TURNS):
        for tie in TIES:
            ended = means.fitted(problem, tie, start, FEW)
            start, steps = ended.value, steps + int(ended.stats["steps"])
        theta = np.asarray(ended.value.theta)
        starts, surprise = filtered(problem, theta)
        start = Unknowns(theta, starts, np.asarray(problem.windows.coefficients))
        if surprise < least:
            least, best = surprise, start
    for tie in TIES:
        ended = means.fitted(problem, tie, best, MANY)
        best, steps = ended.value, steps + int(ended.stats["steps"])
    return best, steps


def likeliest(part: Problem, free: Sequence[str], rng: np.random.Generator, reach: Mapping[str, float]) -> np.ndarray:
    """Parameters (q,) in units of their scale, the likeliest to the filter of many, drawn wide at first, then nearer.

    ``reach`` gives by name the factor by which a parameter may be larger or smaller than it is. What is known of a drive before
    anything else is its inertia as a whole, seen from the link; only the link's share of it is drawn.
    """
    known = dict(zip(values(part.system), map(float, part.base)))
    ratio = known["ratio"]
    whole = known["inertia"] + ratio**2 * known["motor_inertia"]
    width = np.array([np.log(reach.get(name, 1.0)) for name in free])

    def drawn(middle: np.ndarray, spread: np.ndarray) -> np.ndarray:
        theta = np.exp(middle + spread * rng.uniform(-1.0, 1.0, spread.size))
        if {"inertia", "motor_inertia"} <= set(free):
            at, other = free.index("inertia"), free.index("motor_inertia")
            link = np.clip(theta[at] * known["inertia"], 0.1 * whole, 0.9 * whole)
            theta[at], theta[other] = link / known["inertia"], (whole - link) / ratio**2 / known["motor_inertia"]
        return theta

    tried: list[tuple[float, np.ndarray]] = []
    for turn, count in enumerate(DRAWN):
        middles = [np.log(theta) for _, theta in tried[:KEPT_BEST]] or [np.zeros(width.size)]
        factors = [drawn(middles[i % len(middles)], width * 0.4**turn) for i in range(count)]
        tried += [(filtered(part, factor - 1.0)[1], factor) for factor in factors]
        tried = sorted(((np.nan_to_num(c, nan=np.inf), f) for c, f in tried), key=lambda one: one[0])
    return tried[0][1] - 1.0


def _tightened(part: Problem, start: Unknowns, means: Means) -> tuple[Minimum, int]:
    """Where a fit of some windows comes to, and its steps: a few at a time, each from hidden starts found anew; else with ties
    that are looser at first."""
    steps, best = 0, np.inf
    for _ in range(TURNS):
        ended = means.fitted(part, BRISK, start, FEW)
        steps += int(ended.stats["steps"])
        left = _left(ended, part)
        if left < means.enough:
            return ended, steps
        if left >= best:
            break
        best, start = left, _carried_on(part, np.asarray(ended.value.theta))
    for tie in TIES:
        ended = means.fitted(part, tie, start, MANY)
        steps += int(ended.stats["steps"])
        if _left(ended, part) > means.enough:
            other = means.fitted(part, tie, _carried_on(part, np.asarray(ended.value.theta)), MANY)
            steps += int(other.stats["steps"])
            ended = min(ended, other, key=lambda m: float(np.nan_to_num(m.stats["cost"], nan=np.inf)))
        start = ended.value
    return ended, steps


def _carried_on(problem: Problem, theta: np.ndarray) -> Unknowns:
    return Unknowns(theta, filtered(problem, theta)[0], np.asarray(problem.windows.coefficients))


def _left(ended: Minimum, part: Problem) -> float:
    """Reduced chi-square of what a fit leaves."""
    found = 2.0 * float(ended.stats["cost"]) / max(freedom(part, tied=True), 1.0)
    return found if np.isfinite(found) else np.inf
