r"""One kind of fit for every model: by continuation in the size of the torque that the model leaves out.

The equation of motion carries an unknown torque that is white in time, of power q. It acts where shooting windows join: each
window's end may miss the next window's start by a jump whose size goes with :math:`\sqrt q`. A large q frees the windows, q = 0
makes them one trajectory, and for each q the record has a marginal likelihood, its evidence, by Laplace's approximation: the
log-determinant of the windows' own unknowns comes with the block tridiagonal elimination that every step makes anyway.

A fit goes from a large q to smaller ones as long as the evidence rises (to larger ones, where the first was too small already),
each fit begun where the last one ended, and ends at the likeliest q, or at q = 0 where the likelihood ratio does not speak
against it. Dry friction is softened on the way, over a range of speed that narrows with q: a jump that q allows hides what the
softening changes. See `jaxbacklash.shooting.levenberg` for the steps, `jaxbacklash.criticism.model_fitter` for who asks.

Source: MacKay, Neural Computation 4 (1992) 415, on the evidence of a hyperparameter by Laplace's approximation; Allgower and
Georg, Introduction to Numerical Continuation Methods (2003).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..mechanics import AbstractEffect, Instant
from ..parameters import free_specs, specs, values, with_values
from ..shooting.information import freedom
from ..shooting.levenberg import Levenberg, Minimum, minimise
from ..shooting.multiple_shooting import tie_weights
from ..shooting.problem import Problem, Unknowns, changed
from ..system import System
from .friction_homotopy import with_friction_widths
from .settings import (
    BETWEEN,
    CLOSELY,
    FALLEN,
    FINER,
    LAST,
    LOOSEST,
    NARROWEST,
    NEAR_ENOUGH,
    ROUGHLY,
    SHARP,
    SOFT,
    STABLE,
    TIGHTEST,
    WITHIN_CHANCE,
)
from .stick_slip import search_stick_slip


@dataclass(frozen=True)
class Stop:
    """A fit on the way: weight of the ties, log evidence, steps taken."""

    tie: float
    log_evidence: float
    steps: int


@dataclass(frozen=True)
class Continued:
    """Where a fit by continuation ended.

    ``problem`` with the ties at the likeliest q; the ``minimum`` found there; its ``log_evidence``; ``stops``, the fits on the
    way; ``converged`` whether the last one came to its end; ``reached`` where each of those fits ended, by the weight of
    its ties.
    """

    problem: Problem
    minimum: Minimum
    log_evidence: float
    stops: tuple[Stop, ...]
    converged: bool
    reached: Mapping[float, Unknowns]

    @property
    def tie(self) -> float:
        """Weight of the ties: `TIGHTEST` where nothing is left out and the windows are one trajectory."""
        return float(self.problem.tie)


def continued(
    problem: Problem, start: Unknowns, *, first: float = LOOSEST, speeds: Mapping[str, float] | None = None
) -> Continued:
    """Fit a model together with the size of the torque it leaves out.

    Parameters
    ----------
    problem : a model with its free parameters; the weight of its ties is set here
    start : unknowns to begin from
    first : weight of the ties to begin with, the likeliest of a model that this one is near to
    speeds : root mean square speed [rad/s] at which each law of dry friction in the model slides, by the law's name

    Returns
    -------
    Continued
        ``log_evidence`` is minus infinity where no fit stayed finite.

    Examples
    --------
    >>> found = continued(problem, first_guess(problem))  # doctest: +SKIP
    >>> found.tie == TIGHTEST  # nothing is left out  # doctest: +SKIP
    True
    """
    way, speeds = _Way(first, last=SHARP if speeds else TIGHTEST), speeds or {}
    while (tie := way.next_tie()) is not None:
        begin = way.begin(tie, start)
        at = with_friction_width(tied(problem, tie), speeds, begin)
        ended = minimise(at, begin, Levenberg(limit=BETWEEN, atol=ROUGHLY))
        if tie >= SHARP and way.may_reach(at, ended):
            ended = minimise(at, ended.value, Levenberg(limit=LAST - BETWEEN, atol=ROUGHLY))
            ended.stats["steps"] = ended.stats["steps"] + BETWEEN
        way.note(tie, at, ended)
    best = way.likeliest()
    at, minimum = tied(problem, best), way.ended.get(best)
    if minimum is None or not minimum.stats["stalled"]:
        # What has stalled at corners of dry friction would stall there again.
        minimum = minimise(at, way.begin(best, start), Levenberg(limit=LAST, atol=CLOSELY))
    reached = {**{tie: ended.value for tie, ended in way.ended.items()}, best: minimum.value}
    done = int(minimum.stats["steps"]) < LAST
    return Continued(at, minimum, log_evidence(at, minimum), tuple(way.stops), done, reached)


def evidence_at(problem: Problem, reached: Mapping[float, Unknowns], tie: float) -> float:
    """Log evidence of a model with ties of another weight than the likeliest: two models are compared with one and the same.

    Parameters
    ----------
    problem : the model
    reached : where earlier fits of it ended, by the weight of their ties; the nearest is begun from
    tie : weight of the ties
    """
    nearest = min(reached, key=lambda other: abs(np.log(other / tie)))
    at = tied(problem, tie)
    return log_evidence(at, minimise(at, reached[nearest], Levenberg(limit=BETWEEN, atol=ROUGHLY)))


def sharpened(found: Continued, speeds: Mapping[str, float]) -> Continued:
    """A fit with dry friction led to one trajectory by way of softer friction, where the continuation has ended before.

    With dry friction a misfit with tight ties has corners, at which searches stop. Friction that turns over a range of speed has
    none, and what it ends with is begun from as the range narrows. The first trajectory that is as likely as the fit that was is
    what comes back; else that fit.

    Parameters
    ----------
    found : a fit whose windows are no trajectory though nothing seems to be left out
    speeds : root mean square speed [rad/s] at which each law of dry friction slides, by name
    """
    from_here = found.reached[max(found.reached)]
    stops = list(found.stops)
    for shares in ways():
        unknowns, loose = from_here, tied(found.problem, 1.0)
        for share in shares:
            unknowns = minimise(softer(loose, speeds, share, unknowns), unknowns, Levenberg(limit=LAST, atol=ROUGHLY)).value
        unknowns = minimise(loose, unknowns, Levenberg(limit=LAST, atol=ROUGHLY)).value
        at = tied(found.problem, TIGHTEST)
        minimum = minimise(at, unknowns, Levenberg(limit=LAST, atol=CLOSELY, damping=1e-9))
        stops.append(Stop(TIGHTEST, log_evidence(at, minimum), int(minimum.stats["steps"])))
        if stops[-1].log_evidence >= found.log_evidence - WITHIN_CHANCE:
            reached = {**found.reached, TIGHTEST: minimum.value}
            return Continued(at, minimum, stops[-1].log_evidence, tuple(stops), stops[-1].steps < LAST, reached)
    return found


def in_one_run(problem: Problem, theta: np.ndarray | None = None) -> Continued:
    """Fit a link that dry friction holds and that is not seen: each trial is one run through the record, and nothing is left out.

    Where friction holds the link, a window's start has no sensitivity to anything, so that windows of their own tell nothing.

    Parameters
    ----------
    problem : the model with its free parameters
    theta : (q,) parameters to begin from, in units of their scale; default as they are
    """
    at = tied(problem, TIGHTEST)
    begin = np.zeros(problem.directions.shape[1]) if theta is None else theta
    unknowns, seen, steps = search_stick_slip(problem, begin, limit=LAST)
    if float(seen["cost"]) < 0.5 * NEAR_ENOUGH**2 * freedom(problem, tied=True):
        # Near the record the input may follow its own noise.
        further = minimise(at, unknowns, Levenberg(limit=LAST, atol=CLOSELY, damping=1e-9))
        unknowns = further.value if float(further.stats["cost"]) < float(seen["cost"]) else unknowns
    minimum = minimise(at, unknowns, Levenberg(limit=1))
    height = log_evidence(at, minimum)
    minimum.stats["steps"] = np.asarray(steps)
    return Continued(at, minimum, height, (Stop(TIGHTEST, height, steps),), steps < LAST, {TIGHTEST: unknowns})


def ways() -> list[list[float]]:
    """Ranges over which softened friction turns, one after the other, as shares of the speed at which it slides: three ways."""
    narrower = [NARROWEST * math.sqrt(FINER) ** k for k in range(4)][::-1]
    return [[], narrower[2:], narrower]


class _Way:
    """Which weight of the ties comes next, from how the evidence went with those before.

    ``stops`` are the fits so far, ``ended`` where those ended that did not fall below the highest evidence.
    """

    def __init__(self, first: float, last: float) -> None:
        self.first, self.last = first, last
        self.stops: list[Stop] = []
        self.ended: dict[float, Minimum] = {}
        self._tightening = True

    def next_tie(self) -> float | None:
        """Ever tighter ties as long as the evidence does not fall; looser ones where the loosest are the likeliest; then none."""
        if not self.stops:
            return self.first
        if self._tightening and (tie := self._tighter()) is not None:
            return tie
        self._tightening = False
        return self._looser()

    def _tighter(self) -> float | None:
        tie = self.stops[-1].tie
        if tie >= self.last or tie not in self.ended:
            return None
        # Factors of ten end a little beside powers of ten.
        return tie * FINER if tie * FINER < 0.9 * self.last else self.last

    def _looser(self) -> float | None:
        loosest = min(stop.tie for stop in self.stops)
        tie = loosest / FINER
        return tie if loosest == self.best and tie > 0.5 * LOOSEST else None

    def begin(self, tie: float, start: Unknowns) -> Unknowns:
        """Where a fit with these ties begins: where the fit with the nearest ended."""
        if not self.ended:
            return start
        return self.ended[min(self.ended, key=lambda other: abs(np.log(other / tie)))].value

    def may_reach(self, at: Problem, minimum: Minimum) -> bool:
        """Whether a search that its limit has ended may come to evidence not below the highest so far, if each of the steps that
        are left brings what the next one promises."""
        promised = (LAST - BETWEEN) * float(minimum.stats["promise"])
        stopped = int(minimum.stats["steps"]) >= BETWEEN and not minimum.stats["stalled"]
        return stopped and log_evidence(at, minimum) + promised >= self.least

    def note(self, tie: float, at: Problem, minimum: Minimum) -> None:
        """Note a fit, and whether the evidence is not below its highest so far."""
        least = self.least
        self.stops.append(Stop(tie, log_evidence(at, minimum), int(minimum.stats["steps"])))
        if np.isfinite(self.stops[-1].log_evidence) and self.stops[-1].log_evidence >= least:
            self.ended[tie] = minimum

    @property
    def least(self) -> float:
        """Log evidence below which a fit has fallen."""
        return max((stop.log_evidence for stop in self.stops), default=-np.inf) - FALLEN

    def likeliest(self) -> float:
        """The likeliest weight of the ties, `TIGHTEST` where that is as likely within chance."""
        best = self.best
        return TIGHTEST if self.height(TIGHTEST) >= self.height(best) - WITHIN_CHANCE else best

    @property
    def best(self) -> float:
        """The weight of the ties with the highest evidence so far."""
        return max(self.stops, key=lambda stop: stop.log_evidence).tie

    def height(self, tie: float) -> float:
        """Log evidence with these ties, minus infinity where they were not tried."""
        return max((stop.log_evidence for stop in self.stops if stop.tie == tie), default=-np.inf)


def log_evidence(problem: Problem, minimum: Minimum) -> float:
    """Log marginal likelihood of a record under a model and the size of the torque it leaves out, but for a constant.

    The windows' starts and the input's spline are integrated out by Laplace's approximation; the parameters are not, see
    `jaxbacklash.criticism.fitted_model.FittedModel.criterion`.
    """
    on = np.asarray(problem.windows.tie) > 0.0
    ties = np.asarray(tie_weights(problem, minimum.value.starts.shape[0]))[on]
    found = np.sum(np.log(ties)) - minimum.stats["cost"] - 0.5 * minimum.stats["log_determinant"]
    return float(found) if np.isfinite(found) else -np.inf


def tied(problem: Problem, tie: float) -> Problem:
    """The same problem with ties of another weight."""
    return changed(problem, tie=np.asarray(float(tie)))


def with_friction_width(problem: Problem, speeds: Mapping[str, float], begin: Unknowns) -> Problem:
    """A problem with its dry friction softened as far as its ties allow; ``speeds`` as `continued` takes them."""
    tie = float(problem.tie)
    if not speeds or tie >= SHARP:
        return problem
    return softer(problem, speeds, SOFT * min(FINER * LOOSEST / tie, 1.0), begin)


def softer(problem: Problem, speeds: Mapping[str, float], share: float, begin: Unknowns) -> Problem:
    """A problem whose dry friction turns over a ``share`` of the speed at which each law slides, or over which it changes where
    that is lower (softened over more it would be another law), but for those that would be so stiff then, at the parameters to
    ``begin`` with, that a step of the integration could not follow: these stay sharp."""
    step = 0.5 * float(problem.windows.panel)
    system = with_values(
        problem.system, dict(zip(specs(problem.system), map(float, problem.parameters(np.asarray(begin.theta)))))
    )
    inertia = {port: float(system.inertia) for port in system.rows}
    if system.motor is not None:
        inertia["motor"] = float(system.motor.motor_inertia)
    widths = {law: share * min(speed, *_own_speeds(system.effects[law]), math.inf) for law, speed in speeds.items()}
    deepest = float(np.max(np.abs(problem.windows.measured)))
    levels = {law: _level(system.effects[law], system, deepest) for law in widths}
    stiff = [law for law, width in widths.items() if levels[law] * step > STABLE * inertia[system.effects[law].port] * width]
    return problem if stiff else with_friction_widths(problem, widths)


def _own_speeds(law: AbstractEffect) -> list[float]:
    """Speeds [rad/s] by which a law of friction is described, such as that at which it falls."""
    found = values(law)
    return [found[n] for n, s in free_specs(law).items() if s.unit == "rad/s"]


def _level(law: AbstractEffect, system: System, deepest: float) -> float:
    """The largest torque that a law states [N m], or exerts at rest in a contact pressed in by all that was seen [rad]."""
    found, stiffness = values(law), 0.0 if system.contact is None else system.contact.stiffness
    still = np.float64(0.0)
    moment = Instant(
        still, still, still, still, still, still, still, np.float64(deepest), np.float64(1.0), stiffness, system.inertia
    )
    at_rest = law.dry(moment)
    return max((abs(found[n]) for n, s in specs(law).items() if s.unit == "N m"), default=float(at_rest))
