r"""Solves symmetric positive definite systems that are block tridiagonal with a dense border, by block Cholesky elimination.

The matrix of W windows, each with B unknowns of its own that meet only those of the next window, and q parameters that meet all:

.. math:: H = \begin{pmatrix} T & E \\ E^\top & C \end{pmatrix},\qquad
   T = L L^\top,\qquad S = C - E^\top T^{-1} E

T (W B, W B) is block tridiagonal, E (W B, q) the border, C (q, q) the corner, and S, the Schur complement, the information about
the parameters with all windows' unknowns marginalised. Every operation takes time in proportion to W. The step of a fit
(`jaxbacklash.shooting.damped_step`) and the smoother (`jaxbacklash.residuals.smoother`) both use it, and both choose the
parameters' step themselves: one has bounds, the other a prior.

Source: Golub and Van Loan, Matrix Computations, 4th edition (2013), section 4.5; the diagonal of the inverse after Erisman and
Tinney, Communications of the ACM 18 (1975) 177.
"""

from __future__ import annotations

from typing import Any

import equinox as eqx
import jax.numpy as jnp
import jax.scipy.linalg as jsl

from .chunks import scan_used

Array = Any


class Factor(eqx.Module):
    """Cholesky factor L of the T of the first ``used`` windows: lower triangles ``own`` (W, B, B) on its diagonal, and ``link``
    (W, B, B), the transpose of the block below each; zero beyond the windows used."""

    own: Array
    link: Array
    used: Array

    @property
    def log_determinant(self) -> Array:
        """Logarithm of the determinant of T."""
        there = jnp.arange(self.own.shape[0])[:, None] < self.used
        return 2.0 * jnp.sum(jnp.log(jnp.where(there, jnp.diagonal(self.own, axis1=1, axis2=2), 1.0)))


class Eliminated(eqx.Module):
    r"""A system whose windows' unknowns are eliminated, so that the parameters' step :math:`\delta` is left to choose.

    ``factor`` of T; ``halfway`` (W, B, q + 1), the lower factor's solution for the border and for the windows' gradient;
    ``schur`` (q, q), S; ``score`` (q,), minus the gradient of the cost by the parameters with the windows' unknowns following;
    ``gain``, by how much these alone lower the cost.
    """

    factor: Factor
    halfway: Array
    schur: Array
    score: Array
    gain: Array

    def local(self, step: Array) -> Array:
        """The windows' own step (W, B) that goes with a step (q,) of the parameters."""
        return solve_upper(self.factor, -(self.halfway @ jnp.append(step, 1.0))[:, :, None])[:, :, 0]

    def promise(self, step: Array, information: Array) -> Array:
        """By how much both steps lower the cost, as its second-order expansion tells, with ``information`` (q, q) for S."""
        return promise(self, step, information)

    @property
    def log_determinant(self) -> Array:
        """Logarithm of the determinant of T."""
        return self.factor.log_determinant


def promise(of: Any, step: Array, information: Array) -> Array:
    """By how much a step (q,) of the parameters lowers the cost, the windows' own step with it."""
    return of.gain + step @ of.score - 0.5 * step @ information @ step


def factorise(diagonal: Array, below: Array, used: Array | int) -> Factor:
    """Factor a block tridiagonal matrix.

    Parameters
    ----------
    diagonal : (W, B, B) blocks on the diagonal
    below : (W, B, B); block w couples window w + 1 (rows) to window w (columns), the last one is not used
    used : how many windows there are, the first ones; what stands beyond them is not looked at

    Returns
    -------
    Factor; not-a-number where the matrix is not positive definite

    Examples
    --------
    >>> factor = factorise(np.full((2, 1, 1), 2.0), np.full((2, 1, 1), 1.0), 2)  # doctest: +SKIP
    >>> float(np.exp(factor.log_determinant))  # of [[2, 1], [1, 2]]  # doctest: +SKIP
    3.0
    """
    return factorise_with(diagonal, below, jnp.zeros((*diagonal.shape[:2], 0)), used)[0]


def eliminate(
    diagonal: Array, below: Array, border: Array, corner: Array, slope: Array, slope_theta: Array, used: Array | int
) -> Eliminated:
    """Eliminate the windows' unknowns of a system H step = -gradient, in one pass over the windows.

    Parameters
    ----------
    diagonal, below, used : as in `factorise`
    border : (W, B, q)
    corner : (q, q)
    slope, slope_theta : (W, B) and (q,), the gradient of the cost
    """
    factor, halfway = factorise_with(diagonal, below, jnp.concatenate([border, slope[:, :, None]], axis=2), used)
    return bordered(factor, halfway, corner, slope_theta)


def bordered(factor: Factor, halfway: Array, corner: Array, slope_theta: Array) -> Eliminated:
    """The parameters' part of a system, from the lower factor's solution ``halfway`` (W, B, q + 1) as in `Eliminated`."""
    products = jnp.einsum("wbi,wbj->ij", halfway, halfway)
    score = products[:-1, -1] - slope_theta
    return Eliminated(factor, halfway, corner - products[:-1, :-1], score, 0.5 * products[-1, -1])


def solve_lower(factor: Factor, right: Array) -> Array:
    r"""Solve :math:`L v = r` for R right sides (W, B, R): :math:`v^\top v` is then :math:`r^\top T^{-1} r`."""

    def step(taken: Array, block: Any) -> Any:
        own, link, edge = block
        value = jsl.solve_triangular(own, edge - taken, lower=True)
        return link.T @ value, value

    return scan_used(step, jnp.zeros(right.shape[1:]), (factor.own, factor.link, right), factor.used)


def solve_upper(factor: Factor, right: Array) -> Array:
    r"""Solve :math:`L^\top v = r` for R right sides (W, B, R): after `solve_lower`, the solution of T."""

    def step(following: Array, block: Any) -> Any:
        own, link, edge = block
        value = jsl.solve_triangular(own.T, edge - link @ following, lower=False)
        return value, value

    return scan_used(step, jnp.zeros(right.shape[1:]), (factor.own, factor.link, right), factor.used, reverse=True)


def inverse_diagonal(factor: Factor) -> Array:
    """Diagonal of the inverse of T, (W, B), by the backward recursion over windows."""
    size = factor.own.shape[1]
    eye = jnp.eye(size)

    def step(following: Array, block: Any) -> Any:
        own, link = block
        inner = eye + link @ following @ link.T
        left = jsl.solve_triangular(own.T, inner, lower=False)
        inverse = jsl.solve_triangular(own.T, left.T, lower=False)
        return inverse, jnp.diagonal(inverse)

    return scan_used(step, jnp.zeros((size, size)), (factor.own, factor.link), factor.used, reverse=True)


def factorise_with(diagonal: Array, below: Array, right: Array, used: Array | int) -> tuple[Factor, Array]:
    """The factor as of `factorise`, and its lower solution for right sides (W, B, R): one triangular solve takes both."""
    size = diagonal.shape[1]

    def step(taken: Any, block: Any) -> Any:
        own, link, edge = block
        factor = jnp.linalg.cholesky(own - taken[0])
        half = jsl.solve_triangular(factor, jnp.concatenate([link.T, edge - taken[1]], axis=1), lower=True)
        link, edge = half[:, :size], half[:, size:]
        return (link.T @ link, link.T @ edge), (factor, link, edge)

    begin = jnp.zeros((size, size)), jnp.zeros(right.shape[1:])
    own, link, halfway = scan_used(step, begin, (diagonal, below, right), jnp.asarray(used))
    return Factor(own, link, jnp.asarray(used)), halfway
