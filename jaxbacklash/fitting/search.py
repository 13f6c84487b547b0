r"""The search for a minimum: cheaply on a stretch of the record, then on all of it, then with its windows tied."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import equinox as eqx
import numpy as np

from ..errors import NoAnswer
from ..shooting.levenberg import Levenberg, Minimum, minimise
from ..shooting.problem import Problem, Unknowns
from ..shooting.windows import Windows
from ..system import System
from .handed_on import handed_on
from .setup import first_guess, make_problem
from .stick_slip import correlation, search_stick_slip, sticks_and_slips
from .stretch import excess_of, stretch, told

LOOSE = 2.5
"""A run along the smoothed base motion may miss by this much before the base motion is let free within its noise."""
ADEQUATE = 1.25
"""Windows are tied into one trajectory only where the untied misfit is below this many noises: else the model is wrong."""
TIES = ((100.0,), (1.0, 100.0), (1.0,))
"""How sharply windows are tied, in turn, and what is tried next where that fails: sharply at once; a loose tie to find the
trajectory and a sharp one to make it one; the loose one alone."""


SOON, FAR_OFF = 20, 10.0
"""Steps after which a search with sharply tied windows is given up if it misses by so many noises still: what will join has come
near, or is on its way."""
NEAR, CLOSE = 0.1, 1e-3
"""How near to the minimum a search comes that is not the last, and the last, as `Levenberg.atol`."""

NOWHERE = "no start led to a finite misfit: the record may hold something else than this model's motion"


def silent(stage: str, share: float) -> None:
    """Tell nobody how far the work is."""


@dataclass(frozen=True)
class Found:
    """Where a search ended; ``covariance`` (q, q) in the parameters' own units, of the noise alone; ``correlation`` how many
    samples of the residual count for one, told of runs in one piece that the model does not explain."""

    problem: Problem
    unknowns: Unknowns
    covariance: np.ndarray
    cost: float
    agreeing: int
    tried: int
    tied: bool
    steps: int
    correlation: float = 1.0

    def again(self, problem: Problem) -> Found:
        """The search gone on with from where it ended, for the same problem with other weights."""
        how = Levenberg(atol=CLOSE, damping=1e-9) if self.tied else Levenberg()
        best = minimise(problem, self.unknowns, how)
        steps = self.steps + int(best.stats["steps"])
        return replace(
            self, problem=problem, unknowns=best.value, covariance=_covariance(problem, best), cost=float(best.stats["cost"]),
            steps=steps,
        )  # fmt: skip


def search(
    system: System,
    windows: Windows,
    free: Sequence[str],
    *,
    starts: int,
    seed: int,
    rough: bool = True,
    progress: Callable[[str, float], None] = silent,
) -> Found:
    """Minimise the misfit over free windows from several starts, then tie the best one's windows into one trajectory.

    ``rough`` says that the values to start from may be far off: then a stretch of the record is searched first.
    """
    problem = make_problem(system, windows, free)
    if sticks_and_slips(system):
        return _search_stick_slip(problem, free, starts=starts, seed=seed, progress=progress)
    best, steps, agreeing, tried = _from_starts(problem, first_guess(problem), max(1, starts), seed, rough, progress)
    cost = float(best.stats["cost"])
    tied = False
    if np.sqrt(2.0 * cost / freedom(problem)) < ADEQUATE:
        progress("tying the windows into one trajectory", 0.7)
        for ties in TIES:
            joined, solution, taken = tie_windows(problem, best.value, ties)
            steps += taken
            after = float(solution.stats["cost"])
            # Tied windows may disagree where a chaotic record and a slightly wrong model part ways; then they stay apart.
            if np.sqrt(2.0 * after / freedom(problem, tied=True)) < ADEQUATE:
                best, problem, cost, tied = solution, joined, after, True
                break
    if not tied:
        best = minimise(problem, best.value, Levenberg())
        cost, steps = float(best.stats["cost"]), steps + int(best.stats["steps"])
    return Found(problem, best.value, _covariance(problem, best), cost, agreeing, tried, tied, steps)


def _covariance(problem: Problem, best: Minimum) -> np.ndarray:
    scale = np.sum(np.asarray(problem.directions), axis=0)
    return np.asarray(inverse_information(np.asarray(best.stats["schur"])) * np.outer(scale, scale))


def _from_starts(
    problem: Problem, guess: Unknowns, starts: int, seed: int, rough: bool, progress: Callable[[str, float], None]
) -> tuple[Minimum, int, int, int]:
    """Free windows from several starts: the best solution, the steps taken, and how many starts agree of how many tried.

    They are compared on a stretch of the record where it tells all parameters, and only the best goes on to the whole.
    """
    steps = 0
    short = stretch(problem, guess) if rough or starts > 1 else (None, guess)
    for part, begin in (short, (problem, guess)):
        if part is None:
            continue
        arrived = _arrive(part, begin, starts, seed, progress)
        steps += sum(int(one.stats["steps"]) for one in arrived[:1])
        if not arrived or (part is not problem and not told(arrived[0], part)):
            continue
        best, excess = arrived[0], excess_of(arrived[0], part)
        agreeing = sum(float(one.stats["cost"] - best.stats["cost"]) < 2.0 * excess for one in arrived)
        if part is not problem:
            progress("fitting, the whole record", 0.55)
            whole = eqx.tree_at(lambda u: u.theta, guess, best.value.theta)
            best = minimise(problem, whole, Levenberg(atol=NEAR))
            steps += int(best.stats["steps"])
        best, taken = handed_on(problem, best, Levenberg(atol=NEAR))
        steps += taken
        if np.isfinite(best.stats["cost"]):
            return best, steps, agreeing, len(arrived)
    raise NoAnswer(NOWHERE)


def _arrive(problem: Problem, guess: Unknowns, starts: int, seed: int, progress: Callable[[str, float], None]) -> list[Minimum]:
    """Where each start arrives, the best first."""
    rng = np.random.default_rng(seed)
    arrived = []
    for attempt in range(starts):
        progress(f"fitting, start {attempt + 1} of {starts}", 0.05 + 0.5 * attempt / starts)
        begin = eqx.tree_at(lambda u: u.theta, guess, _elsewhere(problem, rng)) if attempt else guess
        arrived.append(minimise(problem, begin, Levenberg(atol=NEAR)))
    return sorted((one for one in arrived if np.isfinite(one.stats["cost"])), key=lambda one: float(one.stats["cost"]))


def _elsewhere(problem: Problem, rng: np.random.Generator) -> np.ndarray:
    """Another point to start from: values that must keep their sign move by up to a factor of 1.6; others by a little of
    their scale."""
    shift = rng.uniform(-0.4, 0.6, problem.directions.shape[1]) * np.where(problem.shrink, 1.0, 0.3)
    return np.clip(shift, problem.lower, problem.upper)


def _search_stick_slip(
    problem: Problem, free: Sequence[str], *, starts: int, seed: int, progress: Callable[[str, float], None]
) -> Found:
    """`search` for a link that friction holds: one run through the record from each starting point, then, where the model is
    adequate, the input moves with it."""
    rng = np.random.default_rng(seed)
    tried = []
    for attempt in range(max(1, starts)):
        said = f"fitting, start {attempt + 1} of {max(1, starts)}"
        progress(said, 0.05 + 0.6 * attempt / max(1, starts))
        theta = _elsewhere(problem, rng) if attempt else np.zeros(len(free))
        tried.append(search_stick_slip(problem, theta, limit=30 if not attempt else 15))
    tried = [entry for entry in tried if np.isfinite(entry[1]["cost"])]
    if not tried:
        raise NoAnswer(NOWHERE)
    unknowns, seen, steps = min(tried, key=lambda entry: float(entry[1]["cost"]))
    cost = float(seen["cost"])
    w = problem.windows
    count = freedom(problem, tied=True)
    agreeing = sum(float(entry[1]["cost"]) - cost < 0.01 * cost for entry in tried)
    tied = eqx.tree_at(lambda p: p.tie, problem, np.asarray(TIES[0][-1]))
    adequate = np.sqrt(2.0 * cost / count) < LOOSE
    if adequate:
        progress("letting the base motion follow its own noise", 0.75)
        joined, solution, taken = tie_windows(problem, unknowns, TIES[0], limit=20)
        after = float(solution.stats["cost"])
        if after < cost:
            tied, unknowns, seen, cost, steps = joined, solution.value, solution.stats, after, steps + taken
        adequate = np.sqrt(2.0 * cost / count) < ADEQUATE
    residual = np.asarray(seen["predicted"].motion) - np.asarray(w.measured)
    pieces = 1.0 if adequate else correlation(residual, np.asarray(w.weight))
    scale = np.sum(np.asarray(problem.directions), axis=0)
    covariance = inverse_information(np.asarray(seen["schur"])) * np.outer(scale, scale)
    return Found(tied, unknowns, covariance, cost, agreeing, len(tried), True, steps, pieces)


def tie_windows(
    problem: Problem, unknowns: Unknowns, ties: Sequence[float], *, limit: int = 60, near: float = CLOSE
) -> tuple[Problem, Minimum, int]:
    """Tie the windows as sharply as ``ties`` say, one after the other: the tied problem, its solution, the steps taken.

    ``near`` is how near to the minimum it comes, as `Levenberg.atol`.
    """
    steps = 0
    for tightness in ties:
        problem = eqx.tree_at(lambda p: p.tie, problem, np.asarray(tightness))
        solution = _tied(problem, unknowns, SOON if len(ties) == 1 and limit > 2 * SOON else limit, limit, near)
        unknowns, steps = solution.value, steps + int(solution.stats["steps"])
    return problem, solution, steps


def _tied(problem: Problem, unknowns: Unknowns, soon: int, limit: int, near: float) -> Minimum:
    """A search with tied windows that is ``given_up``, as its stats then say, if after ``soon`` steps it is far off still."""
    # Free windows end close to the tied ones: a damped step would only fight the ties, which are stiff.
    first = minimise(problem, unknowns, Levenberg(atol=near, damping=1e-9, limit=soon))
    if soon == limit or int(first.stats["steps"]) < soon:
        return first
    if not float(first.stats["cost"]) < 0.5 * FAR_OFF**2 * freedom(problem, tied=True):
        return Minimum(first.value, {**first.stats, "given_up": True})
    # Where corners hold a search, beginning undamped again leads on: going on as damped as it was ends higher.
    rest = minimise(problem, first.value, Levenberg(atol=near, damping=1e-9, limit=limit - soon))
    return Minimum(rest.value, {**rest.stats, "steps": rest.stats["steps"] + soon})


def freedom(problem: Problem, *, tied: bool = False) -> float:
    """Samples less the unknowns: each window's own spline coefficients and, unless it is tied to the one before, its start.

    What a law remembers is tied even where the motion is not. An input as good as exact has no noise to show: neither its samples
    nor what its spline takes of them count.
    """
    windows = problem.windows
    samples = float(np.sum(np.asarray(windows.weight) > 0.0))
    moving = float(np.sum(np.asarray(windows.input_weight) > 0.0))
    used = float(np.sum(np.any(np.asarray(windows.weight) > 0.0, axis=1)))
    first = used - float(np.sum(np.asarray(windows.tie)))
    starts = sum(first if tied or np.isfinite(reach) else used for reach in problem.system.reach)
    return samples + float(windows.told) * (moving - used * windows.intervals) - starts


def misfit(found: Found) -> float:
    """Prediction error of where a search ended, in units of the noise."""
    return float(np.sqrt(2.0 * found.cost / freedom(found.problem, tied=found.tied)))


def inverse_information(schur: np.ndarray) -> np.ndarray:
    """Covariance from information, (q, q): infinite for what shows nowhere, the pseudo-inverse for what only a sum determines."""
    scale = np.sqrt(np.maximum(np.diag(schur), 0.0))
    alive = scale > 0.0
    inverse = np.full(schur.shape, 0.0)
    inverse[np.diag_indices_from(inverse)] = np.inf
    if np.any(alive):
        core = schur[np.ix_(alive, alive)] / np.outer(scale[alive], scale[alive])
        inverse[np.ix_(alive, alive)] = np.linalg.pinv(core, rcond=1e-14, hermitian=True) / np.outer(scale[alive], scale[alive])
    return inverse
