"""Exact steps under drives of polynomials: against scipy with events, against the harmonic steps, and what is refused."""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from jaxbacklash.dynamics.courses import CLOSE, course
from jaxbacklash.dynamics.follow import COURSE, HARMONIC, LOCATED, follow
from jaxbacklash.dynamics.lyapunov import lyapunov_spectrum
from jaxbacklash.dynamics.plan import Plan
from jaxbacklash.effects import AsymmetricGap, ContactDamping, LinearGravity, Preload
from jaxbacklash.errors import BadInput
from jaxbacklash.excitation import Chirp, Harmonic, Multisine, Rest, Sampled
from jaxbacklash.models import base_motion_joint, case_1, two_link

from .independent import events, motions

RIG = {"inertia": 3.0, "backlash": 0.026, "stiffness": 11000.0, "damping": 20.0}
PERIODS, PERIOD = 40, 0.03


@dataclass(frozen=True)
class Measured(motions.Motion):
    """Samples with rates, cubic in between: by scipy."""

    spline: CubicHermiteSpline

    def derivatives(self, t):
        return self.spline(t), self.spline(t, 1), self.spline(t, 2)


def samples(t0=0.0):
    """A base motion sampled at an uneven moment against the periods: 500 Hz, four sines."""
    t = np.arange(700) / 500.0
    omega, size = 2.0 * np.pi * np.array([1.7, 3.1, 5.3, 8.9]), np.array([0.05, 0.03, 0.012, 0.004])
    angle = np.outer(t, omega) + np.array([0.3, 1.0, 2.0, 4.0])
    x, dx = (size * np.sin(angle)).sum(axis=1), (size * omega * np.cos(angle)).sum(axis=1)
    drive = Sampled(jnp.asarray(t0), jnp.asarray(1.0 / 500.0), *(jnp.asarray(v) for v in (x, dx, 0.0 * x)))
    return drive, Measured(CubicHermiteSpline(t, x, dx))


def beside_scipy(system, drive, joint):
    """Largest differences in z and z' over the run, their sizes, and how often the joint met an edge."""
    start = joint.y0 * np.ones(1), joint.v0 * np.ones(1)
    found, name = follow(system, drive, *start, Plan(PERIODS, 0, PERIODS), period=PERIOD)
    assert name == COURSE
    assert not bool(found.unresolved[0])
    t = PERIOD * np.arange(1, PERIODS + 1)
    y, v = events.simulate(joint, t, rtol=1e-12, atol=1e-14, max_step=2e-3)
    x, dx, _ = joint.base.derivatives(t)
    away = np.abs(np.asarray(found.p)[:, 0] - (y - x)), np.abs(np.asarray(found.v)[:, 0] - (v - dx))
    return away[0], away[1], found, len(events.switches(joint, t[-1], max_step=2e-3)[0])


def test_measured_base_motion_under_the_linear_two_link_is_that_of_scipy():
    drive, motion = samples()
    system = two_link(**RIG, gravity=45.0, linearised=True)
    joint = events.TwoLink(*RIG.values(), base=motion, C=15.0, linear=True, y0=0.02, v0=0.3)
    z, dz, found, met = beside_scipy(system, drive, joint)
    assert met >= 8
    room = 1e-8 * np.maximum(1.0, np.exp(np.maximum.accumulate(np.asarray(found.lyapunov)[0] * PERIOD * np.arange(PERIODS))))
    assert np.all(z < room)
    assert np.all(dz < 100.0 * room)  # half plays a swing of the contact


@pytest.mark.slow
def test_a_chirp_by_its_own_spline_is_that_of_scipy():
    drive = Chirp(0.04, 1.0, 9.0, 2.0)
    joint = events.Joint(*RIG.values(), base=motions.Chirp(0.04, 1.0, 4.0, ramp=0.0), y0=0.0, v0=0.0)
    z, dz, _, met = beside_scipy(base_motion_joint(*RIG.values()), drive, joint)
    assert met >= 8
    assert z.max() < 1e-8
    assert dz.max() < 1e-6


@pytest.mark.parametrize("cc", [0.0, 0.3])
def test_both_exact_ways_are_one(cc):
    """CASE 1 by sines and by the quintic through them; with damping of the contact the tangent jumps."""
    system, drive = case_1()
    system = system.with_effects(ContactDamping(cc * 200.0), AsymmetricGap(0.001))
    plan, y0 = Plan(20, 0, 20), np.array([0.0, 0.004, -0.008])
    one, first = follow(system, drive, y0, 0.0 * y0, plan)
    other, second = follow(system, drive, y0, 0.0 * y0, plan, period=2.0 * np.pi / 40.0)
    assert (first, second) == (HARMONIC, COURSE)
    away = np.abs(np.asarray(one.p - other.p)).max(axis=1) / 0.005
    assert away[0] < 1e-9
    assert np.all(away[:4] < 1e-6)  # chaos lets rounding grow
    if cc:
        np.testing.assert_allclose(other.lyapunov, one.lyapunov, atol=1e-5)


@pytest.mark.slow
def test_a_load_in_a_free_play_is_exact_too():
    """What sines and cosines leave out, a constant load in a play without a spring, goes by polynomials by itself."""
    system, drive = case_1()
    system, plan, rest = system.with_effects(Preload(3.0)), Plan(21, 0, 21), np.zeros(1)
    exact, name = follow(system, drive, rest, rest, plan)
    assert name == COURSE
    located, other = follow(system, drive, rest, rest, plan, exact=False, panels=1024)
    assert other == LOCATED
    assert np.abs(np.asarray(exact.p - located.p))[:2].max() < 1e-6 * 0.005


def test_the_spectrum_sums_to_the_divergence():
    drive, _ = samples(t0=3.0)
    found = lyapunov_spectrum(two_link(**RIG, gravity=-30.0, linearised=True), drive, periods=PERIODS, skip=0, period=PERIOD)
    assert found.values.sum() == pytest.approx(-20.0 / 3.0, abs=1e-9)
    free = lyapunov_spectrum(base_motion_joint(*RIG.values()), Rest(), periods=30, skip=0, period=0.1, y0=0.05)
    assert free.values.sum() == pytest.approx(-20.0 / 3.0, abs=1e-9)


@pytest.mark.slow
def test_a_measured_drive_begins_at_its_first_sample():
    system, plan, rest = base_motion_joint(*RIG.values()), Plan(20, 0, 20), np.zeros(1)
    runs = [
        follow(system, samples(t0)[0], rest, rest, plan, period=PERIOD, exact=exact)[0]
        for t0 in (0.0, 5.0) for exact in (None, False)
    ]  # fmt: skip
    for other in runs[1:]:
        np.testing.assert_allclose(other.p, runs[0].p, atol=2e-7)


def test_drives_become_polynomials_where_they_are_smooth():
    many = Multisine(jnp.array([1.0, 0.3]), jnp.array([7.0, 20.0]), jnp.array([0.0, 1.0]))
    t = np.linspace(0.0, 2.0, 999)
    for drive in (Chirp(1.0, 0.0, 8.0, 2.0), many, Harmonic(1.0, 9.0, 0.4)):
        path = course(drive, 2.0)
        assert not isinstance(path, str)
        place = t / float(path.dt)
        k = np.floor(place).astype(int)
        u = place - k
        value = (np.asarray(path.x)[k % len(path.x)] * u[:, None] ** np.arange(6)).sum(axis=1)[:-1]
        wanted = np.asarray(jax.vmap(drive.signal)(jnp.asarray(t[:-1])))
        assert np.abs(value - wanted).max() < 10.0 * CLOSE
    assert "from cell to cell" in course(Chirp(np.ones(3), 0.0, 8.0, 2.0), 2.0)


def test_a_record_that_ends_too_soon_is_refused():
    with pytest.raises(BadInput, match=r"lasts 1.398 s, the run 3 s"):
        follow(base_motion_joint(*RIG.values()), samples()[0], np.zeros(1), np.zeros(1), Plan(30, 0, 5), period=0.1)
    nonlinear = base_motion_joint(*RIG.values()).with_effects(LinearGravity(3.0))
    with pytest.raises(BadInput, match="no period of its own"):
        follow(nonlinear, samples()[0], np.zeros(1), np.zeros(1), Plan(30, 0, 5))
