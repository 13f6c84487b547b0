r"""Panels that no edge of the play splits, where the joint is linear between its edges: one map for each side of the play.

There a panel takes its state, the drive at both of its ends and one constant linearly to the state at its end, so that on a side
all panels of one length have the same derivatives by both. The map is read off the Runge-Kutta steps themselves, at the unit
vectors: what follows from it is what `jaxbacklash.solvers.panels.advance` makes, to rounding. How it moves with the parameters
follows from the same steps. `jaxbacklash.shooting.panel_tangents` differentiates one by one only the panels that an edge splits.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from ..mechanics import AbstractEffect
from .panels import Edges, rk4_in_turns
from .substeps import course

Array = Any
INERT = ("torque", "dry", "kink", "rate", "reshape", "drift", "rubs", "lag")
"""What a law must leave as it is to change nothing of the motion: laws of the sensors only change what is seen of it."""
SIDES = (-1.0, 0.0, 1.0)


def is_linear(system: Any) -> bool:
    """Whether a system on a prescribed base is linear between the edges of its play, which do not move."""
    laws = [type(law) for law in system.effects.values()]
    inert = all(not law.states and all(getattr(law, of) is getattr(AbstractEffect, of) for of in INERT) for law in laws)
    return system.motor is None and not system.slides and inert


class PlainMap(NamedTuple):
    """The map of a panel, by side of the play as `SIDES`: ``end`` and ``middle`` (3, K + 1, 2) of the state, by its K inputs and
    the last row the constant; ``moved`` (q, 3, K + 1, 2), how ``end`` moves with the parameters."""

    end: Array
    middle: Array
    moved: Array


def plain_map(
    rebuild: Callable[[Array], Any], theta: Array, ends: Callable[[Array], tuple[Any, Any]], inputs: int, h: Array
) -> PlainMap:
    """The map of the panels of one length.

    Parameters
    ----------
    rebuild : the system from its free parameters
    theta : (q,) free parameters
    ends : from the inputs after the state, (K - 2,), the drive at both ends of a panel
    inputs : K, two for the state ``(y, dy)`` at the start and those of the drive
    h : length of a panel [s]
    """

    def halves(theta: Array, side: Array, own: Array) -> Array:
        system = rebuild(theta)
        drive_at, _ = course(*ends(own[2:]), h)
        rates = lambda t, state: system.rates(t, state, drive_at(t), side)  # noqa: E731

        def half(state: Any, begin: Array) -> tuple[Any, Array]:  # a loop, not a copy of its code: compiling is what costs here
            state = rk4_in_turns(rates, begin, state, 0.5 * h, rates(begin, state))
            return state, jnp.stack(state)

        return jax.lax.scan(half, (own[0], own[1]), jnp.stack([0.0 * h, 0.5 * h]))[1].ravel()

    units = jnp.concatenate([jnp.eye(inputs), jnp.zeros((1, inputs))])

    def on_sides(theta: Array) -> Array:
        at = jax.vmap(jax.vmap(halves, in_axes=(None, None, 0)), in_axes=(None, 0, None))(theta, jnp.asarray(SIDES), units)
        return jnp.concatenate([at[:, :-1] - at[:, -1:], at[:, -1:]], axis=1)

    found = on_sides(theta)
    moved = jax.vmap(lambda e: jax.jvp(on_sides, (theta,), (e,))[1])(jnp.eye(theta.shape[0]))
    return PlainMap(found[..., 2:], found[..., :2], moved[..., 2:])


def on_side(coefficients: Array, side: Array) -> Array:
    """Coefficients (3,) by side of the play, for panels on these sides."""
    return jnp.where(side > 0.0, coefficients[2], jnp.where(side < 0.0, coefficients[0], coefficients[1]))


def mapped(rows: Array, side: Array, inputs: tuple[Array, ...]) -> list[Array]:
    """The two states that a map (3, K + 1, 2) of `PlainMap` makes of K inputs on these sides."""
    away = side != 0.0
    slope = lambda k, i: jnp.where(away, rows[2, k, i], rows[1, k, i])  # noqa: E731
    return [on_side(rows[:, -1, i], side) + sum(slope(k, i) * value for k, value in enumerate(inputs)) for i in range(2)]


def sides(
    system: Any, t: Array, plain: PlainMap, inputs: tuple[Array, ...], ends: tuple[Any, Any], h: Array
) -> tuple[Array, Array]:
    """On which side of the play each panel begins, and whether it stays there: then its map is that of `PlainMap`.

    The panel is judged as `jaxbacklash.solvers.panels.advance` judges where to split it.
    """
    drive_at, base = course(*ends, h)
    z, dz = inputs[0] - base.a, inputs[1] - base.b
    if not system.has_play:
        return jnp.zeros_like(z), jnp.ones(z.shape, bool)
    edges = Edges.over(system, t, base, h)
    side = edges.side(z, 0.0)
    ddz = system.rates(t, (inputs[0], inputs[1]), drive_at(0.0), side)[1] - 2.0 * base.c
    half = 0.25 * h
    ahead = half * (dz + 0.5 * half * ddz)
    y, dy = mapped(plain.middle, side, inputs)
    z1, dz1 = y - base.at(0.5 * h), dy - base.slope(0.5 * h)
    stays = (edges.side(z + ahead, half) == side) & (edges.side(z1 + half * (dz1 + 0.5 * half * ddz), 3.0 * half) == side)
    return side, stays & (edges.first_crossing(0.0, z, dz, ddz, h) >= h)
