"""The input of each shooting window from the coefficients of its quintic spline, and how it moves with them and with a lag.

Base motion, or a smooth force; `jaxbacklash.shooting.multiple_shooting` runs the windows with it.
"""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

from ..signals import DEGREE
from ..system import System
from .problem import Problem
from .windows import Windows

Array = Any


def lags(w: Windows, system: System, t0: Array) -> Array | None:
    """How far the measured channel lags at the panel edges of windows that begin at ``t0`` (...), (..., P + 1) [s]; None where no
    law makes it lag."""
    times = jnp.asarray(t0)[..., None] + w.panel * jnp.arange(w.basis.shape[1])
    lag = system.lag(times)
    return None if lag is None else jnp.broadcast_to(lag, times.shape)


def spline_input(w: Windows, lag: Array | None, local: Array) -> tuple[Array, Array]:
    """Input and its rate at a window's panel edges, (P + 1,) each, from its ``local`` coefficients (m + 5,); the command of a
    servo is there as it is.

    ``lag`` (P + 1,) [s] is that of the measured channel, None where no law makes it lag.
    """
    if w.by_command:
        return local, jnp.zeros_like(local)
    if not w.intervals:
        zero = jnp.zeros(w.basis.shape[1])
        return zero, zero
    if lag is None:
        return w.basis[0] @ local, w.basis[1] @ local
    # The measured channel lags: it shows the motion that an equally delayed input would have caused. The Taylor series
    # of a quintic ends after six terms, so it is exact within a knot interval.
    u = du = 0.0
    factor: Any = 1.0
    for order in range(DEGREE + 1):
        u = u + factor * (w.basis[order] @ local)
        if order < DEGREE:
            du = du + factor * (w.basis[order + 1] @ local)
        factor = -factor * lag / (order + 1)
    return u, du


def input_tangents(problem: Problem, theta: Array, local: Array) -> tuple[Array, Array | None]:
    """Derivatives of input and rate by the coefficients, (2, P + 1, m + 5, W), and by the parameters where a lag is one of them.

    ``theta`` (q,) are the free parameters, ``local`` (W, m + 5) the coefficients that each window sees. Where nothing lags all
    windows move alike, and the last axis has length 1.
    """
    w = problem.windows
    lag = lambda theta: lags(w, problem.rebuild(theta), w.t0)  # noqa: E731
    delay = lag(theta)
    if not w.intervals:
        return jnp.zeros((2, w.basis.shape[1], 0, 1)), None
    each = jnp.eye(local.shape[1])
    if delay is None:
        return jnp.stack(spline_input(w, None, each))[..., None], None
    basis = jax.vmap(lambda own: jnp.stack(spline_input(w, own[:, None], each)), out_axes=-1)(delay)
    by_lag = jax.jvp(lambda tau: jnp.stack(spline_input(w, tau, local.T)), (delay.T,), (jnp.ones_like(delay.T),))[1]
    return basis, jnp.swapaxes(by_lag, 1, 2)[..., None] * jax.jacfwd(lag)(theta)


def local_coefficients(w: Windows, coefficients: Array) -> Array:
    """Own coefficients and those that the window shares with the next, the first five of a quintic spline: (W, m + 5); where
    there is a command, that at the panel edges (W, P + 1)."""
    if w.by_command:
        return w.command
    shared = w.basis.shape[2] - w.intervals
    if shared == 0:
        return coefficients
    following = jnp.concatenate([coefficients[1:], jnp.zeros_like(coefficients[:1])])
    return jnp.concatenate([coefficients, following[:, :shared]], axis=1)
