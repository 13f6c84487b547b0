r"""The step of a Levenberg-Marquardt search: normal equations by blocks in, a step within the parameters' bounds out.

`jaxbacklash.shooting.block_tridiagonal` eliminates the windows; what is left, a dense system of the parameters, is solved here.
"""

from __future__ import annotations

from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp

from . import block_tridiagonal, side_by_side_windows
from .multiple_shooting import Blocks

Array = Any
MOST_ROUNDS = 50
"""How often a bound is met or left on the way to a step at most; as far as it has come the step lowers the cost."""
DEAD = 1e-7
"""Curvature along an unknown of a window below which it moves nothing, as a share of what is usual along the same in others."""


class DampedStep(eqx.Module):
    """Step of the windows' unknowns ``local`` (W, B) and of the parameters ``theta`` (q,), ``schur`` (q, q) and ``score`` (q,).

    ``schur`` is the information about the parameters with all windows' unknowns marginalised; its inverse is their
    covariance when the blocks are those of J^T J with unit-variance residuals. ``score`` is minus the gradient of the cost
    by the parameters with the windows' unknowns following. ``promise`` is by how much the step lowers the cost as its
    second-order expansion tells, damping included. ``log_determinant`` of the windows' own part of H + lambda D, without the
    unknowns that move nothing.
    """

    local: Array
    theta: Array
    schur: Array
    score: Array
    promise: Array
    log_determinant: Array


def solve(
    blocks: Blocks, damping: Array, used: Array | int | None = None, between: tuple[Array, Array] | None = None
) -> DampedStep:
    r"""Solve :math:`(H + \lambda D)\,\Delta = -g` within bounds.

    D is the diagonal of H as far as it comes from samples: damping measured by the ties as well would hinder windows from
    moving together, which the ties leave free.

    Parameters
    ----------
    blocks : normal equations by blocks (`Blocks`)
    damping : Levenberg-Marquardt :math:`\lambda \ge 0`
    used : windows that hold data, the first ones; default all
    between : least and largest step of each parameter, (q,) each. All else goes along with what is let go: windows that are tied
        would be torn apart by a step that they had made for parameters that a bound then holds
    """
    eye = jnp.eye(blocks.slope.shape[1])
    q = blocks.corner.shape[0]
    used = jnp.asarray(blocks.slope.shape[0] if used is None else used)
    added = _added(blocks, used)
    diagonal = blocks.diagonal + (damping * blocks.seen + added)[:, :, None] * eye
    few = blocks.slope.shape[1] <= side_by_side_windows.MOST
    eliminate: Any = (side_by_side_windows if few else block_tridiagonal).eliminate
    done = eliminate(diagonal, blocks.below, blocks.border, blocks.corner, blocks.slope, blocks.slope_theta, used)
    if q:
        damped = done.schur + damping * jnp.diag(blocks.seen_theta)
        theta = _solve_scaled(damped, done.score) if between is None else _solve_between(damped, done.score, *between)
    else:
        damped, theta = done.schur, jnp.zeros(0)
    # What is added for an unknown that moves nothing is no information about it.
    log_determinant = done.log_determinant - jnp.sum(jnp.log(jnp.where(added > 0.0, added, 1.0)))
    return DampedStep(done.local(theta), theta, done.schur, done.score, done.promise(theta, damped), log_determinant)


def _added(blocks: Blocks, used: Array) -> Array:
    """Curvature (W, B) to add for an unknown that moves nothing, as the speed from which friction brings a link to rest at once.

    What rounding makes of its slope would send it anywhere, at any damping, and the misfit of all windows with it.
    """
    own = jnp.diagonal(blocks.diagonal, axis1=1, axis2=2)
    there = (jnp.arange(own.shape[0]) < used)[:, None]
    # Geometric means, like medians, are not drawn to a few large values, and take no sorting; the second leaves out what is dead.
    usual = _geometric_mean(own, there & (own > 0.0))
    usual = _geometric_mean(own, there & (own > DEAD * usual))
    return jnp.where((own < DEAD * usual) & there, usual, 0.0)


def _geometric_mean(values: Array, where: Array) -> Array:
    """Geometric mean (B,) of positive values (W, B) over the windows, as far as they are in ``where``."""
    logarithms = jnp.where(where, jnp.log(jnp.where(where, values, 1.0)), 0.0)
    return jnp.exp(jnp.sum(logarithms, axis=0) / jnp.maximum(jnp.sum(where, axis=0), 1))


def _solve_between(matrix: Array, right: Array, least: Array, largest: Array) -> Array:
    """The solution within bounds between which no step lies: an active set begun at no step (Nocedal and Wright, Numerical
    Optimization, 2nd edition, algorithm 16.3).

    The way to the solution is followed to the first bound, and the unknown that meets it is held there; one that would go back
    inside is let go. So the cost falls on the whole way. Clipping would send unknowns whose sum alone is determined anywhere.
    """
    size = jnp.sqrt(jnp.maximum(jnp.diagonal(matrix), 1e-300))

    def unfinished(state: tuple[Array, Array, Array, Array]) -> Array:
        return ~state[2] & (state[3] < MOST_ROUNDS)

    def nearer(state: tuple[Array, Array, Array, Array]) -> tuple[Array, Array, Array, Array]:
        theta, held, _, rounds = state
        free = jnp.where(held[:, None] | held[None, :], 0.0, matrix) + jnp.diag(jnp.where(held, 1.0, 0.0))
        wanted = _solve_scaled(free, jnp.where(held, 0.0, right - matrix @ jnp.where(held, theta, 0.0)))
        way = jnp.where(held | ~jnp.isfinite(wanted), 0.0, wanted - theta)
        end = jnp.where(way > 0.0, largest, least)
        reach = jnp.where(way != 0.0, jnp.maximum((end - theta) / jnp.where(way != 0.0, way, 1.0), 0.0), jnp.inf)
        share = jnp.minimum(1.0, jnp.min(reach))
        met = (reach <= share) & (share < 1.0)
        theta = jnp.where(met, end, theta + share * way)
        down = (right - matrix @ theta) / size
        inward = jnp.where(held & (largest > least), jnp.where(theta >= largest, -down, down), 0.0)
        worst = (jnp.arange(theta.size) == jnp.argmax(inward)) & (inward > 1e-9 * jnp.max(jnp.abs(right / size)))
        back = worst & (share >= 1.0)
        return theta, (held | met) & ~back, (share >= 1.0) & ~jnp.any(back), rounds + 1

    begin = jnp.zeros(right.shape), jnp.zeros(right.shape, bool), jnp.asarray(False), jnp.asarray(0)
    return jax.lax.while_loop(unfinished, nearer, begin)[0]


def _solve_scaled(matrix: Array, right: Array) -> Array:
    import lineax as lx  # asked for only while tracing

    # Parameters that nothing determines leave a zero row; scaling and a whisper of ridge keep the step finite.
    scale = jnp.sqrt(jnp.maximum(jnp.diagonal(matrix), 1e-300))
    scaled = matrix / scale[:, None] / scale[None, :]
    scaled = jnp.where(jnp.isfinite(scaled), scaled, 0.0) + 1e-13 * jnp.eye(scale.shape[0])
    operator = lx.MatrixLinearOperator(scaled, lx.symmetric_tag)
    solution = lx.linear_solve(operator, right / scale, lx.LU(), throw=False).value
    return solution / scale
