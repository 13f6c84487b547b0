"""How a quantity that was estimated in one record after another grows or falls, along a straight line."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import stdtr, stdtrit

from .scatter import excess_scatter

CLAIMED = 0.01
"""The p-value from which on a trend is claimed."""
FEWEST = 4
"""Records that a trend is told of at least."""


@dataclass(frozen=True)
class Trend:
    """A straight line through values over records or days.

    Attributes: ``level`` at the middle and ``slope``, with standard errors ``level_stderr`` and ``slope_stderr``; ``middle``,
    where the level is told; ``low`` and ``high``, the 95 % interval of the slope; ``scatter``, the standard deviation between
    records that their own errors do not explain; ``p_value`` of no slope.
    """

    level: float
    level_stderr: float
    slope: float
    slope_stderr: float
    middle: float
    low: float
    high: float
    scatter: float
    p_value: float

    @property
    def claimed(self) -> bool:
        """Whether chance makes such a slope less than once in a hundred times."""
        return self.p_value <= CLAIMED

    def band(self, along: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The line and its standard error (M,) at some places."""
        away = along - self.middle
        return self.level + self.slope * away, np.hypot(self.level_stderr, self.slope_stderr * away)


def find_trend(along: np.ndarray, values: np.ndarray, variances: np.ndarray) -> Trend | None:
    """The weighted least-squares line, with the scatter that the errors do not explain; None of fewer records than four.

    Parameters
    ----------
    along : (N,) numbers of the records, or days
    values, variances : (N,) estimates, and the squares of their standard errors

    Examples
    --------
    >>> found = find_trend(np.arange(5.0), np.array([1.0, 1.1, 1.2, 1.3, 1.4]), np.full(5, 1e-4))
    >>> round(found.slope, 3), found.claimed
    (0.1, True)
    """
    if values.size < FEWEST or float(np.ptp(along)) == 0.0:
        return None
    square = excess_scatter(values, variances, np.stack([np.ones_like(along), along - np.mean(along)], axis=1))
    weights = 1.0 / (variances + square)
    middle = float(np.sum(weights * along) / np.sum(weights))
    away = along - middle
    level = float(np.sum(weights * values) / np.sum(weights))
    curvature = float(np.sum(weights * away**2))
    slope = float(np.sum(weights * away * values)) / curvature
    error, freedom = 1.0 / np.sqrt(curvature), values.size - 2
    half = float(stdtrit(freedom, 0.975)) * error
    p_value = 2.0 * float(stdtr(freedom, -abs(slope) / error))
    return Trend(
        level, float(1.0 / np.sqrt(np.sum(weights))), slope, float(error), middle, slope - half, slope + half,
        float(np.sqrt(square)), p_value,
    )  # fmt: skip
