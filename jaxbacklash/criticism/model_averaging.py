r"""What not knowing which of several models is right adds to the uncertainty of a parameter that they share.

Bayesian model averaging (Hoeting et al., Statistical Science 14, 1999): every model has the weight :math:`e^{-B/2}` of its
criterion :math:`B`, and to each parameter's variance comes the mean square of how far the models' values lie from the one kept.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from ..fitting.estimates import judge
from ..fitting.result import Fit
from .evidence import gain
from .fitted_model import FittedModel


def averaged(fit: Fit, model: FittedModel, others: Sequence[FittedModel]) -> Fit:
    """A fit whose covariance, standard errors and verdicts allow for other models that do as well.

    Parameters
    ----------
    fit : of the model kept
    model : the same as the search has it
    others : models that the record cannot tell from it
    """
    more = between(model, others)
    if not np.any(more):
        return fit
    covariance = fit.covariance + more
    stderr = dict(zip(fit.free, np.sqrt(np.maximum(np.diag(covariance), 0.0))))
    parameters = judge(fit.system, fit.free, stderr, fit.records, per_inertia=fit.per_inertia, translational=fit.translational)
    return dataclasses.replace(fit, parameters=parameters, covariance=covariance)


def between(model: FittedModel, others: Sequence[FittedModel]) -> np.ndarray:
    """Covariance between the models (q, q), in the order and units of the free parameters of the one kept; what another model
    does not have stays where it is."""
    here = model.value
    away = np.array([[other.value.get(name, at) - at for name, at in here.items()] for other in others])
    if not away.size:
        return np.zeros((len(here), len(here)))
    evidence = np.array([0.0, *(gain(model, other) for other in others)])
    weights = np.exp(0.5 * (evidence - np.max(evidence)))
    weights /= np.sum(weights)
    return np.asarray((away.T * weights[1:]) @ away)
