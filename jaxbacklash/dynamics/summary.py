"""What is kept of a run, whichever way it was followed."""

from __future__ import annotations

from typing import Any

import jax.numpy as jnp
import numpy as np

from .errorbars import batch_error
from .plan import Followed, Plan

Array = Any


def summary(plan: Plan, period: Array, p: Array, v: Array, growth: Array, unresolved: Array) -> Followed:
    """Exponent, error bar and samples from what a run gave at the plan's stops.

    Parameters
    ----------
    period : (N,) length of a period
    p, v, growth : (stops, N) position, speed, and the logarithm of the tangent vector's growth so far
    unresolved : (N,) True where the solver gave up
    """
    stops = plan.stops
    from_here = int(np.searchsorted(stops, plan.skip))
    counted = growth[from_here:]
    mean = (counted[-1] - counted[0]) / (plan.periods - plan.skip)
    error = batch_error(stops[from_here:], counted)
    last = jnp.stack([p[-1], v[-1]])
    bad = unresolved | ~jnp.isfinite(mean)
    return Followed(jnp.where(bad, jnp.nan, mean / period), error / period, p[-plan.samples :], v[-plan.samples :], bad, last)
