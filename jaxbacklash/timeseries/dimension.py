"""How many delay coordinates unfold the attractor: false nearest neighbours, and Cao's E1 and E2."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ..side_by_side import side_by_side
from .embedding import embed
from .neighbours import nearest, references

LARGEST = 10
REFERENCES = 2000
RATIO, SIZE = 15.0, 2.0  # thresholds of Kennel, Brown and Abarbanel (1992)
FALSE_SHARE = 0.01
FLAT = 0.9  # E1 has stopped changing once it stays above so much of its last value


@dataclass(frozen=True, eq=False)
class Dimension:
    """Embedding dimension by two rules.

    ``dimensions`` (D,); ``e1``, ``e2`` (D,) of Cao (1997), (2.11); ``false_share`` (D,) share of false nearest neighbours;
    ``cao``, ``false_neighbours`` the dimension each rule takes, None where it finds none up to the largest tried.
    """

    dimensions: np.ndarray
    e1: np.ndarray
    e2: np.ndarray
    false_share: np.ndarray
    cao: int | None
    false_neighbours: int | None


def embedding_dimension(
    series: np.ndarray, delay: int, theiler: int, rng: np.random.Generator, largest: int = LARGEST
) -> Dimension:
    """E1, E2 and false nearest neighbours for dimensions 1 ... ``largest``.

    Cao's number compares how far nearest neighbours (maximum norm) move apart when one more coordinate is looked at; E1 stops
    changing at the dimension that unfolds the attractor, and E2 differs from 1 somewhere if the series is not random. The
    paper's (2.10) is Cao's a(i, d); E1(d) = E(d+1)/E(d). Rule: the smallest d from which on E1 stays above 90 % of its last
    value; by false neighbours, the smallest d with at most 1 % false ones.

    Parameters
    ----------
    series : (N,)
    delay, theiler : samples
    rng : chooses the reference points of a long series, one from each of `REFERENCES` stretches
    largest : dimension up to which the numbers are given
    """
    deviation = float(series.std())
    while series.size - (largest + 1) * delay < 50 + 2 * theiler and largest > 2:
        largest -= 1

    def judged(asked: tuple[int, np.ndarray]) -> tuple[float, float, float]:
        d, at = asked
        points = embed(series, d, delay)[: series.size - d * delay]
        apart, where = nearest(cKDTree(points), points[at], at, 2, theiler, p=np.inf)
        # Equal vectors (an encoder's counts) have no ratio of distances; the next neighbour stands in.
        zero = apart[:, 0] <= 0.0
        apart, where = np.where(zero, apart[:, 1], apart[:, 0]), np.where(zero, where[:, 1], where[:, 0])
        used = (where >= 0) & (apart > 0.0) & np.isfinite(apart)
        at, apart, where = at[used], apart[used], where[used]
        step = np.abs(series[at + d * delay] - series[where + d * delay])
        if not at.size:
            return 1.0, float("nan"), 0.0
        further = np.hypot(np.sqrt(np.sum((points[at] - points[where]) ** 2, axis=1)), step)
        false = np.mean((step / apart > RATIO) | (further / deviation > SIZE))
        return float(np.mean(np.maximum(step, apart) / apart)), float(np.mean(step)), float(false)

    tried = range(1, largest + 2)
    e, star, false = zip(*side_by_side(judged, [(d, references(series.size - d * delay, REFERENCES, rng)) for d in tried]))
    dimensions = np.arange(1, largest + 1)
    e_, star_ = np.array(e), np.maximum(np.array(star), 1e-300)
    e1, e2 = e_[1:] / e_[:-1], star_[1:] / star_[:-1]
    few = np.flatnonzero(np.array(false[:-1]) <= FALSE_SHARE)
    return Dimension(dimensions, e1, e2, np.array(false[:-1]), _settled(e1), int(dimensions[few[0]]) if few.size else None)


def _settled(e1: np.ndarray) -> int | None:
    """Smallest dimension from which on E1 no longer changes."""
    last = float(np.median(e1[-3:]))
    if e1.size < 4 or last < 0.8:
        return None
    low = np.flatnonzero(e1 < FLAT * last)
    start = int(low[-1]) + 1 if low.size else 0
    return start + 1 if start < e1.size - 1 else None
