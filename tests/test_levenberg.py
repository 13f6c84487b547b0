"""The search by bordered block tridiagonal systems: steps that are turned down, and when it has seen enough."""

import equinox as eqx
import jax
import numpy as np
import pytest

from jaxbacklash.fitting.continuation import TIGHTEST, tied
from jaxbacklash.fitting.settings import JOINED
from jaxbacklash.fitting.setup import first_guess, make_problem
from jaxbacklash.parameters import values, with_values
from jaxbacklash.shooting.block_levenberg import BlockLevenbergMarquardt
from jaxbacklash.shooting.levenberg import Levenberg, minimise
from jaxbacklash.shooting.multiple_shooting import linearise, residual_rows, residuals, shoot
from jaxbacklash.shooting.problem import Unknowns

from .hidden import fitter, hidden


def joint(name, seed, seconds):
    """What builds the problems of a record, and the effect that it hides at its true values."""
    record, rig, effects, _ = hidden(name, "chirp", seed, seconds)
    builder = fitter(record, rig.inertia)
    # A few laws make a program of the same kind as all, which takes a minute to compile.
    builder.take_laws({n: builder.laws[n] for n in ("gravity", "contact_damping", *effects)})
    return builder, {n: builder.laws[n](**own) for n, own in effects.items()}


def test_a_shot_costs_half_the_sum_of_its_squares():
    builder, _ = joint(None, 2, 4.0)
    problem, _ = builder.problem({}, builder.base)
    problem = eqx.tree_at(lambda p: p.tie, problem, np.asarray(3.0))
    guess = first_guess(problem)
    rng = np.random.default_rng(3)
    moved = Unknowns(0.01 * rng.standard_normal(guess.theta.shape), guess.starts, guess.coefficients)
    found = jax.jit(residuals)(problem, moved)
    shot = jax.jit(shoot)(problem, moved)
    for mine, other in zip((shot.motion, shot.input, shot.tie), found):
        np.testing.assert_allclose(mine, other, rtol=1e-9, atol=1e-9)
    assert float(shot.cost) == pytest.approx(sum(0.5 * np.sum(np.asarray(r) ** 2) for r in found), rel=1e-9)


@pytest.mark.parametrize("name", [None, pytest.param("dahl", marks=pytest.mark.slow)])
def test_blocks_are_those_of_the_rows_that_optimistix_is_handed(name):
    """J^T r and half of r^T r, by differentiation of the rows as a whole."""
    bench, effects = joint(name, 2, 2.0)
    problem, _ = bench.problem(effects, bench.base)
    guess = first_guess(problem)
    rng = np.random.default_rng(3)
    shift = rng.standard_normal(guess.starts.shape) * (1e-3 if name is None else 1e-2)
    moved = Unknowns(0.01 * rng.standard_normal(guess.theta.shape), guess.starts + shift, guess.coefficients * (1.0 + 1e-4))
    half = lambda u: sum(0.5 * jax.numpy.sum(row**2) for row in residual_rows(u, problem)[0])  # noqa: E731
    cost, slope = jax.jit(lambda u: (half(u), jax.jacfwd(lambda th: half(eqx.tree_at(lambda v: v.theta, u, th)))(u.theta)))(moved)
    blocks = jax.jit(lambda u: linearise(problem, u, shoot(problem, u)))(moved)
    assert float(blocks.cost) == pytest.approx(float(cost), rel=1e-9)
    active = int(problem.active)
    np.testing.assert_allclose(blocks.slope_theta[:active], slope[:active], rtol=1e-6)


@pytest.mark.slow
def test_a_step_that_is_turned_down_changes_nothing_but_the_damping():
    builder, _ = joint(None, 2, 4.0)
    problem, _ = builder.problem({}, builder.base)
    solver = BlockLevenbergMarquardt()
    guess = first_guess(problem)
    shapes = eqx.filter_eval_shape(residual_rows, guess, problem)
    before = solver.init(residual_rows, guess, problem, {}, *shapes, None)
    step = eqx.filter_jit(lambda y, state: solver.step(residual_rows, y, problem, {}, state, None)[:2])
    y, at = step(guess, before)
    far = eqx.tree_at(lambda s: s.trial.starts, at, at.trial.starts + 1.0)
    same, after = step(y, far)
    assert bool(eqx.tree_equal(same, y))
    assert bool(eqx.tree_equal((after.blocks, after.predicted, after.fell), (at.blocks, at.predicted, at.fell)))
    assert float(after.damping) > float(at.damping)
    assert int(after.steps) == int(at.steps) + 1


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 21])
def test_where_a_jagged_cost_ends_the_search_nothing_is_left_to_gain(seed):
    """Dry friction makes the cost of a tied trajectory jagged: half the steps were spent where thousandths were gained."""
    builder, effects = joint("coulomb_joint", seed, 12.0)
    problem, _ = builder.problem(effects, builder.base)
    begin = minimise(problem, first_guess(problem), Levenberg(limit=60)).value
    problem = tied(problem, TIGHTEST)
    ended = minimise(problem, begin, Levenberg(damping=1e-9, limit=150))
    further = minimise(problem, ended.value, Levenberg(atol=1e-9, limit=60))
    assert int(ended.stats["steps"]) < 150
    # One standard error of one parameter costs a half.
    assert float(ended.stats["cost"] - further.stats["cost"]) < 0.05
    moved = problem.directions @ (np.asarray(further.value.theta) - np.asarray(ended.value.theta))
    free = int(problem.active)
    scale = np.sum(problem.directions, axis=0)[:free]
    errors = scale * np.sqrt(np.diag(np.linalg.inv(np.asarray(ended.stats["schur"])[:free, :free])))
    at = [int(np.flatnonzero(problem.directions[:, j])[0]) for j in range(free)]
    assert np.all(np.abs(moved[at]) < 0.3 * errors)


@pytest.mark.slow
def test_a_parameter_at_its_bound_does_not_tear_windows_apart_that_are_tied():
    """What a bound holds is as good as not free: cut off alone, its share of the step left every window where none goes on."""
    builder, _ = joint(None, 6, 6.0)
    problem, _ = builder.problem({}, builder.base)
    starts, found = minimise(problem, first_guess(problem), Levenberg(limit=60)).value, []
    free = problem.rebuild(starts.theta)
    system = with_values(free, {"stiffness": 0.98 * values(free)["stiffness"]})
    for names in (builder.base_free, tuple(n for n in builder.base_free if n != "stiffness")):
        problem = make_problem(system, builder.windows, names)
        if "stiffness" in names:
            cap = np.where(np.array(names) == "stiffness", 0.0, problem.upper)
            problem = eqx.tree_at(lambda p: p.upper, problem, cap)
        begin = Unknowns(np.zeros(len(names)), starts.starts, starts.coefficients)
        solution = minimise(tied(problem, TIGHTEST), begin, Levenberg(damping=1e-9))
        found.append(
            (
                float(solution.stats["cost"]),
                int(solution.stats["steps"]),
                float(problem.rebuild(solution.value.theta).damper.damping),
            )
        )
    (cost, steps, damping), (alone, few, known) = found
    assert cost == pytest.approx(alone, rel=1e-6)
    assert damping == pytest.approx(known, rel=1e-3)
    assert steps <= few + 2


@pytest.mark.parametrize("name", [None, pytest.param("dahl", marks=pytest.mark.slow)])
def test_a_look_at_looser_ties_tells_what_a_search_with_them_tells_at_its_start(name):
    bench, effects = joint(name, 2, 3.0)
    problem, _ = bench.problem(effects, bench.base)
    found = minimise(tied(problem, TIGHTEST), first_guess(problem), Levenberg(limit=8, beside=JOINED))
    alone = minimise(tied(problem, JOINED), found.value, Levenberg(limit=1))
    # Only the order of sums differs, but next to ties ten thousand times as sharp.
    for told in ("cost", "promise", "log_determinant", "score", "schur"):
        least = 1e-7 * np.max(np.abs(alone.stats[told]))
        np.testing.assert_allclose(found.beside.stats[told], alone.stats[told], rtol=1e-6, atol=least)
    assert found.stats["log_determinant"] > alone.stats["log_determinant"] + 100.0
