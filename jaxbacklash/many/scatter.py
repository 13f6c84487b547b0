r"""Values with standard errors that scatter by more than those: by how much, and their weighted mean.

Estimates :math:`v_i` with standard errors :math:`s_i` of one quantity scatter with the variance :math:`s_i^2 + \tau^2`: what a
joint does from day to day, and what a record's own noise does not tell, is :math:`\tau`.

Source: Paule and Mandel, Journal of Research of the National Bureau of Standards 87 (1982) 377.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq


def excess_scatter(values: np.ndarray, variances: np.ndarray, design: np.ndarray | None = None) -> float:
    r"""The variance :math:`\tau^2` with which the weighted sum of squares is as chance makes it, 0 where it is no larger.

    Parameters
    ----------
    values, variances : (N,) estimates and the squares of their standard errors
    design : (N, p) what the values follow, by weighted least squares; default: one mean
    """
    rows = np.ones((values.size, 1)) if design is None else design
    freedom = values.size - rows.shape[1]
    if freedom < 1:
        return 0.0

    def beyond(square: float) -> float:
        weight = 1.0 / np.sqrt(variances + square)
        left = values - rows @ np.linalg.lstsq(rows * weight[:, None], values * weight, rcond=None)[0]
        return float(np.sum((left * weight) ** 2)) - freedom

    highest = float(np.sum((values - np.mean(values)) ** 2)) / freedom
    if highest <= 0.0 or beyond(0.0) <= 0.0:
        return 0.0
    return float(brentq(beyond, 0.0, 2.0 * highest)) if beyond(2.0 * highest) < 0.0 else highest


def usable_errors(errors: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Variances (N,) for standard errors: one that is zero or not known is taken for the median of the others."""
    known = errors[np.isfinite(errors) & (errors > 0.0)]
    instead = float(np.median(known)) if known.size else 1e-9 * max(float(np.max(np.abs(values), initial=0.0)), 1e-300)
    return np.where(np.isfinite(errors) & (errors > 0.0), errors, instead) ** 2
