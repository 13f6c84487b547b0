"""What a law with internal states promises beside a fitted trajectory, even where noise hides it from the quick look.

A law that is weak exerts on the model's own motion, which is free of noise, a torque that is known in advance up to its size. The
same program that fits the model looks at it with small shares of that torque applied as a force, and at what its next step would
make up for: how the misfit answers is the score of the law with everything else free to move, as in a score test (Rao 1948), at
no new compilation.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any

import equinox as eqx
import numpy as np

from ..fitting.levenberg import Levenberg, minimise
from ..fitting.problem import Problem, Unknowns
from ..fitting.search import TIES
from ..fitting.shooting import Prediction
from ..mechanics import AbstractEffect
from ..records import Record
from .along_motion import motion, own_torques
from .quick_look import QuickLook
from .ringing import ringing
from .workbench import Trial, Workbench

SHARE = 0.001
"""Part of a guessed law's torque that is applied, and twice as much: too little to bend the trajectory."""
PARTS = (0.3, 0.03, 0.003)
"""The same of what tells two near relatives apart, which may be so little that a smaller part is lost in rounding: the first
whose answer is a parabola counts."""
FURTHER, BENT = 4.0, 0.25
"""A third such part, at which the answer is foretold, and how far off it may be."""
LOST = 1e3
"""How many times the cost of a trial with dry friction an answer exceeds that has not followed."""
BLUR = 0.3
"""Size of a blur of the sensor that is tried, in units of the noise."""
WEAKEST, STRONGEST = 0.05, 3.0
"""Sizes, as multiples of the guess, within which the promise of a straight line is believed."""


def promises(
    bench: Workbench, trial: Trial, law: type[AbstractEffect], least: float = 0.0
) -> list[tuple[float, AbstractEffect]]:
    """What a law's guesses promise beside a tied trial, ``least`` and more, the best first; none where none does.

    Returns
    -------
    Fall of the sum of squares that each promises at its best size, in units of the noise, and the law of that size to start a
    fit from
    """
    guesses = law.guesses(trial.system, bench.quick.motion)
    sounding = Sounding(bench, trial)
    tones = {w: shape for w in ringing(bench.record, sounding.own) if (shape := law.ringing(trial.system, w)) is not None}
    # As many at a time as there are guesses: for so many a program is at hand.
    groups = [[*tones.values(), *guesses][: len(guesses)], guesses] if tones else [guesses]
    torques = [own_torques(group, trial.system, sounding.along) for group in groups]
    # What a law is of a size, and its torque of size 1.
    heard: list[Callable[[float], Any]] = [partial(law.ringing, trial.system, omega) for omega in tones]
    tried = [*zip(heard, torques[0]), *zip((guess.scaled for guess in guesses), torques[-1])]
    found: list[tuple[float, AbstractEffect]] = []
    for of_size, torque in tried:
        fall, size = sounding.fall(torque, SHARE, least)
        if sounding.lost:
            return []
        if fall > 0.0:
            found.append((fall, of_size(float(np.clip(size, WEAKEST, STRONGEST)))))
    return sorted(found, key=lambda promise: -promise[0])


def changes(
    bench: Workbench, trial: Trial, name: str, others: Sequence[str], least: float
) -> list[tuple[str, float, AbstractEffect]]:
    """What ``others``, near relatives of a tied trial's law with a memory, promise in its place: of each, by name, the shape that
    promises most, and how much as `promises` tells it, if that is more than ``least``.

    Applied is the difference of their torques along the model's own motion, which is all that tells them apart.
    """
    present = trial.system.effects[name]
    sounding = Sounding(bench, trial)
    own = own_torques([present], trial.system, sounding.along)[0]
    found: list[tuple[str, float, AbstractEffect]] = []
    for other in others:
        shapes = bench.laws[other].in_place_of(present, sounding.along)
        if not shapes:
            continue  # a user's law that does not say how
        torques = own_torques(shapes, trial.system, sounding.along)
        falls = [next((f for p in PARTS if (f := sounding.fall(torque - own, p, 0.0)[0]) > 0.0), 0.0) for torque in torques]
        if max(falls) > least:
            found.append((other, max(falls), shapes[int(np.argmax(falls))]))
    return found


class Sounding:
    """A tied trial's trajectory, and how its misfit answers to a little torque on the link."""

    def __init__(self, bench: Workbench, trial: Trial) -> None:
        self.problem, self.unknowns = as_it_ended(bench, trial)
        self.applied, self.edges = np.asarray(bench.windows.force), panel_edges(bench)
        self.still, predicted = answered(self.problem, self.unknowns)
        self.own = model_record(bench, predicted)
        self.along = motion(self.own)
        self.lost = False  # dry friction does not let the trajectory follow, whatever the torque

    def fall(self, torque: np.ndarray, share: float, least: float) -> tuple[float, float]:
        """Fall of the sum of squares that a torque (N,) along the trajectory promises at its best size, in units of the noise,
        and that size, as foretold from ``share`` of it; nothing where that is below ``least`` or no parabola."""
        nothing = (0.0, 0.0)
        torque = np.interp(self.edges, self.along.t, torque)
        once = self._answer(share * torque)
        self.lost = bool(self.problem.system.slides) and not once < LOST * self.still
        if self.lost or not once < 0.0:
            return nothing  # less than half of that share is best, if any
        slope, curvature = parabola(once, self._answer(2.0 * share * torque), share)
        if not (np.isfinite(curvature) and curvature > 0.0 and slope < 0.0):
            return nothing
        fall = slope**2 / curvature
        if not least <= fall < 2.0 * self.still:
            return nothing
        # Where the answer is no parabola, noise is too small for a trajectory to bend so little: it promises nothing.
        further = slope * FURTHER * share + 0.5 * curvature * (FURTHER * share) ** 2
        straight = abs(self._answer(FURTHER * share * torque) - further) < BENT * abs(further)
        return (fall, -slope / curvature) if straight else nothing

    def gained(self, torque: np.ndarray) -> float:
        """Fall of the sum of squares by the whole of a torque (N,) along the trajectory, in units of the noise; below zero where
        it rises. It need be no small one: what all else makes up for is as foretold from where the trajectory is."""
        return -2.0 * self._answer(np.interp(self.edges, self.along.t, torque))

    def _answer(self, torque: np.ndarray) -> float:
        problem = eqx.tree_at(lambda p: p.windows.force, self.problem, self.applied + torque)
        return answered(problem, self.unknowns)[0] - self.still


def panel_edges(bench: Workbench) -> np.ndarray:
    """Times (W, P + 1) at which a force on the link is given [s]."""
    windows = bench.windows
    return np.asarray(windows.t0)[:, None] + float(windows.panel) * np.arange(np.shape(windows.force)[1])


def delayed(bench: Workbench, trial: Trial) -> bool:
    """Whether a model's measured channel lags: how it was read between two samples is not known."""
    return any(bench.laws[n].lag is not AbstractEffect.lag for n in trial.names)


def blurred(bench: Workbench, trial: Trial) -> float:
    r"""What a sensor that averages over a short time would take off the sum of squares beside a tied trial, at most.

    An average over a time :math:`w` shows :math:`z + \ddot z w^2/24`, and so does a delay that ends between two samples and is
    read along a straight line, with :math:`f(1-f)\Delta t^2/2`. What explains no more than that speaks of the sensor alone.
    """
    problem, unknowns = as_it_ended(bench, trial)
    measured = np.asarray(bench.windows.measured)

    def answer(shift: np.ndarray) -> tuple[float, Prediction]:
        return answered(eqx.tree_at(lambda p: p.windows.measured, problem, measured + shift), unknowns)

    still, predicted = answer(np.zeros(measured.shape))
    moved = np.asarray(predicted.motion)
    bend = np.gradient(np.gradient(moved, axis=1), axis=1) * (np.asarray(bench.windows.weight) > 0.0)
    size = float(np.sqrt(np.mean(bend**2)))
    if not size > 0.0:
        return 0.0
    bend *= BLUR * bench.layout.noise[0] / size
    slope, curvature = parabola(answer(-bend)[0] - still, answer(-2.0 * bend)[0] - still, 1.0)
    return slope**2 / curvature if np.isfinite(curvature) and curvature > 0.0 else 0.0


def answered(problem: Problem, unknowns: Unknowns) -> tuple[float, Prediction]:
    """Cost to which a fit would come down after a small change of its problem, and its trajectory before it moves.

    The step is not taken: along a curved valley that takes many, whose ends differ by more than so small a change does.
    """
    stats = minimise(problem, unknowns, Levenberg(limit=1)).stats
    return float(stats["cost"] - stats["promise"]), stats["predicted"]


def parabola(once: float, twice: float, share: float) -> tuple[float, float]:
    """Slope at no share, and curvature, of the parabola through nothing, ``once`` at a share, ``twice`` at twice of it."""
    return (2.0 * once - 0.5 * twice) / share, (twice - 2.0 * once) / share**2


def own_rest(bench: Workbench, trial: Trial) -> np.ndarray:
    """What the quick look leaves of a tied trial's own motion, (R,): nothing is missing from that, but the look takes what the
    measuring chain does, a delay say, for straight lines."""
    return QuickLook(own_record(bench, trial)).missing(trial.system, trial.free)[0]


def as_if_right(bench: Workbench, trial: Trial, draws: int) -> Iterator[Workbench]:
    """The bench with a quick look at a tied trial's own motion, each time with noise drawn as the record has it: what a law
    seems to bring there it brings by chance, or because the look smooths what it looks at."""
    record, random = own_record(bench, trial), np.random.default_rng(0)
    noises = {record.observed_name: bench.layout.noise[0]}
    if not bench.windows.by_force:
        noises["x"] = bench.layout.input_noise[0]
    for _ in range(draws):
        drawn = {n: v + random.normal(0.0, noises[n], v.size) for n, v in record.channels.items() if n in noises}
        looked = copy.copy(bench)
        looked.quick = QuickLook(record.replace(**drawn))
        yield looked


def own_record(bench: Workbench, trial: Trial) -> Record:
    """The trajectory at which the fit of a tied trial had ended, at the samples of the record."""
    problem, unknowns = as_it_ended(bench, trial)
    return model_record(bench, minimise(problem, unknowns, Levenberg(limit=1)).stats["predicted"])


def as_it_ended(bench: Workbench, trial: Trial) -> tuple[Problem, Unknowns]:
    """The problem of a tied trial, and its unknowns where its fit had ended."""
    problem, _ = bench.problem(bench.effects(trial), trial.system)
    problem = eqx.tree_at(lambda p: p.tie, problem, np.asarray(TIES[0][-1]))
    return problem, Unknowns(np.zeros(problem.directions.shape[1]), trial.unknowns.starts, trial.unknowns.coefficients)


def model_record(bench: Workbench, predicted: Prediction) -> Record:
    """A fitted trajectory at the samples of the record, the measured one where windows end before it."""
    record = bench.record
    seen = np.asarray(bench.windows.weight) > 0.0
    channels: dict[str, np.ndarray] = {}
    for name, values in ((record.observed_name, predicted.motion), ("x", predicted.input[:, : bench.windows.samples])):
        if name in record.channels and np.shape(values) == seen.shape and not (name == "x" and bench.windows.by_force):
            values = np.asarray(values)[seen][: record.samples]
            channels[name] = np.concatenate([values, record.channels[name][values.size :]])
    return record.replace(**channels)
