r"""How the prediction of every window moves with its unknowns.

A window is a chain of panels, so its derivatives are products of the panels' own: with :math:`s_{k+1} = P(s_k, u_k, u_{k+1};
\theta)`, the tangents obey :math:`S_{k+1} = A_k S_k + B_k E_k + C_k`. Once the motion is known, the small matrices A, B, C of all
panels of all windows are found at once, without a loop (`jaxbacklash.shooting.panel_tangents`); what is left to do in order is
the product. The input's many spline coefficients act only through four numbers a panel (input and rate at both ends), so they
cost next to nothing.
"""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

from ..solvers.plain_panels import PlainMap
from ..solvers.substeps import run_panels
from ..system import System
from .panel_tangents import drive, panel_matrices
from .windows import Windows

Array = Any


def trajectories(w: Windows, system: System, starts: Array, u: Array, du: Array) -> tuple[Array, tuple[Array, ...]]:
    """States of all windows: at the end (n, W), and at the left edge of every panel, a tuple of n arrays (W, P)."""

    def one(start: Array, t0: Array, u: Array, du: Array, force: Array) -> Any:
        state = tuple(start[i] for i in range(starts.shape[0]))
        begin, panel = system.passed(t0, w.panel)
        return run_panels(system, begin, state, drive(w, u, du, force), panel, 1, system.switches)

    end, states = jax.vmap(one, in_axes=(1, 0, 0, 0, 0))(starts, w.t0, u, du, w.force)
    return jnp.stack(end), states


def output_matrices(w: Windows, rebuild: Any, theta: Array, states: tuple[Array, ...], u: Array, du: Array) -> Array:
    """Derivatives of the measured channels at the samples, (n + 2 + q, W, M C): by state, by u and du, by theta."""
    n, q = len(states), theta.shape[0]
    t = w.t0[:, None] + w.panel * w.every * jnp.arange(w.samples)

    def show(own: Array, theta: Array, t: Array, force: Array) -> Array:
        system = rebuild(theta)
        return system.output(system.passed(t, w.panel)[0], tuple(own[i] for i in range(n)), drive(w, own[n], own[n + 1], force))

    lanes = jax.vmap(jax.vmap(show, in_axes=(-1, None, 0, 0)), in_axes=(-2, None, 0, 0))
    own = jnp.stack([*states, u, du])
    force = w.force[:, : -1 : w.every]

    def push(e: Array) -> Array:
        moved = jnp.broadcast_to(e[: n + 2, None, None], own.shape)
        shown = jax.jvp(lambda o, th: lanes(o, th, t, force), (own, theta), (moved, e[n + 2 :]))[1]
        return shown.reshape(*t.shape[:1], -1)

    return jax.vmap(push)(jnp.eye(n + 2 + q))


def chain(matrices: Array, basis: Array, lagged: Array | None) -> tuple[Array, Array]:
    """Products along the windows.

    Parameters
    ----------
    matrices : (P, n + 4 + q, n, W) of `panel_matrices`
    basis : (2, P+1, L, W) input and rate at panel edges per spline coefficient, W = 1 where windows do not differ
    lagged : (2, W, P+1, q) how they move with theta where the measured channel lags, else None

    Returns
    -------
    tangents at the left edge of every panel, (P, n, n + L + q, W), and at the end, (n, n + L + q, W)
    """
    n, free, windows = matrices.shape[2], basis.shape[2], matrices.shape[3]
    q = matrices.shape[1] - n - 4
    first = jnp.zeros((n, n + free + q, windows)).at[jnp.arange(n), jnp.arange(n)].set(1.0)
    edges = jnp.stack([basis[0, :-1], basis[1, :-1], basis[0, 1:], basis[1, 1:]], axis=1)  # (P, 4, L, W)
    late = jnp.zeros((edges.shape[0], 0))
    if lagged is not None:
        stacked = jnp.stack([lagged[0, :, :-1], lagged[1, :, :-1], lagged[0, :, 1:], lagged[1, :, 1:]], axis=-1)
        late = jnp.einsum("wpqe,penw->pnqw", stacked, matrices[:, n : n + 4])

    def step(tangent: Array, at: Any) -> tuple[Array, Array]:
        own, edge, extra = at
        following = sum(own[j][:, None] * tangent[j] for j in range(n))
        by_input = sum(own[n + e][:, None] * edge[e] for e in range(4))
        by_theta = jnp.swapaxes(own[n + 4 :], 0, 1)
        if lagged is not None:
            by_theta = by_theta + extra
        added = jnp.concatenate([jnp.zeros((n, n, windows)), by_input, by_theta], axis=1)
        return following + added, tangent

    end, before = jax.lax.scan(step, first, (matrices, edges, late))
    return before, end


def rows(
    w: Windows, rebuild: Any, theta: Array, active: Array, plain: PlainMap | None, states: tuple[Array, ...], u: Array, du: Array,
    basis: Array, lagged: Array | None,
) -> tuple[Array, Array]:  # fmt: skip
    """Derivatives of the C measured channels at the samples, (W, n + L + q, M C), and of the ends of windows, (W, n + L + q, n).

    ``states`` (W, P) at panel edges, ``u`` and ``du`` (W, P+1); ``basis`` and ``lagged`` as `chain` takes them,
    ``active`` and ``plain`` as `panel_matrices` does.
    """
    n = len(states)
    along, end = chain(panel_matrices(w, rebuild, theta, active, plain, states, u, du), basis, lagged)
    at = slice(None, -1, w.every)
    shown = output_matrices(w, rebuild, theta, tuple(s[:, :: w.every] for s in states), u[:, at], du[:, at])
    channels = shown.shape[2] // w.samples
    by_state = jnp.repeat(along[:: w.every], channels, axis=0)  # (M C, n, n + L + q, W)
    tangent = sum(shown[i].T[:, None] * by_state[:, i] for i in range(n))
    by_input = sum(shown[n + e].T[:, None] * jnp.repeat(basis[e, at], channels, axis=0) for e in range(2))
    by_theta = jnp.transpose(shown[n + 2 :], (2, 0, 1))
    if lagged is not None:
        by_theta = by_theta + sum(shown[n + e].T[:, None] * jnp.transpose(lagged[e][:, at], (1, 2, 0)) for e in range(2))
    tangent = tangent + jnp.concatenate([jnp.zeros((by_theta.shape[0], n, w.count)), by_input, by_theta], axis=1)
    return jnp.transpose(tangent, (2, 1, 0)), jnp.transpose(end, (2, 1, 0))
