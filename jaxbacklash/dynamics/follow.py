"""Following many motions with one tangent vector each: exactly where the system allows it, else by located steps."""

from __future__ import annotations

from functools import partial
from typing import Any

import diffrax
import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from ..errors import BadInput
from ..excitation import AbstractExcitation, Harmonic
from ..precision import require_double_precision
from ..solvers.exact_periods import ExactPeriods, Phase, Pieces, begin
from ..solvers.linear_pieces import LinearPieces
from ..solvers.substeps import run_panels
from ..system import System
from .errorbars import batch_error
from .normal_form import normal_form, why_not
from .plan import Followed, Plan

Array = Any

BLOCK = 128
"""Cells that wait for each other on a CPU: what a leg needs of them stays in the cache nearest to the core."""
PANELS = 128
"""Fewest panels in a period of the drive where steps are only located."""


def follow(
    system: System, drive: AbstractExcitation, y0: Array, dy0: Array, plan: Plan, *, period: Array | None = None,
    exact: bool | None = None, panels: int | None = None,
) -> tuple[Followed, str]:  # fmt: skip
    """Follow N motions of one kind of system.

    Parameters
    ----------
    system, drive : their parameters may be arrays (N,), one value a cell
    y0, dy0 : (N,) start at t = 0 [rad, rad/s]
    plan : how long, and what to keep
    period : time between two stroboscopic samples [s]; default: the drive's own
    exact : True insists on exact steps, False forbids them; default: wherever the system allows them
    panels : panels in a period of located steps

    Returns
    -------
    exponents per unit of the system's time, samples of z and dz at whole periods [rad, rad/s], and the solver's name

    Raises
    ------
    ValueError
        Exact steps were insisted on and cannot be had.
    BadInput
        The drive has no period and none is given.
    """
    require_double_precision("a map")
    why = why_not(system, drive) if exact is not False else "exact steps were not wanted"
    if why is None and period is None:
        assert isinstance(drive, Harmonic)
        form = normal_form(system, drive)
        one = np.ones(np.shape(y0))
        x0, dx0 = (0.0, 0.0) if drive.as_force else _base_at_start(_full(drive, y0))
        half, middle, phase = (np.asarray(part) for part in (form.half_play, form.middle, form.phase))
        p0, v0 = (np.asarray(y0) - np.asarray(x0) - middle) / half * one, (np.asarray(dy0) - np.asarray(dx0)) / half * one
        pieces = jax.tree.map(lambda leaf: np.asarray(leaf) * one, form.pieces)
        found = jax.tree.map(np.asarray, follow_exact(pieces, phase * one, p0, v0, plan.stops, plan))
        last = np.stack([middle + half * found.last[0], half * found.last[1]])
        return found._replace(p=middle + half * found.p, v=half * found.v, last=last), "exact linear pieces"
    if exact:
        raise ValueError(f"exact steps cannot be used: {why or 'another period than that of the drive was given'}")
    if period is None:
        if not isinstance(drive, Harmonic):
            raise BadInput("the drive has no period of its own: give period, the time between two samples [s]")
        period = 2.0 * np.pi / drive.omega
    count = panels or default_panels(system, period)
    full = (_full(system, y0), _full(drive, y0), jnp.asarray(period) * jnp.ones(jnp.shape(y0)))
    return _follow_located(*full, y0, dy0, plan, count), "located Runge-Kutta panels"


def default_panels(system: System, period: Array) -> int:
    """Panels in a period: at least `PANELS`, and 40 in a period of the stiffest contact among the cells."""
    if system.contact is None:
        return PANELS
    omega = np.sqrt(np.max(np.abs(np.asarray(system.contact.stiffness) / np.asarray(system.inertia))))
    return max(PANELS, int(np.ceil(40.0 * np.max(np.asarray(period)) * omega / (2.0 * np.pi))))


def _full(tree: Any, like: Array) -> Any:
    return jax.tree.map(lambda leaf: np.asarray(leaf, dtype=float) * np.ones(np.shape(like)), tree)


@eqx.filter_jit
def _base_at_start(drive: AbstractExcitation) -> tuple[Array, Array]:
    start = jax.vmap(lambda d: d.at(jnp.zeros(())))(drive)
    return start.x, start.dx


@partial(jax.jit, static_argnames="plan")
def follow_exact(pieces: LinearPieces, phase: Array, p0: Array, v0: Array, stops: Array, plan: Plan) -> Followed:
    """`follow` in units of the half play: all but ``plan`` and its ``stops`` are (N,).

    On a CPU one block of lanes runs to its end before the next begins; elsewhere all run together.
    """
    lanes = p0.shape[0]
    if jax.default_backend() != "cpu" or lanes <= BLOCK:
        return _follow_block(pieces, phase, p0, v0, stops, plan)
    blocks = -(-lanes // BLOCK)
    given = jax.tree.map(
        lambda a: jnp.pad(a, (0, blocks * BLOCK - lanes), mode="edge").reshape(blocks, BLOCK), (pieces, phase, p0, v0)
    )

    def one(block: Any) -> Followed:
        pieces, phase, p0, v0 = block
        return _follow_block(pieces, phase, p0, v0, stops, plan)

    found = jax.lax.map(one, given)
    return jax.tree.map(lambda a: jnp.moveaxis(a, 0, -2).reshape(*a.shape[1:-1], -1)[..., :lanes], found)


def _follow_block(pieces: LinearPieces, phase: Array, p0: Array, v0: Array, stops: Array, plan: Plan) -> Followed:
    solution = diffrax.diffeqsolve(
        Pieces(), ExactPeriods(), stops[0], stops[-1], None, begin(p0, v0), (pieces, phase),
        stepsize_controller=diffrax.StepTo(ts=stops), saveat=diffrax.SaveAt(steps=True, t0=True, fn=_kept),
        max_steps=plan.stops.size - 1, adjoint=diffrax.ForwardMode(), throw=False,
    )  # fmt: skip
    p, v, growth, unresolved = solution.ys
    return _summary(plan, 2.0 * jnp.pi / pieces.omega, p, v, growth, unresolved[-1] > 0.0)


def compile_exact(lanes: int, plan: Plan) -> None:
    """Compile `follow_exact` for so many lanes by a run that is over at once."""
    one = np.ones(lanes)
    pieces = LinearPieces(*(one * number for number in (0.1, 0.0, 0.0, 1.0, 0.0, 0.1, 1.0)))
    jax.block_until_ready(follow_exact(pieces, 0.0 * one, 0.0 * one, 0.0 * one, 1e-6 * plan.stops, plan))


def _kept(t: Any, y: Phase, args: Any) -> tuple[Array, Array, Array, Array]:
    return y.p, y.v, y.growth, y.unresolved


def _summary(plan: Plan, period: Array, p: Array, v: Array, growth: Array, unresolved: Array) -> Followed:
    stops = plan.stops
    from_here = int(np.searchsorted(stops, plan.skip))
    counted = growth[from_here:]
    mean = (counted[-1] - counted[0]) / (plan.periods - plan.skip)
    error = batch_error(stops[from_here:], counted)
    last = jnp.stack([p[-1], v[-1]])
    bad = unresolved | ~jnp.isfinite(mean)
    return Followed(
        jnp.where(bad, jnp.nan, mean / period), error / period, p[-plan.samples :], v[-plan.samples :], bad, last
    )


@eqx.filter_jit
def _follow_located(
    system: System, drive: AbstractExcitation, period: Array, y0: Array, dy0: Array, plan: Plan, panels: int
) -> Followed:
    return jax.vmap(partial(_one_located, plan=plan, panels=panels), out_axes=-1)(system, drive, period, y0, dy0)


def _one_located(
    system: System, drive: AbstractExcitation, period: Array, y0: Array, dy0: Array, plan: Plan, panels: int
) -> Followed:
    """One cell by located panels; the tangent is the derivative of the panels themselves, their switching times included."""
    h = period / panels
    start = drive.at(jnp.zeros(()))
    state = tuple(jnp.asarray(s, dtype=float) * jnp.ones(()) for s in system.rest(jnp.zeros(()), y0, dy0, start))

    def one_period(carry: Any, k: Array) -> Any:
        state, tangent, growth = carry
        t = k * period
        edges = drive.grid(t, h, panels)

        def go(s: Any) -> Any:
            return run_panels(system, t, s, edges, h, panels, system.switches)[0]

        state, tangent = jax.jvp(go, (state,), (tangent,))
        size = jnp.sqrt(sum(d * d for d in tangent))
        growth = growth + jnp.log(size)
        after = drive.at((k + 1.0) * period)
        return (state, tuple(d / size for d in tangent), growth), (state[0] - after.x, state[1] - after.dx, growth)

    tangent = tuple(jnp.ones(()) if i == 0 else jnp.zeros(()) for i in range(len(state)))
    _, (z, dz, growth) = jax.lax.scan(one_period, (state, tangent, jnp.zeros(())), jnp.arange(float(plan.periods)))
    at = (plan.stops[1:] - 1).astype(int)
    z, dz, growth = (jnp.concatenate([first[None], all_[at]]) for first, all_ in (
        (y0 - start.x, z), (dy0 - start.dx, dz), (jnp.zeros(()), growth)))  # fmt: skip
    found = _summary(plan, period, z[:, None], dz[:, None], growth[:, None], jnp.zeros(1, dtype=bool))
    return jax.tree.map(lambda leaf: leaf[..., 0], found)
