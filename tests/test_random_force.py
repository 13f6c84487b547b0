"""A mass on a spring, driven by white noise: no spline may smooth the force, the noise of y is no corner, and how the force goes
on between its samples is read from the record."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import lfilter, lsim

import jaxbacklash as jb
from jaxbacklash.signals import edges_between, is_smooth, noise_level, way_between

RATE, SIGMA = 500.0, 1e-5  # Hz, m
MASS, DAMPING, STIFFNESS, CUBIC = 2.0, 6.0, 8000.0, 3.0e7


def record(seconds, seed=5):
    """White noise, straight between its samples, as the force; integrated by scipy from knot to knot."""
    rng = np.random.default_rng(seed)
    t = np.arange(round(seconds * RATE) + 1) / RATE
    force = 60.0 * rng.standard_normal(t.size)

    def rates(s, q):
        return q[1], (np.interp(s, t, force) - DAMPING * q[1] - STIFFNESS * q[0] - CUBIC * q[0] ** 3) / MASS

    solved = solve_ivp(rates, (0.0, seconds), [0.0, 0.0], t_eval=t, rtol=1e-9, atol=1e-12, max_step=1.0 / RATE)
    return jb.Record(t, {"F": force, "y": solved.y[0] + SIGMA * rng.standard_normal(t.size)})


def test_white_noise_is_not_smooth_and_a_sine_in_noise_is():
    rng = np.random.default_rng(0)
    t = np.arange(5001) / RATE
    white = rng.standard_normal(t.size)
    assert not is_smooth(t, white, 0.1)
    assert is_smooth(t, 10.0 * np.sin(20.0 * t) + white, 0.1)


def test_a_resonance_that_few_knots_cannot_follow_is_no_noise():
    """Ten samples a period: a criterion that rises at first, since a few more knots follow nothing, is not to be believed."""
    rng = np.random.default_rng(3)
    pole = 0.985 * np.exp(2j * np.pi / 10.0)
    y = lfilter([1.0], [1.0, -2.0 * pole.real, abs(pole) ** 2], rng.standard_normal(8000))
    assert noise_level(np.arange(y.size) / 610.0, y) < 0.1 * np.std(y)


def answered(way, share, seed, late=0.0, noise=1e-3, samples=8000):
    """Force samples and the motion of a linear oscillator at a share of the sampling rate: exact, in units of a sample.

    The motion is read ``late`` samples later; a curve is a sum of sines below a third of the rate."""
    rng = np.random.default_rng(seed)
    square, damping = (2.0 * np.pi * share) ** 2, 0.1 * np.pi * share
    fine = 8
    t = np.arange(samples * fine + 1) / fine
    if way == "curved":
        f = np.fft.rfftfreq(samples * fine, 1.0 / fine)
        lines = np.where((f > 0) & (f < 0.33), rng.standard_normal((2, f.size)), 0.0)
        spectrum = lines[0] + 1j * lines[1]
        omega = 2.0 * np.pi * f
        answer = spectrum / (square - omega**2 + 1j * damping * omega) * np.exp(-1j * omega * late)
        samples_of = lambda s: np.fft.irfft(s, samples * fine)[::fine]  # noqa: E731
        values, y = samples_of(spectrum), samples_of(answer)
    else:
        values = rng.standard_normal(samples + 1)
        held = np.append(np.repeat(values[:-1], fine), 0.0)
        drive = np.interp(t, np.arange(samples + 1), values) if way == "straight" else held
        _, moved, _ = lsim(([1.0], [1.0, damping, square]), drive, t, interp=way == "straight")
        values, y = values[:-1], np.interp(np.arange(samples) - late, t, moved)
    return values, y + noise * np.std(y) * rng.standard_normal(samples)


@pytest.mark.parametrize("share", [0.03, 0.1, 0.2])
@pytest.mark.parametrize("way", ["straight", "held", "curved"])
def test_the_record_tells_how_its_force_goes_on(way, share):
    assert [way_between(*answered(way, share, seed)) for seed in range(3)] == [way] * 3


@pytest.mark.parametrize("late", [0.5, 2.5])
def test_a_sensor_that_is_late_is_no_force_that_is_held(late):
    assert [way_between(*answered("straight", 0.1, seed, late)) for seed in range(3)] == ["straight"] * 3


def test_a_short_record_or_a_motion_lost_in_noise_says_nothing():
    assert way_between(*answered("held", 0.1, 0, samples=600)) == "straight"
    values, y = answered("held", 0.1, 0, noise=30.0)
    assert way_between(values, y) == "straight"
    assert way_between(np.ones(8000), y) == "straight"


def test_a_record_without_noise_or_at_rest_for_long_is_read_too():
    values, y = answered("held", 0.1, 0, noise=0.0)
    assert way_between(values, y) == "held"
    values[:4000], y[:4000] = 0.0, 0.0
    assert way_between(values, y) == "held"


@pytest.mark.parametrize("way", ["held", "curved"])
def test_straight_lines_stand_for_a_force_that_is_not_straight(way):
    """An oscillator at a tenth of the rate answers to four lines a sample as to the force itself."""
    share, every = 0.1, 4
    values, y = answered(way, share, 3, noise=0.0, samples=2000)
    edges = edges_between(values, every, way)
    t = np.arange(edges.size) / every
    square, damping = (2.0 * np.pi * share) ** 2, 0.1 * np.pi * share
    wrong = {}
    for name, drive in (("lines", edges), ("samples", edges_between(values, every, "straight"))):
        moved = lsim(([1.0], [1.0, damping, square]), drive, t)[1][::every]
        late = slice(400, 1900)  # the curve's motion is periodic, and this one begins at rest
        wrong[name] = np.std(moved[late] - y[late]) / np.std(y)
    assert wrong["lines"] < 2e-3 < 0.02 < wrong["samples"]


@pytest.mark.slow
def test_the_hardening_is_found():
    found = jb.refine(record(10.0), model="linear", translational=True)
    assert found.effects == ("cubic_stiffness",)
    assert found.verdict.complete
    last = found.stages[-1]
    truth = {"stiffness": STIFFNESS, "damping": DAMPING, "inertia": MASS, "cubic_stiffness.k3": CUBIC}
    for name, value in truth.items():
        assert last.fit.parameters[name].value == pytest.approx(value, abs=4.0 * last.fit.parameters[name].stderr)


@pytest.mark.slow
def test_a_held_force_is_no_effect(recwarn):
    """The same mass, its force held: 16 classical Runge-Kutta steps a sample."""
    rng = np.random.default_rng(6)
    push = 60.0 * rng.standard_normal(5000)
    h, state, path = 1.0 / (16.0 * RATE), np.zeros(2), []

    def rates(q, now):
        return np.array([q[1], (now - DAMPING * q[1] - STIFFNESS * q[0] - CUBIC * q[0] ** 3) / MASS])

    for now in push:
        path.append(state[0])
        for _ in range(16):
            a = rates(state, now)
            b = rates(state + 0.5 * h * a, now)
            c = rates(state + 0.5 * h * b, now)
            state = state + h / 6.0 * (a + 2.0 * (b + c) + rates(state + h * c, now))
    y = np.array(path) + SIGMA * rng.standard_normal(push.size)
    found = jb.refine(jb.Record(np.arange(push.size) / RATE, {"F": push, "y": y}), model="linear", translational=True)
    assert found.effects == ("cubic_stiffness",)
    assert found.verdict.complete
    assert sum("held from each sample to the next" in str(w.message) for w in recwarn) == 1
    value = found.stages[-1].fit.parameters["cubic_stiffness.k3"]
    assert value.value == pytest.approx(CUBIC, abs=4.0 * value.stderr)
