"""Runs of many panels in one scan: what the diffrax solvers step with (`jaxbacklash.solvers.panel_solver`), and a fit itself.

Apart from them, because a command that finds its programs compiled need not wait for diffrax to load.
"""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

from .dry import advance_dry
from .dry_ports import advance_ports
from .panels import Cubic, advance, advance_in_turns, advance_smooth, advance_smooth_in_turns

MANY = 4
"""Laws, some with internal states, above which a panel is advanced in loops."""


def course(a: Any, b: Any, h: Any) -> tuple[Any, Cubic]:
    """The drive over a panel of length ``h`` [s], ``a`` and ``b`` at its edges, as a function of the time since its start; and
    the base motion alone."""
    base = Cubic.hermite(a.x, a.dx, b.x, b.dx, h)
    force = Cubic.between(a.force, a.dforce, b.force, b.dforce, h)
    # A torque of which no rate is known is held, as a controller holds it.
    smooth = None if a.dtorque is None else Cubic.hermite(a.torque, a.dtorque, b.torque, b.dtorque, h)

    def drive_at(tau: Any) -> Any:
        return type(a)(base.at(tau), base.slope(tau), force.at(tau), None, a.torque if smooth is None else smooth.at(tau))

    return drive_at, base


def one_panel(system: Any, t: Any, state: Any, a: Any, b: Any, h: Any, located: bool) -> Any:
    """The state one panel of length ``h`` [s] after ``t``, the drive given as ``a`` and ``b`` at the panel's two edges."""
    drive_at, base = course(a, b, h)
    in_turns = (len(state) > system.mechanical and len(system.effects) > MANY) or bool(system.plays)
    if located and system.slides:
        dry = advance_dry if system.motor is None else advance_ports
        return dry(system, t, state, drive_at, base, h)
    if located:
        return (advance_in_turns if in_turns else advance)(system, t, state, drive_at, base, h)
    return (advance_smooth_in_turns if in_turns else advance_smooth)(system, t, state, drive_at, h)


def run_panels(system: Any, t: Any, state: Any, edges: Any, h: Any, every: int, located: bool) -> tuple[Any, Any]:
    """Scan over the panels of one run.

    Parameters
    ----------
    system : laws and edges of the play
    t : time at the first edge [s]
    state : tuple of scalars at the first edge
    edges : the drive at all ``P + 1`` panel edges, arrays with the panels on the leading axis
    h : length of a panel [s]
    every : panels between kept states; divides P
    located : split panels where the link meets an edge of the play or comes to rest in dry friction

    Returns
    -------
    the state after the last panel, and the states before panels 0, every, 2 every, ... stacked on a leading axis
    """

    def panel(carry: Any, at: Any) -> Any:
        t, state = carry
        return (t + h, one_panel(system, t, state, at[0], at[1], h, located)), None

    def sample(carry: Any, at: Any) -> Any:
        if every == 1:
            after, _ = panel(carry, jax.tree.map(lambda u: u[0], at))
        else:  # a loop, not a copy of the panel's code: compiling is what costs here
            after, _ = jax.lax.scan(panel, carry, at)
        return after, carry[1]

    left = jax.tree.map(lambda u: u[:-1].reshape(-1, every), edges)
    right = jax.tree.map(lambda u: u[1:].reshape(-1, every), edges)
    t = jnp.asarray(t, dtype=jnp.result_type(float))
    (_, end), states = jax.lax.scan(sample, (t, state), (left, right))
    return end, states
