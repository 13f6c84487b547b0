"""Skeletons against exact answers: free play, linear, Duffing, steady states of the dead zone, and the formulas of the paper."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk

import jaxbacklash as jb
from jaxbacklash.signals import analytic
from jaxbacklash.skeletons.describing_function import (
    TRAP,
    axis_crossing,
    dead_zone,
    describing_function,
    free_play_frequency,
    half_play_for,
)
from jaxbacklash.skeletons.modal import base_motion, forcevib, freevib

from .independent import events, free_play
from .independent.harmonic_balance import steady_state
from .independent.motions import SteppedSine

OMEGA, HALF = 2 * np.pi * 10.0, 0.01
METHODS = ("hilbert", "wavelet")


def decays():
    """Free decays that pass 1.2 to 20 half plays; each so slow that a moment has an amplitude, long enough to see it fall."""
    for peak, zeta, seconds in ((22.0, 8e-4, 50.0), (3.5, 2e-4, 60.0), (1.45, 8e-5, 100.0)):
        t = np.arange(0.0, seconds, 2e-3)
        yield peak, zeta, jb.Record(t, {"z": free_play.decay(t, peak * HALF, HALF, OMEGA, zeta)})


@pytest.fixture(scope="module")
def backbones():
    return [(zeta, jb.skeleton(record)) for _, zeta, record in decays()]


@pytest.mark.parametrize("method", METHODS)
def test_backbone_of_free_play(backbones, method):
    seen = []
    for _, found in backbones:
        skeleton = getattr(found, method)
        peak, kept = skeleton.peak / HALF, skeleton.kept
        exact = free_play_frequency(skeleton.peak, HALF, OMEGA) / (2 * np.pi)
        error = np.abs(skeleton.frequency / exact - 1.0)[kept & (peak > 1.2) & (peak < 20.0)]
        assert np.max(error) < 5e-3
        seen.append(peak[kept])
    everywhere = np.concatenate(seen)
    counts, _ = np.histogram(everywhere, bins=[1.2, 1.25, 1.3, 1.6, 2, 3, 5, 10, 15, 20])
    assert np.all(counts > 10), counts


@pytest.mark.parametrize("method", METHODS)
def test_values_of_free_play(backbones, method):
    for zeta, found in backbones[:2]:
        values = getattr(found, method).parameters
        assert values["backlash"].value == pytest.approx(2 * HALF, rel=2e-3)
        assert values["stiffness"].value == pytest.approx(OMEGA**2, rel=2e-3)
        assert values["damping"].value == pytest.approx(2 * zeta * OMEGA, rel=3e-2)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("zeta", [0.003, 0.01, 0.02])
def test_linear_oscillator(method, zeta):
    t = np.arange(0.0, min(15.0, 6.5 / (zeta * OMEGA)), 1e-3)
    z = 0.1 * np.exp(-zeta * OMEGA * t) * np.cos(OMEGA * np.sqrt(1 - zeta**2) * t)
    found = getattr(jb.skeleton(jb.Record(t, {"z": z})), method)
    assert np.quantile(np.abs(np.sqrt(found.stiffness[found.kept]) / OMEGA - 1.0), 0.95) < 1e-3
    assert np.median(found.damping[found.kept]) == pytest.approx(zeta * OMEGA, rel=1e-3)
    assert found.parameters["stiffness"].value == pytest.approx(OMEGA**2, rel=1e-3)
    assert found.parameters["damping"].value == pytest.approx(2 * zeta * OMEGA, rel=1e-3)
    assert found.parameters["backlash"].value is None
    assert "no play" in found.parameters["backlash"].why


@pytest.mark.parametrize("method", METHODS)
def test_duffing_backbone(method):
    cubic, zeta, swing = 1.2 * OMEGA**2 / 0.1**2, 0.001, 0.1
    t = np.arange(0.0, 30.0, 2e-3)

    def field(_, s):
        return [s[1], -2 * zeta * OMEGA * s[1] - OMEGA**2 * s[0] - cubic * s[0] ** 3]

    z = solve_ivp(field, (0.0, t[-1]), [swing, 0.0], "DOP853", t, rtol=1e-10, atol=1e-13).y[0]
    found = getattr(jb.skeleton(jb.Record(t, {"z": z})), method)
    kept = found.kept
    stiff = OMEGA**2 + cubic * found.peak[kept] ** 2
    exact = np.sqrt(stiff) / (4 * ellipk(cubic * found.peak[kept] ** 2 / (2 * stiff)))
    assert kept.sum() > 300
    assert found.peak[kept].max() > 4 * found.peak[kept].min()
    assert np.max(np.abs(found.frequency[kept] / exact - 1.0)) < 2e-3


JOINT, FREQUENCY, LEVELS, HOLD = (3.16, 0.0262, 15095.0, 60.0), 7.0, (0.016, 0.02, 0.026), 6.0


@pytest.fixture(scope="module")
def steady():
    """Three steady states one after the other, simulated with located contacts, and what the skeletons say."""
    base = SteppedSine(FREQUENCY, LEVELS, hold=HOLD, blend=1.0, ramp=1.0)
    t = np.arange(0.0, HOLD * len(LEVELS), 2e-3)
    y, _ = events.simulate(events.Joint(*JOINT, base=base), t, rtol=1e-8, atol=1e-11, max_step=1e-2)
    return jb.skeleton(jb.Record(t, {"x": base.x(t), "z": y - base.x(t)}), JOINT[0])


@pytest.mark.parametrize("method", METHODS)
def test_steady_states_against_harmonic_balance(steady, method):
    found, state, omega = getattr(steady, method), None, 2 * np.pi * FREQUENCY
    for number, level in enumerate(LEVELS):
        at = (found.t > HOLD * number + 3.5) & (found.t < HOLD * number + 5.0)
        state = steady_state(*JOINT, level, FREQUENCY, start=state)
        first = state[0]
        ratio = omega**2 * (first + level) / first
        assert np.median(found.amplitude[at]) == pytest.approx(abs(first), rel=2e-3)
        assert np.median(found.stiffness[at]) == pytest.approx(ratio.real, rel=5e-3)
        assert np.median(found.damping[at]) == pytest.approx(ratio.imag / (2 * omega), rel=2e-2)


def test_describing_function():
    theta = 2 * np.pi * np.arange(200_000) / 200_000
    for amplitude in (1.05, 1.5, 4.0, 30.0):
        first = 2 * np.mean(dead_zone(amplitude * np.sin(theta), 1.0) * np.sin(theta)) / amplitude
        assert describing_function(amplitude, 1.0) == pytest.approx(first, abs=1e-8)
        assert half_play_for(first, amplitude) == pytest.approx(1.0, rel=1e-6)
    assert describing_function(0.7, 1.0) == 0.0
    far = np.linspace(40.0, 80.0, 30)
    slope, crossing = axis_crossing(far, 5.0 * far * describing_function(far, 1.0))
    assert slope == pytest.approx(5.0, rel=1e-3)
    assert crossing == pytest.approx(TRAP, rel=2e-2)  # the 27 % trap


def test_forms_are_the_papers_equations():
    """(2.4a), (2.4b) written out, against the complex form; (3.6) with gravity on a made-up joint."""
    t = np.linspace(0.0, 1.0, 400)
    log_a, dlog = -0.3 * t + 0.1 * np.sin(5 * t), -0.3 + 0.5 * np.cos(5 * t)
    ddlog, omega, domega = -2.5 * np.sin(5 * t), 60.0 + 8.0 * t, 8.0
    a, rate = np.exp(log_a), dlog + 1j * omega
    y = a * np.exp(1j * (60.0 * t + 4.0 * t**2))
    dy, ddy = rate * y, (rate**2 + ddlog + 1j * domega) * y
    force, mass = 300.0 * np.exp(1j * (60.0 * t + 1.0)), 2.5
    alpha, beta = (force / y).real, (force / y).imag
    da, dda = dlog * a, (dlog**2 + ddlog) * a
    h0 = beta / (2 * omega * mass) - da / a - domega / (2 * omega)
    square = omega**2 + alpha / mass - beta * da / (a * omega * mass) - dda / a + 2 * da**2 / a**2 + da * domega / (a * omega)
    found = forcevib(y, dy, ddy, force, mass)
    np.testing.assert_allclose(found[0], square, rtol=1e-10)
    np.testing.assert_allclose(found[1], h0, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(freevib(y, dy, ddy), forcevib(y, dy, ddy, 0.0 * y, 1.0))
    x, stiff, damp, gravity = 0.2 * np.exp(1j * 50.0 * t), 3000.0, 4.0, -6.0
    ddx = -2500.0 * x
    z = x * 2500.0 + gravity * x
    z = z / (stiff - 2500.0 + 2j * damp * 50.0 - gravity)
    found = base_motion(z, 50j * z, -2500.0 * z, ddx, gravity, z + x)
    np.testing.assert_allclose(found[0], stiff, rtol=1e-10)
    np.testing.assert_allclose(found[1], damp, rtol=1e-10)


def test_analytic_signal_has_no_ends():
    t = np.arange(0.0, 4.0, 1e-3)
    wave = np.exp(-0.5 * t) * np.cos(40.0 * t)
    error = np.abs(analytic(wave) - np.exp((-0.5 + 40j) * t)) / np.exp(-0.5 * t)
    assert np.max(error[500:-500]) < 0.02
    assert np.median(error) < 2e-3
