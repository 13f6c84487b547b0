"""The straight part of a curve, by one rule for stretching curves and correlation sums alike."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

STRAIGHT = 0.03  # rms distance from the line, as a share of its rise
POINTS = 5


@dataclass(frozen=True)
class Region:
    """The straight part of a curve: from index ``first`` to ``last`` inclusive, with its ``slope`` and ``intercept``."""

    first: int
    last: int
    slope: float
    intercept: float


def straight_part(x: np.ndarray, y: np.ndarray, least_rise: float, straight: float = STRAIGHT) -> Region | None:
    """The stretch of the largest rise that is a straight line.

    Rule: of all stretches of at least five points that rise by ``least_rise`` or more and keep to their least-squares line
    within 3 % of the rise (rms), the one with the largest rise; None where there is no such stretch. No slope is preferred.

    Parameters
    ----------
    x, y : (n,) the curve, x increasing
    least_rise : smallest rise that counts as a scaling region [unit of y]
    straight : allowed rms distance from the line over the rise
    """
    n = x.size
    if n < POINTS:
        return None
    # All stretches at once from cumulated sums: sums over i..j inclusive are differences.
    x0, y0 = x - x.mean(), y - y.mean()
    sums = [np.concatenate([[0.0], np.cumsum(v)]) for v in (np.ones(n), x0, y0, x0 * x0, x0 * y0, y0 * y0)]
    one, sx, sy, sxx, sxy, syy = (s[None, 1:] - s[:-1, None] for s in sums)
    with np.errstate(divide="ignore", invalid="ignore"):
        cxx, cxy, cyy = sxx - sx * sx / one, sxy - sx * sy / one, syy - sy * sy / one
        slope = cxy / cxx
        rms = np.sqrt(np.maximum(cyy - slope * cxy, 0.0) / one)
        rise = slope * (x0[None, :] - x0[:, None])
    good = (one >= POINTS) & (rise >= least_rise) & (rms <= straight * rise)
    if not good.any():
        return None
    first, last = np.unravel_index(int(np.argmax(np.where(good, rise, -np.inf))), rise.shape)
    line = float(slope[first, last])
    middle = float(np.mean(y[first : last + 1]) - line * np.mean(x[first : last + 1]))
    return Region(int(first), int(last), line, middle)
