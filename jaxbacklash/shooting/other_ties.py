r"""The normal equations with looser ties, at a point where those with tighter ones are known.

Ties of another weight change neither the motion of a window nor how it moves with its unknowns: what tighter ones add is taken
out again. `jaxbacklash.shooting.block_levenberg` looks so at a torque left out where a fit of one trajectory has ended, without
running through the windows once more.
"""

from __future__ import annotations

from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp

from .multiple_shooting import Blocks, Prediction, assemble, tie_weights, weighed
from .problem import Problem, Unknowns, changed

Array = Any


def loosened(problem: Problem, unknowns: Unknowns, predicted: Prediction, blocks: Blocks, tie: Array) -> Blocks:
    """Normal equations with ties of the weight ``tie``, which is less than that of the ``problem``.

    Parameters
    ----------
    problem, unknowns : where the ``blocks`` were made
    predicted : what the windows predict there
    blocks : normal equations by `jaxbacklash.shooting.multiple_shooting.linearise`
    tie : the other weight
    """
    n, m, q = unknowns.starts.shape[0], unknowns.coefficients.shape[1], unknowns.theta.shape[0]
    now, then = tie_weights(problem, n), tie_weights(changed(problem, tie=jnp.asarray(tie)), n)
    share = jnp.sqrt(jnp.maximum(1.0 - jnp.where(now > 0.0, then / jnp.where(now > 0.0, now, 1.0), 1.0) ** 2, 0.0))
    following = jnp.concatenate([unknowns.starts[:, 1:], unknowns.starts[:, :1]], axis=1).T
    ends, weight = blocks.ends * share[:, None, :], now * share
    missed = weighed(predicted.end - following, weight)
    gram = jnp.einsum("wir,wjr->wij", ends, ends)
    slope = jnp.einsum("wir,wr->wi", ends, missed)
    less = assemble(gram, slope, ends, missed, weight, jnp.zeros_like(slope), n, m, q, 0.5 * jnp.sum(missed**2))
    less = eqx.tree_at(lambda b: b.ends, less, blocks.ends - ends, is_leaf=lambda v: v is None)
    return jax.tree.map(jnp.subtract, blocks, less)
