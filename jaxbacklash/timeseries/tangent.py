"""The dynamics as a patchwork of linear maps fitted to near neighbours, and the exponent of their product.

Sano and Sawada (1985); Eckmann, Kamphorst, Ruelle and Ciliberto (1986). Around each state the neighbours' futures give an
affine map; carrying a small difference along the trajectory through these maps gives the largest exponent. Nothing grows
until it saturates here, so short records suffice, which two neighbours that must stay near each other do not. How large the
neighbourhoods are and how many coordinates count is decided by prediction: the maps that predict best, out of sample, are used.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ..side_by_side import side_by_side
from .embedding import embed
from .neighbours import nearest, references

COUNTS = (12, 20, 35, 60, 110, 200)  # neighbours tried
SCAN = 600  # reference points the choice is made on
CHAIN = 12000  # points through which a difference is carried, at most
BLOCK = 1024
SINGULAR = 0.02  # directions that the neighbours span less than this share of the widest one are not fitted
VANISHED = 1e-9  # a map that keeps nothing of a difference says nothing: begin anew
SETTLING = 10  # maps after which a difference points in the most unstable direction


@dataclass(frozen=True)
class LocalMap:
    """How well maps from ``neighbours`` points in ``dimension`` coordinates predict: ``error`` rms, ``median`` of the absolute
    error, both one delay ahead, in standard deviations of the series."""

    dimension: int
    neighbours: int
    error: float
    median: float


@dataclass(frozen=True, eq=False)
class Growth:
    """How a small difference grows along the trajectory: ``rates`` (chains, steps) per sample, ``map`` it came from."""

    map: LocalMap
    rates: np.ndarray

    @property
    def exponent(self) -> float:
        """Mean rate per sample."""
        return float(self.rates.mean())


def scan(series: np.ndarray, delay: int, theiler: int, dimensions: range, rng: np.random.Generator) -> list[LocalMap]:
    """Out-of-sample prediction error for each number of coordinates and neighbours, best first.

    Parameters
    ----------
    series : (N,) with standard deviation 1
    delay, theiler : samples; neighbours within the Theiler window of the predicted point are never used
    dimensions : numbers of coordinates to try
    rng : chooses the points judged
    """
    asked = []
    for m in dimensions:
        usable = series.size - m * delay
        counts = [count for count in COUNTS if 2 * m + 3 <= count <= usable // 8]
        if usable < 20 * m + 4 * theiler + 50 or not counts:
            break
        asked.append((m, counts, references(usable, SCAN, rng)))

    def judged(one: tuple[int, list[int], np.ndarray]) -> list[LocalMap]:
        m, counts, at = one
        points, found = embed(series, m, delay), []
        tree = cKDTree(points[: series.size - m * delay])
        _, where = nearest(tree, points[at], at, counts[-1], theiler)
        for count in counts:
            enough = where[:, count - 1] >= 0
            _, predicted = fit_maps(points, at[enough], where[enough, :count], delay)
            missed = predicted - points[at[enough] + delay, -1]
            found.append(LocalMap(m, count, float(np.sqrt(np.mean(missed**2))), float(np.median(np.abs(missed)))))
        return found

    return sorted((found for each in side_by_side(judged, asked) for found in each), key=lambda one: one.error)


def growth(
    series: np.ndarray, delay: int, theiler: int, chosen: LocalMap, rng: np.random.Generator, chain: int = CHAIN
) -> Growth:
    """Carry a small difference along the series through the fitted maps.

    A series with more steps than ``chain`` is followed in contiguous pieces, spread evenly over it.

    Parameters
    ----------
    series : (N,) with standard deviation 1
    delay, theiler : samples
    chosen : what maps to fit
    rng : first directions of the differences
    chain : points to carry them through, at most

    Returns
    -------
    Growth
    """
    points = embed(series, chosen.dimension, delay)
    usable = len(points) - delay
    tree = cKDTree(points[:usable])
    steps = usable // delay
    # Chains that begin a sample apart tell nearly the same, so three of them are enough.
    chains, length = max(1, min(delay, 3, chain // steps)), steps
    first = np.arange(chains) * delay // chains
    if steps > chain:
        chains, length = 12, chain // 12
        first = np.linspace(0, usable - length * delay, chains).astype(int)
    at = (first[None, :] + delay * np.arange(length)[:, None]).ravel()

    def fitted(begin: int) -> np.ndarray:
        here = at[begin : begin + BLOCK]
        _, where = nearest(tree, points[here], here, chosen.neighbours, theiler)
        # A point with too few neighbours outside the window repeats the ones it has.
        where = np.where(where < 0, where[:, :1], where)
        return fit_maps(points, here, where, delay)[0]

    maps = np.concatenate(side_by_side(fitted, range(0, at.size, BLOCK)))
    steps_of = maps.reshape(length, chains, chosen.dimension, chosen.dimension)
    direction = rng.standard_normal((chains, chosen.dimension))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    grown = np.empty((length, chains))
    for k, step in enumerate(steps_of):
        direction = (step @ direction[:, :, None])[:, :, 0]
        grown[k] = size = np.sqrt(np.einsum("cm,cm->c", direction, direction))
        direction = direction / np.maximum(size, VANISHED)[:, None]
        if size.min() < VANISHED:
            direction[size < VANISHED] = 1.0 / np.sqrt(chosen.dimension)
    rates = np.log(np.where(grown < VANISHED, 1.0, grown))
    return Growth(chosen, rates[min(SETTLING, length // 4) :].T / delay)


def fit_maps(points: np.ndarray, at: np.ndarray, where: np.ndarray, delay: int) -> tuple[np.ndarray, np.ndarray]:
    """Affine maps over one delay from neighbours ``where`` (R, q): Jacobians (R, m, m), and predictions (R,) of the newest
    coordinate at the points ``at``."""
    m = points.shape[1]
    jacobian = np.zeros((at.size, m, m))
    # One delay later a delay vector has moved up by one place; only its newest coordinate is unknown.
    jacobian[:, np.arange(m - 1), np.arange(1, m)] = 1.0
    predicted = np.empty(at.size)
    for begin in range(0, at.size, BLOCK):
        rows = slice(begin, min(begin + BLOCK, at.size))
        near, after = points[where[rows]], points[where[rows] + delay, -1]
        centre, later = near.mean(axis=1), after.mean(axis=1)
        spread = near - centre[:, None]
        turned = spread.transpose(0, 2, 1)
        values, axes = np.linalg.eigh(turned @ spread)
        inverse = np.where(values > SINGULAR**2 * values[:, -1:], 1.0 / np.maximum(values, 1e-300), 0.0)
        moved = (turned @ (after - later[:, None])[:, :, None])[:, :, 0]
        slope = np.einsum("rij,rj->ri", axes, inverse * np.einsum("rji,rj->ri", axes, moved))
        jacobian[rows, -1] = slope
        predicted[rows] = later + np.sum(slope * (points[at[rows]] - centre), axis=1)
    return jacobian, predicted
