"""What a record can tell: its degrees of freedom, and the covariance that information about parameters comes to."""

from __future__ import annotations

import numpy as np

from .problem import Problem


def freedom(problem: Problem, *, tied: bool = False) -> float:
    """Samples less the unknowns: each window's own spline coefficients and, unless it is tied to the one before, its start.

    What a law remembers is tied even where the motion is not. An input as good as exact has no noise to show: neither its samples
    nor what its spline takes of them count.
    """
    windows = problem.windows
    samples = float(np.sum(np.asarray(windows.weight) > 0.0))
    moving = float(np.sum(np.asarray(windows.input_weight) > 0.0))
    used = float(np.sum(np.any(np.asarray(windows.weight) > 0.0, axis=1)))
    first = used - float(np.sum(np.asarray(windows.tie)))
    starts = sum(first if tied or np.isfinite(reach) else used for reach in problem.system.reach)
    return samples + float(windows.told) * (moving - used * windows.intervals) - starts


def inverse_information(schur: np.ndarray) -> np.ndarray:
    """Covariance from information, (q, q): infinite for what shows nowhere, the pseudo-inverse for what only a sum determines."""
    scale = np.sqrt(np.maximum(np.diag(schur), 0.0))
    alive = scale > 0.0
    inverse = np.full(schur.shape, 0.0)
    inverse[np.diag_indices_from(inverse)] = np.inf
    if np.any(alive):
        core = schur[np.ix_(alive, alive)] / np.outer(scale[alive], scale[alive])
        inverse[np.ix_(alive, alive)] = np.linalg.pinv(core, rcond=1e-14, hermitian=True) / np.outer(scale[alive], scale[alive])
    return inverse
