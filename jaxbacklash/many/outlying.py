"""Which of many joints, or records, differ from the others by more than these scatter.

The generalised extreme Studentised deviate test: the one farthest from the weighted mean of the rest is taken out, then the
next, up to a quarter of all; the largest number of them whose farthest was too far for chance is the number that differ. One
that differs does so not hide another one.

Source: Rosner, Technometrics 25 (1983) 165.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from .scatter import excess_scatter

CLAIMED = 0.01
"""Chance with which any is named though none differs."""
FEWEST = 6
"""How many are compared at least."""
MOST = 0.25
"""Share of all that may differ from the rest at most."""
LIMIT = 200
"""How many are named at most."""


@dataclass(frozen=True)
class Outlier:
    """One that differs: its ``index``, by what share of the mean of the ``others`` it is ``apart``, with the 95 % half
    width ``half``."""

    index: int
    apart: float
    half: float
    others: float


def find_outliers(values: np.ndarray, variances: np.ndarray) -> list[Outlier]:
    """Those that differ from the rest, the farthest first; none of fewer than six.

    Parameters
    ----------
    values, variances : (N,) estimates of each, and the squares of their standard errors

    Examples
    --------
    >>> values = np.array([1.0, 1.01, 0.99, 1.02, 0.98, 1.0, 1.3])
    >>> [one.index for one in find_outliers(values, np.full(7, 1e-4))]
    [6]
    """
    count = values.size
    if count < FEWEST:
        return []
    left = np.arange(count)
    taken: list[Outlier] = []
    differ = 0
    for number in range(1, min(LIMIT, int(MOST * count)) + 1):
        farthest, ratio, told = _farthest(values[left], variances[left])
        taken.append(Outlier(int(left[farthest]), *told))
        n = left.size
        # Of n values all may be the farthest, to either side.
        critical = float(stdtrit(n - 2, 1.0 - CLAIMED / (2.0 * n)))
        if ratio > critical:
            differ = number
        left = np.delete(left, farthest)
    return taken[:differ]


def _farthest(values: np.ndarray, variances: np.ndarray) -> tuple[int, float, tuple[float, float, float]]:
    """Which is the farthest from the mean of the others, by how many standard errors of that, and what is told of it."""
    square = excess_scatter(values, variances)
    weights = 1.0 / (variances + square)
    total, moment = np.sum(weights), np.sum(weights * values)
    guess = int(np.argmax(np.abs(values - (moment - weights * values) / (total - weights)) * np.sqrt(weights)))
    others = np.arange(values.size) != guess
    square = excess_scatter(values[others], variances[others])
    weights = 1.0 / (variances[others] + square)
    mean = float(np.sum(weights * values[others]) / np.sum(weights))
    error = float(np.sqrt(variances[guess] + square + 1.0 / np.sum(weights)))
    apart = float(values[guess]) - mean
    share = abs(mean) if mean else np.nan
    half = float(stdtrit(values.size - 2, 0.975)) * error
    return guess, abs(apart) / error, (apart / share, half / share, mean)
