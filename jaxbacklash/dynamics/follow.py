"""Following many motions with one tangent vector each: exactly where the system allows it, else by located steps."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from ..errors import BadInput
from ..excitation import AbstractExcitation, Harmonic
from ..precision import require_double_precision
from ..program import on_cpu
from ..solvers.exact_courses import Along, Course, ExactCourse, Joint
from ..solvers.exact_periods import ExactPeriods, Phase, Pieces, begin
from ..solvers.linear_pieces import LinearPieces
from ..system import System
from .courses import begins, check_length, course
from .located import default_panels, follow_located, over_cells
from .normal_form import bare_joint, normal_form, not_linear, why_not
from .plan import Followed, Plan
from .summary import summary

Array = Any

BLOCK = 128
"""Cells that wait for each other on a CPU: what a leg needs of them stays in the cache nearest to the core."""
HARMONIC, COURSE, LOCATED = "exact linear pieces", "exact linear pieces, drive by polynomials", "located Runge-Kutta panels"


def follow(
    system: System, drive: AbstractExcitation, y0: Array, dy0: Array, plan: Plan, *, period: Array | None = None,
    exact: bool | None = None, panels: int | None = None,
) -> tuple[Followed, str]:  # fmt: skip
    """Follow N motions of one kind of system.

    Exact steps are taken wherever the motion is linear between the edges of a play: under a harmonic drive by its sines and
    cosines, under any other that all cells share by polynomials. Everything else goes by located panels.

    Parameters
    ----------
    system, drive : their parameters may be arrays (N,), one value a cell
    y0, dy0 : (N,) start of the link at t = 0, or at a measured drive's first sample [rad, rad/s]
    plan : how long, and what to keep
    period : time between two stroboscopic samples [s], one number or (N,); default: the drive's own
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
        The drive has no period and none is given, or is measured and too short.
    """
    require_double_precision("a map")
    harmonic = why_not(system, drive) if period is None else "another period than that of the drive was given"
    if harmonic is None and exact is not False:
        assert isinstance(drive, Harmonic)
        return _harmonic(system, drive, y0, dy0, plan), HARMONIC
    if period is None:
        if not isinstance(drive, Harmonic):
            raise BadInput("the drive has no period of its own: give period, the time between two samples [s]")
        period = 2.0 * np.pi / drive.omega
    check_length(drive, plan.periods * float(np.max(np.asarray(period))))
    lengths = jnp.asarray(period) * jnp.ones(jnp.shape(y0))
    if exact is not False and panels is None:
        path: Course | str | None = not_linear(system) or course(drive, plan.periods * float(np.max(np.asarray(period))))
        if isinstance(path, Course):
            return _along(system, drive, path, lengths, y0, dy0, plan), COURSE
        if exact:
            raise ValueError(f"exact steps cannot be used: {harmonic}; {path}")
    count = panels or default_panels(system, period)
    return follow_located(system, drive, lengths, y0, dy0, plan, count), LOCATED


def _harmonic(system: System, drive: Harmonic, y0: Array, dy0: Array, plan: Plan) -> Followed:
    form = normal_form(system, drive)
    one = np.ones(np.shape(y0))
    x0, dx0 = (0.0, 0.0) if drive.as_force else _base_at_start(over_cells(drive, y0))
    half, middle, phase = (np.asarray(part) for part in (form.half_play, form.middle, form.phase))
    p0, v0 = (np.asarray(y0) - np.asarray(x0) - middle) / half * one, (np.asarray(dy0) - np.asarray(dx0)) / half * one
    pieces = jax.tree.map(lambda leaf: np.asarray(leaf) * one, form.pieces)
    return _in_radians(follow_exact(pieces, phase * one, p0, v0, plan.stops, plan), middle, half)


def _along(system: System, drive: AbstractExcitation, path: Course, period: Array, y0: Array, dy0: Array, plan: Plan) -> Followed:
    joint, middle, half = bare_joint(system)
    x0 = drive.at(jnp.asarray(begins(drive), dtype=float))
    one = jnp.ones(jnp.shape(y0))
    p0, v0 = (y0 - x0.x - middle) / half * one, (dy0 - x0.dx) / half * one
    joint = jax.tree.map(lambda leaf: leaf * one, joint)
    return _in_radians(follow_course(joint, path, period, p0, v0, plan.stops, plan), middle, half)


@eqx.filter_jit
def _base_at_start(drive: AbstractExcitation) -> tuple[Array, Array]:
    start = jax.vmap(lambda d: d.at(jnp.zeros(())))(drive)
    return start.x, start.dx


def _in_radians(found: Followed, middle: Array, half: Array) -> Followed:
    found, middle, half = jax.tree.map(np.asarray, (found, middle, half))
    last = np.stack([middle + half * found.last[0], half * found.last[1]])
    return found._replace(p=middle + half * found.p, v=half * found.v, last=last)


@partial(jax.jit, static_argnames="plan")
def follow_exact(pieces: LinearPieces, phase: Array, p0: Array, v0: Array, stops: Array, plan: Plan) -> Followed:
    """`follow` under a harmonic drive, in units of the half play: all but ``plan`` and its ``stops`` are (N,).

    On a CPU one block of lanes runs to its end before the next begins; elsewhere all run together.
    """
    together = BLOCK if on_cpu() else p0.shape[0]
    run = _block_by_block if together < p0.shape[0] else _follow_block
    return run(pieces, phase, p0, v0, stops, plan)


def _block_by_block(pieces: LinearPieces, phase: Array, p0: Array, v0: Array, stops: Array, plan: Plan) -> Followed:
    lanes = p0.shape[0]
    blocks = -(-lanes // BLOCK)
    leaves, shape = jax.tree.flatten((pieces, phase, p0, v0))
    # As one array: each of ten would have a program of its own that cuts its block out.
    given = jnp.pad(jnp.stack(leaves), ((0, 0), (0, blocks * BLOCK - lanes)), mode="edge")
    given = jnp.moveaxis(given.reshape(-1, blocks, BLOCK), 1, 0)

    def one(block: Array) -> Followed:
        pieces, phase, p0, v0 = jax.tree.unflatten(shape, list(block))
        return _follow_block(pieces, phase, p0, v0, stops, plan)

    found = jax.lax.map(one, given)
    return jax.tree.map(lambda a: jnp.moveaxis(a, 0, -2).reshape(*a.shape[1:-1], -1)[..., :lanes], found)


def _follow_block(pieces: LinearPieces, phase: Array, p0: Array, v0: Array, stops: Array, plan: Plan) -> Followed:
    return _solve(Pieces(), ExactPeriods(), (pieces, phase), 2.0 * jnp.pi / pieces.omega, p0, v0, stops, plan)


@partial(jax.jit, static_argnames="plan")
def follow_course(joint: Joint, path: Course, period: Array, p0: Array, v0: Array, stops: Array, plan: Plan) -> Followed:
    """`follow` along a drive of polynomials, in units of the half play: all but the drive and the plan are (N,)."""
    return _solve(Along(), ExactCourse(), (joint, path, period), period, p0, v0, stops, plan)


def _solve(term: Any, solver: Any, args: Any, period: Array, p0: Array, v0: Array, stops: Array, plan: Plan) -> Followed:
    """The solver's steps from stop to stop, taken one by one: they are given, and none is refused.

    `diffrax.diffeqsolve` would do the same, and more than double the program for it: before its loop it works out the
    hundredth number below the last stop.
    """

    def step(y: Phase, ends: tuple[Array, Array]) -> tuple[Phase, Array]:
        y1 = solver.step(term, *ends, y, args, None, False)[0]
        return y1, _kept(y1)

    start = begin(p0, v0)
    _, seen = jax.lax.scan(step, start, (stops[:-1], stops[1:]))
    p, v, growth, unresolved = jnp.moveaxis(jnp.concatenate([_kept(start)[None], seen]), 1, 0)
    return summary(plan, period, p, v, growth, unresolved[-1] > 0.0)


def trace_exact(lanes: int, plan: Plan) -> Callable[[], Any]:
    """Trace `follow_exact` for so many lanes; what is returned compiles it, by a run that is over at once."""
    one = np.ones(lanes)
    pieces = LinearPieces(*(one * number for number in (0.1, 0.0, 0.0, 1.0, 0.0, 0.1, 1.0)))
    given = pieces, 0.0 * one, 0.0 * one, 0.0 * one, 1e-6 * plan.stops
    follow_exact.trace(*given, plan).lower()
    return lambda: jax.block_until_ready(follow_exact(*given, plan))


def _kept(y: Phase) -> Array:
    return jnp.stack([y.p, y.v, y.growth, y.unresolved])
