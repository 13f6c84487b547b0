"""The arrow's linear algebra against dense algebra, and damping that leaves tied windows free to move together."""

import jax.numpy as jnp
import numpy as np
import pytest

from jaxbacklash.fitting.arrow import solve
from jaxbacklash.fitting.shooting import Blocks


def chain(rng, windows=5, size=3, q=2):
    """A positive definite arrow, as blocks and as one matrix, with its gradient."""
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


@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_it_solves_what_dense_algebra_solves(damping):
    blocks, matrix, slope = chain(np.random.default_rng(4))
    found = solve(blocks, jnp.asarray(damping))
    size = found.local.size
    exact = np.linalg.solve(matrix + damping * np.diag(np.diag(matrix)), -slope)
    np.testing.assert_allclose(np.ravel(found.local), exact[:size], rtol=1e-9)
    if damping == 0.0:
        np.testing.assert_allclose(found.theta, exact[size:], rtol=1e-9)
        marginal = np.linalg.inv(np.linalg.inv(matrix)[size:, size:])
        np.testing.assert_allclose(found.schur, marginal, rtol=1e-9)


@pytest.mark.parametrize("tie", [0.0, 1.0, 1e3])
def test_ties_do_not_hinder_windows_that_move_together(tie):
    """Two windows that both want to move by one, damped by as much as the samples hold them: half of it, however tied."""
    one = np.ones((2, 1))
    blocks = Blocks(
        (1.0 + tie**2) * one[:, :, None], np.array([[[-(tie**2)]], [[0.0]]]), np.zeros((2, 1, 0)), np.zeros((0, 0)),
        -one, np.zeros(0), np.zeros(()), one, np.zeros(0),
    )  # fmt: skip
    np.testing.assert_allclose(solve(blocks, jnp.asarray(1.0)).local, 0.5 * one, rtol=1e-6)
