"""Levenberg-Marquardt for normal equations that come in blocks, as an optimistix least-squares solver.

`jaxbacklash.shooting.levenberg` hands it to `optimistix.least_squares` with the residual of multiple shooting. What optimistix
would do by automatic differentiation of that residual, `jaxbacklash.shooting.multiple_shooting.linearise` and
`jaxbacklash.shooting.damped_step` do in time linear in the number of windows: CONTRIBUTING.md compares the two.
"""

from __future__ import annotations

from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import optimistix as optx

from .damped_step import solve
from .multiple_shooting import Blocks, Prediction, Shot, linearise
from .other_ties import loosened
from .problem import Problem, Unknowns

Array = Any
_linearise = eqx.filter_jit(linearise)  # traced once, though a search writes it down twice

PROMISED = 10.0
"""How many times what may be left to gain a step may promise where the last one kept less than that."""
POOR, FAIR = 0.1, 0.5
"""Share of what it promised that a step must keep for the damping to stay, and to come down."""
LEAST = 1e-4
"""Damping after a step is turned down, at least: less than that hardly changes a step."""
STALLED, PROGRESS = 8, 20.0
"""A search ends that over so many steps has gained less than so many times what may be left to gain."""


class SearchState(eqx.Module):
    """Where the search stands: ``blocks`` and ``predicted`` at the best point, the ``trial`` that is looked at next, ``damping``,
    ``gain`` the decrease of the cost that the step to it promises, ``fell`` the last decrease, ``steps`` tried so far, ``mark``
    the cost and the steps when it had last gained something worth while."""

    blocks: Blocks
    predicted: Prediction
    trial: Unknowns
    damping: Array
    gain: Array
    fell: Array
    steps: Array
    mark: tuple[Array, Array]


class BlockLevenbergMarquardt(optx.AbstractLeastSquaresSolver):
    """Levenberg-Marquardt that solves the normal equations by blocks, within bounds.

    ``fn`` is `jaxbacklash.shooting.multiple_shooting.residual_rows`, which returns the `Shot` beside the rows; `linearise`
    takes its Jacobian. The first five are those of `jaxbacklash.shooting.levenberg.Levenberg`.
    """

    rtol: Array = 0.0
    atol: Array = 1e-3
    damping: Array = 1e-3
    limit: Array = 60
    beside: Array = 0.0
    norm: Any = eqx.field(default=optx.max_norm, static=True)

    def init(self, fn: Any, y: Unknowns, args: Problem, options: Any, f_struct: Any, aux_struct: Shot, tags: Any) -> SearchState:
        shapes = eqx.filter_eval_shape(_linearise, args, y, aux_struct), aux_struct.predicted
        blocks, predicted = jax.tree.map(lambda s: jnp.zeros(s.shape, s.dtype), shapes)
        far = jnp.asarray(jnp.inf)
        blocks = eqx.tree_at(lambda b: b.cost, blocks, far)
        none = jnp.asarray(0)
        return SearchState(blocks, predicted, y, jnp.asarray(self.damping), far, far, none, (far, none))

    def step(
        self, fn: Any, y: Unknowns, args: Problem, options: Any, state: SearchState, tags: Any
    ) -> tuple[Unknowns, SearchState, Any]:
        _, shot = fn(state.trial, args)
        # The first call looks at the start, whatever it is worth.
        better = (shot.cost < state.blocks.cost) | (state.steps == 0)
        pick = lambda new, old: jnp.where(better, new, old)  # noqa: E731
        fell = pick(state.blocks.cost - shot.cost, state.fell)
        blocks = jax.lax.cond(better, lambda: _linearise(args, state.trial, shot), lambda: state.blocks)
        blocks = eqx.tree_at(lambda b: b.cost, blocks, pick(shot.cost, state.blocks.cost))
        y = jax.tree.map(pick, state.trial, y)
        # Where dry friction makes the cost jagged, steps that only just help lead into corners.
        kept = (state.blocks.cost - shot.cost) / state.gain
        less, more = jnp.maximum(0.1 * state.damping, 1e-12), jnp.clip(10.0 * state.damping, LEAST, 1e12)
        damping = jnp.where(better & (kept > FAIR), less, jnp.where(better & (kept > POOR), state.damping, more))
        damping = jnp.where(state.steps == 0, self.damping, damping)

        # After the last look no step is taken.
        ahead = lambda: solve(blocks, damping, args.windows.used, _room(args, y.theta))  # noqa: E731
        nowhere = jax.tree.map(lambda s: jnp.zeros(s.shape, s.dtype), eqx.filter_eval_shape(ahead))
        solution = jax.lax.cond(state.steps + 1 < self.limit, ahead, lambda: nowhere)
        n = y.starts.shape[0]
        theta = jnp.clip(y.theta + solution.theta, args.lower, args.upper)
        trial = Unknowns(theta, y.starts + solution.local[:, :n].T, y.coefficients + solution.local[:, n:])
        predicted = jax.tree.map(pick, shot.predicted, state.predicted)
        steps = state.steps + 1
        gained = state.mark[0] - blocks.cost > PROGRESS * self._least(args, blocks.cost)
        mark = jax.tree.map(lambda new, old: jnp.where(gained, new, old), (blocks.cost, steps), state.mark)
        return y, SearchState(blocks, predicted, trial, damping, solution.promise, fell, steps, mark), shot

    def _least(self, args: Problem, cost: Array) -> Array:
        # Where the model misfits, the noise is no measure of what matters: the misfit is.
        return self.atol * jnp.maximum(1.0, 2.0 * cost / (_rows(args) + 1.0))

    def terminate(self, fn: Any, y: Unknowns, args: Problem, options: Any, state: SearchState, tags: Any) -> Any:
        cost = state.blocks.cost
        least = self._least(args, cost)
        small = state.gain < least + self.rtol * jnp.maximum(cost - _rows(args), 0.0)
        # Where dry friction makes the cost jagged, a little is promised for ever and next to nothing kept.
        small = small | ((state.fell < least) & (state.gain < PROMISED * least))
        # A promise under heavy damping says little; wait until the damping has come down or nothing helps any more.
        done = (small & (state.damping < 1.0)) | _stalled(state) | (state.steps >= self.limit)
        return done & (state.steps > 0), optx.RESULTS.successful

    def postprocess(
        self, fn: Any, y: Unknowns, aux: Any, args: Problem, options: Any, state: SearchState, tags: Any, result: Any
    ) -> Any:
        def undamped(blocks: Blocks) -> dict[str, Array]:
            found = solve(blocks, jnp.asarray(0.0), args.windows.used, _room(args, y.theta))
            told = {"cost": blocks.cost, "schur": found.schur, "score": found.score, "promise": found.promise}
            return told | {"log_determinant": found.log_determinant}

        def look(k: Array, found: dict[str, Array]) -> dict[str, Array]:
            looser = lambda: loosened(args, y, state.predicted, state.blocks, self.beside)  # noqa: E731
            told = undamped(jax.lax.cond(k == 0, lambda: state.blocks, looser))
            return {name: found[name].at[k].set(value) for name, value in told.items()}

        # With these ties and with looser ones in turns, not by a copy of the code: compiling is what costs here.
        shapes = eqx.filter_eval_shape(undamped, state.blocks)
        both = {name: jnp.full((2, *s.shape), jnp.nan, s.dtype) for name, s in shapes.items()}
        both = jax.lax.fori_loop(0, jnp.where(jnp.asarray(self.beside) > 0.0, 2, 1), look, both)
        stats = {"predicted": state.predicted, "steps": state.steps, "stalled": _stalled(state)}
        stats |= {name: value[0] for name, value in both.items()} | {"beside": {name: value[1] for name, value in both.items()}}
        return y, aux, stats


def _stalled(state: SearchState) -> Array:
    return (state.steps - state.mark[1] >= STALLED) | (state.damping > 1e11)


def _rows(problem: Problem) -> Array:
    return jnp.sum(problem.windows.weight > 0.0)


def _room(problem: Problem, theta: Array) -> tuple[Array, Array]:
    """Least and largest step (q,) that leads to no bound's other side; where a value must keep its sign, to no less than a third
    and no more than three times of it."""
    scale = jnp.sum(problem.directions, axis=0)
    offset = jnp.sum(jnp.where(problem.directions != 0.0, problem.base[:, None], 0.0), axis=0)
    value = offset + scale * theta
    near = (value / 3.0 - offset) / scale, (value * 3.0 - offset) / scale
    least = jnp.where(problem.shrink, jnp.maximum(problem.lower, near[0]), problem.lower)
    largest = jnp.where(problem.shrink, jnp.minimum(problem.upper, near[1]), problem.upper)
    return least - theta, largest - theta
