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

from .embedding import embed
from .neighbours import nearest, references

COUNTS = (12, 20, 35, 60, 110, 200)  # neighbours tried
SCAN = 600  # reference points the choice is made on
CHAIN = 12000  # points through which a difference is carried, at most
BLOCK = 1024
SINGULAR = 0.02  # directions that the neighbours span less than this share of the widest one are not fitted
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
    found = []
    for m in dimensions:
        points = embed(series, m, delay)
        usable = len(points) - delay
        if usable < 20 * m + 4 * theiler + 50:
            break
        tree = cKDTree(points[:usable])
        at = references(usable, SCAN, rng)
        counts = [count for count in COUNTS if 2 * m + 3 <= count <= usable // 8]
        if not counts:
            break
        _, where = nearest(tree, points[at], at, counts[-1], theiler)
        for count in counts:
            enough = where[:, count - 1] >= 0
            _, predicted = fit_maps(points, at[enough], where[enough, :count], delay)
            missed = predicted - points[at[enough] + delay, -1]
            found.append(LocalMap(m, count, float(np.sqrt(np.mean(missed**2))), float(np.median(np.abs(missed)))))
    return sorted(found, key=lambda one: one.error)


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
    maps = np.empty((at.size, chosen.dimension, chosen.dimension))
    for begin in range(0, at.size, BLOCK):
        here = at[begin : begin + BLOCK]
        _, where = nearest(tree, points[here], here, chosen.neighbours, theiler)
        # A point with too few neighbours outside the window repeats the ones it has.
        where = np.where(where < 0, where[:, :1], where)
        maps[begin : begin + BLOCK], _ = fit_maps(points, here, where, delay)
    steps_of = maps.reshape(length, chains, chosen.dimension, chosen.dimension)
    direction = rng.standard_normal((chains, chosen.dimension))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    rates = np.zeros((length, chains))
    for k in range(length):
        direction = (steps_of[k] @ direction[:, :, None])[:, :, 0]
        grown = np.linalg.norm(direction, axis=1)
        lost = grown < 1e-9  # a map that keeps nothing says nothing: begin anew
        rates[k] = np.where(lost, 0.0, np.log(np.maximum(grown, 1e-9)))
        direction = np.where(lost[:, None], 1.0 / np.sqrt(chosen.dimension), direction / np.maximum(grown, 1e-9)[:, None])
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
