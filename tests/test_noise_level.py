"""The noise that is said of a record is the true one, or said to be open: at slow rates, under forces that no spline follows, and
where counting or writing has left most of it."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import lsim

import jaxbacklash as jb
from jaxbacklash.shooting.lengths import score_window, shooting_window
from jaxbacklash.signals import choose_intervals, estimate_noise, fit_spline, rounding_noise, span
from tests.independent.free_play import decay


def noisy(values, level, seed):
    return values + level * np.random.default_rng([seed, 7]).standard_normal(values.size)


def slow_decay(rate, seconds, *, level, seed, play=0.02):
    """A free decay, exact; the smallest of its three rates gives 25 samples a period."""
    t = np.arange(round(rate * seconds)) / rate
    return t, noisy(decay(t, 0.15, 0.5 * play, 2 * np.pi * 1.2, 0.04), level, seed)


def swinging(rate, seconds, *, level, seed):
    """A pendulum that is let go at 1 rad."""
    t = np.arange(round(rate * seconds)) / rate
    solved = solve_ivp(lambda _, q: (q[1], -9.81 * np.sin(q[0]) - 0.1 * q[1]), (0, seconds), [1.0, 0.0], t_eval=t, rtol=1e-9)
    return t, noisy(solved.y[0], level, seed)


def servo(rate, seconds, *, level, seed):
    """An axis of mass and damping under steps of torque that a ramp rounds off; exact."""
    t = np.arange(round(rate * seconds)) / rate
    force = np.clip(4.0 * np.sin(2 * np.pi * t / 8.0), -1.0, 1.0)
    _, motion, _ = lsim(([1.0], [1.0, 1.5, 0.0]), force, t)
    return t, force, noisy(motion, level, seed)


def shaken(*, level, seed, share=1 / 3, rate=610.0, seconds=8.0, fine=10):
    """A mass on a hardening spring under a force that is noise up to a share of the Nyquist rate, straight between its samples:
    classical Runge-Kutta, ten steps a sample."""
    rng = np.random.default_rng(seed)
    lines = np.fft.rfft(rng.standard_normal(round(rate * seconds)))
    lines[np.linspace(0.0, 1.0, lines.size) > share] = 0.0
    force = np.fft.irfft(lines, round(rate * seconds))
    force *= 60.0 / np.std(force)
    edges = np.interp(np.arange((force.size - 1) * 2 * fine + 1) / (2 * fine), np.arange(force.size), force)
    h, y, v, seen = 1.0 / (rate * fine), 0.0, 0.0, []

    def push(q, y, v):
        return (q - 8000.0 * y - 3e7 * y**3 - 6.0 * v) / 0.5

    for k in range((force.size - 1) * fine + 1):
        if k % fine == 0:
            seen.append(y)
        if k < (force.size - 1) * fine:
            q0, q1, q2 = edges[2 * k : 2 * k + 3]
            a = push(q0, y, v)
            b = push(q1, y + h / 2 * v, v + h / 2 * a)
            c = push(q1, y + h / 2 * (v + h / 2 * a), v + h / 2 * b)
            d = push(q2, y + h * (v + h / 2 * b), v + h * c)
            y, v = y + h * v + h * h / 6 * (a + b + c), v + h / 6 * (a + 2 * b + 2 * c + d)
    return np.arange(force.size) / rate, force, noisy(np.array(seen), level, seed)


@pytest.mark.parametrize("level", [3e-5, 1e-3])
@pytest.mark.parametrize("rate", [20.0, 50.0, 51.0, 100.0, 159.0, 400.0])
def test_a_smooth_motion_tells_its_noise_at_any_rate(rate, level):
    said = [estimate_noise(*slow_decay(rate, 24.0, level=level, seed=s)) for s in range(3)]
    said += [estimate_noise(*swinging(rate, 24.0, level=level, seed=s)) for s in range(3)]
    t, _, motion = servo(rate, 24.0, level=level, seed=1)
    said.append(estimate_noise(t, motion))
    assert [one.level / level for one in said if one.told] == pytest.approx([1.0] * sum(one.told for one in said), abs=0.25)
    assert all(0.8 * level < one.level < 1.5 * level for one in said)
    assert sum(one.told for one in said) >= 5 or rate < 50.0


def test_a_spline_leaves_freedom_at_any_rate():
    for rate in (1.0, 20.0, 50.0, 500.0):
        t = np.arange(400) / rate
        values = np.random.default_rng(0).standard_normal(t.size)
        window = span(1 / rate)
        fitted = fit_spline(t, values, t[0], window / choose_intervals(t, values, window))
        assert fitted.coefficients.size < 0.6 * t.size


def test_noise_that_the_samples_do_not_tell_is_an_upper_bound():
    for seed in range(2):
        t, _, motion = shaken(level=2e-7, seed=seed, seconds=3.0)
        found = estimate_noise(t, motion)
        assert not found.told
        assert found.level > 2e-7
        t, _, motion = shaken(level=1e-4, seed=seed, seconds=3.0)
        found = estimate_noise(t, motion)
        assert found.told
        assert found.level == pytest.approx(1e-4, rel=0.1)


def test_few_smooth_records_are_taken_for_rough_ones():
    told = [estimate_noise(*slow_decay(50.0, 12.0, level=1e-3, seed=s)).told for s in range(20)]
    assert np.mean(told) >= 0.85


def test_rounding_is_read_off_the_values():
    values = np.random.default_rng(2).standard_normal(2000)
    uniform = 1 / np.sqrt(12)
    assert rounding_noise(values) == 0.0
    assert rounding_noise(np.round(values, 4)) == pytest.approx(1e-4 * uniform)
    assert rounding_noise(np.radians(np.round(values, 3))) == pytest.approx(np.radians(1e-3) * uniform)
    assert rounding_noise(np.round(values, 3) / 1000.0) == pytest.approx(1e-6 * uniform)
    count = 2 * np.pi / 4096
    assert rounding_noise(np.round(values / count / 100) * count) == pytest.approx(count * uniform, rel=1e-6)
    digits = np.array([float(f"{v:.6g}") for v in values])
    off = rounding_noise(digits)
    assert off == pytest.approx(np.std(digits - values), rel=0.1)
    assert rounding_noise(np.zeros(100)) == 0.0


@pytest.mark.parametrize("digits", [3, 5])
def test_a_smooth_motion_is_no_quieter_than_its_file(digits):
    t = np.arange(600) / 50.0
    values = np.round(0.1 * np.sin(0.7 * t), digits)
    assert estimate_noise(t, values).level >= 0.99 * 10.0**-digits / np.sqrt(12)


def test_windows_hold_samples_and_what_the_user_says_stays():
    assert (score_window(0.002), shooting_window(0.2)) == (0.2, 0.05)
    assert score_window(0.02) == pytest.approx(0.64)
    assert score_window(0.02, 0.3) == 0.3
    assert shooting_window(0.03) == pytest.approx(0.015)


@pytest.mark.slow
@pytest.mark.parametrize("level", [2e-7, 2e-6, 2e-5])
def test_a_fit_tells_the_noise_under_a_force_of_noise(level):
    ratios = []
    for seed in range(2):
        t, force, motion = shaken(level=level, seed=seed)
        found = jb.fit(jb.Record(t, {"F": force, "y": motion}), model="linear", effects=["cubic_stiffness"])
        assert found.noise_open == ({},)
        assert found.adequate
        for name, true in {"inertia": 0.5, "stiffness": 8000.0, "damping": 6.0, "cubic_stiffness.k3": 3e7}.items():
            told = found.parameters[name]
            assert abs(told.value - true) < 4.0 * told.stderr + 1e-5 * true
        ratios.append(found.noise[0] / level)
    assert np.array(ratios) == pytest.approx(1.0, abs=0.2)


@pytest.mark.slow
@pytest.mark.parametrize("level", [1e-5, 1e-3])
def test_a_fit_tells_the_noise_of_slow_records(level):
    trust = frozenset({"t"})
    ratios = []
    for seed in range(3):
        t, z = slow_decay(50.0, 12.0, level=level, seed=seed)
        found = jb.fit(jb.Record(t, {"z": z}, confirmed=trust))
        play = found.parameters["backlash"]
        assert abs(play.value - 0.02) < 4.0 * play.stderr
        assert found.adequate
        ratios.append(found.noise[0] / level)
        t, force, motion = servo(25.0, 40.0, level=level, seed=seed)
        found = jb.fit(jb.Record(t, {"F": force, "y": motion}, confirmed=trust), model="free")
        assert found.adequate
        ratios.append(found.noise[0] / level)
    assert np.array(ratios) == pytest.approx(1.0, abs=0.2)


@pytest.mark.slow
def test_noise_is_open_where_no_model_explains_a_rough_motion():
    t, force, motion = shaken(level=2e-7, seed=3)
    found = jb.fit(jb.Record(t, {"F": force, "y": motion}), model="linear")
    assert "not smooth" in found.noise_open[0]["y"]
    assert "at most" in str(found)
