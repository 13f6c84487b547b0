"""What checks share about a channel is the same whether it is worked out in full or told by a shortcut."""

import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from jaxbacklash.records.findings.channel import Channel, once
from jaxbacklash.records.findings.local import SURPRISE_OF_NOISE, level, surprise


def values_of(kind, seed):
    """Twenty seconds of a motion with noise, as a file or a sensor would have it."""
    rng = np.random.default_rng(seed)
    t = np.arange(4000) / 200.0
    z = 0.02 * np.sin(2 * np.pi * 1.3 * t) + rng.normal(scale=1e-4, size=t.size)
    if kind == "decimals":
        return np.round(z, 4)
    if kind == "counts":
        return np.round(z / 7e-4) * 7e-4
    if kind == "steps":
        return np.repeat(rng.normal(size=10), 400)
    if kind == "spikes":
        z[rng.integers(5, z.size - 5, size=6)] += 0.05
    return z


KINDS = ("fine", "decimals", "counts", "steps", "spikes")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(3))
def test_a_channel_is_finer_than_a_limit_as_its_quantum_is(kind, seed):
    values = values_of(kind, seed)
    quantum = Channel(values).quantum
    assert quantum > 0.0
    for times in (0.01, 0.9, 1.0, 1.1, 3.0, 1e3):
        assert Channel(values).is_finer(times * quantum) == (quantum < times * quantum)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("size", [3999, 4000])
def test_a_channel_is_quieter_than_a_limit_as_its_noise_is(kind, seed, size):
    values = values_of(kind, seed)[:size]
    noise = level(surprise(values))
    for limit in (0.0, 0.9 * noise, 1.1 * noise, 3.0 * noise, 1.0):
        assert Channel(values).is_quieter(limit) == (noise < limit)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(3))
def test_the_rows_that_stand_out_are_those_beyond_the_median(kind, seed):
    values = values_of(kind, seed)
    size = np.abs(surprise(values))
    for times in (1.0, 3.0, 8.0, 30.0):
        rows = np.flatnonzero(size > times * SURPRISE_OF_NOISE * level(size))
        np.testing.assert_array_equal(Channel(values).standing_out(times), rows)
    assert Channel(values).standing_out(8.0).size == 0 or kind in ("steps", "spikes")


def test_the_channels_of_a_record_are_worked_out_at_the_same_time():
    """Each waits for the other: one after another, neither would come to an end."""
    both = threading.Barrier(2, timeout=20.0)

    class Waits:
        @once
        def met(self):
            return both.wait()

    with ThreadPoolExecutor(2) as pool:
        assert sorted(pool.map(lambda one: one.met, [Waits(), Waits()])) == [0, 1]
