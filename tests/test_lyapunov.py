"""Exponents against known values: linear systems exactly, chaotic ones from the literature, jumps against the exact steps."""

import jax.numpy as jnp
import numpy as np
import pytest

from jaxbacklash.dynamics.family import PaperCase
from jaxbacklash.dynamics.follow import follow
from jaxbacklash.dynamics.lyapunov import field_spectrum, lyapunov_spectrum
from jaxbacklash.dynamics.plan import Plan
from jaxbacklash.effects import ContactDamping, CoulombGround, FlexibleLink
from jaxbacklash.errors import NoAnswer
from jaxbacklash.excitation import Chirp, Harmonic
from jaxbacklash.models import linear_oscillator

FORCE = Harmonic(0.5, 0.2, 0.0, as_force=True)


def test_a_linear_oscillator_has_minus_zeta_twice():
    found = lyapunov_spectrum(linear_oscillator(1.0, 1.0, 0.04), FORCE, periods=400, skip=100, panels=512)
    np.testing.assert_allclose(found.values, -0.02, atol=2e-5)  # what is left of the rotation at the end of a finite run
    assert found.values.sum() == pytest.approx(-0.04, abs=1e-8)


@pytest.mark.parametrize("inverse_alpha", [2.0, 3.0, 4.7])
def test_the_spectrum_sums_to_the_divergence(inverse_alpha):
    system, force = PaperCase(1, inverse_alpha=inverse_alpha).build({})
    found = lyapunov_spectrum(system, force, periods=60, skip=10)
    assert found.values.sum() == pytest.approx(-0.04, abs=1e-9)


@pytest.mark.slow
def test_located_steps_sum_to_the_divergence_too():
    system, force = PaperCase(1).build({})
    found = lyapunov_spectrum(system, force, periods=40, skip=10, panels=512)
    assert found.values.sum() == pytest.approx(-0.04, abs=1e-8)


def test_lorenz():
    """0.9056, 0, -14.5723 (Sprott, Chaos and Time-Series Analysis, 2003); the sum is -(10 + 1 + 8/3)."""

    def lorenz(t, q):
        return jnp.array([10.0 * (q[1] - q[0]), q[0] * (28.0 - q[2]) - q[1], q[0] * q[1] - 8.0 / 3.0 * q[2]])

    found = field_spectrum(lorenz, [1.0, 1.0, 20.0], step=0.01, stretches=20000, skip=1000, steps=5)
    assert np.all(np.abs(found.values - [0.9056, 0.0, -14.5723]) < 4.0 * found.stderr + 1e-3)
    assert found.stderr[0] < 0.01
    assert found.values.sum() == pytest.approx(-41.0 / 3.0, abs=1e-3)


def test_duffing():
    """Ueda's form of Duffing's equation, x'' + 0.05 x' + x^3 = 7.5 sin t: 0.1034, -0.1534 (Sprott, 2003)."""

    def duffing(t, q):
        return jnp.array([q[1], 7.5 * jnp.sin(t) - q[0] ** 3 - 0.05 * q[1]])

    found = field_spectrum(duffing, [2.5, 0.0], step=2.0 * np.pi / 200.0, stretches=20000, skip=1000, steps=20)
    assert np.all(np.abs(found.values - [0.1034, -0.1534]) < 4.0 * found.stderr)
    assert found.stderr[0] < 0.005
    assert found.values.sum() == pytest.approx(-0.05, abs=1e-6)


def test_the_jump_of_contact_damping_is_in_the_tangent():
    """Located steps end at the jump at a time that depends on the state; without that derivative they would not close in."""
    system, _ = PaperCase(1).build({})
    system = system.with_effects(ContactDamping(0.3))
    force = Harmonic(1.0 / np.array([1.5, 2.0, 4.7]), 0.2, 0.0, as_force=True)
    plan, zero = Plan(21, 0, 4), np.zeros(3)
    exact, _ = follow(system, force, zero, zero, plan)
    errors = []
    for panels in (256, 1024):
        found, _ = follow(system, force, zero, zero, plan, exact=False, panels=panels)
        errors.append(np.abs(np.asarray(found.lyapunov - exact.lyapunov)))
    assert errors[1].max() < 1e-5
    assert errors[1].max() < 0.15 * errors[0].max()


@pytest.mark.slow
def test_the_jump_of_coulomb_friction_is_in_the_tangent():
    """A sliding mass under dry friction, derivative against differences across two reversals of its speed."""
    system = linear_oscillator(1.0, 1.0, 0.02).with_effects(CoulombGround(0.05))
    drive = Harmonic(1.0, 0.7, 0.0, as_force=True)
    plan = Plan(21, 0, 21)
    step = 1e-5
    y0 = np.array([0.3, 0.3 + step, 0.3 - step])
    found, _ = follow(system, drive, y0, np.zeros(3), plan, panels=512)
    p, v = np.asarray(found.p)[0], np.asarray(found.v)[0]
    by_differences = np.log(np.hypot(p[1] - p[2], v[1] - v[2]) / (2.0 * step))
    spectrum = lyapunov_spectrum(system, drive, count=1, periods=21, skip=0, y0=0.3, panels=512)
    assert spectrum.growth[1, 0] == pytest.approx(by_differences, abs=1e-4)


@pytest.mark.slow
def test_every_state_has_an_exponent():
    system, force = PaperCase(1).build({})
    found = lyapunov_spectrum(system.with_effects(FlexibleLink(0.2, 1.0, 0.05)), force, periods=30, skip=5)
    assert found.values.shape == (4,)
    assert found.values.sum() == pytest.approx(-0.04 - 0.05 - 0.05 / 0.2, abs=1e-5)


def test_what_has_no_exponent_says_so():
    with pytest.raises(NoAnswer, match="without bound"):
        lyapunov_spectrum(linear_oscillator(1.0, -400.0, 0.04), FORCE, periods=40, skip=0)
    with pytest.raises(ValueError, match="period"):
        lyapunov_spectrum(linear_oscillator(1.0, 1.0, 0.04), Chirp(1.0, 0.0, 5.0, 10.0))
