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
from ..shooting.block_tridiagonal import Factor, bordered, solve_lower
from ..shooting.multiple_shooting import Blocks
from .smoother import Point, Smoother, prior, solve, solve_parameters, torque_places

Array = Any


class Explained(eqx.Module):
    """Evidence (log marginal likelihood), the table ``beta`` (R,) and its ``covariance`` (R, R) in the smoother's unit, the
    parameters ``theta`` (q,) that go with it."""

    evidence: Array
    beta: Array
    covariance: Array
    theta: Array


class Prepared(eqx.Module):
    """The smoother's system under each of G priors of the remainder (first differences of a torque, of ``log_precisions`` (G,)),
    for many calls of `explain`: the prior itself, and ``factor`` and ``halfway`` as in `Eliminated`, with G in front."""

    linear: Blocks
    diagonal: Array
    below: Array
    slope: Array
    rough: Array
    log_precisions: Array
    factor: Factor
    halfway: Array


@kept_jit
def prepare(s: Smoother, at: Point, linear: Blocks, log_precisions: Array) -> Prepared:
    """What every table needs, from the normal equations ``linear`` at a point as `finish` gives them."""
    diagonal, below, slope, rough = (part[1] for part in prior(s, at))

    def under(log_precision: Array) -> tuple[Factor, Array]:
        precision = jnp.exp(log_precision)
        done = solve(linear, precision * diagonal, precision * below, precision * slope, s.problem.windows.used).eliminated
        return done.factor, done.halfway

    return Prepared(linear, diagonal, below, slope, rough, log_precisions, *jax.lax.map(under, log_precisions))


@kept_jit
def explain(s: Smoother, at: Point, prepared: Prepared, phi: Array, penalty: Array) -> Explained:
    """Estimate a table under the likeliest of the priors of the remainder.

    Parameters
    ----------
    s, at : the smoother and the point of its linearisation
    prepared : the smoother's system there, from `prepare`
    phi : (W, K, R) the table's basis at the torque's values
    penalty : (R, R) precision of the table in the smoother's unit, positive definite
    """
    linear, diagonal, below = prepared.linear, prepared.diagonal, prepared.below
    q, width = at.unknowns.theta.shape[0], phi.shape[2]
    place = torque_places(s, at)
    full = jnp.zeros((*linear.slope.shape, width)).at[:, place].set(phi)
    follows = jnp.concatenate([full[1:], jnp.zeros_like(full[:1])])
    leads = jnp.einsum("wij,wjr->wir", below, full)
    leads = jnp.concatenate([jnp.zeros_like(leads[:1]), leads[:-1]])
    pulled = jnp.einsum("wij,wjr->wir", diagonal, full) + leads + jnp.einsum("wji,wjr->wir", below, follows)
    gram = jnp.einsum("wir,wis->rs", full, pulled)
    against = jnp.einsum("wir,wi->r", full, prepared.slope)
    rows = jnp.sum(s.present) * s.nodes

    def one(under: Any) -> tuple[Array, Array, Array]:
        log_precision, factor, known = under
        precision = jnp.exp(log_precision)
        new = solve_lower(factor, -precision * pulled)
        halfway = jnp.concatenate([known[:, :, :-1], new, known[:, :, -1:]], axis=2)
        corner = jsl.block_diag(linear.corner, precision * gram + penalty)
        slope_theta = jnp.concatenate([linear.slope_theta, -precision * against])
        done = solve_parameters(bordered(factor, halfway, corner, slope_theta), corner)
        least = linear.cost + 0.5 * precision * prepared.rough - done.promise
        told = 0.5 * rows * log_precision - 0.5 * done.log_determinant - least
        return told, done.theta, done.schur

    told, step, schur = jax.lax.map(one, (prepared.log_precisions, prepared.factor, prepared.halfway))
    told = jnp.where(jnp.isfinite(told), told, -jnp.inf) + 0.5 * jnp.linalg.slogdet(penalty)[1]
    best = jnp.argmax(told)
    covariance = jsl.cho_solve((schur[best], True), jnp.eye(q + width))[q:, q:]
    theta = jnp.clip(at.unknowns.theta + step[best][:q], s.problem.lower, s.problem.upper)
    return Explained(told[best], step[best][q:], covariance, theta)
