"""Fits any model of the catalogue to one record by continuation, with one compiled program; what is fitted is kept.

Between the search (`evidence_search`), which asks for models, and `jaxbacklash.fitting.continuation`, which fits them.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from ..fitting.continuation import LOOSEST, TIGHTEST, Continued, continued, log_evidence, tied
from ..fitting.levenberg import Levenberg, Minimum, minimise
from ..fitting.problem import Problem, Unknowns
from ..fitting.search import freedom
from ..fitting.setup import first_guess, read_through
from ..mechanics import AbstractEffect
from ..parameters import values, with_values
from ..records import Record
from ..system import System
from .evidence import measures_only
from .fitted_model import FittedModel
from .workbench import Workbench, correlation_length

SHOOTING = 0.025
"""Length of a shooting window [s], eight samples at least: the unknown torque acts where windows join, so they are short beside
the time in which a missing torque changes."""
LOOSE = 1e-2
"""Weight of the ties with which a model is begun at most, whatever its neighbour ended with: it may lack what that one has."""

MEASURING = 2.0
"""Minus twice the log prior odds of a fault of the measuring chain against a law of the joint."""


class ModelFitter(Workbench):
    """Fits models of a record: sets of effects beside the joint.

    Parameters
    ----------
    record : what was measured
    base : the joint with values to start from
    base_free : its free parameters
    window : length of the windows whose error is quoted [s]
    beside : another record that will be predicted with the same program
    """

    def __init__(
        self, record: Record, base: System, base_free: Iterable[str], window: float | None, beside: Record | None = None
    ) -> None:
        super().__init__(record, base, base_free, window, beside, shooting=SHOOTING)
        self.fitted: dict[frozenset[str], FittedModel] = {}

    def problem(self, *args: object, **named: object) -> tuple[Problem, tuple[str, ...]]:
        """As that of `Workbench`; a torque that is left out acts on the link, and jumps no state inside a law."""
        problem, free = super().problem(*args, **named)  # type: ignore[arg-type]
        return replace(problem, inner_tie=np.asarray(TIGHTEST)), free

    def fit_model(self, effects: dict[str, AbstractEffect], near: FittedModel | None = None) -> FittedModel:
        """The joint with these effects, fitted from their values; the better of this fit and of an earlier one is kept.

        Parameters
        ----------
        effects : by canonical name, at the values to start from
        near : a fitted model from whose joint, windows and ties to start, or looser ones; None starts from the record
        """
        problem, free = self.problem(effects, self.base if near is None else near.system)
        unknowns = first_guess(problem)
        if near is not None:
            starts = read_through(self.windows, np.asarray(near.unknowns.starts[:2]), problem.system, near.system)
            unknowns = Unknowns(unknowns.theta, starts, near.unknowns.coefficients)
        if any(effect.states for effect in effects.values()):
            starts = self._followed(effects, problem.system, unknowns.starts)
            unknowns = Unknowns(unknowns.theta, starts, unknowns.coefficients)
        self._count()
        first = LOOSEST if near is None else min(near.tie, LOOSE)
        found = continued(problem, unknowns, first=first, speeds=self.speeds(effects))
        model = self._model(found, frozenset(effects), free)
        known = self.fitted.get(model.names)
        if known is None or model.criterion < known.criterion:
            self.fitted[model.names] = model
        return self.fitted[model.names]

    def speeds(self, effects: dict[str, AbstractEffect]) -> dict[str, float]:
        """Root mean square speed [rad/s] at which each law of dry friction slides, by name."""
        return {n: float(np.sqrt(np.mean(self.sliding(e.port) ** 2))) for n, e in effects.items() if e.slides}

    def _doubt(self, names: frozenset[str]) -> float:
        """Minus twice the log prior of a set of laws: what measures only is the less likely of two that do the same."""
        return MEASURING * sum(measures_only(self.laws[n]) for n in names)

    def _rest(self, found: Continued) -> float:
        """By how much minus twice the log evidence is above that of one trajectory that leaves noise alone.

        Such a one would have half a unit of cost for each degree of freedom, and the log-determinants of this model's windows.
        """
        tight = tied(found.problem, TIGHTEST)
        seen = minimise(tight, found.minimum.value, Levenberg(limit=1))
        stats = {**seen.stats, "cost": np.asarray(0.5 * freedom(tight, tied=True))}
        return 2.0 * (log_evidence(tight, Minimum(seen.value, stats)) - found.log_evidence)

    def _model(self, found: Continued, names: frozenset[str], free: tuple[str, ...]) -> FittedModel:
        problem, stats = found.problem, found.minimum.stats
        moved = np.asarray(problem.parameters(found.minimum.value.theta))
        weight = np.asarray(self.windows.weight)
        rows = float(np.sum(weight > 0.0))
        residual = (np.asarray(stats["predicted"].motion) - np.asarray(self.windows.measured)) * weight
        residual = np.where(weight > 0.0, residual, 0.0)
        inside = float(np.sqrt(np.sum(residual**2) / rows))
        cost = float(np.nan_to_num(stats["cost"], nan=np.inf))
        whole = found.tie >= TIGHTEST
        # Free windows leave as much as their samples hold beyond what follows the noise.
        misfit = np.sqrt(2.0 * cost / freedom(problem, tied=True)) if whole else inside
        return FittedModel(
            with_values(problem.system, dict(zip(values(problem.system), moved))), names, free, found.minimum.value, cost,
            float(misfit), np.asarray(stats["schur"]), np.asarray(stats["pull"]), np.sum(problem.directions, axis=0), whole,
            found.converged, len(free) * float(np.log(rows)) + self._doubt(names), correlation_length(residual),
            int(stats["steps"]), found.tie, found.log_evidence, inside, 0.0 if whole else self._rest(found), found.stops,
        )  # fmt: skip

