"""What a fitted trajectory's misfit says to a small change of its problem, with every unknown free to make up for it.

The same program that fits a model looks at it with a little torque applied as a force, or with the measurement blurred: the
cost to which the next step would come down is the score of that change (a score test, Rao 1948), at no new compilation.
`unnamed` holds torques outside the catalogue against a model in this way.
"""

from __future__ import annotations

import equinox as eqx
import numpy as np

from ..fitting.continuation import tied
from ..mechanics import AbstractEffect
from ..records import Record
from ..shooting.levenberg import Levenberg, minimise
from ..shooting.multiple_shooting import Prediction
from ..shooting.problem import Problem, Unknowns
from .fitted_model import FittedModel
from .model_builder import ModelBuilder


def panel_edges(builder: ModelBuilder) -> np.ndarray:
    """Times (W, P + 1) at which a force on the link is given [s]."""
    windows = builder.windows
    return np.asarray(windows.t0)[:, None] + float(windows.panel) * np.arange(np.shape(windows.force)[1])


def delayed(builder: ModelBuilder, model: FittedModel) -> bool:
    """Whether a model's measured channel lags: how it was read between two samples is not known."""
    return any(builder.laws[n].lag is not AbstractEffect.lag for n in model.names)


def blurred(builder: ModelBuilder, model: FittedModel, size: float = 0.3) -> float:
    r"""What a sensor that averages over a short time would take off the sum of squares beside a tied model, at most.

    An average over a time :math:`w` shows :math:`z + \ddot z w^2/24`, and so does a delay that ends between two samples and is
    read along a straight line, with :math:`f(1-f)\Delta t^2/2`. What explains no more than that speaks of the sensor alone.
    Blurs of ``size`` and twice of it, in units of the noise, are tried: small, so that the misfit is a parabola of them.
    """
    problem, unknowns = as_it_ended(builder, model)
    measured = np.asarray(builder.windows.measured)

    def answer(shift: np.ndarray) -> tuple[float, Prediction]:
        return answered(eqx.tree_at(lambda p: p.windows.measured, problem, measured + shift), unknowns)

    still, predicted = answer(np.zeros(measured.shape))
    moved = np.asarray(predicted.motion)
    bend = np.gradient(np.gradient(moved, axis=1), axis=1) * (np.asarray(builder.windows.weight) > 0.0)
    bent = float(np.sqrt(np.mean(bend**2)))
    if not bent > 0.0:
        return 0.0
    bend *= size * builder.layout.noise[0] / bent
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


def as_it_ended(builder: ModelBuilder, model: FittedModel) -> tuple[Problem, Unknowns]:
    """The problem of a model with the ties that it was fitted with, and its unknowns where its fit had ended."""
    problem, _ = builder.problem(builder.effects(model), model.system)
    problem = tied(problem, model.tie)
    return problem, Unknowns(np.zeros(problem.directions.shape[1]), model.unknowns.starts, model.unknowns.coefficients)


def model_record(builder: ModelBuilder, predicted: Prediction) -> Record:
    """A fitted trajectory at the samples of the record, the measured one where windows end before it or it runs away."""
    record, names = builder.record, builder.record.observed_names
    seen = (np.asarray(builder.windows.weight) > 0.0)[:, :: len(names)]
    channels: dict[str, np.ndarray] = {}
    shown = [(name, predicted.motion[:, k :: len(names)]) for k, name in enumerate(names)]
    for name, values in (*shown, ("x", predicted.input[:, : builder.windows.samples])):
        if name in record.channels and np.shape(values) == seen.shape and not (name == "x" and builder.windows.by_force):
            values, own = np.asarray(values)[seen][: record.samples], record.channels[name]
            # What has run away, further from the measured motion than that ever goes, says nothing of where the link was.
            told = np.abs(values - own[: values.size]) <= np.ptp(own)
            channels[name] = np.concatenate([np.where(told, values, own[: values.size]), own[values.size :]])
    return record.replace(**channels)
