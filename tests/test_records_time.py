"""Which times count as even, and what resampling makes of those that do not."""

import numpy as np
import pytest

from jaxbacklash.errors import BadInput
from jaxbacklash.records import read_record
from jaxbacklash.records.resample import resampled
from jaxbacklash.records.time_axis import uniform_grid


def clock(samples: int, rate: float, start: float = 0.0) -> np.ndarray:
    return start + np.arange(samples) / rate


def digits(t: np.ndarray, template: str) -> np.ndarray:
    """Times as they read back once printed."""
    return np.array([float(template % value) for value in t])


def test_ten_minutes_at_five_kilohertz_are_even():
    t = clock(3_000_000, 5000)
    assert uniform_grid(t) is t


@pytest.mark.parametrize(
    ("rounded", "rate"),
    [
        (digits(clock(10001, 500), "%.3f"), 500),
        (digits(clock(10001, 333), "%.6f"), 333),
        (digits(clock(10001, 333), "%.3f"), 333),
        (digits(clock(1001, 1000 / 3), "%.3f"), 1000 / 3),
        (digits(clock(5001, 480, 7.3), "%.4f"), 480),
        (digits(clock(100001, 333), "%.9g"), 333),
        (digits(clock(5001, 700), "%.7g"), 700),
        (digits(1e3 * clock(5001, 700), "%.3f") * 1e-3, 700),
        (clock(30001, 333).astype(np.float32).astype(float), 333),
        ((1e3 * clock(30001, 333)).astype(np.float32) * np.float64(1e-3), 333),
        (np.floor(clock(20000, 777) * 25e6) / 25e6, 777),
        (clock(30001, 333, 1.7e9), 333),
        (np.cumsum(np.full(30001, 1 / 333)), 333),
    ],
)
def test_rounding_of_an_even_clock_is_seen_through(rounded, rate):
    grid = uniform_grid(rounded)
    assert grid is not None
    steps = np.diff(grid)
    assert np.ptp(steps) <= 2e-6 / rate + 4 * np.spacing(grid[-1])
    assert (grid.size - 1) / (grid[-1] - grid[0]) == pytest.approx(rate, rel=1e-5)
    assert np.abs(grid - rounded).max() <= 1.1 * np.abs(clock(rounded.size, rate, rounded[0]) - rounded).max() + 1e-3 / rate


def lost_row(t, row):
    return np.delete(t, row)


@pytest.mark.parametrize("decimals", [3, 4, 6, 15])
@pytest.mark.parametrize("rate", [1000.0, 500.0, 400.0, 333.0])
@pytest.mark.parametrize("row", [1, 300, 500, 998])
def test_a_lost_row_is_not_taken_for_rounding(rate, decimals, row):
    assert uniform_grid(np.round(lost_row(clock(1000, rate), row), decimals)) is None


@pytest.mark.parametrize("shift", [0.01, 0.25, 0.5, 0.9])
@pytest.mark.parametrize("decimals", [3, 6, 15])
def test_a_shift_of_the_clock_is_not_taken_for_rounding(shift, decimals):
    t = clock(1000, 500)
    t = np.round(t + shift * 0.002 * (t > 0.9), decimals)
    exact = not np.any(np.abs(np.diff(t) - 0.002) > 1e-9)
    assert (uniform_grid(t) is not None) == exact


@pytest.mark.parametrize("size", [1e-5, 1e-3, 0.1, 0.3])
def test_jitter_is_not_taken_for_rounding(size):
    t = clock(5000, 500)
    jittered = t + 0.002 * size * np.random.default_rng(0).uniform(-1, 1, t.size)
    assert uniform_grid(jittered) is None
    assert uniform_grid(np.round(jittered, 9)) is None
    assert uniform_grid(t + 1e-7 * (jittered - t) / size) is not None


def test_a_slow_drift_of_the_clock_is_not_taken_for_rounding():
    t = clock(5000, 500)
    assert uniform_grid(t + 1e-5 * t**2) is None


def tone(t, frequency=20.0):
    return np.sin(2 * np.pi * frequency * t + 0.3)


def inside(t):
    """The interior: the ends of a filter are worse, and said to be."""
    return (t > t[0] + 0.25) & (t < t[-1] - 0.25)


def test_uneven_times_become_even_and_the_motion_stays():
    even = clock(4000, 1000)
    t = np.delete(even + np.random.default_rng(0).uniform(-3e-4, 3e-4, even.size), [500, 900, 901, 2000])
    new, columns = resampled(t, {"z": tone(t), "state": np.arange(t.size).astype(str)}, None, "here")
    assert np.ptp(np.diff(new)) < 1e-9
    assert (new.size - 1) / (new[-1] - new[0]) == pytest.approx(1000, rel=0.02)
    error = np.abs(columns["z"] - tone(new))
    assert np.median(error) < 2e-6
    assert error.max() < 5e-4
    assert columns["state"].shape == new.shape


@pytest.mark.parametrize("rate", [100.0, 250.0, 333.0, 999.0])
def test_a_lower_rate_keeps_what_it_can_show_and_drops_the_rest(rate):
    t = clock(8000, 1000)
    new, columns = resampled(t, {"low": tone(t, 0.2 * rate), "high": tone(t, 0.52 * rate + 5)}, rate, "here")
    assert np.diff(new) == pytest.approx(1 / rate)
    # The last thousandth is the spline's, whose samples at 1000 Hz thin out as the tone climbs.
    assert columns["low"][inside(new)] == pytest.approx(tone(new, 0.2 * rate)[inside(new)], abs=0.02)
    if rate < 500:
        assert columns["low"][inside(new)] == pytest.approx(tone(new, 0.2 * rate)[inside(new)], abs=1e-3)
        assert np.abs(columns["high"][inside(new)]).max() < 1e-3


def test_a_higher_rate_and_the_same_rate():
    t = clock(2000, 500)
    new, columns = resampled(t, {"z": tone(t)}, 1250, "here")
    assert columns["z"] == pytest.approx(tone(new), abs=2e-3)
    same, columns = resampled(t, {"z": tone(t)}, 500, "here")
    assert same is t
    np.testing.assert_array_equal(columns["z"], tone(t))


@pytest.mark.parametrize("rate", [0.0, -5.0, np.nan, np.inf, 1e6])
def test_a_senseless_rate_is_refused(rate):
    with pytest.raises(BadInput, match="Hz to resample to"):
        resampled(clock(1000, 500), {}, rate, "here")


def test_read_record_resamples_only_when_told(tmp_path):
    t = np.delete(clock(2000, 500), [700, 1200])
    np.savez(tmp_path / "rec.npz", t=t, z=0.1 * tone(t, 6), speed=tone(t, 5))
    with pytest.raises(BadInput, match="--resample"):
        read_record(tmp_path / "rec.npz")
    record = read_record(tmp_path / "rec.npz", resample=True)
    assert (record.samples, record.rate_hz) == (2000, pytest.approx(500))
    assert record.channels["z"] == pytest.approx(0.1 * tone(record.t, 6), abs=1e-6)
    assert record.extras["speed"] == pytest.approx(tone(record.t, 5), abs=1e-5)
    assert read_record(tmp_path / "rec.npz", resample=200).rate_hz == pytest.approx(200)
