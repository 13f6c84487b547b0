"""One compiled program for every model of a record: the joint with the whole catalogue at its null values.

Which effects are in a model is data, not code: a model is a set of names, and a fit of it moves the joint's parameters and those
of the effects named, through a matrix of directions with a fixed number of columns. Laws with internal states change the number
of unknowns a window has, so each of those brings a program of its own, compiled when it is first tried.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property

import equinox as eqx
import numpy as np

from ..fitting.fit import prepare
from ..fitting.handed_on import handed_on
from ..fitting.left_over import quieter
from ..fitting.levenberg import Levenberg, Minimum, minimise
from ..fitting.problem import Problem, Unknowns
from ..fitting.score import Score, begin_anew, score
from ..fitting.search import ADEQUATE, LOOSE, NEAR, TIES, freedom, tie_windows
from ..fitting.setup import first_guess, free_names, held_system, make_problem, read_through
from ..fitting.softened import through_softened
from ..fitting.stick_slip import search_stick_slip, sticks_and_slips
from ..fitting.windows import Layout, Windows
from ..mechanics import AbstractEffect, catalogue
from ..parameters import specs, values, with_values
from ..records import Record
from ..signals import noise_of_speed
from ..system import System
from .along_motion import own_states
from .laws_for import laws_for
from .quick_look import QuickLook

COLUMNS = 10
"""Free parameters in steps of this many, so that adding one compiles nothing."""
PATIENCE = 25
"""Linearisations spent on a model before it is compared with others; the one that is kept is finished."""
COMPARED = 1e-2
"""How near to the minimum one trajectory comes, as `Levenberg.atol`: no parameter is off by 15 % of its standard error."""
ENOUGH = 3e-3
"""A model that is clearly wrong is not fitted on when a step promises less than this share of its misfit."""


RESTING = 0.015
"""A link rests for long that does so in a larger share of its windows."""


MOST_FITS = 1000
"""Fits of one search at most: it ends with what it has by then. Counted and not timed, so that every run ends alike."""


class ExhaustedError(Exception):
    """A search has made all its fits; caught where the search began."""


@dataclass(frozen=True)
class Trial:
    """A fitted model: ``effects`` as fitted, by name; ``parameters`` free ones by name; ``cost`` half the sum of squares.

    ``misfit`` is the root of the reduced chi-square; ``schur`` (q, q) the information in units of ``scales`` (q,); ``pull``
    (q,) the score of every column at the end; ``tied`` whether the windows are one trajectory; ``done`` whether it converged;
    ``penalty`` of the criterion; ``correlation`` how many samples of the residual count for one; ``steps`` of its last search.
    """

    system: System
    names: frozenset[str]
    free: tuple[str, ...]
    unknowns: Unknowns = field(repr=False)
    cost: float
    misfit: float
    schur: np.ndarray = field(repr=False)
    pull: np.ndarray = field(repr=False)
    scales: np.ndarray = field(repr=False)
    tied: bool
    done: bool
    penalty: float
    correlation: float
    steps: int = 0

    @property
    def value(self) -> dict[str, float]:
        """Values of the free parameters by name."""
        present = values(self.system)
        return {name: present[name] for name in self.free}

    @property
    def criterion(self) -> float:
        """Bayesian information criterion with known noise: twice the cost and a penalty a parameter. Less is better."""
        return 2.0 * self.cost + self.penalty


class Workbench:
    """Fits any model of a record, the joint and some effects, without compiling anything anew.

    Parameters
    ----------
    record : what was measured
    base : the joint with values to start from
    base_free : its free parameters
    window : length of the windows whose error is quoted [s]
    beside : another record that will be predicted with the same program
    shooting : length of the shooting windows [s]; default as for a fit
    """

    def __init__(
        self, record: Record, base: System, base_free: Iterable[str], window: float | None, beside: Record | None = None, *,
        shooting: float | None = None,
    ) -> None:  # fmt: skip
        self.shooting = shooting
        self.record, self.base, self.base_free, self.window = record, base, tuple(base_free), window
        self.windows: Windows
        self.layout: Layout
        self.outright = gripping() if record.kind == "transmitted" else ()
        self.gripped = with_friction(record, base, self.base_free, self.outright)
        self.pace = self.gripped or base
        least = 0 if beside is None else prepare(self.pace, [beside], window, shooting=shooting)[0].intervals
        self.windows, self.layout, self.group = prepare(self.pace, [record], window, intervals=least, shooting=shooting)
        self.ties = np.asarray(self.windows.tie)
        self.noise_factor = 1.0
        self.laws: dict[str, type[AbstractEffect]]
        self.static: dict[str, type[AbstractEffect]]
        self.take_laws(laws_for(base))
        self.quick = QuickLook(record)
        self.fits, self.most = 0, float(MOST_FITS)

    @cached_property
    def slowest(self) -> float:
        """Speed [rad/s] below which the record cannot tell motion from rest; zero where the motion is not in the record."""
        if self.quick.blind:
            return 0.0
        return noise_of_speed(self.record.t, self.record.channels[self.record.observed_name], self.layout.noise[0])

    def take_laws(self, laws: dict[str, type[AbstractEffect]]) -> None:
        """Propose these laws and no others, by canonical name; the default is `laws_for` a link that turns or slides."""
        self.laws = laws
        self.static = {n: c for n, c in laws.items() if not c.states}

    def _count(self) -> None:
        if self.fits >= self.most:
            raise ExhaustedError
        self.fits += 1

    def contained(self, name: str) -> tuple[str, ...]:
        """Simpler laws that a law contains, those that can act in this joint: an axis without one has no friction in it."""
        return tuple(n for n in self.laws[name].absorbs if n in self.laws)

    def rests(self, port: str) -> bool:
        """Whether the link rests for long at a port, ``joint`` or ``ground``, or may for all that the record tells."""
        if self.quick.blind:
            return True
        samples, speed = self.windows.samples, self.sliding(port)
        rows = speed[: speed.size // samples * samples].reshape(-1, samples)
        return bool(np.mean(np.sqrt(np.mean(rows**2, axis=1)) < self.slowest) > RESTING)

    def sliding(self, port: str) -> np.ndarray:
        """Measured speed (N,) [rad/s] at which friction slides at a port."""
        m = self.quick.motion
        return np.asarray(m.dy - m.dx if port == "joint" else m.dy)

    def problem(
        self, effects: dict[str, AbstractEffect], joint: System, *, extra: Iterable[str] = (),
        shapes: dict[str, AbstractEffect] | None = None,
    ) -> tuple[Problem, tuple[str, ...]]:  # fmt: skip
        """The shooting problem with the joint's and these effects' parameters free, padded to a fixed number of columns.

        Parameters
        ----------
        effects : by canonical name, as they are; every other static law is there at its null value
        joint : a system with the joint's values
        extra : further free parameters by name
        shapes : how absent laws are shaped, at their null values
        """
        shapes, extra = shapes or {}, tuple(extra)
        quiet = {name: shapes.get(name, law()) for name, law in self.static.items() if name not in effects}
        # Friction that is only judged need not stick; friction in the model does, at its port alone.
        sliding = {e.port for e in effects.values() if e.slides}
        smoothed = tuple(port for port in ("joint", "ground") if port not in sliding)
        bare = System(joint.inertia, joint.contact, joint.damper, {}, joint.observed, smoothed)
        system = bare.with_effects(*quiet.values(), *effects.values())
        free = (*self.base_free, *(n for n in free_names(system, effects) if n.partition(".")[0] in effects), *extra)
        return _pad(make_problem(system, self.windows, free)), free

    def fit(
        self, effects: dict[str, AbstractEffect], start: Trial | None = None, *, joint: System | None = None,
        tied: bool = False, patience: int = PATIENCE, followed: bool = False, through: bool = False, near: float = NEAR,
    ) -> Trial:  # fmt: skip
        """Fit the joint with these effects, from their values and from the windows of an earlier fit.

        Parameters
        ----------
        effects : by canonical name, at the values to start from
        start : a fit whose windows to start from; None takes the smoothed data
        joint : a system whose joint to start from; default that of ``start``
        tied : fit one trajectory instead of free windows
        patience : linearisations allowed
        followed : take internal states that ``start`` does not have from the laws followed along the measured motion
        through : run through the whole record from one start, as a link that friction holds always does
        near : how much of half the sum of squares, in units of the noise, free windows may leave to gain
        """
        begin = joint if joint is not None else (self.base if start is None else start.system)
        grips = [name for name in effects if name in self.outright]
        if grips and self.gripped is not None and joint is None and (start is None or not self.grips(start.names)):
            # Far from anything that the joint alone could tell: the force loop says where to start.
            begin = self.gripped
            effects = {**effects, **{name: begin.effects[name] for name in grips}}
        problem, free = self.problem(effects, begin)
        if through or sticks_and_slips(problem.system):
            self._count()
            return self._run(problem, frozenset(effects), free, patience)
        unknowns = first_guess(problem)
        if start is not None:
            same = start.system.state_names == problem.system.state_names
            own = start.unknowns.starts if same else np.concatenate([start.unknowns.starts[:2], unknowns.starts[2:]])
            own = read_through(self.windows, np.asarray(own), problem.system, start.system)
            unknowns = Unknowns(unknowns.theta, own, start.unknowns.coefficients)
        if followed:
            unknowns = Unknowns(unknowns.theta, self._followed(effects, begin, unknowns.starts), unknowns.coefficients)
        self._count()
        if tied:
            problem, solution, _ = tie_windows(problem, unknowns, TIES[0], limit=patience, near=COMPARED)
            if patience > PATIENCE and 2.0 * float(solution.stats["cost"]) > ADEQUATE**2 * freedom(problem, tied=True):
                problem, solution, _ = tie_windows(problem, unknowns, TIES[1], limit=patience, near=COMPARED)
        else:
            how = Levenberg(limit=patience, atol=near, rtol=ENOUGH)
            solution, _ = handed_on(problem, minimise(problem, unknowns, how), how)
        return self._trial(problem, solution, frozenset(effects), free, tied, patience)

    def fit_softly(self, trial: Trial, patience: int, way: int) -> Trial:
        """A tied model with dry friction fitted once more, by way of friction without corners."""
        effects = self.effects(trial)
        sliding = {n: float(np.sqrt(np.mean(self.sliding(e.port) ** 2))) for n, e in effects.items() if e.slides}
        problem, free = self.problem(effects, trial.system)
        still = Unknowns(np.zeros(problem.directions.shape[1]), trial.unknowns.starts, trial.unknowns.coefficients)
        self._count()
        begin = through_softened(problem, still, sliding, way)
        problem, solution, _ = tie_windows(problem, begin, TIES[0], limit=patience, near=COMPARED)
        return self._trial(problem, solution, trial.names, free, True, patience)

    def _followed(self, effects: dict[str, AbstractEffect], joint: System, starts: np.ndarray) -> np.ndarray:
        m, t0 = self.quick.motion, np.asarray(self.windows.t0)
        hidden = [np.interp(t0, m.t, s) for n in sorted(effects) for s in own_states(effects[n], joint, m)]
        return np.stack([*np.asarray(starts)[:2], *hidden])

    def _run(self, problem: Problem, names: frozenset[str], free: tuple[str, ...], patience: int) -> Trial:
        """The fit of a link that friction holds: always one trajectory."""
        unknowns, seen, steps = search_stick_slip(problem, np.zeros(problem.directions.shape[1]), limit=patience)
        count = freedom(problem, tied=True)
        if np.sqrt(2.0 * float(seen["cost"]) / count) < LOOSE:
            _, solution, taken = tie_windows(problem, unknowns, TIES[0], limit=patience, near=COMPARED)
            if float(solution.stats["cost"]) < float(seen["cost"]):
                unknowns, seen, steps = solution.value, solution.stats, taken
        return self._trial(problem, Minimum(unknowns, {**seen, "steps": steps}), names, free, True, patience)

    def look(self, problem: Problem, unknowns: Unknowns) -> tuple[np.ndarray, np.ndarray, float, np.ndarray]:
        """Information about all columns (q, q), their score (q,), the cost, and the columns' scales (q,), at a point."""
        still = Unknowns(np.zeros(problem.directions.shape[1]), unknowns.starts, unknowns.coefficients)
        stats = minimise(problem, still, Levenberg(limit=1)).stats
        scales = np.sum(problem.directions, axis=0)
        return np.asarray(stats["schur"]), np.asarray(stats["pull"]), float(stats["cost"]), scales

    def grips(self, names: Iterable[str]) -> bool:
        """Whether a model with these effects holds its link by friction, so that its run is one trajectory."""
        return bool(set(names) & set(self.outright))

    def quieter(self, factor: float) -> None:
        """Take the noise of the measured channel to be ``factor`` times what it was taken for."""
        self.noise_factor *= factor
        self.windows = self.windows.noisier(factor)
        self.layout = replace(self.layout, noise=tuple(factor * n for n in self.layout.noise))

    def scored(self, trial: Trial) -> Score:
        """What a model misses its record by, as every command tells it."""
        problem, _ = self.problem(self.effects(trial), trial.system)
        # A window whose error is quoted is one trajectory, wherever the search was cut.
        whole = eqx.tree_at(lambda p: p.windows.tie, problem, self.ties)
        begin = begin_anew(whole, np.zeros(problem.directions.shape[1]))
        return score(whole, begin, self.layout, group=self.group)[0][0]

    def too_loud(self, trial: Trial) -> float:
        """By which factor the noise is to be taken beside a model, 1 where that leaves as much."""
        return quieter(self.layout.noise, [self.scored(trial)], [self.record])[0]

    def cut(self, ties: np.ndarray) -> None:
        """Tie only those windows from now on that have a one in ``ties`` (W,); ``self.ties`` keeps what was tied before."""
        self.windows = eqx.tree_at(lambda w: w.tie, self.windows, ties)

    @property
    def is_cut(self) -> bool:
        """Whether some windows are not tied that could be."""
        return not np.array_equal(self.windows.tie, self.ties)

    def _trial(
        self, problem: Problem, solution: Minimum, names: frozenset[str], free: tuple[str, ...], tied: bool, patience: int
    ) -> Trial:
        # What was not finite anywhere is as bad as can be, and compares as such.
        cost = float(np.nan_to_num(solution.stats["cost"], nan=np.inf))
        system = problem.system
        moved = np.asarray(problem.parameters(solution.value.theta))
        fitted = with_values(system, dict(zip(values(system), moved)))
        count = freedom(problem, tied=tied)
        rows = float(np.sum(np.asarray(self.windows.weight) > 0.0))
        used = float(np.sum(np.any(np.asarray(self.windows.weight) > 0.0, axis=1)))
        # What a window begins with by itself is a parameter: where windows are free what no law remembers, all where one is cut.
        cuts = float(np.sum(self.ties - np.asarray(self.windows.tie)))
        starts = sum(cuts if tied or np.isfinite(reach) else used for reach in system.reach[0 if tied else 2 :])
        penalty = len(free) * np.log(rows) + 2.0 * starts
        done = int(solution.stats["steps"]) < patience and "given_up" not in solution.stats
        return Trial(
            fitted, names, free, solution.value, cost, float(np.sqrt(2.0 * cost / count)),
            np.asarray(solution.stats["schur"]), np.asarray(solution.stats["pull"]),
            np.sum(problem.directions, axis=0), tied, done, float(penalty),
            _correlation(self.windows, np.asarray(solution.stats["predicted"].motion)), int(solution.stats["steps"]),
        )  # fmt: skip

    def effects(self, trial: Trial) -> dict[str, AbstractEffect]:
        """The effects of a fitted model at their fitted values."""
        return {name: trial.system.effects[name] for name in trial.names}


def pruned(trial: Trial) -> System:
    """The fitted system without the laws that stand at their null values."""
    full = trial.system
    bare = System(full.inertia, full.contact, full.damper, {n: full.effects[n] for n in trial.names}, full.observed)
    return with_values(bare, values(bare))


def gripping() -> tuple[str, ...]:
    """Laws of dry friction that can hold a link to the ground."""
    return tuple(n for n, law in catalogue().items() if law.catalogued and law.slides and law.port == "ground")


def with_friction(record: Record, base: System, free: tuple[str, ...], names: tuple[str, ...]) -> System | None:
    """The joint of a record of transmitted force with friction at the ground, from its force loop; None for other records.

    Without friction the link floats, and the sensitivities of a floating link say nothing about one that is held.
    """
    if record.kind != "transmitted" or not names:
        return None
    known = None if "inertia" in free else float(base.inertia)
    return held_system(record, "joint" if base.has_play else "linear", known, names)[0]


def strengths(effect: AbstractEffect) -> tuple[str, ...]:
    """Names of the parameters with which a law vanishes."""
    return tuple(n for n, s in specs(effect).items() if s.null is not None and not s.fixed)


def adequate(trial: Trial) -> bool:
    """Whether the misfit is small enough for the windows to be tied."""
    return trial.misfit < ADEQUATE


def _correlation(windows: Windows, predicted: np.ndarray) -> float:
    """Integrated autocorrelation of the residual inside the windows, in samples: 1 for noise, the more the model is wrong."""
    return correlation_length((predicted - np.asarray(windows.measured)) * np.asarray(windows.weight))


def correlation_length(residual: np.ndarray) -> float:
    """Integrated autocorrelation of a residual (W, M) along its rows up to the first zero, in samples, at least 1."""
    with np.errstate(over="ignore", invalid="ignore"):  # what has run away misses by more than a square can hold
        energy = max(float(np.sum(residual**2)), 1e-300)
        lags = [float(np.sum(residual[:, k:] * residual[:, :-k])) / energy for k in range(1, residual.shape[1] // 2)]
    first = next((k for k, rho in enumerate(lags) if rho <= 0.0), len(lags))
    return max(1.0, 1.0 + 2.0 * sum(lags[:first]))


def width(columns: int) -> int:
    """The number of columns compiled for this many free parameters."""
    return -(-columns // COLUMNS) * COLUMNS


def _pad(problem: Problem) -> Problem:
    q = problem.directions.shape[1]
    extra = width(q) - q
    return eqx.tree_at(
        lambda p: (p.directions, p.lower, p.upper, p.shrink),
        problem,
        (
            np.pad(problem.directions, ((0, 0), (0, extra))),
            np.pad(problem.lower, (0, extra)),
            np.pad(problem.upper, (0, extra)),
            np.pad(problem.shrink, (0, extra)),
        ),
    )

