"""diffrax solvers that take many panels inside one solver step.

One Runge-Kutta step per diffrax step costs some thirty times the arithmetic on a CPU, because the bookkeeping of a
step weighs more than four evaluations of a small law. Here a step is an inner scan over panels, and the states at
the panel edges are handed out as the step's dense output.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar, Protocol

import diffrax
import equinox as eqx
import jax
import jax.numpy as jnp

from .dry import advance_dry
from .panels import Cubic, advance, advance_smooth


class Driven(Protocol):
    """What the solver needs as ``args``: a system with laws, edges and a play, and an excitation with a grid."""

    system: Any
    excitation: Any
    t0: Any


class DrivenTerm(diffrax.ODETerm):
    """The vector field of a driven system; ``args`` is a `Driven`, time runs from ``args.t0``."""

    def __init__(self) -> None:
        super().__init__(lambda t, y, args: args.system.rates(args.t0 + t, y, args.excitation.at(args.t0 + t)))


class PanelInterpolation(diffrax.AbstractLocalInterpolation):
    """The states at panel edges; between them the cubic through values and slopes is not needed, the nearest edge is."""

    t0: Any
    t1: Any
    edges: Any

    def evaluate(self, t0: Any, t1: Any = None, left: bool = True) -> Any:
        def look_up(t: Any) -> Any:
            count = jax.tree.leaves(self.edges)[0].shape[0]
            position = (t - self.t0) / (self.t1 - self.t0) * (count - 1)
            k = jnp.clip(jnp.floor(position).astype(int), 0, count - 2)
            s = position - k
            return jax.tree.map(lambda e: (1.0 - s) * e[k] + s * e[k + 1], self.edges)

        if t1 is None:
            return look_up(t0)
        return jax.tree.map(jnp.subtract, look_up(t1), look_up(t0))


class PanelRK4(diffrax.AbstractSolver):
    """Fourth-order Runge-Kutta over ``panels`` panels in one step, split at its events when ``located``.

    ``keep`` states are handed out per step, evenly spaced, besides the first; it divides ``panels``.
    """

    panels: int = eqx.field(static=True)
    keep: int = eqx.field(static=True)
    located: bool = eqx.field(static=True, default=True)

    term_structure: ClassVar[Any] = DrivenTerm
    interpolation_cls: ClassVar[Callable[..., Any]] = PanelInterpolation

    def order(self, terms: Any) -> int:
        return 4

    def init(self, terms: Any, t0: Any, t1: Any, y0: Any, args: Any) -> None:
        return None

    def func(self, terms: Any, t0: Any, y0: Any, args: Any) -> Any:
        return terms.vf(t0, y0, args)

    def step(self, terms: Any, t0: Any, t1: Any, y0: Any, args: Any, solver_state: Any, made_jump: Any) -> Any:
        h = (t1 - t0) / self.panels
        start = args.t0 + t0
        edges = args.excitation.grid(start, h, self.panels)
        y1, states = run_panels(args.system, start, y0, edges, h, self.panels // self.keep, self.located)
        kept = jax.tree.map(lambda s, e: jnp.concatenate([s, e[None]]), states, y1)
        return y1, None, {"edges": kept}, None, diffrax.RESULTS.successful


def one_panel(system: Any, t: Any, state: Any, a: Any, b: Any, h: Any, located: bool) -> Any:
    """The state one panel of length ``h`` [s] after ``t``, the drive given as ``a`` and ``b`` at the panel's two edges."""
    base = Cubic.hermite(a.x, a.dx, b.x, b.dx, h)
    force = Cubic.between(a.force, a.dforce, b.force, b.dforce, h)

    def drive_at(tau: Any) -> Any:
        return type(a)(base.at(tau), base.slope(tau), force.at(tau))

    if located and system.slides:
        return advance_dry(system, t, state, drive_at, base, h)
    if located:
        return advance(system, t, state, drive_at, base, h)
    return advance_smooth(system, t, state, drive_at, h)


def run_panels(
    system: Any, t: Any, state: Any, edges: Any, h: Any, every: int, located: bool
) -> tuple[Any, Any]:
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
