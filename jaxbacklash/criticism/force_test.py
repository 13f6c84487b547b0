r"""What a torque along a fitted model's own motion would bring: screening of laws that have no sensitivity at strength zero.

A law that remembers is followed along the smoothed motion that the model was fitted with, and its torque is put on the link as
an outer one, a share of it and twice that. The model's cost after one linear step, windows and parameters moving along, is a
parabola of that share: its lowest point says what the law brings, and at what strength. `screening` asks for it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import equinox as eqx
import numpy as np

from ..fitting.continuation import tied
from ..fitting.settings import PUSH, SHARP
from ..mechanics import AbstractEffect
from ..regression.along_motion import motion, own_states, own_torques
from ..shooting.problem import Unknowns
from .fitted_model import FittedModel
from .model_fitter import ModelFitter
from .perturbed import answered, model_record, panel_edges, parabola


class ForceTest:
    """How a fitted model answers to torques on its link.

    Parameters
    ----------
    fitter : of the record
    model : a fitted model
    """

    def __init__(self, fitter: ModelFitter, model: FittedModel) -> None:
        problem, _ = fitter.problem(fitter.effects(model), model.system)
        self.problem, self.system = tied(problem, min(model.tie, SHARP)), model.system
        still = np.zeros(problem.directions.shape[1])
        self.unknowns = Unknowns(still, model.unknowns.starts, model.unknowns.coefficients)
        self.applied, self.edges = np.asarray(fitter.windows.force), panel_edges(fitter)
        self.still, predicted = answered(self.problem, self.unknowns)
        self.along = motion(model_record(fitter, predicted))

    def best(
        self, shapes: list[AbstractEffect], instead: list[AbstractEffect], begun: np.ndarray | None = None
    ) -> tuple[float, AbstractEffect, int]:
        """The largest fall of minus twice the log likelihood among a law's shapes, that shape at its best strength, and which it
        is; the strength of a law that comes ``instead`` of others of the model is left as it is. ``begun`` (K, S) as in
        `own_torques`."""
        less = sum((own_torques([law], self.system, self.along)[0] for law in instead), np.zeros(self.along.t.size))
        torques = [torque - less for torque in own_torques(shapes, self.system, self.along, begun)]
        found = [self.fall(torque) for torque in torques]
        best = max(range(len(shapes)), key=lambda k: found[k][0])
        while found[best][0] > 0.0:
            rise = self._answer(self._at_edges(torques[best]), found[best][1])
            if rise < 0.0:
                break
            found[best] = redrawn(*found[best], rise)
            best = max(range(len(shapes)), key=lambda k: found[k][0])
        gain, size = found[best]
        return gain, shapes[best].scaled(size) if gain > 0.0 and not instead else shapes[best], best

    def best_shown(self, shapes: list[AbstractEffect]) -> tuple[float, AbstractEffect]:
        """The same of a law of the measuring chain, which shows the motion otherwise."""
        at_samples = self.edges[:, : -1 : self.problem.windows.every]
        along = self.along.y - self.along.x if self.system.observed == "z" else self.along.y
        shown = [np.asarray(shape.observe(along, own_states(shape, self.system, self.along))) for shape in shapes]
        shifts = [np.interp(at_samples, self.along.t, s - along) for s in shown]
        falls = [self._lowest(partial(self._shown, shift))[0] for shift in shifts]
        best = max(range(len(shapes)), key=lambda k: falls[k])
        return falls[best], shapes[best]

    def fall(self, torque: np.ndarray) -> tuple[float, float]:
        """What a torque (N,) [N m] along the motion brings at its best size, and that size; nothing where it is below zero."""
        return self._lowest(partial(self._answer, self._at_edges(torque)))

    def _at_edges(self, torque: np.ndarray) -> np.ndarray:
        return np.interp(self.edges, self.along.t, torque)

    def _lowest(self, rise: Callable[[float], float]) -> tuple[float, float]:
        once = rise(PUSH)
        if not once < 0.0:
            return 0.0, 1.0  # less than half of that share is best, if any
        slope, curvature = parabola(once, rise(2.0 * PUSH), PUSH)
        if not (np.isfinite(curvature) and curvature > 0.0 and slope < 0.0):
            return 0.0, 1.0
        return slope**2 / curvature, -slope / curvature

    def _answer(self, torque: np.ndarray, share: float) -> float:
        problem = eqx.tree_at(lambda p: p.windows.force, self.problem, self.applied + share * torque)
        return answered(problem, self.unknowns)[0] - self.still

    def _shown(self, shift: np.ndarray, share: float) -> float:
        measured = np.asarray(self.problem.windows.measured) - share * shift
        problem = eqx.tree_at(lambda p: p.windows.measured, self.problem, measured)
        return answered(problem, self.unknowns)[0] - self.still


def redrawn(gain: float, size: float, rise: float) -> tuple[float, float]:
    """Gain and size anew where the cost has risen by ``rise`` at a size far beyond the shares that were tried.

    They are those of the parabola of the same slope through that point, which halves both at least; nothing where the motion ran
    away.
    """
    if not np.isfinite(rise):
        return 0.0, 1.0
    slope = -gain / size
    curvature = 2.0 * (rise - slope * size) / size**2
    return slope**2 / curvature, -slope / curvature
