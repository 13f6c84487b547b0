r"""Linear algebra of the arrow: block tridiagonal with a dense border, solved in time linear in the number of windows."""

from __future__ import annotations

from typing import Any

import equinox as eqx
import jax.numpy as jnp
import jax.scipy.linalg as jsl

from .chunks import scan_used
from .shooting import Blocks

Array = Any


ROUNDS = 3
"""How often it is looked which parameters go beyond their bounds, once some are held there."""
DEAD = 1e-7
"""Curvature along an unknown of a window below which it moves nothing, as a share of what is usual along the same in others."""


class ArrowSolution(eqx.Module):
    """Step for the local unknowns ``local`` (W, B) and parameters ``theta`` (q,), ``schur`` (q, q) and ``pull`` (q,).

    ``schur`` is the information about the parameters with all local unknowns marginalised; its inverse is their
    covariance when the blocks are those of J^T J with unit-variance residuals. ``pull`` is minus the gradient of the cost
    with the local unknowns following: the score. ``promise`` is by how much the step lowers the cost as far as its derivatives
    tell, damping included. ``log_determinant`` of the local unknowns' own part of H + lambda D, those that move nothing apart.
    """

    local: Array
    theta: Array
    schur: Array
    pull: Array
    promise: Array
    log_determinant: Array


def solve(
    blocks: Blocks, damping: Array, used: Array | int | None = None, between: tuple[Array, Array] | None = None
) -> ArrowSolution:
    r"""Solve :math:`(H + \lambda D)\,\Delta = -g` by elimination of the windows in order.

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
    size = blocks.slope.shape[1]
    q = blocks.corner.shape[0]
    eye = jnp.eye(size)
    used = jnp.asarray(blocks.slope.shape[0] if used is None else used)
    held = _held(blocks, used)
    diagonal = blocks.diagonal + (damping * blocks.seen + held)[:, :, None] * eye
    border = jnp.concatenate([blocks.border, blocks.slope[:, :, None]], axis=2)

    def eliminate(carry: Any, block: Any) -> Any:
        taken, taken_border = carry
        own, below, edge = block
        factor = jnp.linalg.cholesky(own - taken)
        edge = edge - taken_border
        right = jnp.concatenate([below.T, edge], axis=1)
        half = jsl.solve_triangular(factor, right, lower=True)
        half_below, half_edge = half[:, :size], half[:, size:]
        carry = (half_below.T @ half_below, half_below.T @ half_edge)
        return carry, (factor, half_below, half_edge)

    start = (jnp.zeros((size, size)), jnp.zeros((size, q + 1)))
    factors, half_below, half_edge = scan_used(eliminate, start, (diagonal, blocks.below, border), used)

    inner = jnp.einsum("wbi,wbj->ij", half_edge, half_edge)
    schur = blocks.corner - inner[:q, :q]
    right = -(blocks.slope_theta - inner[:q, q])
    if q:
        damped = schur + damping * jnp.diag(blocks.seen_theta)
        theta = _solve_scaled(damped, right) if between is None else _solve_between(damped, right, *between)
    else:
        damped, theta = schur, jnp.zeros(0)
    promise = 0.5 * inner[q, q] + theta @ right - 0.5 * theta @ damped @ theta

    def back(following: Array, stored: Any) -> Any:
        factor, below, edge = stored
        right = -edge[:, q] - edge[:, :q] @ theta - below @ following
        own = jsl.solve_triangular(factor.T, right, lower=False)
        return own, own

    local = scan_used(back, jnp.zeros(size), (factors, half_below, half_edge), used, reverse=True)
    return ArrowSolution(local, theta, schur, right, promise, _log_determinant(factors, held, used))


def _log_determinant(factors: Array, held: Array, used: Array) -> Array:
    """Of a block tridiagonal matrix by its Cholesky factors (W, B, B), without what holds an unknown that moves nothing."""
    own = 2.0 * jnp.log(jnp.diagonal(factors, axis1=1, axis2=2)) - jnp.log(jnp.where(held > 0.0, held, 1.0))
    there = jnp.arange(factors.shape[0]) < used
    return jnp.sum(jnp.where(there[:, None], own, 0.0))


def _held(blocks: Blocks, used: Array) -> Array:
    """Curvature (W, B) that holds an unknown that moves nothing, as the speed from which friction brings a link to rest at once.

    What rounding makes of its slope would send it anywhere, at any damping, and the misfit of all windows with it.
    """
    own = jnp.diagonal(blocks.diagonal, axis1=1, axis2=2)
    there = jnp.arange(own.shape[0]) < used
    usual = jnp.nanmedian(jnp.where(there[:, None], own, jnp.nan), axis=0)
    return jnp.where(own < DEAD * usual, usual, 0.0)


def _solve_between(matrix: Array, right: Array, least: Array, largest: Array) -> Array:
    """The solution with some unknowns held at what bounds them, found by holding those that go beyond, in a few rounds."""
    held, theta = jnp.zeros(right.shape, bool), _solve_scaled(matrix, right)
    for _ in range(ROUNDS):
        within = jnp.clip(theta, least, largest)
        held = held | (theta != within)
        at = jnp.where(held, within, 0.0)
        free = jnp.where(held[:, None] | held[None, :], 0.0, matrix) + jnp.diag(jnp.where(held, 1.0, 0.0))
        theta = jnp.where(held, at, _solve_scaled(free, jnp.where(held, 0.0, right - matrix @ at)))
    return jnp.clip(theta, least, largest)


def _solve_scaled(matrix: Array, right: Array) -> Array:
    import lineax as lx  # asked for only while tracing

    # Parameters that nothing determines leave a zero row; scaling and a whisper of ridge keep the step finite.
    scale = jnp.sqrt(jnp.maximum(jnp.diagonal(matrix), 1e-300))
    scaled = matrix / scale[:, None] / scale[None, :]
    scaled = jnp.where(jnp.isfinite(scaled), scaled, 0.0) + 1e-13 * jnp.eye(scale.shape[0])
    operator = lx.MatrixLinearOperator(scaled, lx.symmetric_tag)
    solution = lx.linear_solve(operator, right / scale, lx.LU(), throw=False).value
    return solution / scale
