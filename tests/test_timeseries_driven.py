"""Chaos under a measured drive: exponents against the exact tangent of a joint with play, and when there is no number."""

import numpy as np
import pytest

from jaxbacklash import chaos
from jaxbacklash.timeseries import driven_exponent, mean_period
from jaxbacklash.timeseries.force_surface import WeakForm, bent_edges


def rng(seed=0):
    return np.random.default_rng(seed)


K, C, HALF_PLAY, DT = 3600.0, 6.0, 0.012, 0.002  # 9.5 Hz in contact


def swept(size, seconds=16.0, noise=3e-5, seed=0, wear=0.0):
    """A joint with play under a swept base motion: measured x and z, and the exponent of its exact tangent [1/s].

    The play grows by a share ``wear`` of its middle value over the record.

    Runge-Kutta steps of DT / 8, the tangent beside the motion by the slope of the law.
    """
    fine = 8
    h = DT / fine
    t = h * np.arange(int(seconds / DT) * fine + 1)
    phase = 2.0 * np.pi * (1.5 * t + 0.5 * 0.1 * t**2)
    x, dx = size * np.sin(phase), size * np.cos(phase) * 2.0 * np.pi * (1.5 + 0.1 * t)
    y, v, a, b, grown = 0.005, 0.0, 1.0, 0.0, 0.0
    z, half = np.empty(t.size), HALF_PLAY * (1.0 + wear * (t / seconds - 0.5))

    def pull(y, v, k):
        apart = y - x[k]
        return -K * (apart - min(max(apart, -half[k]), half[k])) - C * (v - dx[k])

    for k in range(t.size):
        z[k] = y - x[k]
        inside = abs(z[k]) < half[k]
        f = pull(y, v, k)
        middle_v, middle_y = v + 0.5 * h * f, y + 0.5 * h * v
        f2 = pull(middle_y, middle_v, k)
        y, v = y + h * middle_v, v + h * f2
        g = -(0.0 if inside else K) * a - C * b
        a, b = a + h * (b + 0.5 * h * g), b + h * (-(0.0 if inside else K) * (a + 0.5 * h * b) - C * (b + 0.5 * h * g))
        if k % 400 == 399:
            length = np.hypot(a, b / 50.0)
            grown, a, b = grown + np.log(length), a / length, b / length
    grain = noise * rng(seed).standard_normal((2, int(seconds / DT) + 1))
    return x[::fine] + grain[0], z[::fine] + grain[1], grown / seconds


@pytest.fixture(scope="module")
def parting():
    return swept(0.055)


def test_exponent_under_a_sweep_is_that_of_the_tangent(parting):
    x, z, exact = parting
    found = driven_exponent(z, x, mean_period(z), rng())
    assert exact > 0.7
    assert found.value / DT == pytest.approx(exact, rel=0.25)
    assert abs(found.value / DT - exact) < 3.0 * found.stderr / DT
    assert (found.value + found.second) / DT == pytest.approx(-C, rel=0.05)
    assert found.word == "separate"


def test_a_play_that_wears_is_seen_and_followed():
    x, z, exact = swept(0.055, wear=0.3)
    found = driven_exponent(z, x, mean_period(z), rng())
    assert found.drift == pytest.approx(0.3, abs=0.05)
    assert exact > 0.7
    assert found.value / DT == pytest.approx(exact, rel=0.25)
    assert "its lengths, the play among them, change by +3" in str(chaos(z, DT, drive=x, drive_name="base motion", clean=False))


def test_a_play_that_stays_is_not_called_drifting(parting):
    x, z, _ = parting
    assert driven_exponent(z, x, mean_period(z), rng()).drift == 0.0


def test_a_few_swings_are_too_few_for_a_law():
    t = DT * np.arange(2200)
    found = driven_exponent(np.sin(9.0 * t), np.cos(9.0 * t), 350.0, rng())
    assert found.word == "none"
    assert found.why == "the drive is measured, but 6 swings are too few for the law of motion"


def test_a_law_with_play_is_found_flat_between_kinks(parting):
    x, z, _ = parting
    law = driven_exponent(z, x, mean_period(z), rng())
    edges = law.middle + law.deviation * law.surface.edges
    stiffness = -np.diff(law.surface.force * law.deviation) / np.diff(edges) / DT**2
    middle = 0.5 * (edges[1:] + edges[:-1])
    assert np.all(np.abs(stiffness[np.abs(middle) < 0.8 * HALF_PLAY]) < 0.05 * K)
    assert np.median(stiffness[np.abs(middle) > 1.2 * HALF_PLAY]) == pytest.approx(K, rel=0.02)


def test_a_joint_that_forgets_its_start_comes_together():
    x, z, exact = swept(0.02)
    found = driven_exponent(z, x, mean_period(z), rng())
    assert exact < -1.0
    assert found.value / DT == pytest.approx(exact, rel=0.25)
    assert found.word == "meet"


def test_the_verdict_is_conditional_on_a_swept_drive(parting):
    x, z, _ = parting
    found = chaos(z, DT, drive=x, drive_name="base motion", clean=False)
    assert found.conditional
    assert found.verdict.word == "chaotic"
    assert "start apart under the same base motion separate" in found.verdict.text
    assert "conditional" in found.verdict.text
    assert found.lyapunov == pytest.approx(found.driven.value / DT)
    assert found.interval[0] < found.lyapunov < found.interval[1]
    assert "law of motion" in str(found)


def test_a_links_own_motion_needs_the_motion_across_the_joint(parting):
    x, z, _ = parting
    found = chaos(z + x, DT, drive=x, motion=z, clean=False)
    assert found.lyapunov == pytest.approx(driven_exponent(z, x, found.period, rng()).value / DT, rel=0.3)


def test_what_a_drive_does_not_tell_has_no_number():
    noise = rng(15).standard_normal((2, 4000)).cumsum(axis=1)
    found = driven_exponent(noise[0], noise[1], 50.0, rng())
    assert found.value is None
    assert "do not tell the motion" in found.why
    assert driven_exponent(noise[0], np.zeros(4000), 50.0, rng()).why == "the drive does not move"
    assert "too few" in driven_exponent(noise[0, :1000], noise[1, :1000], 50.0, rng()).why


def test_weak_forms_are_derivatives():
    t = np.arange(3000)
    weak = WeakForm(np.sin(0.05 * t), np.cos(0.03 * t), 20)
    assert weak.acceleration == pytest.approx(-(0.05**2) * weak.of(weak.series, 0), rel=1e-6, abs=1e-9)
    assert weak.inputs[:, 1] == pytest.approx(-0.03 * weak.of(np.sin(0.03 * t), 0), rel=1e-6, abs=1e-9)
    edges, damped = weak.damping
    assert damped.sum(axis=1) == pytest.approx(-weak.of(weak.series, 1), rel=1e-6, abs=1e-9)  # the hats make one
    assert edges.size == damped.shape[1]


def test_edges_go_where_a_table_bends():
    edges = np.linspace(-1.0, 1.0, 25)
    moved = bent_edges(edges, np.maximum(edges - 0.4, 0.0))
    assert moved.size == edges.size
    assert moved[[0, -1]] == pytest.approx([-1.0, 1.0])
    assert np.diff(moved).min() < 0.5 * np.diff(edges)[0]
    assert abs(moved[np.argmin(np.diff(moved))] - 0.4) < 0.15


@pytest.mark.slow
def test_intervals_under_a_drive_hold_the_tangents_exponent():
    inside = 0
    for k, size in enumerate(np.linspace(0.04, 0.065, 8)):
        x, z, exact = swept(size, noise=5e-5, seed=k)
        found = driven_exponent(z, x, mean_period(z), rng(k))
        inside += abs(found.value / DT - exact) < 2.5 * found.stderr / DT
    assert inside >= 7
