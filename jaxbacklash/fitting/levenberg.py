"""Levenberg-Marquardt for the multiple-shooting arrow, as an optimistix least-squares solver."""

from __future__ import annotations

from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx

from .arrow import solve
from .shooting import Blocks, Prediction, Problem, Unknowns, linearise

Array = Any
_linearise = eqx.filter_jit(linearise)  # traced once, though a search writes it down three times


class ArrowState(eqx.Module):
    """Where the search stands: ``blocks`` and ``predicted`` at the best point, ``damping``, ``gain`` the decrease of the cost
    that a full Gauss-Newton step still promises, ``schur`` the information about the parameters, ``steps`` taken so far."""

    blocks: Blocks
    predicted: Prediction
    damping: Array
    gain: Array
    schur: Array
    steps: Array
    ready: Array


class ArrowLevenbergMarquardt(optx.AbstractLeastSquaresSolver):
    """Levenberg-Marquardt whose linear algebra knows the arrow (`jaxbacklash.fitting.arrow`).

    ``fn`` is not differentiated as a whole: ``args`` is the `Problem`, whose blocks are built by
    `jaxbacklash.fitting.shooting.linearise`. The search ends when a full step promises to lower half the sum of squares by less
    than ``atol`` (in units of the noise, so 1e-3 means that no parameter would move by 5 % of its standard error), or by
    less than ``rtol`` of what it exceeds the noise by, or after ``limit`` linearisations; a limit of 1 only looks at the start.
    """

    rtol: Array = eqx.field(default=0.0, converter=np.asarray)
    atol: Array = eqx.field(default=1e-3, converter=np.asarray)
    damping: Array = eqx.field(default=1e-3, converter=np.asarray)
    limit: Array = eqx.field(default=60, converter=np.asarray)
    norm: Any = eqx.field(default=optx.max_norm, static=True)

    def init(self, fn: Any, y: Unknowns, args: Problem, options: Any, f_struct: Any, aux_struct: Any, tags: Any) -> ArrowState:
        shapes = eqx.filter_eval_shape(_linearise, args, y)
        blocks, predicted = jax.tree.map(lambda s: jnp.zeros(s.shape, s.dtype), shapes)
        blocks = eqx.tree_at(lambda b: b.cost, blocks, jnp.asarray(jnp.inf))
        q = y.theta.shape[0]
        return ArrowState(
            blocks, predicted, jnp.asarray(self.damping), jnp.asarray(jnp.inf), jnp.zeros((q, q)), jnp.asarray(0),
            jnp.asarray(False),
        )  # fmt: skip

    def step(
        self, fn: Any, y: Unknowns, args: Problem, options: Any, state: ArrowState, tags: Any
    ) -> tuple[Unknowns, ArrowState, Any]:
        # The first call only linearises at the start: a step of zero length is always accepted.
        solution = solve(state.blocks, state.damping)
        n = y.starts.shape[0]
        theta = jnp.clip(y.theta + solution.theta, args.lower, args.upper)
        theta = jnp.where(args.shrink, _keep_sign(args, y.theta, theta), theta)
        trial = Unknowns(
            theta, y.starts + solution.local[:, :n].T, y.coefficients + solution.local[:, n:]
        )
        trial = jax.tree.map(lambda new, old: jnp.where(state.ready, new, old), trial, y)
        blocks, predicted = _linearise(args, trial)
        better = blocks.cost < state.blocks.cost
        pick = lambda new, old: jnp.where(better, new, old)  # noqa: E731
        damping = jnp.where(better, jnp.maximum(0.1 * state.damping, 1e-12), jnp.clip(10.0 * state.damping, 1e-7, 1e12))
        damping = jnp.where(state.ready, damping, jnp.asarray(self.damping))
        # What a Gauss-Newton step promised at the old point, damped as it was: the measure of being there.
        promise = -0.5 * (jnp.sum(state.blocks.slope * solution.local) + jnp.sum(state.blocks.slope_theta * solution.theta))
        new = ArrowState(
            jax.tree.map(pick, blocks, state.blocks),
            jax.tree.map(pick, predicted, state.predicted),
            damping,
            jnp.where(state.ready, promise, jnp.inf),
            solution.schur,
            state.steps + 1,
            jnp.asarray(True),
        )
        return jax.tree.map(pick, trial, y), new, None

    def terminate(self, fn: Any, y: Unknowns, args: Problem, options: Any, state: ArrowState, tags: Any) -> Any:
        # Where the model misfits, the noise is no measure of what matters: the misfit is.
        rows = jnp.sum(args.windows.weight > 0.0)
        cost = state.blocks.cost
        small = state.gain < self.atol * jnp.maximum(1.0, 2.0 * cost / (rows + 1.0)) + self.rtol * jnp.maximum(cost - rows, 0.0)
        # A promise under heavy damping says little; wait until the damping has come down or nothing helps any more.
        done = (small & (state.damping < 1.0)) | (state.damping > 1e11) | (state.steps >= self.limit)
        return done & state.ready, optx.RESULTS.successful

    def postprocess(
        self, fn: Any, y: Unknowns, aux: Any, args: Problem, options: Any, state: ArrowState, tags: Any, result: Any
    ) -> Any:
        undamped = solve(state.blocks, jnp.asarray(0.0))
        return y, aux, {"state": state, "schur": undamped.schur, "pull": undamped.pull}


def _keep_sign(problem: Problem, old: Array, new: Array) -> Array:
    # Bounds on the value itself: between a third and three times the present one.
    scale = jnp.sum(problem.directions, axis=0)
    offset = jnp.sum(jnp.where(problem.directions != 0.0, problem.base[:, None], 0.0), axis=0)
    value = offset + scale * old
    wanted = offset + scale * new
    return (jnp.clip(wanted, value / 3.0, value * 3.0) - offset) / scale


@eqx.filter_jit
def minimise(problem: Problem, start: Unknowns, solver: ArrowLevenbergMarquardt, max_steps: int = 200) -> optx.Solution:
    """Run the search from ``start``; the solution's ``stats`` hold the final `ArrowState`, the ``schur`` information and
    the ``pull``, both undamped."""

    def residual(y: Unknowns, args: Problem) -> Array:
        # optimistix asks only for its structure: the solver builds residuals and blocks together.
        return jnp.zeros(())

    return optx.least_squares(residual, solver, start, args=problem, max_steps=max_steps, throw=False)
