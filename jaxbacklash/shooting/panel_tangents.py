r"""How the end of every panel moves with its start, with the drive at both of its ends and with the parameters.

A panel is differentiated step by step, whatever its laws. Where the joint is linear between the edges of its play most panels
need not be: those that stay on one side have one map (`jaxbacklash.solvers.plain_panels`), and what is left are a few in a
hundred. `jaxbacklash.shooting.tangents` makes products of what is found here.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp

from ..mechanics import Drive
from ..solvers.plain_panels import PlainMap, is_linear, mapped, plain_map, sides
from ..solvers.substeps import one_panel
from ..system import System
from .windows import Windows

Array = Any
BLOCK, TOGETHER = 400, 3
"""Panels that are differentiated side by side, at most, and directions that share one pass through the laws."""
FEW = 64
"""Panels that are differentiated side by side where few have to be."""
MOVING, DRIVEN = 4, 6
"""Numbers that tell the drive of a panel: input and rate at its start, the same at its end; and with the exact force at both."""


def drive(w: Windows, u: Array, du: Array, force: Array) -> Drive:
    """The drive at a panel edge: ``u``, ``du`` is the splined input (base motion, force or torque at a motor) and its rate, or
    the command that a servo holds from here on; ``force`` exact, on the link or at the motor."""
    if w.at_motor:
        return Drive(jnp.zeros_like(u), jnp.zeros_like(u), jnp.zeros_like(u), None, u + force)
    if w.by_torque or w.by_command:
        return Drive(jnp.zeros_like(u), jnp.zeros_like(u), force, None, u)
    if w.by_force:
        return Drive(jnp.zeros_like(u), jnp.zeros_like(u), force + u, du)
    return Drive(u, du, force)


def plain_of(w: Windows, rebuild: Callable[[Array], System], theta: Array) -> PlainMap | None:
    """What all panels have in common that stay on one side of the play; None where the system is not linear there."""
    if not is_linear(rebuild(theta)):
        return None
    return plain_map(rebuild, theta, lambda given: _ends(w, given), 2 + DRIVEN, w.panel)


def panel_matrices(
    w: Windows, rebuild: Any, theta: Array, active: Array, plain: PlainMap | None, states: tuple[Array, ...], u: Array, du: Array,
    edges: int = MOVING,
) -> Array:  # fmt: skip
    """Derivatives of every panel's end, shape (P, n + e + q, n, W): by its start, by u, du at both edges, by theta.

    Those by theta only as far as the first ``active``; ``plain`` is what `plain_of` tells. ``edges`` is e: `MOVING`, or `DRIVEN`
    for those by the exact force at both edges as well, which come after u and du.
    """
    given = *states, u[:, :-1], du[:, :-1], u[:, 1:], du[:, 1:], w.force[:, :-1], w.force[:, 1:]
    inputs = tuple(value.T for value in given)  # each (P, W)
    own = len(states) + edges
    if plain is None:
        return _one_by_one(w, rebuild, theta, active, inputs, len(states), own)
    return _of_linear(w, rebuild, theta, active, plain, inputs, own)


def _ends(w: Windows, given: Any) -> tuple[Drive, Drive]:
    """The drive at both ends of panels, from what is given of it."""
    u0, du0, u1, du1, f0, f1 = given
    return drive(w, u0, du0, f0), drive(w, u1, du1, f1)


def _one_by_one(
    w: Windows, rebuild: Any, theta: Array, active: Array, inputs: tuple[Array, ...], n: int, own: int
) -> Array:  # fmt: skip
    """In blocks of panels that stay in the processor's cache: some times faster than all at once."""
    panels, windows = inputs[0].shape
    blocks = -(-panels * windows // BLOCK)
    size = -(-panels * windows // blocks)
    lay = lambda values: jnp.pad(values.ravel(), (0, blocks * size - values.size)).reshape(blocks, size)  # noqa: E731
    differentiated = _differentiated(w, rebuild, theta, active, n, own)
    found = jax.lax.map(lambda at: differentiated(*at), (tuple(lay(v) for v in inputs), lay(_times(w, panels))))

    def unlay(values: Array) -> Array:
        flat = jnp.swapaxes(values, 0, 1).reshape(values.shape[1], -1)[:, : panels * windows]
        return jnp.swapaxes(flat.reshape(-1, panels, windows), 0, 1)

    return jnp.stack([unlay(v) for v in found], axis=2)


def _times(w: Windows, panels: int) -> Array:
    return w.t0 + w.panel * jnp.arange(panels)[:, None]


def _differentiated(
    w: Windows, rebuild: Any, theta: Array, active: Array, n: int, own: int
) -> Callable[[tuple[Array, ...], Array], tuple[Array, ...]]:
    """A function of the inputs and times of some panels, (lanes,) each: derivatives of each of n states, (own + q, lanes), by the
    first ``own`` inputs and by theta.

    A few directions after the other, those of theta only as far as they are active: with dry friction in a third less time than
    one by one.
    """
    count = own + theta.shape[0]
    seeds = jnp.eye(-(-count // TOGETHER) * TOGETHER, count)

    def step(free: Any, theta: Array, t: Array, held: Any) -> Any:
        system = rebuild(theta)
        a, b = _ends(w, (*free[n:], *held))
        begin, panel = system.passed(t, w.panel)
        return one_panel(system, begin, free[:n], a, b, panel, system.switches)

    lanes = jax.vmap(step, in_axes=(0, None, 0, 0))

    def of(inputs: tuple[Array, ...], t: Array) -> tuple[Array, ...]:
        free, held = inputs[:own], inputs[own:]

        def along(seed: Array) -> Any:
            moved = tuple(jnp.broadcast_to(seed[i], t.shape) for i in range(own))
            return jax.jvp(lambda o, th: lanes(o, th, t, held), (free, theta), (moved, seed[own:]))[1]

        def push(turn: Array, found: Any) -> Any:
            first = turn * TOGETHER
            end = jax.vmap(along)(jax.lax.dynamic_slice_in_dim(seeds, first, TOGETHER))
            return tuple(jax.lax.dynamic_update_slice_in_dim(f, e, first, axis=0) for f, e in zip(found, end))

        empty = tuple(jnp.zeros((seeds.shape[0], t.shape[0])) for _ in range(n))
        found = jax.lax.fori_loop(0, -(-(own + active) // TOGETHER), push, empty)
        return tuple(f[:count] for f in found)

    return of


def _of_linear(
    w: Windows, rebuild: Any, theta: Array, active: Array, plain: PlainMap, inputs: tuple[Array, ...], own: int
) -> Array:  # fmt: skip
    """Panels that stay on a side of the play by its map, and then those that do not."""
    n, (panels, windows) = len(inputs) - DRIVEN, inputs[0].shape
    t = _times(w, panels)
    side, stays = sides(rebuild(theta), t, plain, inputs, _ends(w, inputs[n:]), w.panel)
    away = (side != 0.0)[:, None, None, :]
    by_own = jnp.where(away, plain.end[2, :own, :, None], plain.end[1, :own, :, None])
    by_theta = [jnp.stack(mapped(moved, side, inputs), axis=1)[:, None] for moved in plain.moved]
    matrices = jnp.concatenate([by_own, *by_theta], axis=1)

    before = jnp.cumsum(~stays.ravel())
    differentiated = _differentiated(w, rebuild, theta, active, n, own)
    flat = tuple(v.ravel() for v in (*inputs, t))

    def block(k: Array, matrices: Array) -> Array:
        at = jnp.searchsorted(before, k * FEW + 1 + jnp.arange(FEW))  # beyond the last one: the number of panels
        *given, times = (jnp.take(v, at, mode="clip") for v in flat)
        found = jnp.stack(differentiated(tuple(given), times), axis=-1)  # (own + q, lanes, n)
        return matrices.at[at // windows, :, :, at % windows].set(jnp.swapaxes(found, 0, 1), mode="drop")

    return jax.lax.fori_loop(0, -(-before[-1] // FEW), block, matrices)
