"""How far the drive goes, after it turns round, before the link follows: the travel under which two levels explain the record
best.

Every travel on a grid is tried. For each, the play operator says where the link is carried and where it stands, and a straight
least squares with two levels, a curve over the angle and a drift says how well that explains the link's motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .angle import Curve, Wave
from .play import Passes, passes, states

TRIED, FINER = 40, 9
"""Travels tried over the whole range, and around the best, twice."""
KNOWN = 0.5
"""Share of the samples at which a travel must say where the joint is."""
MOST_SAMPLES = 12_000
"""Samples that are tried; of more, neighbours are averaged."""


@dataclass(frozen=True)
class Crossing:
    """``travel`` to the other edge and what it leaves (mean square, ``left``); ``plain`` without play, ``lagging`` with a lag in
    its place; ``slope`` of the link against its drive, ``width`` between the levels, at that travel."""

    travel: float
    left: float
    plain: float
    lagging: float
    slope: float
    width: float


def thinned(values: np.ndarray, most: int = MOST_SAMPLES) -> np.ndarray:
    """Means of neighbours, at most ``most`` of them; what is left over at the end is not used."""
    many = -(-values.size // most)
    return values if many == 1 else values[: values.size // many * many].reshape(-1, many).mean(axis=1)


def crossing(
    t: np.ndarray, driver: np.ndarray, follower: np.ndarray, least: float, drift: np.ndarray, told: tuple[Wave, ...] = ()
) -> Crossing | None:
    """The travel that explains a follower best.

    Parameters
    ----------
    t, driver, follower : (N,) [s], and in one unit
    least : travel of the driver that is no noise
    drift : (N, D) slow functions of time
    told : waves over the angle that the motion can tell

    Returns
    -------
    None where the driver never goes back and forth by more than ``least``
    """
    found = passes(driver, least)
    if found.count < 2:
        return None
    speed = np.gradient(driver, t)
    curve = Curve(float(driver.min()), float(driver.max()), 6, told)
    widest = float(np.sort(found.strokes)[-2])  # a joint that is crossed once only shows nothing
    smallest = max(least, 2e-3 * widest)
    tried: dict[float, tuple[float, float, float]] = {}

    def left(travel: float) -> float:
        if travel not in tried:
            tried[travel] = _left(driver, follower, found, travel, curve, drift)
        return tried[travel][0]

    grid = np.geomspace(smallest, 0.98 * widest, TRIED) if widest > 1.05 * smallest else np.array([smallest])
    best = min(grid, key=left)
    ratio = float(grid[1] / grid[0]) if grid.size > 1 else 1.0
    for _ in range(2):
        best = min(best * np.geomspace(1.0 / ratio, ratio, FINER), key=left)
        ratio = ratio ** (2.0 / (FINER - 1))
    basis = np.concatenate([curve.rows(driver), drift], axis=1)
    plain = _rest(basis, follower - driver)[0]
    lagging = _rest(np.concatenate([basis, speed[:, None]], axis=1), follower - driver)[0]
    mean_square, half, slope = tried[best]
    return Crossing(float(best), mean_square, plain, lagging, slope, 2.0 * half)


def _left(
    driver: np.ndarray, follower: np.ndarray, found: Passes, travel: float, curve: Curve, drift: np.ndarray
) -> tuple[float, float, float]:
    """What one travel leaves (mean square), half the distance of the levels, and the slope of the link."""
    where = states(driver, found, travel)
    known = where.side != 0.0
    if np.mean(known) < KNOWN or np.ptp(where.side[known]) == 0.0:
        return np.inf, 0.0, 1.0
    at = where.held_at[known]
    rows = np.concatenate([-where.side[known][:, None], drift[known], curve.rows(at)], axis=1)
    mean_square, values = _rest(rows, follower[known] - at)
    on_line = curve.rows(np.linspace(curve.low, curve.high, 33)) @ values[1 + drift.shape[1] :]
    slope = float(np.polyfit(np.linspace(curve.low, curve.high, 33), on_line, 1)[0])
    return mean_square, float(values[0]), 1.0 + slope


def _rest(rows: np.ndarray, answer: np.ndarray) -> tuple[float, np.ndarray]:
    """Mean square of what a least squares leaves, and its coefficients."""
    scale = np.sqrt(np.sum(rows**2, axis=0)) + 1e-300
    scaled = rows / scale
    values = np.linalg.solve(scaled.T @ scaled + 1e-12 * np.eye(rows.shape[1]), scaled.T @ answer)
    return float(np.mean((answer - scaled @ values) ** 2)), values / scale
