"""Samples of a finely written record that repeat the one before by chance are no stale samples."""

import numpy as np
import pytest

from jaxbacklash.records.findings.channel import Channel
from jaxbacklash.records.findings.held import _of_like_size, stale_rows


def written(noise, digits, significant, seed):
    """A million rows of smooth motion and noise with a fixed number of significant digits or of decimals."""
    t = np.arange(1_000_000) / 50e3
    z = 0.02 * np.sin(2 * np.pi * 3.0 * t) + 0.01 * np.sin(2 * np.pi * 7.3 * t + 1.0)
    z += noise * np.random.default_rng(seed).normal(size=t.size)
    decimals = digits - 1 - np.floor(np.log10(np.abs(z))) if significant else digits
    return np.round(z * 10.0**decimals) / 10.0**decimals


@pytest.mark.parametrize("significant", [True, False], ids=["digits", "decimals"])
@pytest.mark.parametrize("digits", [7, 8, 9])
@pytest.mark.parametrize("noise", [1e-7, 1e-6, 1e-5])
def test_chance_repeats_are_not_stale(noise, digits, significant):
    z = written(noise, digits, significant, seed=digits)
    if digits == 7:
        assert np.count_nonzero(np.diff(z) == 0.0) > 100  # else there is nothing to take for stale
    assert stale_rows(Channel(z)).size == 0
    assert stale_rows(Channel(z * np.pi / 180.0)).size == 0


@pytest.mark.parametrize("significant", [True, False], ids=["digits", "decimals"])
def test_more_repeats_than_chance_brings_are_stale(significant):
    z = written(1e-6, 8, significant, seed=1)
    rows = np.arange(50, z.size - 50, 500)
    z[rows] = z[rows - 1]
    assert np.isin(rows, stale_rows(Channel(z))).mean() > 0.95


@pytest.mark.parametrize("groups", [1, 2, 7])
def test_groups_of_like_size_part_all_samples_and_begin_with_that_of_one(groups):
    size = np.random.default_rng(3).permutation(200) / 10.0
    for one in (int(np.argmin(size)), int(np.argmax(size)), 17):
        found = list(_of_like_size(size, groups, one))
        assert one in found[0]
        expected = np.array_split(np.argsort(size), groups)
        assert {tuple(sorted(group)) for group in found} == {tuple(sorted(group)) for group in expected}
