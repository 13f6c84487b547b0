"""Delay vectors: the state of a system from one measured coordinate (Takens, 1981)."""

from __future__ import annotations

import numpy as np


def embed(series: np.ndarray, dimension: int, delay: int) -> np.ndarray:
    """Vectors (s_i, s_{i+delay}, ..., s_{i+(m-1) delay}) (2.9).

    Parameters
    ----------
    series : (N,)
    dimension : m
    delay : samples between neighbouring coordinates

    Returns
    -------
    array of shape (N - (m - 1) delay, m), a copy laid out row by row
    """
    rows = vectors(series.size, dimension, delay)
    return np.ascontiguousarray(np.stack([series[shift * delay : shift * delay + rows] for shift in range(dimension)], axis=1))


def vectors(samples: int, dimension: int, delay: int) -> int:
    """How many delay vectors a series of so many samples has."""
    return max(0, samples - (dimension - 1) * delay)
