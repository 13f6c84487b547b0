"""Chaos as a signature of the play: the scaling, the inference as a statistic, patterns, refusals."""

from types import SimpleNamespace

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.effects import GapSpring, LinearGravity, Preload
from jaxbacklash.errors import BadInput
from jaxbacklash.excitation import Harmonic
from jaxbacklash.models import linear_oscillator
from jaxbacklash.signature import ExponentMap, Level, expected_precision, exponent_map, match_pattern, play_from_exponents
from tests.independent import exponents

FREQUENCY, INERTIA = 1.54, 3.16
AMPLITUDES = np.radians([1.34, 2.07, 2.68, 3.41, 3.65, 3.78, 4.87, 5.73])


def joint(play_deg=1.5, gravity=-60.0, zeta=0.02):
    omega = 2 * np.pi * 11.0
    return jb.two_link(INERTIA, np.radians(play_deg), INERTIA * omega**2, 2 * zeta * INERTIA * omega, gravity, linearised=True)


def made_up(exponent, axes=None, low=0.5, high=5.0):
    """A map with given exponents (..., R) that all of two starts share."""
    exponent = np.asarray(exponent, float)
    both = np.stack([exponent, exponent])
    return ExponentMap(np.geomspace(low, high, exponent.shape[-1]), axes or {}, both, np.full_like(both, 0.01), FREQUENCY)


def straight(size=401):
    """A map whose exponent is the logarithm of 2 amplitude / play: one exponent names one play."""
    return made_up(np.log(2.0 * np.geomspace(0.5, 5.0, size)) + 0.05)


def windowed(size=401):
    """A map as a joint has it: chaos with slopes, between and beside regular windows."""
    place = np.linspace(0.0, 1.0, size)
    chaos = 1.0 + 0.5 * np.sin(9.0 * place) + 0.2 * np.sin(31.0 * place)
    return made_up(np.where((place % 0.23 < 0.14) & (place > 0.12), chaos, -0.5))


@pytest.mark.parametrize("gravity", [-60.0, 0.0])
def test_play_and_amplitude_enter_as_their_ratio_alone(gravity):
    size = {"starts": 2, "periods": 120, "skip": 80}
    one = exponent_map(joint(1.5, gravity), FREQUENCY, (0.8, 4.0, 32), **size)
    # A quarter of the play changes no bit of the numbers; other shares change their rounding, which chaos shows.
    quarter = exponent_map(joint(0.375, gravity), FREQUENCY, (0.8, 4.0, 32), **size)
    assert one.chaotic.any()
    np.testing.assert_allclose(quarter.exponent, one.exponent, rtol=1e-9)


def test_the_exponent_agrees_with_a_simulation_that_shares_no_code():
    """The dimensionless form of the docstring, by scipy with events: half plays, time in 1 / omega_0."""
    zeta, ratio, weight, Omega = 0.02, 0.85, 0.004, 0.14
    cell = exponents.Cell(1.0 / (2 * ratio * (Omega**2 - weight)), zeta, Omega, k1=weight)
    # The first start is at rest in the middle of the play, z = z' = 0, as the base is at its end.
    expected, _, _ = exponents.follow(cell, 40, 20)
    system = jb.two_link(1.0, 0.026, 1.0, 2 * zeta, -weight, linearised=True)
    found = exponent_map(system, Omega / (2 * np.pi), (ratio, 1.0, 2), starts=1, periods=40, skip=20)
    assert found.exponent[0, 0] == pytest.approx(expected * 2 * np.pi / Omega, abs=1e-5)


def test_further_axes_are_maps_of_their_own():
    size = {"periods": 60, "skip": 40}
    both = exponent_map(joint(), FREQUENCY, (3.0, 4.0, 4), over={"linear_gravity.G": [-60.0, -20.0]}, starts=1, **size)
    alone = exponent_map(joint(gravity=-20.0), FREQUENCY, (3.0, 4.0, 4), starts=2, **size)
    assert both.exponent.shape == (1, 2, 4)
    np.testing.assert_allclose(both.exponent[0, 1], alone.exponent[0], atol=1e-8)


def test_systems_without_the_scaling_are_refused():
    for effect, word in ((Preload(5.0), "preload"), (GapSpring(100.0, 0.01), "z0"), (jb.Gravity(-60.0), "gravity")):
        with pytest.raises(BadInput, match=word):
            exponent_map(jb.base_motion_joint(INERTIA, 0.026, 15000.0, 8.0).with_effects(effect), FREQUENCY)
    with pytest.raises(BadInput, match="no play"):
        exponent_map(linear_oscillator(1.0, 100.0, 1.0).with_effects(LinearGravity(-1.0)), FREQUENCY)
    with pytest.raises(BadInput, match="unit of the map"):
        exponent_map(joint(), FREQUENCY, over={"backlash": [0.02]})
    with pytest.raises(BadInput, match="no parameter"):
        exponent_map(joint(), FREQUENCY, over={"mass": [1.0]})
    for ratios in ((2.0, 1.0, 8), (0.0, 1.0, 8), (1.0, 2.0, 1)):
        with pytest.raises(BadInput, match="ratios"):
            exponent_map(joint(), FREQUENCY, ratios)


def test_one_exponent_on_a_straight_map_gives_the_play_and_its_error():
    """There the posterior of log b is normal: the mean is told by the map, the spread by the exponent's error and the drive's."""
    play, amplitude = 0.026, 0.05
    exponent = np.log(2.0 * amplitude / play) + 0.05
    found = play_from_exponents(straight(), [Level(amplitude, "chaotic", exponent, 0.03)], drive_error=0.01, systematic=0.0,
                                false_alarm=1e-9, plays=(0.02, 0.034))  # fmt: skip
    assert found.value == pytest.approx(play, rel=1e-3)
    spread = np.sqrt(0.03**2 + 0.01**2 + 0.01**2)  # the map's own error bar is 0.01
    half = 0.5 * np.log(found.interval[1] / found.interval[0])
    assert half == pytest.approx(1.96 * spread, rel=0.03)
    assert len(found.pieces) == 1
    assert found.density.sum() * np.log(found.plays[1] / found.plays[0]) == pytest.approx(1.0, rel=1e-6)


def test_regimes_alone_bracket_the_play():
    """Chaos between ratios 1 and 2 only: a chaotic level at 3 deg and a regular one at 2 deg leave plays of 2 to 3 deg."""
    ratios = np.geomspace(0.5, 5.0, 1001)
    map_ = made_up(np.where((ratios > 1.0) & (ratios < 2.0), 1.0, -0.5))
    levels = [Level(np.radians(3.0), "chaotic"), Level(np.radians(2.0), "regular")]
    found = play_from_exponents(map_, levels, drive_error=0.0, false_alarm=0.001, missed=0.001)
    assert np.degrees(found.pieces[0]) == pytest.approx([2.0, 3.0], rel=0.02)
    assert np.degrees(found.interval) == pytest.approx([2.0, 3.0], rel=0.03)


@pytest.mark.parametrize(("map_", "levels"), [(windowed(), 8), (straight(), 3)], ids=["windows", "straight"])
def test_intervals_hold_the_truth_as_often_as_they_say(map_, levels):
    amplitudes = np.geomspace(AMPLITUDES[0], AMPLITUDES[-1], levels)
    found = expected_precision(map_, amplitudes, (np.radians(1.2), np.radians(2.6)), experiments=400, seed=3)
    share, deviation = found.covered[found.determined].mean(), np.sqrt(0.95 * 0.05 / found.determined.sum())
    assert abs(share - 0.95) < 3.0 * deviation
    assert found.determined.mean() > 0.9
    # More levels, narrower intervals; and they beat what was thought possible before by far.
    assert np.nanmedian(found.half_width) < 0.12


def test_a_wrong_map_is_noticed_or_at_least_widens():
    """A level whose exponent the map has nowhere near the place the others point to."""
    map_ = straight()
    play = 0.026
    levels = [Level(a, "chaotic", float(np.log(2 * a / play) + 0.05), 0.03) for a in (0.03, 0.04, 0.06)]
    assert play_from_exponents(map_, levels).disagree == []
    wrong = [*levels, Level(0.05, "chaotic", float(np.log(2 * 0.05 / play) + 1.0), 0.03)]
    assert play_from_exponents(map_, wrong).disagree == [0.05]
    assert "does not fit" in str(play_from_exponents(map_, wrong))


def test_a_map_without_contrast_determines_nothing():
    found = play_from_exponents(made_up(np.ones(301)), [Level(a, "chaotic", 1.0, 0.1) for a in AMPLITUDES])
    assert found.value is None
    assert found.interval is None
    assert "nearly all" in found.why
    assert "not determined" in str(found)
    assert found.bits < 0.05


def test_unknown_parameters_widen_the_interval_and_are_told():
    base = np.log(2.0 * np.geomspace(0.5, 5.0, 401)) + 0.05
    shifted = made_up(np.stack([base, base + 0.2, base - 0.2]), {"damping": np.array([4.0, 2.0, 8.0])})
    levels = [Level(0.05, "chaotic", float(np.log(2 * 0.05 / 0.026) + 0.05), 0.03)]
    known, unknown = play_from_exponents(straight(), levels), play_from_exponents(shifted, levels)
    assert np.ptp(unknown.interval) > 2.0 * np.ptp(known.interval)
    values, weights = unknown.parameters["damping"]
    assert values.tolist() == [4.0, 2.0, 8.0]
    assert weights.sum() == pytest.approx(1.0)


def test_what_says_nothing_changes_nothing():
    levels = [Level(0.05, "chaotic", 1.4, 0.05)]
    found = play_from_exponents(windowed(), levels, plays=(0.02, 0.04))
    more = play_from_exponents(windowed(), [*levels, Level(0.06, "undecided"), Level(0.07, "stochastic")], plays=(0.02, 0.04))
    np.testing.assert_allclose(found.density, more.density)
    with pytest.raises(BadInput, match="no verdict"):
        play_from_exponents(windowed(), [Level(0.05, "undecided")])


def test_plays_beyond_the_map_are_refused_with_the_map_that_is_wanted():
    with pytest.raises(BadInput, match="wanted a map of ratios"):
        play_from_exponents(windowed(), [Level(0.05, "regular")], plays=(0.001, 0.04))
    with pytest.raises(BadInput, match="above zero"):
        play_from_exponents(windowed(), [Level(0.05, "regular")], plays=(0.05, 0.04))
    with pytest.raises(BadInput, match="no verdict is certain"):
        play_from_exponents(windowed(), [Level(0.05, "regular")], missed=0.0)


def test_levels_are_refused_broken():
    chaotic = [(1.0,), (1.0, 0.0), (np.nan, 0.1)]
    for bad in ((0.0, "regular"), (0.05, "maybe"), *((0.05, "chaotic", *rest) for rest in chaotic)):
        with pytest.raises(BadInput):
            Level(*bad)


def test_a_report_becomes_a_level_per_drive_period():
    verdict, exponent = SimpleNamespace(word="chaotic"), SimpleNamespace(stderr=0.0002)
    report = SimpleNamespace(verdict=verdict, lyapunov=1.54, exponent=exponent, dt=0.002)
    level = Level.measured(0.05, report, FREQUENCY)
    assert level.exponent == pytest.approx(1.0)
    assert level.stderr == pytest.approx(0.1 / FREQUENCY)
    report.lyapunov = None
    assert Level.measured(0.05, report, FREQUENCY) == Level(0.05, "chaotic")
    verdict.word = "regular"
    assert Level.measured(0.05, report, FREQUENCY) == Level(0.05, "regular")


def test_a_pattern_is_found_where_it_is():
    """Chaos between ratios 1.5 and 2.7: the paper's pattern asks for a play between 3.78/2.7 and 2.68/1.5 deg, and above
    2.07/1.5 but below 4.87/2.7 deg."""
    ratios = np.geomspace(0.5, 5.0, 1001)
    here = np.where((ratios > 1.5) & (ratios < 2.7), 1.0, -0.5)
    map_ = made_up(np.stack([here, np.full_like(here, -0.5)]), {"damping": np.array([4.0, 40.0])})
    seen = [False, False, True, True, True, True, False, False]
    plays = np.radians(np.linspace(1.2, 2.0, 81))
    match = match_pattern(map_, AMPLITUDES, seen, plays)
    inside = np.degrees(plays[match.chance[0] == 1.0])
    assert inside.min() == pytest.approx(1.40, abs=0.011)
    assert inside.max() == pytest.approx(1.78, abs=0.011)
    assert match.chance[1].max() == 0.0
    assert match.right[1] == pytest.approx(4.0)
    assert match.best()["damping"] == 4.0
    assert match.share(1.0) == pytest.approx(0.5 * inside.size / plays.size)
    matters = match.matters()
    assert matters["damping"] > 0.05
    assert sum(matters.values()) <= 1.0 + 1e-9
    with pytest.raises(BadInput, match="one regime an amplitude"):
        match_pattern(map_, AMPLITUDES, seen[:3], plays)
    with pytest.raises(BadInput, match="the map holds"):
        match_pattern(map_, AMPLITUDES, seen, [np.radians(0.2)])


@pytest.mark.slow
def test_the_paper_pattern_of_an_independent_simulation():
    """G = -60 N m, 2 % damping, 11 Hz, 1.5 deg: an independent simulation gave 0, +, +, +, +, +, 0, 0."""
    map_ = exponent_map(joint(), FREQUENCY, (0.85, 4.0, 1024), starts=4, periods=300, skip=150)
    at = np.rint(map_.place(AMPLITUDES, np.radians(1.5))).astype(int)
    assert np.array_equal(map_.chaotic_share[at], [0, 1, 1, 1, 1, 1, 0, 0])
    assert np.array_equal(map_.chaotic_share[at] > 0.5, [0, 1, 1, 1, 1, 1, 0, 0])


@pytest.mark.slow
def test_from_series_to_play():
    """Four drive levels as they would be measured, noise of 1 %, and the play from the verdicts and exponents alone."""
    play, rate = np.radians(1.7), 250.0
    map_ = exponent_map(joint(), FREQUENCY, (0.8, 4.6, 700), starts=4)
    system, levels = joint(np.degrees(play)), []
    for k, amplitude in enumerate(np.radians([1.4, 2.6, 3.6, 5.6])):
        motion = jb.simulate(system, Harmonic(float(amplitude), 2 * np.pi * FREQUENCY), duration=90.0, rate=rate)
        z = np.asarray(motion.z)[round(40 * rate) :]
        z = z + 0.01 * z.std() * np.random.default_rng(k).standard_normal(z.size)
        levels.append(Level.measured(float(amplitude), jb.chaos(z, 1 / rate, clean=False), FREQUENCY))
    found = play_from_exponents(map_, levels, plays=(np.radians(1.25), np.radians(1.7 * 1.02)))
    words = [level.word for level in levels]
    assert "chaotic" in words
    assert found.pieces[0][0] <= play <= found.pieces[-1][1]
