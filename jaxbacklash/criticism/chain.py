r"""Linear algebra of a chain: a block tridiagonal, positive definite matrix, its determinant and the blocks of its inverse.

A smoother over W windows whose unknowns meet only those of the next window is such a chain. Everything costs in
proportion to W. Rasmussen & Williams, Gaussian Processes for Machine Learning (2006), appendix B, has the general case.
"""

from __future__ import annotations

from typing import Any

import equinox as eqx
import jax.numpy as jnp
import jax.scipy.linalg as jsl

from ..fitting.chunks import scan_used

Array = Any


class Factor(eqx.Module):
    """Cholesky factor by blocks: ``own`` (W, B, B) lower triangles L, ``half`` (W, B, B) with the links to the next window, zero
    beyond the first ``used`` windows."""

    own: Array
    half: Array
    used: Array

    @property
    def log_determinant(self) -> Array:
        """Logarithm of the determinant of the matrix of the windows used."""
        there = jnp.arange(self.own.shape[0])[:, None] < self.used
        return 2.0 * jnp.sum(jnp.log(jnp.where(there, jnp.diagonal(self.own, axis1=1, axis2=2), 1.0)))


def factorise(diagonal: Array, below: Array, used: Array) -> Factor:
    """Factor a chain.

    Parameters
    ----------
    diagonal : (W, B, B) blocks on the diagonal
    below : (W, B, B); block w couples window w + 1 (rows) to window w (columns), the last one is not used
    used : how many windows there are; what stands beyond them is not looked at

    Returns
    -------
    Factor; not-a-number where the matrix is not positive definite
    """

    def eliminate(taken: Array, block: Any) -> Any:
        own, link = block
        factor = jnp.linalg.cholesky(own - taken)
        half = jsl.solve_triangular(factor, link.T, lower=True)
        return half.T @ half, (factor, half)

    own, half = scan_used(eliminate, jnp.zeros(diagonal.shape[1:]), (diagonal, below), used)
    return Factor(own, half, used)


def forward(factor: Factor, right: Array) -> Array:
    """Half of a solution, the lower factor's answer to R right sides (W, B, R): products of two such are those of the inverse."""

    def step(taken: Array, block: Any) -> Any:
        own, half, edge = block
        value = jsl.solve_triangular(own, edge - taken, lower=True)
        return half.T @ value, value

    return scan_used(step, jnp.zeros(right.shape[1:]), (factor.own, factor.half, right), factor.used)


def backward(factor: Factor, halfway: Array) -> Array:
    """The other half, from what `forward` gave (W, B, R) to the solution (W, B, R)."""

    def step(following: Array, block: Any) -> Any:
        own, half, edge = block
        value = jsl.solve_triangular(own.T, edge - half @ following, lower=False)
        return value, value

    return scan_used(step, jnp.zeros(halfway.shape[1:]), (factor.own, factor.half, halfway), factor.used, reverse=True)


def variances(factor: Factor) -> Array:
    """Diagonal of the inverse, (W, B), by the backward recursion over windows."""
    size = factor.own.shape[1]
    eye = jnp.eye(size)

    def step(following: Array, block: Any) -> Any:
        own, half = block
        inner = eye + half @ following @ half.T
        left = jsl.solve_triangular(own.T, inner, lower=False)
        inverse = jsl.solve_triangular(own.T, left.T, lower=False)
        return inverse, jnp.diagonal(inverse)

    return scan_used(step, jnp.zeros((size, size)), (factor.own, factor.half), factor.used, reverse=True)
