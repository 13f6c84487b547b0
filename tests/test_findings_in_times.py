"""What is odd in the times of a record, and the rate that they tell."""

import numpy as np
import pytest

from jaxbacklash.records.findings import find_in_times
from jaxbacklash.records.findings.stamps import rate_of
from jaxbacklash.records.options import ReadOptions
from jaxbacklash.records.remedies import applied
from jaxbacklash.records.time_axis import uniform_grid

NOTHING_SAID = ReadOptions()
SEEDS = (0, 1, 2)


@pytest.mark.parametrize("rate", [333.0, 400.0, 640.0, 800.0, 900.0])
def test_the_rate_of_rounded_stamps_is_the_rate_of_the_samples(rate):
    t = np.round(np.arange(6000) / rate, 3)
    assert rate_of(t) == pytest.approx(rate, rel=1e-5)
    grid = uniform_grid(t)
    assert grid is not None
    assert 1.0 / np.diff(grid).mean() == pytest.approx(rate, rel=1e-5)
    assert not find_in_times(t, NOTHING_SAID)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_rate_with_lost_rows_or_jitter_is_that_of_the_others(seed):
    rng = np.random.default_rng(seed)
    lost = np.sort(rng.choice(6000, 5700, replace=False)) / 500.0
    assert rate_of(lost) == pytest.approx(500.0, rel=1e-9)
    assert uniform_grid(lost) is None
    assert rate_of((np.arange(6000) + rng.uniform(-0.3, 0.3, 6000)) / 500.0) == pytest.approx(500.0, rel=1e-3)


@pytest.mark.parametrize("rate", [200.0, 500.0, 1000.0, 2500.0])
def test_stamps_in_bursts_propose_the_rate_of_the_samples(rate):
    rows = np.arange(5000)
    for t in ((rows // 16) * 16 / rate, (rows // 16) * 16 / rate + (rows % 16) * 1e-7, np.round(rows / 1500.0, 3)):
        found = find_in_times(t, NOTHING_SAID)
        true = 1500.0 if t[-1] == np.round(rows / 1500.0, 3)[-1] else rate
        assert [one.kind for one in found] == ["bursts"]
        assert applied(NOTHING_SAID, found[0].remedy).rate == pytest.approx(true, rel=1e-3)


@pytest.mark.parametrize(
    ("t", "asked"),
    [
        (2.0 * np.arange(200), []),  # a picture every 2 s: as milliseconds it would last 0.4 s
        (0.1 * np.arange(3000), []),
        (2.0 * np.arange(3000), ["--unit t=ms"]),
        (2e3 * np.arange(3000), ["--unit t=us"]),
    ],
)
def test_slow_times_are_asked_about_only_where_they_may_be_milliseconds(t, asked):
    assert [one.remedy for one in find_in_times(t, NOTHING_SAID)] == asked
    assert not find_in_times(t, NOTHING_SAID, units_stated=frozenset("t"))
