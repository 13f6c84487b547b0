"""Drift before all else, and what a short or a coarse series may not claim."""

import warnings

import numpy as np
import pytest

from jaxbacklash import BadInput, chaos
from jaxbacklash.timeseries import find_drift
from jaxbacklash.timeseries.analyse import LONGEST, _shortened
from jaxbacklash.timeseries.driven import Driven
from jaxbacklash.timeseries.verdict import judge_driven

from .independent.chaotic import HELD_BACK, HENON, KNOWN, LORENZ, NOT_CHAOTIC_HELD_BACK, ar2, torus, with_noise


def rng(seed=0):
    return np.random.default_rng(seed)


def walk(samples, seed, volatile=False):
    """A share index: a geometric random walk, with steps of 1 %, or of a size that follows its last one (ARCH)."""
    steps = rng(seed).standard_normal(samples)
    if volatile:
        size = 0.01
        for k in range(samples):
            steps[k] *= size
            size = np.sqrt(3e-5 + 0.7 * steps[k] ** 2)
        return 100.0 * np.exp(np.cumsum(steps))
    return 100.0 * np.exp(np.cumsum(0.0003 + 0.01 * steps))


@pytest.mark.parametrize("samples", [500, 1500, 5000])
def test_nearly_all_random_walks_are_seen(samples):
    made = [walk(samples, seed, volatile) for seed in range(20) for volatile in (False, True)]
    made += [rng(seed).standard_normal(samples).cumsum() for seed in range(20)]
    assert sum(find_drift(one).forbids for one in made) >= 57


def test_steady_motions_do_not_drift():
    made = [*HENON.series(2000, 4, 3), *LORENZ.series(4000, 6, 3), *torus(3000, 6, 3), *ar2(3000, 6, 3)]
    assert sum(find_drift(one).kind != "none" for one in made) <= 2


@pytest.mark.slow
@pytest.mark.parametrize("samples", [1500, 3000])
def test_no_steady_motion_of_thirty_swings_is_forbidden_a_verdict(samples):
    made = [one for system in (*KNOWN, *HELD_BACK) for one in with_noise(system.series(samples, 6, 11), 0.02, 11)]
    quiet = (make for name, make in NOT_CHAOTIC_HELD_BACK.items() if name != "1/f noise")
    made += [one for make in quiet for one in make(samples, 6, 11)]
    assert sum(find_drift(one).forbids for one in made) <= 2


def test_a_forced_pendulum_does_not_wander():
    (pendulum,) = (system for system in HELD_BACK if system.name == "forced pendulum")
    assert not any(find_drift(one).forbids for one in pendulum.series(1500, 12, 9))


@pytest.mark.parametrize("degree", [1, 2])
def test_a_slow_trend_is_taken_off_and_nothing_else(degree):
    motion = LORENZ.series(5000, 1, 5)[0]
    trend = 40.0 * np.linspace(0.0, 1.0, motion.size) ** degree
    found = find_drift(motion + trend)
    assert found.kind == "trend"
    assert np.sqrt(np.mean((found.steady - motion - np.mean(found.steady - motion)) ** 2)) < 0.15 * motion.std()
    assert found.change == pytest.approx(40.0, rel=0.2)


def test_a_step_and_a_changing_size_are_named():
    motion = with_noise(np.sin(0.3 * np.arange(3000)), 0.02)
    step = find_drift(motion + 2.0 * (np.arange(3000) > 1800))
    assert step.kind == "level"
    assert step.at == pytest.approx(1800, abs=150)
    assert step.change == pytest.approx(2.0, rel=0.1)
    assert find_drift(HENON.series(3000, 1)[0] * np.linspace(1.0, 4.0, 3000)).kind == "size"


def test_a_slow_wave_is_not_taken_for_a_trend():
    slow = 10.0 * np.sin(6.0 * np.pi * np.linspace(0.0, 1.0, 5000))
    assert find_drift(LORENZ.series(5000, 1, 5)[0] + slow).forbids


def test_lorenz_under_a_trend_keeps_its_exponent():
    series = LORENZ.series(4000, 1, 6)[0]
    found = chaos(series + np.linspace(0.0, 40.0, series.size), LORENZ.dt, clean=False)
    assert found.verdict.word == "chaotic"
    assert "slow trend was taken off" in found.verdict.text
    assert found.interval[0] < 0.906 < found.interval[1]


def test_a_walk_is_undecided_because_of_drift():
    found = chaos(walk(1500, 3), 1.0, clean=False)
    assert found.verdict.word == "undecided"
    assert "because of drift" in found.verdict.text
    assert found.lyapunov is None


def test_a_short_series_like_noise_is_undecided_and_a_long_one_is_noise():
    noise = rng(2).standard_normal(1500)
    short, long = chaos(noise[:500], clean=False), chaos(noise, clean=False)
    assert (short.verdict.word, long.verdict.word) == ("undecided", "stochastic")
    assert "1000 samples and 20 swings" in short.verdict.text


@pytest.mark.parametrize(
    ("series", "words"),
    [
        (1e300 * np.sin(np.arange(600.0)), "convert"),
        (1e-200 * np.sin(np.arange(600.0)), "convert"),
        (np.round(0.01 * np.arange(600.0), 6), "straight line"),
        (np.sin(np.arange(100.0)), "at least 500"),
    ],
)
def test_what_is_no_motion_is_refused_without_a_warning(series, words):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(BadInput, match=words):
            chaos(series)
        with pytest.raises(BadInput, match="seed"):
            chaos(np.sin(np.arange(600.0)), seed=-1)


@pytest.mark.parametrize("counts", [1, 4])
def test_counts_are_judged_without_a_warning(counts):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = chaos(np.round(counts * HENON.series(1200, 1)[0]), clean=True)
    assert found.verdict.word in ("chaotic", "stochastic", "undecided")
    assert str(found)


def test_a_long_series_says_what_of_it_was_used():
    t = np.arange(400_000)
    used, stride, told = _shortened(np.sin(2.0 * np.pi * t / 300.0), driven=False)
    assert used.size == LONGEST
    assert stride == 5
    assert told.startswith("of 400000 samples every 5th sample")
    assert _shortened(np.sin(t), driven=True)[1] == 1
    assert _shortened(np.sin(t[:1000]), driven=False)[2] is None


@pytest.mark.slow
def test_share_indices_are_never_regular_nor_chaotic():
    words = [chaos(walk(500 + 150 * k, k, k % 2 > 0), clean=False, seed=k).verdict.word for k in range(12)]
    assert set(words) <= {"stochastic", "undecided"}


@pytest.mark.slow
def test_intervals_hold_the_truth_however_coarse_the_sampling():
    from benchmarks.chaos_coarse import drawn

    inside, told = 0, 0
    for case in drawn(16, 7):
        found = chaos(case.series(), case.system.dt, seed=case.seed)
        if found.interval is not None:
            told += 1
            inside += found.interval[0] <= case.truth() <= found.interval[1]
    assert told >= 8
    assert inside >= told - 2


def test_a_growth_is_told_as_a_factor_that_can_be_read():
    found = Driven(-0.002, 0.001, (-0.004, 0.0), None, None, np.zeros(4), 0, 2000, 0.0, 1.0, None, None, (), ())
    text = judge_driven(found, 0.01, "base motion").text
    assert (
        "over these 20 s a difference becomes 0.018 times as large, 0.0025 times to 0.14 times within one standard error" in text
    )
