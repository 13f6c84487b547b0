"""The planes and neighbourhoods by which noise is taken off a series."""

import numpy as np

from jaxbacklash.timeseries import embed, projective
from jaxbacklash.timeseries.noise_reduction import _neighbourhoods
from jaxbacklash.timeseries.planes import widest


def test_the_widest_directions_are_those_of_the_largest_eigenvalues():
    rng = np.random.default_rng(3)
    axes = np.linalg.qr(rng.standard_normal((200, 15, 15)))[0]
    variances = np.concatenate([np.geomspace(1e4, 1.0, 4), np.full(11, 0.1)]) * rng.uniform(0.9, 1.1, (200, 15))
    basis = widest(axes @ (variances[:, :, None] * axes.transpose(0, 2, 1)), 4)
    np.testing.assert_allclose(basis.transpose(0, 2, 1) @ basis, np.broadcast_to(np.eye(4), (200, 4, 4)), atol=1e-12)
    wanted = axes[:, :, :4]
    np.testing.assert_allclose(basis @ basis.transpose(0, 2, 1), wanted @ wanted.transpose(0, 2, 1), atol=1e-6)
    assert np.all(widest(np.zeros((2, 5, 5)), 2) == 0.0)


def test_noise_is_taken_off_where_an_encoder_stands_still():
    """Hundreds of vectors are equal there, and none need be its own neighbour."""
    t = np.arange(4000)
    moves, noise = t % 1000 < 600, 0.01 * np.random.default_rng(4).standard_normal(t.size)
    moving = np.where(moves, np.sin(2 * np.pi * t / 50.0) + noise, 0.0)
    seen = np.round(moving / 0.02) * 0.02
    around = _neighbourhoods(embed(seen, 15, 1), 1)
    np.testing.assert_array_equal(around.near[:, 0], around.taken)
    np.testing.assert_allclose(around.mean_of_taken.sum(axis=1), 1.0)
    cleaned = projective(seen, window=15, delay=1, kept=3)
    assert np.all(np.isfinite(cleaned.series))
    assert np.sqrt(np.mean((cleaned.series - seen) ** 2)) < 0.02
