r"""The search of `fit`: from several starting points to the fit by continuation with the highest evidence.

Each starting point is fitted with windows nearly free, on a segment of the record where that determines the parameters. Points
that arrive at one place are one from there on, and each place is fitted by `jaxbacklash.fitting.continuation` to the whole
record.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import equinox as eqx
import numpy as np

from ..errors import NoAnswer
from ..once import once
from ..one_encoder.carried import one_side
from ..one_encoder.near_by import Means, in_turns, near_by
from ..shooting.information import freedom, inverse_information
from ..shooting.levenberg import Levenberg, Minimum, minimise
from ..shooting.problem import Problem, Unknowns
from ..shooting.windows import Windows
from ..system import System
from .continuation import Continued, Stop, continued, in_one_run, log_evidence, sharpened, tied, with_friction_width
from .friction_homotopy import sliding_speeds
from .left_out import misfit, most_of_noise
from .segment import determines, segment, variance_ratio
from .settings import (
    BETWEEN,
    CLOSELY,
    EXPLAINED,
    FINER,
    JOINED,
    LAST,
    LIKELY,
    LOOSE,
    LOOSEST,
    ROUGHLY,
    TIGHTEST,
    WITHIN_CHANCE,
)
from .setup import first_guess, make_problem
from .stick_slip import search_stick_slip, sticks_and_slips

UNSEEN = (
    "no motion of the motor, which no encoder sees, was found that explains the link's as one trajectory, so that no parameter "
    "can be trusted; record the motor's encoder (motor), alone or beside the link's"
)
NOWHERE = "no start led to a finite misfit: the record may hold something else than this model's motion"


def silent(stage: str, share: float) -> None:
    """Tell nobody how far the work is."""


@dataclass(frozen=True)
class Found:
    """Where a search ended: the ``fit`` with the highest evidence; how many starting points were ``tried`` and are ``agreeing``
    with it; the ``steps`` that led to it."""

    fit: Continued
    agreeing: int
    tried: int
    steps: int

    @property
    def problem(self) -> Problem:
        """The problem with the ties at which the fit ended."""
        return self.fit.problem

    @property
    def unknowns(self) -> Unknowns:
        """Parameters, starts of windows and coefficients of the input."""
        return self.fit.minimum.value

    @property
    def cost(self) -> float:
        """Half the sum of squares."""
        return float(self.fit.minimum.stats["cost"])

    @property
    def tied(self) -> bool:
        """Whether the windows are one trajectory, and nothing is left out."""
        return self.fit.tie >= TIGHTEST

    @once
    def misfit(self) -> float:
        """Root of the reduced chi-square of one trajectory, or of what would leave as much as the model leaves out."""
        return misfit(self.fit)

    @property
    def covariance(self) -> np.ndarray:
        """Covariance (q, q) in the parameters' own units, of the noise and of the torque that is left out."""
        scale = np.sum(np.asarray(self.problem.directions), axis=0)
        return np.asarray(inverse_information(np.asarray(self.fit.minimum.stats["schur"])) * np.outer(scale, scale))

    def again(self, problem: Problem) -> Found:
        """The search gone on with from where it ended, for the same problem with other weights."""
        direct = _one_trajectory(problem, self.unknowns) if self.tied else None
        found = direct or _continued(problem, self.unknowns, first=self.fit.tie)
        return Found(found, self.agreeing, self.tried, self.steps + _steps(found))


def search(
    system: System,
    windows: Windows,
    free: Sequence[str],
    *,
    starts: int,
    seed: int,
    spare: bool = False,
    rough: bool = True,
    progress: Callable[[str, float], None] = silent,
) -> Found:
    """Fit a model from several starting points.

    Parameters
    ----------
    system : with the values to start from
    windows : the records
    free : names of the free parameters
    starts, seed : how many starting points, and the seed of those after the first
    spare : the others are not tried where the first leads to one trajectory that leaves noise alone: no place is better by much
    rough : whether the values to start from may be far off: then a long record is not fitted before a segment of it
    progress : told the stage in words and the share of the work done

    Raises
    ------
    NoAnswer
        No start led to a finite misfit.
    """
    problem, starts = make_problem(system, windows, free), max(1, starts)
    if sticks_and_slips(system):
        return _stick_slip(problem, starts, seed, progress)
    guess = first_guess(problem)
    if one_side(system):
        return _one_side(problem, guess, free, seed, progress)
    if system.plays:
        return _second_links(problem, guess, progress)
    if spare and starts > 1 and (enough := _from_the_first(problem, guess, seed, progress)) is not None:
        return enough
    short = segment(problem, guess) if rough or starts > 1 else None
    arrived: list[Minimum] = []
    if short is not None:
        arrived = _arrivals(*short, starts, seed, progress)
        if not arrived or not determines(arrived[0], short[0]):
            short = None
    if short is None:
        arrived = _arrivals(problem, guess, starts, seed, progress)
    if not arrived:
        raise NoAnswer(NOWHERE)
    places = _places(arrived, problem if short is None else short[0])
    progress("fitting, the whole record", 0.55)
    ends = []
    for place, count in places:
        begin = place.value if short is None else eqx.tree_at(lambda u: u.theta, guess, place.value.theta)
        found = _one_trajectory(problem, begin) or _continued(problem, begin)
        ends.append((found, count, int(place.stats["steps"]) + _steps(found)))
    best, _, steps = max(ends, key=lambda end: end[0].log_evidence)
    if not np.isfinite(best.log_evidence):
        raise NoAnswer(NOWHERE)
    agreeing = sum(count for found, count, _ in ends if best.log_evidence - found.log_evidence < WITHIN_CHANCE)
    return Found(best, agreeing, len(arrived), steps)


def _from_the_first(problem: Problem, guess: Unknowns, seed: int, progress: Callable[[str, float], None]) -> Found | None:
    """Where the first starting point leads to, if that is one trajectory that leaves noise alone."""
    arrived = _arrivals(problem, guess, 1, seed, progress)
    found = _one_trajectory(problem, arrived[0].value) if arrived else None
    if found is None or not np.isfinite(found.log_evidence):
        return None
    return Found(found, 1, 1, int(arrived[0].stats["steps"]) + _steps(found))


def _arrivals(problem: Problem, guess: Unknowns, starts: int, seed: int, progress: Callable[[str, float], None]) -> list[Minimum]:
    """Where each starting point arrives with windows nearly free, the best first."""
    rng = np.random.default_rng(seed)
    at, arrived = tied(problem, LOOSEST), []
    for attempt in range(starts):
        progress(f"fitting, start {attempt + 1} of {starts}", 0.05 + 0.5 * attempt / starts)
        begin = eqx.tree_at(lambda u: u.theta, guess, _elsewhere(problem, rng)) if attempt else guess
        arrived.append(minimise(at, begin, Levenberg(limit=BETWEEN, atol=ROUGHLY)))
    return sorted((one for one in arrived if np.isfinite(one.stats["cost"])), key=lambda one: float(one.stats["cost"]))


def _places(arrived: Sequence[Minimum], problem: Problem) -> list[tuple[Minimum, int]]:
    """The places at which starting points have arrived, and how many at each."""
    places: list[tuple[Minimum, int]] = []
    for one in arrived:
        last = places[-1] if places else None
        if last and float(one.stats["cost"] - last[0].stats["cost"]) < 2.0 * variance_ratio(last[0], problem):
            places[-1] = last[0], last[1] + 1
        else:
            places.append((one, 1))
    return places


def _one_trajectory(problem: Problem, start: Unknowns) -> Continued | None:
    """One trajectory searched for at once, where it leaves no more than noise and a torque left out makes it no likelier.

    The values to start from are near: a fit by continuation would end there too, by a longer way. None where it does not.
    """
    if sliding_speeds(problem):
        return None
    at, beside = tied(problem, TIGHTEST), tied(problem, JOINED)
    # Nearly free windows end close to tied ones: a damped step would only fight the ties, which are stiff.
    minimum = minimise(at, start, Levenberg(limit=BETWEEN, atol=CLOSELY, damping=1e-9, beside=JOINED))
    count, steps = freedom(problem, tied=True), int(minimum.stats["steps"])
    if steps >= BETWEEN or not 2.0 * float(minimum.stats["cost"]) < most_of_noise(count, LIKELY) ** 2 * count:
        return None
    looser, height = minimum.beside, log_evidence(at, minimum)
    # Near a minimum a step keeps what it promises; a promise that is too large only sends the fit the longer way.
    likelier = log_evidence(beside, looser) + float(looser.stats["promise"]) - height
    if likelier > WITHIN_CHANCE:
        return None
    stops = (Stop(TIGHTEST, height, steps), Stop(JOINED, height + likelier, int(looser.stats["steps"])))
    return Continued(at, minimum, height, stops, True, {TIGHTEST: minimum.value, JOINED: looser.value})


def _continued(problem: Problem, start: Unknowns, first: float = LOOSEST) -> Continued:
    """A fit by continuation; with dry friction it is led to one trajectory where nothing is left out."""
    speeds = sliding_speeds(problem)
    found = continued(problem, start, first=first, speeds=speeds)
    if not speeds or not found.reached or found.tie >= TIGHTEST:
        return found
    leaves_noise = misfit(found) <= most_of_noise(freedom(problem, tied=True), LIKELY)
    return sharpened(found, speeds) if leaves_noise else found


def _steps(found: Continued) -> int:
    """Steps of all the fits on the way, and of the last."""
    return sum(stop.steps for stop in found.stops) + int(found.minimum.stats["steps"])


def _elsewhere(problem: Problem, rng: np.random.Generator) -> np.ndarray:
    """Another point to start from: values that must keep their sign move by up to a factor of 1.6; others by a little of
    their scale."""
    shift = rng.uniform(-0.4, 0.6, problem.directions.shape[1]) * np.where(problem.shrink, 1.0, 0.3)
    return np.clip(shift, problem.lower, problem.upper)


def _one_side(problem: Problem, guess: Unknowns, free: Sequence[str], seed: int, progress: Callable[[str, float], None]) -> Found:
    """`search` for a drive of which motor or link is not seen: segments first, then the whole record from near its minimum."""
    means = Means(segment, _roughly, EXPLAINED)
    begin, steps = near_by(problem, guess, free, np.random.default_rng(seed), progress, means)
    progress("fitting, the whole record", 0.55)
    loose = _roughly(problem, LOOSE, begin, LAST)
    found = _one_trajectory(problem, loose.value) or _continued(problem, loose.value, first=LOOSE / FINER)
    if not np.isfinite(found.log_evidence):
        raise NoAnswer(NOWHERE)
    if "motor" not in problem.system.channels and found.tie < TIGHTEST:
        # Of such a fit even what it tells most sharply was twelve standard errors off.
        raise NoAnswer(UNSEEN)
    return Found(found, 1, 1, steps + int(loose.stats["steps"]) + _steps(found))


def _second_links(problem: Problem, guess: Unknowns, progress: Callable[[str, float], None]) -> Found:
    """`search` for a joint with a play behind the link: in turns with what finds the hidden starts, then with tighter ties."""
    progress("looking for the link that is not seen", 0.05)
    begin, steps = in_turns(problem, guess, Means(segment, _roughly, EXPLAINED))
    found = _continued(problem, begin, first=LOOSE)
    if not np.isfinite(found.log_evidence):
        raise NoAnswer(NOWHERE)
    return Found(found, 1, 1, steps + _steps(found))


def _roughly(problem: Problem, tie: float, begin: Unknowns, limit: int) -> Minimum:
    at = with_friction_width(tied(problem, tie), sliding_speeds(problem), begin)
    return minimise(at, begin, Levenberg(limit=limit, atol=ROUGHLY))


def _stick_slip(problem: Problem, starts: int, seed: int, progress: Callable[[str, float], None]) -> Found:
    """`search` for a link that friction holds: one run through the record from each starting point, and on from the best."""
    rng = np.random.default_rng(seed)
    ended = []
    for attempt in range(starts):
        progress(f"fitting, start {attempt + 1} of {starts}", 0.05 + 0.6 * attempt / starts)
        theta = _elsewhere(problem, rng) if attempt else np.zeros(problem.directions.shape[1])
        unknowns, seen, steps = search_stick_slip(problem, theta, limit=15 if attempt else 30)
        if np.isfinite(seen["cost"]):
            ended.append((float(seen["cost"]), unknowns.theta, steps))
    if not ended:
        raise NoAnswer(NOWHERE)
    cost, theta, steps = min(ended, key=lambda end: end[0])
    progress("letting the base motion follow its own noise", 0.75)
    found = in_one_run(problem, np.asarray(theta))
    agreeing = sum(other - cost < 0.01 * cost for other, _, _ in ended)
    return Found(found, agreeing, len(ended), steps + int(found.minimum.stats["steps"]))
