"""Fits any model of the catalogue to one record by continuation, with one compiled program; what is fitted is kept.

Between the search (`evidence_search`), which asks for models, and `jaxbacklash.fitting.continuation`, which fits them.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..fitting.continuation import Continued, continued, in_one_run, sharpened, tied, with_friction_width
from ..fitting.left_out import excess
from ..fitting.search import silent
from ..fitting.segment import segment
from ..fitting.settings import EXPLAINED, FALLEN, LOOSE, LOOSEST, MEASURING, MOST_STEPS, ROUGHLY, SHARP, TIGHTEST
from ..fitting.setup import first_guess, read_through
from ..fitting.stick_slip import sticks_and_slips
from ..mechanics import AbstractEffect
from ..one_encoder import Means, near_by, one_side
from ..parameters import values, with_values
from ..records import Record
from ..shooting.information import freedom
from ..shooting.levenberg import Levenberg, Minimum, minimise
from ..shooting.problem import Problem, Unknowns
from ..system import System
from .evidence import correlation_length, leaves_noise, measures_only
from .fitted_model import FittedModel
from .model_builder import ModelBuilder


class ExhaustedError(Exception):
    """A search has spent its budget; caught where the search began."""


class ModelFitter(ModelBuilder):
    """Fits models of a record: sets of effects beside the joint. Its parameters are those of `ModelBuilder`."""

    def __init__(
        self, record: Record, base: System, base_free: Iterable[str], window: float | None, beside: Record | None = None
    ) -> None:
        super().__init__(record, base, base_free, window, beside)
        self.fitted: dict[frozenset[str], FittedModel] = {}
        self.before: dict[frozenset[str], FittedModel] = {}
        self.fits, self.steps, self.budget = 0, 0, float(MOST_STEPS)

    def _count(self) -> None:
        if self.steps >= self.budget:
            raise ExhaustedError
        self.fits += 1

    def quieter(self, factor: float) -> None:
        """Take the noise for ``factor`` times what it was: every model is fitted anew, from where it was."""
        super().quieter(factor)
        self.before, self.fitted = self.fitted, {}

    def fit_model(
        self, effects: dict[str, AbstractEffect], near: FittedModel | None = None, joint: System | None = None, *,
        again: bool = False, begun: dict[str, np.ndarray] | None = None,
    ) -> FittedModel:  # fmt: skip
        """The joint with these effects, fitted from their values once for each set of laws.

        Parameters
        ----------
        effects : by canonical name, at the values to start from
        near : a fitted model from whose joint, windows and ties to start, or looser ones; None starts from the record
        joint : a system with the joint's values to start from instead
        again : fit it though it was fitted before; the better of both fits is kept. So is a fit that has not converged, from a
            model that contains it
        begun : how far states (S,) of laws are from rest at the first sample, by the law's name; at rest those that are not named
        """
        known = self.fitted.get(frozenset(effects))
        if known is not None and not again and (known.converged or near is None or not near.names > known.names):
            return known
        elsewhere = near is not None and not again and not leaves_noise(near) and one_side(near.system)
        # Beside a model that lacks something, the side that no encoder sees is somewhere else: the record says where.
        if elsewhere and leaves_noise(model := self.fit_model(effects, again=True)):
            return model
        if (was := self.before.get(frozenset(effects))) is not None:
            effects, near, joint = self.effects(was), was, None
        begin = joint if joint is not None else self.base if near is None else near.system
        grips = [name for name in effects if name in self.outright]
        if grips and self.gripped is not None and (near is None or not self.grips(near.names)):
            # Far from anything that the joint alone could tell: the force loop says where to start.
            begin = self.gripped
            effects = {**effects, **{name: begin.effects[name] for name in grips}}
        problem, free = self.problem(effects, begin)
        if sticks_and_slips(problem.system):
            self._count()
            return self._keep(self._model(in_one_run(problem), frozenset(effects), free))
        if near is None:
            unknowns = first_guess(problem)
            if one_side(problem.system):
                unknowns = self._other_side(problem, unknowns, free, self.speeds(effects))
        else:
            starts = np.asarray(near.unknowns.starts[: problem.system.mechanical])
            starts = starts if problem.system.motor else read_through(self.windows, starts, problem.system, near.system)
            unknowns = Unknowns(np.zeros(problem.directions.shape[1]), starts, near.unknowns.coefficients)
        if was is not None:
            unknowns = Unknowns(unknowns.theta, was.unknowns.starts, was.unknowns.coefficients)
        elif any(effect.states for effect in effects.values()):
            starts = self.followed(effects, problem.system, unknowns.starts, begun or {})
            unknowns = Unknowns(unknowns.theta, starts, unknowns.coefficients)
        self._count()
        hard = any(e.slides or e.states for e in effects.values())
        richer = near is not None and near.names < frozenset(effects) and not hard
        first = LOOSEST if near is None else near.tie if richer or was is not None else min(near.tie, LOOSE)
        speeds = self.speeds(effects)
        model = self._model(continued(problem, unknowns, first=first, speeds=speeds), frozenset(effects), free)
        if near is not None and near.names < model.names and first < near.tie and self._fell_behind(model, near):
            # What contains a model fits no worse: another minimum was met on the way up from loose ties.
            self._keep(model)
            first = min(near.tie, SHARP) if speeds else near.tie
            model = self._model(continued(problem, unknowns, first=first, speeds=speeds), frozenset(effects), free)
        return self._keep(model)

    def _fell_behind(self, model: FittedModel, near: FittedModel) -> bool:
        """Whether a fit came to less evidence than that of a model it contains, with ties as tight as dry friction allows, by a
        larger misfit or looser ties: where the misfit alone is smaller, no other minimum was met."""
        most = SHARP if self.speeds(self.effects(model)) else TIGHTEST
        behind = model.log_evidence < 0.5 * (near.penalty - near.criterion_at(min(near.tie, most))) - FALLEN
        return behind and (model.cost > near.cost if model.tie == near.tie else model.tie < near.tie)

    def _other_side(self, problem: Problem, start: Unknowns, free: tuple[str, ...], speeds: dict[str, float]) -> Unknowns:
        """Unknowns of a drive of which motor or link is not seen, brought near to where that one was by a segment of the record,
        as `fit` does it, but once."""

        def fitted(at: Problem, tie: float, begin: Unknowns, limit: int) -> Minimum:
            return minimise(with_friction_width(tied(at, tie), speeds, begin), begin, Levenberg(limit=limit, atol=ROUGHLY))

        means = Means(segment, fitted, EXPLAINED)
        return near_by(problem, start, free, np.random.default_rng(0), silent, means, tries=1)[0]

    def _keep(self, model: FittedModel) -> FittedModel:
        self.steps += sum(stop.steps for stop in model.stops)
        known = self.fitted.get(model.names)
        if known is None or model.criterion < known.criterion:
            self.fitted[model.names] = model
        return self.fitted[model.names]

    def sharpened(self, model: FittedModel) -> FittedModel:
        """A model that leaves out nothing led to one trajectory, where corners of dry friction have kept it from that."""
        speeds = self.speeds(self.effects(model))
        if model.tied or not speeds or model.found is None or not leaves_noise(model):
            return model
        self._count()
        return self._keep(self._model(sharpened(model.found, speeds), model.names, model.free))

    def speeds(self, effects: dict[str, AbstractEffect]) -> dict[str, float]:
        """Root mean square speed [rad/s] at which each law of dry friction slides, by name."""
        return {n: float(np.sqrt(np.mean(self.sliding(e.port) ** 2))) for n, e in effects.items() if e.slides}

    def _doubt(self, names: frozenset[str]) -> float:
        """Minus twice the log prior of a set of laws: what measures only is the less likely of two that do the same."""
        return MEASURING * sum(measures_only(self.laws[n]) for n in names)

    def _model(self, found: Continued, names: frozenset[str], free: tuple[str, ...]) -> FittedModel:
        problem, stats = found.problem, found.minimum.stats
        moved = np.asarray(problem.parameters(found.minimum.value.theta))
        weight = np.asarray(self.windows.weight)
        rows = float(np.sum(weight > 0.0))
        residual = (np.asarray(stats["predicted"].motion) - np.asarray(self.windows.measured)) * weight
        residual = np.where(weight > 0.0, residual, 0.0)
        with np.errstate(over="ignore"):  # of a trajectory that ran away
            inside = float(np.sqrt(np.sum(residual**2) / rows))
        cost = float(np.nan_to_num(stats["cost"], nan=np.inf))
        whole = found.tie >= TIGHTEST
        count, correlation = freedom(problem, tied=True), correlation_length(_by_channel(residual, problem))
        rest = excess(found)
        # What a model leaves out counts as if it were left as misfit by one trajectory.
        misfit = np.sqrt(max(1.0 + rest / count, 0.0))
        # Dry friction is softened on the way up to `SHARP`, so that those fits are not of this model.
        least = SHARP if any(self.laws[n].slides for n in names) else LOOSEST
        seen = {stop.tie: stop.log_evidence for stop in found.stops if stop.tie >= least}
        return FittedModel(
            with_values(problem.system, dict(zip(values(problem.system), moved))), names, free, found.minimum.value, cost,
            float(misfit), np.asarray(stats["schur"]), np.sum(problem.directions, axis=0), whole,
            found.converged, len(free) * float(np.log(rows)) + self._doubt(names), correlation,
            int(stats["steps"]), found.tie, found.log_evidence, inside, rest, count, found.stops, found, seen,
        )  # fmt: skip


def _by_channel(residual: np.ndarray, problem: Problem) -> np.ndarray:
    """Residuals (W, M C) with each channel's in rows of its own, (C W, M)."""
    count = len(problem.system.channels)
    return np.concatenate([residual[:, channel::count] for channel in range(count)])
