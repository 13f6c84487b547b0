"""The block tridiagonal solver and the step of a fit against dense algebra, and damping that leaves tied windows free to move
together."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy import optimize

from jaxbacklash.shooting import block_tridiagonal, damped_step, side_by_side_windows
from jaxbacklash.shooting.block_tridiagonal import (
    bordered,
    eliminate,
    factorise,
    inverse_diagonal,
    solve_lower,
    solve_upper,
)
from jaxbacklash.shooting.multiple_shooting import Blocks

solve = eqx.filter_jit(damped_step.solve)


def system(rng, windows=5, size=3, q=2):
    """A positive definite system, as blocks and as one matrix, with its gradient."""
    n = windows * size
    jacobian = np.zeros((40 * windows, n + q))
    for w in range(windows):
        rows = slice(40 * w, 40 * (w + 1))
        seen = slice(size * w, min(size * (w + 2), n))
        jacobian[rows, seen] = rng.normal(size=(40, seen.stop - seen.start))
        jacobian[rows, n:] = rng.normal(size=(40, q))
    matrix, slope = jacobian.T @ jacobian, rng.normal(size=n + q)
    part = lambda a, b: matrix[size * a : size * (a + 1), size * b : size * (b + 1)]  # noqa: E731
    diagonal = np.stack([part(w, w) for w in range(windows)])
    below = np.stack([part(w + 1, w) if w + 1 < windows else np.zeros((size, size)) for w in range(windows)])
    border = matrix[:n, n:].reshape(windows, size, q)
    seen = np.diag(matrix)
    blocks = Blocks(
        diagonal, below, border, matrix[n:, n:], slope[:n].reshape(windows, size), slope[n:], np.zeros(()),
        seen[:n].reshape(windows, size), seen[n:],
    )  # fmt: skip
    return blocks, matrix, slope


def padded(part, rng, more=2):
    """An array with windows beyond those that are used: what they hold is nobody's."""
    return np.concatenate([part, rng.standard_normal((more, *part.shape[1:]))])


def test_factor_is_that_of_the_dense_matrix():
    rng = np.random.default_rng(0)
    blocks, matrix, _ = system(rng, windows=4)
    windows, size = blocks.slope.shape
    dense = matrix[: windows * size, : windows * size]
    right = rng.standard_normal((windows, size, 2))
    factor = factorise(padded(blocks.diagonal, rng), padded(blocks.below, rng), windows)
    half = solve_lower(factor, padded(right, rng))
    solution = np.linalg.solve(dense, right.reshape(-1, 2))
    assert float(factor.log_determinant) == pytest.approx(np.linalg.slogdet(dense)[1])
    np.testing.assert_allclose(solve_upper(factor, half)[:windows].reshape(-1, 2), solution, rtol=1e-9)
    np.testing.assert_allclose(np.einsum("wbi,wbj->ij", half, half), right.reshape(-1, 2).T @ solution, rtol=1e-9)
    np.testing.assert_allclose(np.ravel(inverse_diagonal(factor)[:windows]), np.diag(np.linalg.inv(dense)), rtol=1e-9)


ONE_BY_ONE, SIDE_BY_SIDE = block_tridiagonal.eliminate, side_by_side_windows.eliminate
CHAINS = [(0, 5, ONE_BY_ONE), (3, 5, ONE_BY_ONE), (0, 40, SIDE_BY_SIDE), (2, 3, SIDE_BY_SIDE), (2, 49, SIDE_BY_SIDE)]


@pytest.mark.parametrize(("q", "windows", "way"), CHAINS)
def test_elimination_leaves_the_schur_complement_and_the_score(q, windows, way):
    """One after the other, and in stretches: as many as there are lanes or fewer, whole ones and one that is cut short."""
    rng = np.random.default_rng(q)
    blocks, matrix, slope = system(rng, windows=windows, q=q)
    size = blocks.slope.shape[1]
    n = windows * size
    along = [padded(np.asarray(part), rng) for part in (blocks.diagonal, blocks.below, blocks.border, blocks.slope)]
    done = jax.jit(way)(*along[:3], blocks.corner, along[3], blocks.slope_theta, windows)
    inner = np.linalg.inv(matrix[:n, :n])
    schur = matrix[n:, n:] - matrix[n:, :n] @ inner @ matrix[:n, n:]
    np.testing.assert_allclose(done.schur, schur, rtol=1e-9)
    np.testing.assert_allclose(done.score, -slope[n:] + matrix[n:, :n] @ inner @ slope[:n], rtol=1e-9, atol=1e-12)
    assert float(done.log_determinant) == pytest.approx(np.linalg.slogdet(matrix[:n, :n])[1])
    step = rng.standard_normal(q)
    local = -inner @ (slope[:n] + matrix[:n, n:] @ step)
    found = np.asarray(jax.jit(lambda done: done.local(step))(done))
    np.testing.assert_allclose(np.ravel(found[:windows]), local, rtol=1e-8, atol=1e-12)
    assert np.all(found[windows:] == 0.0)
    whole = np.concatenate([local, step])
    promise = -(slope @ whole + 0.5 * whole @ matrix @ whole)
    assert float(done.promise(step, done.schur)) == pytest.approx(promise, rel=1e-9)


def test_a_border_may_be_added_later():
    blocks, _, _ = system(np.random.default_rng(2))
    done = eliminate(
        blocks.diagonal, blocks.below, blocks.border, blocks.corner, blocks.slope, blocks.slope_theta, blocks.slope.shape[0]
    )
    again = bordered(done.factor, done.halfway, blocks.corner, blocks.slope_theta)
    np.testing.assert_array_equal(again.schur, done.schur)


def test_a_matrix_that_is_not_positive_definite_says_so():
    blocks, _, _ = system(np.random.default_rng(1))
    assert np.isnan(factorise(-blocks.diagonal, blocks.below, 5).log_determinant)
    blocks, _, _ = system(np.random.default_rng(1), windows=30)
    parts = blocks.below, blocks.border, blocks.corner, blocks.slope, blocks.slope_theta
    assert np.isnan(jax.jit(SIDE_BY_SIDE)(-blocks.diagonal, *parts, 30).log_determinant)


@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_it_solves_what_dense_algebra_solves(damping):
    blocks, matrix, slope = system(np.random.default_rng(4))
    found = solve(blocks, jnp.asarray(damping))
    size = found.local.size
    exact = np.linalg.solve(matrix + damping * np.diag(np.diag(matrix)), -slope)
    np.testing.assert_allclose(np.ravel(found.local), exact[:size], rtol=1e-9)
    if damping == 0.0:
        np.testing.assert_allclose(found.theta, exact[size:], rtol=1e-9)
        marginal = np.linalg.inv(np.linalg.inv(matrix)[size:, size:])
        np.testing.assert_allclose(found.schur, marginal, rtol=1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_what_a_bound_holds_takes_all_else_with_it(seed):
    """Against scipy's bounded least squares: of the parameters' steps, half the room that they ask for."""
    rng = np.random.default_rng(seed)
    blocks, matrix, slope = system(rng)
    size, q = blocks.slope.size, blocks.corner.shape[0]
    asked = np.abs(np.linalg.solve(matrix, -slope)[size:])
    room = np.where(np.arange(q) == seed % q, 0.0, np.where(rng.random(q) < 0.5, 0.5, 2.0) * asked)
    root = np.linalg.cholesky(matrix).T
    bound = np.concatenate([np.full(size, np.inf), room + 1e-12])
    exact = optimize.lsq_linear(root, np.linalg.solve(root.T, -slope), (-bound, bound), method="bvls", tol=1e-14).x
    found = solve(blocks, jnp.asarray(0.0), between=(-room, room))
    np.testing.assert_allclose(found.theta, exact[size:], atol=1e-8 * np.max(asked))
    np.testing.assert_allclose(np.ravel(found.local), exact[:size], atol=1e-7 * np.max(np.abs(exact)))
    assert float(found.promise) == pytest.approx(-(slope @ exact + 0.5 * exact @ matrix @ exact), rel=1e-6)


@pytest.mark.parametrize("tie", [0.0, 1.0, 1e3])
def test_ties_do_not_hinder_windows_that_move_together(tie):
    """Two windows that both want to move by one, damped by as much as the samples hold them: half of it, however tied."""
    one = np.ones((2, 1))
    blocks = Blocks(
        (1.0 + tie**2) * one[:, :, None], np.array([[[-(tie**2)]], [[0.0]]]), np.zeros((2, 1, 0)), np.zeros((0, 0)),
        -one, np.zeros(0), np.zeros(()), one, np.zeros(0),
    )  # fmt: skip
    np.testing.assert_allclose(solve(blocks, jnp.asarray(1.0)).local, 0.5 * one, rtol=1e-6)


@pytest.mark.parametrize("damping", [0.0, 1e-3, 1e3])
def test_what_moves_nothing_is_not_sent_anywhere_by_the_rounding_of_its_slope(damping):
    """The speed from which dry friction brings a link to rest at once: no damping that is a share of its curvature holds it."""
    blocks, matrix, slope = system(np.random.default_rng(5))
    size, q = blocks.slope.shape[1], blocks.corner.shape[0]
    dead = size * 2 + 1  # the second unknown of the third window
    matrix, slope = matrix.copy(), slope.copy()
    matrix[dead], matrix[:, dead] = 0.0, 0.0
    matrix[dead, dead], slope[dead] = 1e-14 * np.max(matrix), 1e-5
    n = slope.size - q
    part = lambda a, b: matrix[size * a : size * (a + 1), size * b : size * (b + 1)]  # noqa: E731
    count = n // size
    blocks = Blocks(
        np.stack([part(w, w) for w in range(count)]),
        np.stack([part(w + 1, w) if w + 1 < count else np.zeros((size, size)) for w in range(count)]),
        matrix[:n, n:].reshape(count, size, q), matrix[n:, n:], slope[:n].reshape(count, size), slope[n:], np.zeros(()),
        np.diag(matrix)[:n].reshape(count, size), np.diag(matrix)[n:],
    )  # fmt: skip
    found = solve(blocks, jnp.asarray(damping))
    rest = np.delete(np.arange(n + q), dead)
    alone = matrix[np.ix_(rest, rest)]
    exact = np.linalg.solve(alone + damping * np.diag(np.diag(alone)), -slope[rest])
    local = np.ravel(found.local)
    assert abs(local[dead]) < 1e-5
    np.testing.assert_allclose(np.delete(local, dead), exact[: n - 1], rtol=1e-8)
    np.testing.assert_allclose(found.theta, exact[n - 1 :], rtol=1e-8)


@pytest.mark.parametrize("seed", range(20))
def test_a_sum_that_alone_is_determined_sends_no_step_uphill(seed):
    """Two parameters of which only the sum shows: rounding sends both far along the difference, up to a bound and no further."""
    rng = np.random.default_rng(seed)
    rows = rng.standard_normal((30, 3))
    rows = np.column_stack([rows, rows[:, 0] * rng.uniform(0.5, 2.0)])
    wanted = rng.standard_normal(4)
    slope = -rows.T @ (rows @ wanted) + 1e-3 * rng.standard_normal(4)
    blocks = Blocks(
        np.ones((1, 1, 1)), np.zeros((1, 1, 1)), np.zeros((1, 1, 4)), rows.T @ rows, np.zeros((1, 1)), slope, np.zeros(()),
        np.ones((1, 1)), np.ones(4),
    )  # fmt: skip
    least, largest = -rng.uniform(0.1, 5.0, 4), rng.uniform(0.1, 5.0, 4)
    found = solve(blocks, jnp.asarray(0.0), between=(least, largest))
    theta = np.asarray(found.theta)
    assert np.all(theta >= least - 1e-12)
    assert np.all(theta <= largest + 1e-12)
    exact = optimize.lsq_linear(rows, np.linalg.lstsq(rows.T, -slope)[0], (least, largest)).x
    best = -(slope @ exact + 0.5 * exact @ (rows.T @ rows) @ exact)
    assert float(found.promise) == pytest.approx(best, rel=0.02)
