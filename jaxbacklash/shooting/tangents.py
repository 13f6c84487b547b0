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
from .panel_tangents import DRIVEN, MOVING, drive, panel_matrices
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


def output_matrices(w: Windows, rebuild: Any, theta: Array, states: tuple[Array, ...], *given: Array) -> Array:
    """Derivatives of the measured channels at the samples, (n + g + q, W, M C): by state, by each of the g ``given`` of the drive
    (u and du, or those and the exact force), by theta."""
    n, own, q = len(states), len(states) + len(given), theta.shape[0]
    t = w.t0[:, None] + w.panel * w.every * jnp.arange(w.samples)

    def show(free: Array, theta: Array, t: Array, force: Array) -> Array:
        system = rebuild(theta)
        at = drive(w, free[n], free[n + 1], force if own == n + 2 else free[n + 2])
        return system.output(system.passed(t, w.panel)[0], tuple(free[i] for i in range(n)), at)

    lanes = jax.vmap(jax.vmap(show, in_axes=(-1, None, 0, 0)), in_axes=(-2, None, 0, 0))
    free = jnp.stack([*states, *given])
    force = w.force[:, : -1 : w.every]

    def push(e: Array) -> Array:
        moved = jnp.broadcast_to(e[:own, None, None], free.shape)
        shown = jax.jvp(lambda o, th: lanes(o, th, t, force), (free, theta), (moved, e[own:]))[1]
        return shown.reshape(*t.shape[:1], -1)

    return jax.vmap(push)(jnp.eye(own + q))


def chain(matrices: Array, basis: Array, lagged: Array | None, torques: Array | None = None) -> tuple[Array, Array]:
    """Products along the windows.

    Parameters
    ----------
    matrices : (P, n + e + q, n, W) of `panel_matrices`
    basis : (2, P+1, L, W) input and rate at panel edges per spline coefficient, W = 1 where windows do not differ
    lagged : (2, W, P+1, q) how they move with theta where the measured channel lags, else None
    torques : (W, K, P+1) torques on the link at panel edges, whose sizes are K more parameters; with the matrices by force

    Returns
    -------
    tangents at the left edge of every panel, (P, n, n + L + q + K, W), and at the end, (n, n + L + q + K, W)
    """
    n, free, windows = matrices.shape[2], basis.shape[2], matrices.shape[3]
    before = n + (MOVING if torques is None else DRIVEN)
    q = matrices.shape[1] - before + (0 if torques is None else torques.shape[1])
    first = jnp.zeros((n, n + free + q, windows)).at[jnp.arange(n), jnp.arange(n)].set(1.0)
    edges = jnp.stack([basis[0, :-1], basis[1, :-1], basis[0, 1:], basis[1, 1:]], axis=1)  # (P, 4, L, W)
    late, pushed = jnp.zeros((edges.shape[0], 0)), jnp.zeros((edges.shape[0], n, 0, windows))
    if lagged is not None:
        stacked = jnp.stack([lagged[0, :, :-1], lagged[1, :, :-1], lagged[0, :, 1:], lagged[1, :, 1:]], axis=-1)
        late = jnp.einsum("wpqe,penw->pnqw", stacked, matrices[:, n : n + MOVING])
    if torques is not None:
        forces = jnp.stack([torques[:, :, :-1], torques[:, :, 1:]])
        pushed = jnp.einsum("ewkp,penw->pnkw", forces, matrices[:, n + MOVING : before])

    def step(tangent: Array, at: Any) -> tuple[Array, Array]:
        own, edge, extra, push = at
        following = sum(own[j][:, None] * tangent[j] for j in range(n))
        by_input = sum(own[n + e][:, None] * edge[e] for e in range(4))
        by_theta = jnp.swapaxes(own[before:], 0, 1)
        if lagged is not None:
            by_theta = by_theta + extra
        added = jnp.concatenate([jnp.zeros((n, n, windows)), by_input, by_theta, push], axis=1)
        return following + added, tangent

    end, along = jax.lax.scan(step, first, (matrices, edges, late, pushed))
    return along, end


def rows(
    w: Windows, rebuild: Any, theta: Array, active: Array, plain: PlainMap | None, states: tuple[Array, ...], u: Array, du: Array,
    basis: Array, lagged: Array | None, torques: Array | None = None,
) -> tuple[Array, Array]:  # fmt: skip
    """Derivatives of the C measured channels at the samples, (W, n + L + q + K, M C), and of the ends of windows,
    (W, n + L + q + K, n).

    ``states`` (W, P) at panel edges, ``u`` and ``du`` (W, P+1); ``basis``, ``lagged`` and ``torques`` as `chain` takes them,
    ``active`` and ``plain`` as `panel_matrices` does.
    """
    n = len(states)
    matrices = panel_matrices(w, rebuild, theta, active, plain, states, u, du, MOVING if torques is None else DRIVEN)
    along, end = chain(matrices, basis, lagged, torques)
    at = slice(None, -1, w.every)
    given = (u[:, at], du[:, at]) if torques is None else (u[:, at], du[:, at], w.force[:, at])
    shown = output_matrices(w, rebuild, theta, tuple(s[:, :: w.every] for s in states), *given)
    channels = shown.shape[2] // w.samples
    by_state = jnp.repeat(along[:: w.every], channels, axis=0)  # (M C, n, n + L + q, W)
    tangent = sum(shown[i].T[:, None] * by_state[:, i] for i in range(n))
    by_input = sum(shown[n + e].T[:, None] * jnp.repeat(basis[e, at], channels, axis=0) for e in range(2))
    by_theta = jnp.transpose(shown[n + len(given) :], (2, 0, 1))
    if lagged is not None:
        by_theta = by_theta + sum(shown[n + e].T[:, None] * jnp.transpose(lagged[e][:, at], (1, 2, 0)) for e in range(2))
    if torques is not None:
        by_size = shown[n + 2].T[:, None] * jnp.repeat(jnp.transpose(torques[:, :, at], (2, 1, 0)), channels, axis=0)
        by_theta = jnp.concatenate([by_theta, by_size], axis=1)
    tangent = tangent + jnp.concatenate([jnp.zeros((by_theta.shape[0], n, w.count)), by_input, by_theta], axis=1)
    return jnp.transpose(tangent, (2, 1, 0)), jnp.transpose(end, (2, 1, 0))
