"""What a sample should be by its neighbours, and runs of equal flags: the arithmetic that several checks share."""

from __future__ import annotations

import numpy as np


def surprise(values: np.ndarray) -> np.ndarray:
    """How far each sample lies from the cubic through the two before and the two after it.

    Parameters
    ----------
    values : array of shape (N,), N >= 5, at even steps

    Returns
    -------
    array of shape (N,)
        In the unit of the values, 0 for the first and the last two. White noise of standard deviation s gives 1.39 s; a single
        sample off by S gives S (1/6, -2/3, 1, -2/3, 1/6) around it, and a lasting shift by S gives S (-1, 3, -3, 1)/6.
    """
    out = np.zeros_like(values)
    out[2:-2] = values[2:-2] - (4.0 * (values[1:-3] + values[3:-1]) - values[:-4] - values[4:]) / 6.0
    return out


def runs(flags: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First rows and lengths of the runs of True in an array of shape (N,)."""
    edges = np.flatnonzero(np.diff(flags.astype(np.int8), prepend=np.int8(0), append=np.int8(0)))
    return edges[::2], edges[1::2] - edges[::2]


def quantum(values: np.ndarray) -> float:
    """The smallest step between samples that is no rounding of double precision; 0 for a constant."""
    steps = np.abs(np.diff(values))
    steps = steps[steps > 1e-13 * np.abs(values).max(initial=0.0)]
    return float(steps.min(initial=np.inf)) if steps.size else 0.0
