r"""How the prediction of every window moves with its unknowns.

A window is a chain of panels, so its derivatives are products of the panels' own: with :math:`s_{k+1} = P(s_k, u_k, u_{k+1};
\theta)`, the tangents obey :math:`S_{k+1} = A_k S_k + B_k E_k + C_k`. Once the motion is known, the small matrices A, B, C of all
panels of all windows are found at once, without a loop; what is left to do in order is the product. The input's many spline
coefficients act only through four numbers a panel (input and rate at both ends), so they cost next to nothing.
"""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

from ..mechanics import Drive
from ..solvers.substeps import one_panel, run_panels
from ..system import System
from .windows import Windows

Array = Any
BLOCK, TOGETHER = 400, 3
"""Panels that are differentiated side by side, at most, and directions that share one pass through the laws."""


def drive(w: Windows, u: Array, du: Array, force: Array) -> Drive:
    """The drive at a panel edge: ``u``, ``du`` is the splined input (base motion, force or torque at a motor) and its rate,
    ``force`` exact."""
    if w.by_torque:
        return Drive(jnp.zeros_like(u), jnp.zeros_like(u), force, None, u)
    if w.by_force:
        return Drive(jnp.zeros_like(u), jnp.zeros_like(u), force + u, du)
    return Drive(u, du, force)


def trajectories(w: Windows, system: System, starts: Array, u: Array, du: Array) -> tuple[Array, tuple[Array, ...]]:
    """States of all windows: at the end (n, W), and at the left edge of every panel, a tuple of n arrays (W, P)."""

    def one(start: Array, t0: Array, u: Array, du: Array, force: Array) -> Any:
        state = tuple(start[i] for i in range(starts.shape[0]))
        begin, panel = system.passed(t0, w.panel)
        return run_panels(system, begin, state, drive(w, u, du, force), panel, 1, system.switches)

    end, states = jax.vmap(one, in_axes=(1, 0, 0, 0, 0))(starts, w.t0, u, du, w.force)
    return jnp.stack(end), states


def panel_matrices(
    w: Windows, rebuild: Any, theta: Array, active: Array, states: tuple[Array, ...], u: Array, du: Array
) -> Array:
    """Derivatives of every panel's end, shape (P, n + 4 + q, n, W): by its start, by u, du at both edges, by theta.

    In blocks of panels that stay in the processor's cache, a few directions after the other, those of theta only as far as
    the first ``active``: some times faster than all at once, and with dry friction in a third less time than one by one.
    """
    n, q = len(states), theta.shape[0]
    panels, windows = w.force.shape[1] - 1, w.count
    blocks = -(-panels * windows // BLOCK)
    size = -(-panels * windows // blocks)

    def lay(values: Array) -> Array:
        flat = values.T.ravel()
        return jnp.pad(flat, (0, blocks * size - flat.size)).reshape(blocks, size)

    edges = (*states, u[:, :-1], du[:, :-1], u[:, 1:], du[:, 1:])
    t = w.t0[:, None] + w.panel * jnp.arange(panels)
    seeds = jnp.eye(-(-(n + 4 + q) // TOGETHER) * TOGETHER, n + 4 + q)

    def step(own: Any, theta: Array, t: Array, f0: Array, f1: Array) -> Any:
        system = rebuild(theta)
        a, b = drive(w, own[n], own[n + 1], f0), drive(w, own[n + 2], own[n + 3], f1)
        begin, panel = system.passed(t, w.panel)
        return one_panel(system, begin, own[:n], a, b, panel, system.switches)

    lanes = jax.vmap(step, in_axes=(0, None, 0, 0, 0))

    def block(at: Any) -> Any:
        own, t, f0, f1 = at

        def along(seed: Array) -> Any:
            moved = tuple(jnp.broadcast_to(seed[i], t.shape) for i in range(n + 4))
            return jax.jvp(lambda o, th: lanes(o, th, t, f0, f1), (own, theta), (moved, seed[n + 4 :]))[1]

        def push(turn: Array, found: Any) -> Any:
            first = turn * TOGETHER
            end = jax.vmap(along)(jax.lax.dynamic_slice_in_dim(seeds, first, TOGETHER))
            return tuple(jax.lax.dynamic_update_slice_in_dim(f, e, first, axis=0) for f, e in zip(found, end))

        empty = tuple(jnp.zeros((seeds.shape[0], size)) for _ in range(n))
        return jax.lax.fori_loop(0, -(-(n + 4 + active) // TOGETHER), push, empty)

    found = jax.lax.map(block, (tuple(lay(v) for v in edges), lay(t), lay(w.force[:, :-1]), lay(w.force[:, 1:])))

    def unlay(values: Array) -> Array:
        flat = jnp.swapaxes(values, 0, 1)[: n + 4 + q].reshape(n + 4 + q, -1)[:, : panels * windows]
        return jnp.swapaxes(flat.reshape(n + 4 + q, panels, windows), 0, 1)

    return jnp.stack([unlay(v) for v in found], axis=2)


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
    w: Windows, rebuild: Any, theta: Array, active: Array, states: tuple[Array, ...], u: Array, du: Array, basis: Array,
    lagged: Array | None,
) -> tuple[Array, Array]:  # fmt: skip
    """Derivatives of the C measured channels at the samples, (W, n + L + q, M C), and of the ends of windows, (W, n + L + q, n).

    ``states`` (W, P) at panel edges, ``u`` and ``du`` (W, P+1); ``basis`` and ``lagged`` as `chain` takes them.
    """
    n = len(states)
    along, end = chain(panel_matrices(w, rebuild, theta, active, states, u, du), basis, lagged)
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
