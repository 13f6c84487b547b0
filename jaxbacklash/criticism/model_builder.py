"""Builds the one shooting problem of a record in which any set of laws can be active.

The joint stands there with the whole catalogue at its null values. Which laws are in a model is data, not code: a model is a
set of names, and a fit of it moves the joint's parameters and those of the laws named, through a matrix of directions with a
fixed number of columns, so that one compiled program serves all models. Laws with internal states change the number of unknowns
a window has; each of those brings a program of its own, compiled when it is first tried. `model_fitter` fits what is built
here.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from ..fitting.fit import prepare
from ..fitting.left_over import quieter
from ..fitting.score import Score, begin_anew, score
from ..fitting.settings import EXPLAINED
from ..fitting.setup import free_names, make_problem, stick_slip_system
from ..mechanics import AbstractEffect, catalogue
from ..one_encoder import one_side
from ..parameters import specs
from ..records import Record
from ..regression.along_motion import own_states
from ..regression.motor_form import MotorForm
from ..regression.weak_form import WeakForm
from ..shooting.levenberg import Levenberg, minimise
from ..shooting.problem import Problem, Unknowns
from ..shooting.windows import Layout, Windows
from ..system import System
from .fitted_model import FittedModel
from .laws_for import laws_for


class ModelBuilder:
    """Builds models of one record, the joint and any set of laws, and says what they miss it by.

    Parameters
    ----------
    record : what was measured
    base : the joint with values to start from
    base_free : its free parameters
    window : length of the windows whose error is quoted [s]
    beside : another record that will be predicted with the same program

    Attributes: ``windows``, ``layout`` and ``group``, the shooting windows, where they lie in the record, and how many of them
    make a window whose error is quoted; ``quoted``, the same as they were cut, before any noise was taken from a model; ``laws``
    that may be proposed, by canonical name, and ``static``, those without states; ``weak_form`` of the record, and
    ``motor_form``, that of a drive's motor; for a record of
    transmitted force ``outright``, laws of friction that may hold the link, and ``gripped``, the joint with them from its force
    loop; ``pace``, the system by whose frequencies windows are cut.
    """

    def __init__(
        self, record: Record, base: System, base_free: Iterable[str], window: float | None, beside: Record | None = None
    ) -> None:
        self.record, self.base, self.base_free, self.window = record, base, tuple(base_free), window
        self.windows: Windows
        self.layout: Layout
        self.outright = gripping() if record.kind == "transmitted" else ()
        self.gripped = with_friction(record, base, self.base_free, self.outright)
        self.pace = self.gripped or base
        self.beside = beside
        least = 0 if beside is None else prepare(self.pace, [beside], window)[0].intervals
        self.quoted = prepare(self.pace, [record], window, intervals=least)
        self.windows, self.layout, self.group = self.quoted
        self.noise_factor = 1.0
        self.laws: dict[str, type[AbstractEffect]]
        self.static: dict[str, type[AbstractEffect]]
        self.take_laws(laws_for(base))
        self.weak_form = WeakForm(record)
        self.motor_form = MotorForm(record) if record.kind == "drive" and not record.blind else self.weak_form
        self._scored: dict[int, tuple[FittedModel, Score]] = {}

    def take_laws(self, laws: dict[str, type[AbstractEffect]]) -> None:
        """Propose these laws and no others, by canonical name; the default is `laws_for` a link that turns or slides."""
        self.laws = laws
        self.static = {n: c for n, c in laws.items() if not c.states}

    def contained(self, name: str) -> tuple[str, ...]:
        """Simpler laws that a law contains, those that can act in this joint: an axis without one has no friction in it."""
        return tuple(n for n in self.laws[name].absorbs if n in self.laws)

    def sliding(self, port: str) -> np.ndarray:
        """Measured speed (N,) [rad/s] at which friction slides at a port."""
        m = self.weak_form.motion
        if port == "motor":
            return np.asarray(m.dx * self.record.ratio)
        return np.asarray(m.dy - m.dx if port == "joint" else m.dy)

    def form_of(self, name: str) -> WeakForm:
        """The weak form of the balance in which a law shows by itself: at the motor for one at its port, else at the link."""
        return self.motor_form if self.laws[name].port == "motor" else self.weak_form

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
        smoothed = tuple(port for port in joint.rows if port not in sliding)
        bare = System(joint.inertia, joint.contact, joint.damper, {}, joint.observed, smoothed, joint.motor)
        system = bare.with_effects(*quiet.values(), *effects.values())
        free = (*self.base_free, *(n for n in free_names(system, effects) if n.partition(".")[0] in effects), *extra)
        # A torque that is left out acts on the link, and jumps no state inside a law.
        return _pad(make_problem(system, self.windows, free)), free

    def followed(
        self, effects: dict[str, AbstractEffect], joint: System, starts: np.ndarray, begun: dict[str, np.ndarray]
    ) -> np.ndarray:
        """Starts (S, W) of windows: motion as in ``starts``, states of laws as they follow the measured motion, from rest or from
        where they have ``begun``."""
        m, t0 = self.weak_form.motion, np.asarray(self.windows.t0)
        hidden = [np.interp(t0, m.t, s) for n in sorted(effects) for s in own_states(effects[n], joint, m, begun.get(n))]
        return np.stack([*np.asarray(starts)[:2], *hidden])

    def sensitivities(self, problem: Problem, unknowns: Unknowns) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Information about all columns (q, q), their score (q,) and scales (q,), at a point."""
        still = Unknowns(np.zeros(problem.directions.shape[1]), unknowns.starts, unknowns.coefficients)
        stats = minimise(problem, still, Levenberg(limit=1)).stats
        return np.asarray(stats["schur"]), np.asarray(stats["score"]), np.sum(problem.directions, axis=0)

    def grips(self, names: Iterable[str]) -> bool:
        """Whether a model with these effects holds its link by friction, so that its run is one trajectory."""
        return bool(set(names) & set(self.outright))

    def quieter(self, factor: float) -> None:
        """Take the noise of the measured channel to be ``factor`` times what it was taken for."""
        self.noise_factor *= factor
        self.windows = self.windows.noisier(factor)
        self._scored.clear()
        self.layout = replace(self.layout, noise=tuple(factor * n for n in self.layout.noise))

    def scored(self, model: FittedModel) -> Score:
        """What a model misses its record by, as every command tells it."""
        if (known := self._scored.get(id(model))) is not None and known[0] is model:
            return known[1]
        problem, _ = self.problem(self.effects(model), model.system)
        still = np.zeros(problem.directions.shape[1])
        may_explain = model.misfit < EXPLAINED
        how: dict[str, Any] = {"group": self.group, "may_explain": may_explain}
        found = score(problem, begin_anew(problem, still), self.layout, **how)[0][0]
        if one_side(model.system) and found.rms > EXPLAINED and may_explain:
            # A motion that the fit has found is one, whether a score from nothing finds it or not.
            begin = Unknowns(still, model.unknowns.starts, model.unknowns.coefficients)
            found = min(found, score(problem, begin, self.layout, **how)[0][0], key=lambda told: told.rms)
        self._scored[id(model)] = model, found
        return found

    def too_loud(self, model: FittedModel) -> float:
        """By which factor the noise is to be taken beside a model, 1 where that leaves as much."""
        return quieter(self.layout.noise, [self.scored(model)], [self.record])[0]

    def effects(self, model: FittedModel) -> dict[str, AbstractEffect]:
        """The effects of a fitted model at their fitted values."""
        return {name: model.system.effects[name] for name in model.names}


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
    return stick_slip_system(record, "joint" if base.has_play else "linear", known, names)[0]


def strengths(effect: AbstractEffect) -> tuple[str, ...]:
    """Names of the parameters with which a law vanishes."""
    return tuple(n for n, s in specs(effect).items() if s.null is not None and not s.fixed)


def width(columns: int, step: int = 10) -> int:
    """The number of columns compiled for so many free parameters: a multiple of ``step``, so that one more compiles nothing."""
    return -(-columns // step) * step


def _pad(problem: Problem) -> Problem:
    q = problem.directions.shape[1]
    extra = width(q) - q
    lower, upper, shrink = (np.pad(column, (0, extra)) for column in (problem.lower, problem.upper, problem.shrink))
    directions = np.pad(problem.directions, ((0, 0), (0, extra)))
    return replace(problem, directions=directions, lower=lower, upper=upper, shrink=shrink)
