"""A mass on a hardening spring, driven by white noise: no spline may smooth the force, and the noise of y is no corner."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

import jaxbacklash as jb
from jaxbacklash.signals import is_smooth, noise_level

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


@pytest.mark.slow
def test_the_hardening_is_found():
    found = jb.refine(record(10.0), model="linear", translational=True)
    assert found.effects == ("cubic_stiffness",)
    assert found.verdict.complete
    last = found.stages[-1]
    truth = {"stiffness": STIFFNESS, "damping": DAMPING, "inertia": MASS, "cubic_stiffness.k3": CUBIC}
    for name, value in truth.items():
        assert last.fit.parameters[name].value == pytest.approx(value, abs=4.0 * last.fit.parameters[name].stderr)
