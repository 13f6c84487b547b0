r"""The error bar of an exponent from one run: batch means.

An exponent is the mean of the tangent vector's growth. Growth in neighbouring periods is correlated, so the spread of single
periods says little; means over batches that are long against the correlation are nearly independent, and the spread of
`BATCHES` of them over the root of their number is the error of the whole mean (Schmeiser, Operations Research 30, 1982). It is
widened by Student's factor, so that it may be used like one standard deviation. It tells how far a longer run would move the
number, not whether the run has left its transient.
"""

from __future__ import annotations

from typing import Any

import jax.numpy as jnp
import numpy as np

Array = Any

BATCHES = 10
STUDENT = (1.837, 1.321, 1.197, 1.142, 1.111, 1.091, 1.077, 1.067, 1.059)
"""Quantile of Student's distribution at one standard deviation, from one degree of freedom on: scipy.special would take a
tenth of a second to import, and a map waits for it."""


def batch_error(times: np.ndarray, growth: Array) -> Array:
    """Standard error of ``(growth[-1] - growth[0]) / (times[-1] - times[0])``.

    Parameters
    ----------
    times : (K,) moments at which growth was read
    growth : (K, N) logarithm of the tangent vector's growth up to then

    Returns
    -------
    (N,), in units of growth over time; NaN where there are fewer than two batches
    """
    edges = np.linspace(times[0], times[-1], min(BATCHES, times.size - 1) + 1)
    at = np.unique(np.searchsorted(times, edges - 1e-9).clip(0, times.size - 1))
    lengths = np.diff(times[at])
    if lengths.size < 2:
        return jnp.full(growth.shape[1:], jnp.nan)
    rates = jnp.diff(growth[at], axis=0) / lengths[:, None]
    share = lengths / lengths.sum()
    mean = jnp.sum(share[:, None] * rates, axis=0)
    # Batches differ in length by a chunk at most; each counts by its share.
    spread = jnp.sum(share[:, None] * (rates - mean) ** 2, axis=0) / (lengths.size - 1)
    return STUDENT[lengths.size - 2] * jnp.sqrt(spread)
