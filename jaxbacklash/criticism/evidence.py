"""What counts as evidence: for an effect, for a model, for there being nothing left to find."""

from __future__ import annotations

import numpy as np

from ..fitting import left_out
from ..fitting.settings import LIKELY, SURE
from ..mechanics import AbstractEffect
from ..parameters import Spec, specs, values
from .fitted_model import FittedModel
from .model_builder import ModelBuilder, strengths


def demanded(fitter: ModelBuilder) -> float:
    """The fall of the criterion that an addition must bring: as many candidates as there are had their chance to fool us."""
    return 2.0 * float(np.log(max(len(fitter.laws), 2)))


def gain(before: FittedModel, after: FittedModel) -> float:
    """Evidence for ``after``: fall of the criterion, divided where what remains is larger than noise or correlated."""
    return (before.criterion - after.criterion) / after.deflation


def noise_too_large(model: FittedModel) -> bool:
    """Whether a model in one piece leaves less than the noise was taken for, which then may be wrong, as where corners were
    taken for noise. By how much, if so, `jaxbacklash.fitting.left_over.quieter` tells."""
    return model.tied and model.misfit < 1.0


def most_of_noise(model: FittedModel, sigmas: float | None = None) -> float:
    """The largest misfit of a model that noise may leave, see `jaxbacklash.fitting.left_out.most_of_noise`."""
    return left_out.most_of_noise(model.freedom, SURE if sigmas is None else sigmas)


def leaves_a_rest(model: FittedModel) -> bool:
    """Whether a model leaves clearly more than noise."""
    return model.misfit > most_of_noise(model, LIKELY)


def leaves_noise(model: FittedModel) -> bool:
    """Whether a model leaves out nothing that shows, as one trajectory or as far as its evidence tells."""
    return not leaves_a_rest(model)


def measures_only(law: type[AbstractEffect]) -> bool:
    """True for what happens in the measuring chain, which changes nothing of the motion itself."""
    return law.observe is not AbstractEffect.observe or law.lag is not AbstractEffect.lag


def standard_errors(model: FittedModel) -> np.ndarray:
    """Of all columns, those that only pad included; wider where a rest remains that is no noise."""
    size = np.sqrt(np.maximum(np.diag(model.information), 1e-300))
    # What only a sum determines must come out uncertain, not as a pseudo-inverse has it.
    inverse = np.linalg.inv(model.information / np.outer(size, size) + 1e-12 * np.eye(size.size))
    errors = np.sqrt(np.maximum(np.diag(inverse), 1e-300)) / size * model.scales
    return np.asarray(errors * np.sqrt(max(1.0, model.misfit**2) * model.correlation))


def at_a_limit(model: FittedModel, name: str) -> bool:
    """Whether a strength of an effect would have to leave the range that physics allows."""
    found, described = values(model.system.effects[name]), specs(model.system.effects[name])
    own = [n for n in strengths(model.system.effects[name]) if f"{name}.{n}" in model.free]
    return any(_end(found[n], described[n]) not in (None, described[n].null) for n in own)


def _end(value: float, spec: Spec) -> float | None:
    """The end of its range at which a parameter stands; None inside."""
    return next((e for e in (spec.lower, spec.upper) if np.isfinite(e) and abs(value - e) <= 1e-6 * abs(e)), None)


def correlation_length(residual: np.ndarray) -> float:
    """Integrated autocorrelation of a residual (W, M) along its rows up to the first zero, in samples, at least 1."""
    with np.errstate(over="ignore", invalid="ignore"):  # what has run away misses by more than a square can hold
        energy = max(float(np.sum(residual**2)), 1e-300)
        lags = [float(np.sum(residual[:, k:] * residual[:, :-k])) / energy for k in range(1, residual.shape[1] // 2)]
    first = next((k for k, rho in enumerate(lags) if rho <= 0.0), len(lags))
    return max(1.0, 1.0 + 2.0 * sum(lags[:first]))
