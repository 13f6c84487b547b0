"""Samples of a finely written record that repeat the one before by chance are no stale samples."""

import numpy as np
import pytest

from jaxbacklash.records.findings.channel import Channel
from jaxbacklash.records.findings.held_values import _at_least, _by_size, stale_rows


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


@pytest.mark.parametrize("significant", [True, False], ids=["digits", "decimals"])
@pytest.mark.parametrize("digits", [3, 4, 6])
@pytest.mark.parametrize("tail", [0.0, 0.002, 0.2])
@pytest.mark.parametrize("rows", [80, 2500, 70_000])
def test_repeats_by_chance_are_not_fewer_than_the_quick_look_promises(significant, digits, tail, rows):
    """Also where some steps are far larger than the others, or many samples rest."""
    rng = np.random.default_rng([digits, rows])
    steps = rng.normal(size=rows) * np.where(rng.random(rows) < tail, 30.0, 1.0)
    z = np.cumsum(steps) * 1e-4 - 0.003
    z[rows // 3 : rows // 2] = z[rows // 3]
    decimals = digits - 1 - np.floor(np.log10(np.abs(z))) if significant else digits
    channel = Channel(np.round(z * 10.0**decimals) / 10.0**decimals)
    coarsest, _ = _by_size(channel)
    count = max(channel.quantum, coarsest)
    size = np.abs(channel.steps)
    assert _at_least(channel) <= np.count_nonzero((size > 0.5 * count) & (size < 1.5 * count)) / 2


def test_the_quick_look_counts_the_steps_near_the_rarest_count():
    counts = np.repeat([0.0, 1.0, 2.0, 3.0, 900.0], [40, 1000, 50, 1200, 5])
    steps = np.random.default_rng(1).permutation(counts) * np.resize([1.0, -1.0], counts.size)
    # Two counts a step are rarest but for the five leaps, which no samples of like size have throughout.
    assert _at_least(Channel(np.cumsum(steps))) == 25.0
