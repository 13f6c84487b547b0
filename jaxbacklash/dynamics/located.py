"""The general way of following motions: Runge-Kutta panels that end at edges and at rest, for any system and any drive.

The tangent is the derivative of the panels themselves, their switching times included, so that it has the jumps of contact
damping and of dry friction.
"""

from __future__ import annotations

from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from ..excitation import AbstractExcitation
from ..mechanics import Drive
from ..solvers.substeps import run_panels
from ..system import System
from .courses import begins
from .plan import Followed, Plan
from .summary import summary

Array = Any
State = tuple[Array, ...]

PANELS = 128
"""Fewest panels in a period of the drive where steps are only located."""
IN_A_SWING = 40
"""Panels in a period of the fastest linear motion of the system in contact."""


def default_panels(system: System, period: Array) -> int:
    """Panels in a period: at least `PANELS`, and `IN_A_SWING` in a period of the fastest motion among the cells.

    The fastest is that of the system linearised in contact, half a play deep, friction apart: with what hangs behind the link
    and the states of hysteresis. Steps of a half in the count keep one program for many tiles of a map.
    """
    count = IN_A_SWING * float(np.max(np.asarray(period))) * fastest(system) / (2.0 * np.pi)
    return int(np.ceil(max(count / PANELS, 1.0) * 2.0) / 2.0 * PANELS)


def fastest(system: System) -> float:
    """The largest rate [rad/s] of the system linearised half a play deep in contact, among its cells."""
    cells = np.broadcast_shapes(*(np.shape(leaf) for leaf in jax.tree.leaves(system)))
    count = int(np.prod(cells)) if cells else 1
    slopes = np.asarray(_slopes(jax.tree.map(lambda leaf: jnp.broadcast_to(jnp.asarray(leaf, dtype=float), (count,)), system)))
    known = slopes[np.isfinite(slopes).all(axis=(1, 2))]
    return float(np.abs(np.linalg.eigvals(known)).max()) if len(known) else 0.0


@jax.jit
def _slopes(system: System) -> Array:
    def one(system: System) -> Array:
        t = jnp.zeros(())
        edge = system.edges(t, 0.0 * t) if system.has_play else (0.0, 0.0)
        z = edge[1] + 0.5 * (edge[1] - edge[0])
        side = jnp.ones(()) if system.has_play else None
        drive = Drive(0.0 * t, 0.0 * t, 0.0 * t)
        state = jnp.stack([jnp.asarray(s) * jnp.ones(()) for s in system.rest(t, z, 0.0 * z, drive)])
        return jax.jacfwd(lambda q: jnp.stack(system.sliding(t, tuple(q), drive, side)[0]))(state)

    return jax.vmap(one)(system)


def over_cells(tree: Any, like: Array) -> Any:
    """Every number of a system or drive as an array over the cells."""
    return jax.tree.map(lambda leaf: jnp.asarray(leaf, dtype=float) * jnp.ones(jnp.shape(like)), tree)


def own_and_shared(drive: AbstractExcitation, like: Array) -> tuple[Any, Any]:
    """A drive in two parts that `eqx.combine` joins: its numbers as arrays over the cells, and the series all cells share."""
    mine = jax.tree_util.tree_map_with_path(lambda path, _: path[0].name not in drive.series, drive)
    own, shared = eqx.partition(drive, mine)
    return over_cells(own, like), shared


def follow_located(
    system: System, drive: AbstractExcitation, period: Array, y0: Array, dy0: Array, plan: Plan, panels: int
) -> Followed:
    """`follow` by located panels; ``period`` (N,) [s]."""
    own, shared = own_and_shared(drive, y0)
    return _follow(over_cells(system, y0), own, shared, period, y0, dy0, plan, panels)


@eqx.filter_jit
def _follow(system: System, own: Any, shared: Any, period: Array, y0: Array, dy0: Array, plan: Plan, panels: int) -> Followed:
    def one(system: System, own: Any, period: Array, y0: Array, dy0: Array) -> Followed:
        drive = eqx.combine(own, shared)
        state = system.rest(jnp.asarray(begins(drive), dtype=float), y0, dy0, drive.at(jnp.asarray(begins(drive), dtype=float)))
        return _one(system, drive, period, state, plan, panels)[0]

    return jax.vmap(one, out_axes=-1)(system, own, period, y0, dy0)


@eqx.filter_jit
def sweep_located(
    system: System, own: Any, shared: Any, period: Array, z0: Array, dz0: Array, plan: Plan, panels: int
) -> tuple[Array, Array, Array, Array]:
    """Motions that go on from value to value: samples z, dz (V, S, K) and exponents with error bars (V, K).

    Leaves of ``system`` and ``own`` and ``period`` are (V, K): K sweeps beside one another. The relative motion and the
    internal states go on; the drive begins anew, so that only a drive that repeats is the same at every value.
    """

    def begin(system: System, own: Any, z: Array, dz: Array) -> State:
        drive = eqx.combine(own, shared).at(jnp.zeros(()))
        return system.rest(jnp.zeros(()), z + drive.x, dz + drive.dx, drive)

    def one(system: System, own: Any, period: Array, state: State) -> tuple[Followed, State]:
        drive = eqx.combine(own, shared)
        now = drive.at(jnp.zeros(()))
        found, end = _one(system, drive, period, (state[0] + now.x, state[1] + now.dx, *state[2:]), plan, panels)
        return found, (found.last[0], found.last[1], *end[2:])

    def step(state: State, at: Any) -> Any:
        values, own, length = at
        found, state = jax.vmap(one, out_axes=-1)(values, own, length, state)
        return state, (found.p, found.v, found.lyapunov, found.stderr)

    one_system, one_drive = jax.tree.map(lambda leaf: leaf[0], (system, own))
    state = jax.vmap(begin)(one_system, one_drive, z0, dz0)
    now = jax.vmap(lambda own: eqx.combine(own, shared).at(jnp.zeros(())))(one_drive)
    relative = (state[0] - now.x, state[1] - now.dx, *(s * jnp.ones_like(z0) for s in state[2:]))
    return jax.lax.scan(step, relative, (system, own, period))[1]


def _one(
    system: System, drive: AbstractExcitation, period: Array, state: State, plan: Plan, panels: int
) -> tuple[Followed, State]:
    """One cell from a state at the drive's beginning, and the state at the end."""
    h, begin = period / panels, begins(drive)
    start = drive.at(jnp.asarray(begin, dtype=float))
    state = tuple(jnp.asarray(s, dtype=float) * jnp.ones(()) for s in state)

    def one_period(carry: Any, k: Array) -> Any:
        state, tangent, growth = carry
        t = begin + k * period
        edges = drive.grid(t, h, panels)

        def go(s: Any) -> Any:
            return run_panels(system, t, s, edges, h, panels, system.switches)[0]

        state, tangent = jax.jvp(go, (state,), (tangent,))
        size = jnp.sqrt(sum(d * d for d in tangent))
        growth = growth + jnp.log(size)
        after = jax.tree.map(lambda u: u[-1], edges)
        return (state, tuple(d / size for d in tangent), growth), (state[0] - after.x, state[1] - after.dx, growth)

    tangent = tuple(jnp.ones(()) if i == 0 else jnp.zeros(()) for i in range(len(state)))
    begun = (state, tangent, jnp.zeros(()))
    (end, _, _), (z, dz, growth) = jax.lax.scan(one_period, begun, jnp.arange(float(plan.periods)))
    at = (plan.stops[1:] - 1).astype(int)
    z, dz, growth = (jnp.concatenate([first[None], all_[at]]) for first, all_ in (
        (state[0] - start.x, z), (state[1] - start.dx, dz), (jnp.zeros(()), growth)))  # fmt: skip
    found = summary(plan, period, z[:, None], dz[:, None], growth[:, None], jnp.zeros(1, dtype=bool))
    return jax.tree.map(lambda leaf: leaf[..., 0], found), end
