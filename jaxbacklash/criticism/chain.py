r"""Linear algebra of a chain: a block tridiagonal, positive definite matrix, its determinant and the blocks of its inverse.

A smoother over W windows whose unknowns meet only those of the next window is such a chain. Everything costs in
proportion to W. Rasmussen & Williams, Gaussian Processes for Machine Learning (2006), appendix B, has the general case.
"""

from __future__ import annotations

from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import jax.scipy.linalg as jsl

Array = Any


class Factor(eqx.Module):
    """Cholesky factor by blocks: ``own`` (W, B, B) lower triangles L, ``half`` (W, B, B) with the links to the next window."""

    own: Array
    half: Array

    @property
    def log_determinant(self) -> Array:
        """Logarithm of the determinant of the whole matrix."""
        return 2.0 * jnp.sum(jnp.log(jnp.diagonal(self.own, axis1=1, axis2=2)))


def factorise(diagonal: Array, below: Array) -> Factor:
    """Factor a chain.

    Parameters
    ----------
    diagonal : (W, B, B) blocks on the diagonal
    below : (W, B, B); block w couples window w + 1 (rows) to window w (columns), the last one is not used

    Returns
    -------
    Factor; not-a-number where the matrix is not positive definite
    """

    def eliminate(taken: Array, block: Any) -> Any:
        own, link = block
        factor = jnp.linalg.cholesky(own - taken)
        half = jsl.solve_triangular(factor, link.T, lower=True)
        return half.T @ half, (factor, half)

    _, (own, half) = jax.lax.scan(eliminate, jnp.zeros(diagonal.shape[1:]), (diagonal, below))
    return Factor(own, half)


def solve_chain(factor: Factor, right: Array) -> Array:
    """Solve for R right sides (W, B, R); the answer has the same shape."""

    def forward(taken: Array, block: Any) -> Any:
        own, half, edge = block
        value = jsl.solve_triangular(own, edge - taken, lower=True)
        return half.T @ value, value

    def backward(following: Array, block: Any) -> Any:
        own, half, edge = block
        value = jsl.solve_triangular(own.T, edge - half @ following, lower=False)
        return value, value

    empty = jnp.zeros(right.shape[1:])
    _, halfway = jax.lax.scan(forward, empty, (factor.own, factor.half, right))
    _, found = jax.lax.scan(backward, empty, (factor.own, factor.half, halfway), reverse=True)
    return found


def variances(factor: Factor) -> Array:
    """Diagonal of the inverse, (W, B), by the backward recursion over windows."""
    size = factor.own.shape[1]
    eye = jnp.eye(size)

    def backward(following: Array, block: Any) -> Any:
        own, half = block
        inner = eye + half @ following @ half.T
        left = jsl.solve_triangular(own.T, inner, lower=False)
        inverse = jsl.solve_triangular(own.T, left.T, lower=False)
        return inverse, jnp.diagonal(inverse)

    _, found = jax.lax.scan(backward, jnp.zeros((size, size)), (factor.own, factor.half), reverse=True)
    return found
