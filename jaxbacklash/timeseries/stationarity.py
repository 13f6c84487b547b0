"""Does the motion keep its nature over the record, or is it a different one at its end?"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from .embedding import embed
from .neighbours import nearest, references

PARTS = 10
REFERENCES = 400
NEIGHBOURS = 5


def kept_company(series: np.ndarray, dimension: int, delay: int, theiler: int, rng: np.random.Generator) -> float:
    """Share of nearest neighbours that come from the same tenth of the record.

    A steady motion comes back to a state at any time, so a tenth of the neighbours do. In a sweep or a decay states recur
    only near their own time, and distances between neighbours then say how the motion changes, not how it forgets its
    start (the idea of the space time separation plot, Provenzale et al., 1992).

    Parameters
    ----------
    series : (N,)
    dimension, delay, theiler : of the delay vectors; samples
    rng : chooses the reference points
    """
    points = embed(series, dimension, delay)
    at = references(len(points), REFERENCES, rng)
    _, where = nearest(cKDTree(points), points[at], at, NEIGHBOURS, theiler)
    part = len(points) / PARTS
    found = where >= 0
    same = (where // part) == (at[:, None] // part)
    return float((same & found).sum() / max(1, found.sum()))
