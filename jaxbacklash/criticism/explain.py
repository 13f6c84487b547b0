r"""The smoother with a mean: how much of the missing torque is a function of given coordinates?

The unknown torque is :math:`\Phi\beta + r`: a table over coordinates of the smoothed motion, and a remainder with the smoother's
own prior. Both, and the parameters of the model, are estimated together at one linearisation, and the marginal likelihood
tells whether the table earns its place.
"""

from __future__ import annotations

from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import jax.scipy.linalg as jsl

from ..compiled import kept_jit
from ..fitting.shooting import Blocks
from .smoother import Point, Smoother, linearise, prior, solve, torque_places

Array = Any


class Explained(eqx.Module):
    """Evidence (log marginal likelihood), the table ``beta`` (R,) and its ``covariance`` (R, R) in the smoother's unit, the
    parameters ``theta`` (q,) that go with it, and the whole torque ``torque`` (W, K)."""

    evidence: Array
    beta: Array
    covariance: Array
    theta: Array
    torque: Array


@kept_jit
def prepare_linear(s: Smoother, at: Point) -> tuple[Blocks, Any]:
    """The chain at a point and the remainder's prior (first differences), for many calls of `explain`."""
    diagonal, below, slope, rough = prior(s, at)
    return linearise(s, at), (diagonal[1], below[1], slope[1], rough[1])


@kept_jit
def explain(
    s: Smoother, at: Point, linear: Blocks, remainder: Any, phi: Array, penalty: Array, log_precisions: Array
) -> Explained:
    """Estimate a table under the likeliest of G priors of the remainder.

    Parameters
    ----------
    s, at : the smoother and the point of its linearisation
    linear, remainder : from `prepare_linear`
    phi : (W, K, R) the table's basis at the torque's values
    penalty : (R, R) precision of the table in the smoother's unit, positive definite
    log_precisions : (G,) precisions of the remainder's differences to choose from
    """
    diagonal, below, slope, rough = remainder
    q, width = at.unknowns.theta.shape[0], phi.shape[2]
    place = torque_places(s, at)
    full = jnp.zeros((*linear.slope.shape, width)).at[:, place].set(phi)
    follows = jnp.concatenate([full[1:], jnp.zeros_like(full[:1])])
    leads = jnp.einsum("wij,wjr->wir", below, full)
    leads = jnp.concatenate([jnp.zeros_like(leads[:1]), leads[:-1]])
    pulled = jnp.einsum("wij,wjr->wir", diagonal, full) + leads + jnp.einsum("wji,wjr->wir", below, follows)
    gram = jnp.einsum("wir,wis->rs", full, pulled)
    against = jnp.einsum("wir,wi->r", full, slope)
    rows = jnp.sum(s.present) * s.nodes

    def one(log_precision: Array) -> tuple[Array, Array, Array, Array]:
        precision = jnp.exp(log_precision)
        border = jnp.concatenate([linear.border, -precision * pulled], axis=2)
        corner = jsl.block_diag(linear.corner, precision * gram + penalty)
        right = jnp.concatenate([linear.slope_theta, -precision * against])
        wide = Blocks(linear.diagonal, linear.below, border, corner, linear.slope, right, linear.cost)
        done = solve(wide, precision * diagonal, precision * below, precision * slope)
        least = linear.cost + 0.5 * precision * rough - done.promise
        told = 0.5 * rows * log_precision - 0.5 * done.log_determinant - least
        return told, done.theta, done.schur, done.local[:, place]

    told, step, schur, moved = jax.lax.map(one, log_precisions)
    told = jnp.where(jnp.isfinite(told), told, -jnp.inf) + 0.5 * jnp.linalg.slogdet(penalty)[1]
    best = jnp.argmax(told)
    covariance = jsl.cho_solve((schur[best], True), jnp.eye(q + width))[q:, q:]
    theta = jnp.clip(at.unknowns.theta + step[best][:q], s.problem.lower, s.problem.upper)
    return Explained(told[best], step[best][q:], covariance, theta, at.torque + moved[best])
