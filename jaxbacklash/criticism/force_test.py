r"""What a torque along a fitted model's own motion would bring: screening of laws that have no sensitivity at strength zero.

A law that remembers is followed along the smoothed motion that the model was fitted with, and its torque is put on the link as
an outer one. The score test of its size, windows and parameters moving along, says what the law brings and at what strength,
for all shapes of a law at once (`jaxbacklash.shooting.score_columns`); what the best of them promises is tried. `screening` asks
for it.
"""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator

import equinox as eqx
import numpy as np

from ..fitting.continuation import tied
from ..fitting.settings import SHARP
from ..fitting.setup import first_guess
from ..fitting.stick_slip import sticks_and_slips
from ..mechanics import AbstractEffect
from ..regression.along_motion import motion, own_states, own_torques
from ..shooting.problem import Unknowns
from ..shooting.score_columns import ready
from .candidates import column_gains
from .fitted_model import FittedModel
from .model_fitter import ModelFitter
from .perturbed import answered, model_record, panel_edges, parabola


@contextlib.contextmanager
def compiling_aside(fitter: ModelFitter) -> Iterator[None]:
    """Within it another thread compiles the program of `ForceTest`, or reads it, while the joint is fitted alone; where no law
    that remembers, or is a sine over time, may be asked, nothing."""
    remembers = not fitter.weak_form.blind and any(law.states for law in fitter.laws.values())
    if not remembers and not any(law.wave is not None and law.wave.over == "t" for law in fitter.laws.values()):
        yield
        return
    problem = fitter.problem({}, fitter.base)[0]

    def aside() -> None:
        with contextlib.suppress(Exception):  # what is wrong is raised where the program is asked for
            ready(problem, first_guess(problem))

    thread = None if sticks_and_slips(problem.system) else threading.Thread(target=aside)
    with contextlib.ExitStack() as stack:
        if thread is not None:
            with contextlib.suppress(RuntimeError):  # no more threads for this user: it is compiled when it is asked for
                thread.start()
                stack.callback(thread.join)  # a thread that is left inside the compiler while Python ends takes it along
        yield


class ForceTest:
    """How a fitted model answers to torques on its link.

    Parameters
    ----------
    fitter : of the record
    model : a fitted model
    """

    def __init__(self, fitter: ModelFitter, model: FittedModel) -> None:
        problem, free = fitter.problem(fitter.effects(model), model.system)
        self.problem, self.system, self.free = tied(problem, min(model.tie, SHARP)), model.system, len(free)
        still = np.zeros(problem.directions.shape[1])
        self.unknowns = Unknowns(still, model.unknowns.starts, model.unknowns.coefficients)
        self.applied, self.edges = np.asarray(fitter.windows.force), panel_edges(fitter)
        self.price = float(np.log(fitter.record.samples))  # of a parameter: what brings less promises nothing
        self.still, predicted = answered(self.problem, self.unknowns)
        self.along = motion(model_record(fitter, predicted))

    def best(
        self, shapes: list[AbstractEffect], instead: list[AbstractEffect], begun: np.ndarray | None = None
    ) -> tuple[float, AbstractEffect, int]:
        """The largest fall of minus twice the log likelihood among a law's shapes, that shape at its best strength, and which it
        is; the strength of a law that comes ``instead`` of others of the model is left as it is. ``begun`` (K, S) as in
        `own_torques`."""
        less = sum((own_torques([law], self.system, self.along)[0] for law in instead), np.zeros(self.along.t.size))
        torques = own_torques(shapes, self.system, self.along, begun) - less
        found = self.falls(torques)
        known: set[int] = set()
        while (best := max(range(len(shapes)), key=lambda k: found[k][0])) not in known and found[best][0] > self.price:
            gain, size = found[best]
            half, whole = (self._answer(torques[best], share * size) for share in (0.5, 1.0))
            if min(half, whole) < 0.0:
                found[best] = tried(size, half, whole)
                known.add(best)
            else:
                found[best] = redrawn(gain, size, whole)
        gain, size = found[best]
        return gain, shapes[best].scaled(size) if gain > 0.0 and not instead else shapes[best], best

    def best_shown(self, shapes: list[AbstractEffect]) -> tuple[float, AbstractEffect]:
        """The same of a law of the measuring chain, which shows the motion otherwise."""
        at_samples = self.edges[:, : -1 : self.problem.windows.every]
        along = self.along.y - self.along.x if self.system.observed == "z" else self.along.y
        seen = [np.asarray(shape.observe(along, own_states(shape, self.system, self.along))) for shape in shapes]
        shown = np.stack([np.interp(at_samples, self.along.t, s - along) for s in seen])
        falls = self._falls(np.zeros((len(shapes), *self.edges.shape)), shown)
        best = max(range(len(shapes)), key=lambda k: falls[k][0])
        return falls[best][0], shapes[best]

    def falls(self, torques: np.ndarray) -> list[tuple[float, float]]:
        """What each of some torques (K, N) [N m] along the motion brings at its best size, and that size; nothing where it is
        below zero."""
        at_edges = np.stack([np.interp(self.edges, self.along.t, torque) for torque in torques])
        return self._falls(at_edges, np.zeros((len(torques), *np.shape(self.problem.windows.measured))))

    def _falls(self, torques: np.ndarray, shown: np.ndarray) -> list[tuple[float, float]]:
        told = column_gains(self.problem, self.unknowns, self.free, torques, shown)
        return [(gain, float(size[0])) if size[0] > 0.0 else (0.0, 1.0) for size, gain in told]

    def _answer(self, torque: np.ndarray, share: float) -> float:
        at_edges = np.interp(self.edges, self.along.t, torque)
        problem = eqx.tree_at(lambda p: p.windows.force, self.problem, self.applied + share * at_edges)
        return answered(problem, self.unknowns)[0] - self.still


def tried(size: float, half: float, whole: float) -> tuple[float, float]:
    """Gain and size by the parabola through what the cost has risen by at ``half`` of a size and at the ``whole`` of it, of which
    one is below zero; by the lower of them where the parabola is lowest beyond twice the size, or nowhere."""
    slope, curvature = parabola(half, whole, 0.5)
    best = -slope / curvature if np.isfinite(curvature) and curvature > 0.0 else np.inf
    if 0.0 < best < 2.0:
        return -slope * best, size * best
    return (-2.0 * whole, size) if whole < half else (-2.0 * half, 0.5 * size)


def redrawn(gain: float, size: float, rise: float) -> tuple[float, float]:
    """Gain and size anew where the cost has risen by ``rise`` at a size far beyond the shares that were tried.

    They are those of the parabola of the same slope through that point, which halves both at least; nothing where the motion ran
    away.
    """
    if not np.isfinite(rise):
        return 0.0, 1.0
    share = gain / (2.0 * (rise + gain))
    return gain * share, size * share
