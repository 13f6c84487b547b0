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

from .substeps import run_panels


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
