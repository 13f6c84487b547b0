"""The simulators against what is not themselves: closed forms, event-located solutions, another integrator."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.effects import Contact, Damper, Preload, corner
from jaxbacklash.excitation import Chirp, Harmonic, Panelled, Sampled, SteppedSine
from jaxbacklash.fitting.setup import first_guess, make_problem
from jaxbacklash.mechanics import Drive
from jaxbacklash.models import Dimensionless, free_axis, linear_oscillator
from jaxbacklash.parameters import with_values
from jaxbacklash.shooting.multiple_shooting import predictions
from jaxbacklash.shooting.windows import cut
from jaxbacklash.simulation import as_record, measured_base
from jaxbacklash.solvers.panels import advance_smooth
from tests.independent import events, motions


@pytest.mark.parametrize("amplitude", [1.2, 2.0, 5.0, 20.0])
def test_period_of_free_vibration(amplitude):
    r"""2 pi / omega_0 + 4 (b/2) / (omega_0 (A - b/2)), exactly, in units of half play and 1 / omega_0."""
    exact = 2 * np.pi + 4 / (amplitude - 1)
    path = jb.simulate(
        jb.base_motion_joint(1.0, 2.0, 1.0, 0.0), duration=exact, rate=400 / exact, y0=amplitude, dy0=0.0, panels_per_sample=1
    )
    assert abs(float(path.dy[-1]) / (amplitude - 1)) / exact < 1e-8
    energy = 0.5 * np.asarray(path.dy) ** 2 + 0.5 * np.maximum(np.abs(np.asarray(path.y)) - 1, 0) ** 2
    assert np.ptp(energy) / energy[0] < 1e-7


def one_period(system, drive, exact, period, first, panels, periods=6, samples=16, **how):
    """Largest position error of each period, started from the exact state, in the exact solution's unit."""
    t = (first + np.arange(periods * samples + 1) / samples) * period
    y, v = (a[1:] for a in events.simulate(exact, np.concatenate([[0.0], t])))
    worst = []
    for k in range(periods):
        at = slice(k * samples, (k + 1) * samples + 1)
        path = jb.simulate(
            system, drive, duration=period, rate=samples / period, t0=t[k * samples], y0=y[k * samples], dy0=v[k * samples],
            panels_per_sample=panels // samples, **how,
        )  # fmt: skip
        worst.append(np.max(np.abs(np.asarray(path.y) - y[at])))
    return np.array(worst)


@pytest.mark.parametrize("case", [1, 2])
def test_forced_oscillator_against_events(case):
    """Below 1e-6 half plays a forcing period at 512 panels, and of fourth order though every period meets the edges."""
    system, force = jb.case_1() if case == 1 else jb.case_2()
    exact = events.case1() if case == 1 else events.case2()
    found = {n: one_period(system, force, exact, 2 * np.pi / 40, 20, n) / 0.005 for n in (256, 512)}
    assert found[512].max() < 1e-6
    assert np.log2(np.median(found[256]) / np.median(found[512])) == pytest.approx(4.0, abs=0.5)


@pytest.mark.parametrize("hanging", [False, True], ids=["joint", "two-link"])
def test_base_motion_against_events(hanging):
    known = dict(inertia=3.16, backlash=0.02618, stiffness=13000.0, damping=12.0)
    sweep = motions.Chirp(amplitude=0.07, rate=0.4, corner=6.0, order=0.5)
    drive = Chirp(0.07, 0.0, 12.0, 30.0, corner=6.0)
    system = jb.two_link(**known, gravity=-45.0) if hanging else jb.base_motion_joint(**known)
    exact = events.TwoLink(base=sweep, C=-45.0 / 3.16, **known) if hanging else events.Joint(base=sweep, **known)
    found = one_period(system, drive, exact, 0.25, 8, 256) / 0.01309
    assert found.max() < 1e-6
    default = one_period(system, drive, exact, 0.25, 8, 128) / 0.01309  # the fit's panels of 2 ms
    assert default.max() < 1e-5


def test_smoothed_corner_bias_falls_with_the_square_of_its_width():
    """The adaptive referee: another method, another treatment of the corner, and it converges to the same motion."""
    system, force = jb.case_1()
    bias = []
    for width in (0.03, 0.01):
        smooth = with_values(system, {"width": width * 0.005})
        bias.append(np.median(one_period(smooth, force, events.case1(), 2 * np.pi / 40, 20, 16, 4, adaptive=True)))
    assert np.log(bias[0] / bias[1]) / np.log(3) == pytest.approx(2.0, abs=0.3)


def test_corner_is_the_sharp_one_outside_its_width():
    u = np.linspace(-3e-3, 3e-3, 601)
    value, slope = corner(u, 1e-3)
    outside = np.abs(u) >= 1e-3
    np.testing.assert_allclose(value[outside], np.maximum(u, 0)[outside], atol=1e-18)
    assert corner(0.0, 1e-3)[0] == pytest.approx(3 / 16 * 1e-3)
    np.testing.assert_allclose(slope, np.gradient(value, u), atol=5e-3)
    sharp, step = corner(u, 0.0)
    np.testing.assert_allclose(sharp, np.maximum(u, 0), atol=1e-12)
    assert set(np.unique(np.round(step, 12))) <= {0.0, 0.5, 1.0}


def test_linear_oscillator_against_closed_form():
    system = linear_oscillator(2.0, 800.0, 4.0)
    path = jb.simulate(system, duration=2.0, rate=500.0, y0=0.01, dy0=0.0)
    h, w0 = 1.0, 20.0
    wd = np.sqrt(w0**2 - h**2)
    t = np.asarray(path.t)
    exact = 0.01 * np.exp(-h * t) * (np.cos(wd * t) + h / wd * np.sin(wd * t))
    np.testing.assert_allclose(path.y, exact, atol=1e-9)


def test_free_axis_against_closed_form():
    path = jb.simulate(free_axis(2.0, 3.0), duration=1.0, rate=200.0, y0=0.0, dy0=0.5)
    np.testing.assert_allclose(path.y, 0.5 * 2 / 3 * (1 - np.exp(-1.5 * np.asarray(path.t))), atol=1e-10)


def test_dimensionless_form_both_ways():
    system, force = jb.case_1()
    form = jb.dimensionless(system, force)
    assert (2 * form.zeta, form.alpha, form.Omega) == pytest.approx((0.04, 0.5, 0.2))
    again, pushed = form.dimensional(1.0, 40000.0, 0.005)
    assert jb.dimensionless(again, pushed) == pytest.approx(form)
    tau_system, tau_force = Dimensionless(*form).system()
    period = 2 * np.pi / 40
    path = jb.simulate(system, force, duration=period, rate=64 / period, y0=0.0, dy0=0.0, panels_per_sample=8)
    scaled = jb.simulate(
        tau_system, tau_force, duration=200 * period, rate=64 / period / 200, y0=0.0, dy0=0.0, panels_per_sample=8
    )
    np.testing.assert_allclose(np.asarray(path.y) / 0.005, scaled.y, atol=1e-9)


def test_shooting_windows_take_the_same_steps_as_simulate():
    """The fit's windows and diffrax's run are one integrator: same panels, same numbers."""
    system = jb.base_motion_joint(3.2, 0.024, 12000.0, 20.0)
    record = as_record(jb.simulate(system, Harmonic(0.06, 11.0), duration=0.6, rate=500.0), system)
    windows, _ = cut([record], 0.1)
    problem = make_problem(system, windows, ["backlash"])
    guess = first_guess(problem)
    motion = np.asarray(predictions(problem, guess).motion)[0]
    x = windows.basis[0] @ np.concatenate([windows.coefficients[0], windows.coefficients[1][:5]])
    dx = windows.basis[1] @ np.concatenate([windows.coefficients[0], windows.coefficients[1][:5]])
    drive = Panelled(0.0, 0.002, jnp.asarray(x), jnp.asarray(dx), jnp.zeros(x.size))
    y0, dy0 = float(guess.starts[0, 0]), float(guess.starts[1, 0])
    path = jb.simulate(system, drive, duration=0.002 * windows.samples, rate=500.0, y0=y0, dy0=dy0, panels_per_sample=1)
    np.testing.assert_allclose(np.asarray(path.z)[:-1], motion, atol=1e-15)


def test_plain_runge_kutta_has_fourth_order_on_a_smooth_law():
    system = jb.System(1.0, Contact(0.0, 1.0, 10.0), Damper(0.0))

    def end(n):
        state = (jnp.asarray(1.0), jnp.asarray(0.0))
        for k in range(n):
            state = advance_smooth(system, k * 2.0 / n, state, lambda tau: Drive(0.0, 0.0, 0.0), 2.0 / n)
        return float(state[0])

    errors = [abs(end(n) - end(256)) for n in (8, 16)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.3)


def test_measured_base_gives_rates_without_differencing_noise():
    rng = np.random.default_rng(2)
    t = np.arange(5000) / 500.0
    x = 0.06 * np.sin(2 * np.pi * 3.0 * t)
    record = jb.Record(t, {"x": x + 3e-5 * rng.standard_normal(t.size), "z": 0.02 * np.cos(17 * t)})
    drive = measured_base(record)
    assert isinstance(drive, Sampled)
    error = np.asarray(drive.dx) - 0.06 * 6 * np.pi * np.cos(6 * np.pi * t)
    differenced = np.gradient(record.channels["x"], t) - 0.06 * 6 * np.pi * np.cos(6 * np.pi * t)
    assert np.std(error[20:-20]) < 0.3 * np.std(differenced[20:-20])
    middle = drive.at(jnp.asarray(4.001))
    assert float(middle.x) == pytest.approx(0.06 * np.sin(6 * np.pi * 4.001), abs=5e-5)


def test_stepped_sine_is_continuous():
    drive = SteppedSine(np.array([0.02, 0.05, 0.03]), np.array([2.0, 4.0, 7.0]), 1.0)
    t = jnp.linspace(0.0, 3.0, 30001)
    x = jax.vmap(drive.signal)(t)
    assert float(jnp.max(jnp.abs(jnp.diff(x)))) < 1e-4 * 2 * np.pi * 8 * 0.06


def test_a_preloaded_link_rests_where_the_spring_carries_it():
    system = jb.base_motion_joint(3.0, 0.02, 1e4, 60.0).with_effects(Preload(25.0))
    path = jb.simulate(system, duration=4.0, rate=200.0, y0=0.0, dy0=0.0)
    assert float(path.y[-1]) == pytest.approx(0.01 + 25.0 / 1e4, abs=1e-9)


def test_single_precision_is_refused():
    jax.config.update("jax_enable_x64", False)
    try:
        with pytest.raises(RuntimeError, match="enable_double_precision"):
            jb.simulate(*jb.case_1(), duration=0.1)
    finally:
        jax.config.update("jax_enable_x64", True)


def test_a_link_that_is_through_its_play_in_no_time_meets_both_edges():
    """The exact period again, of an amplitude of 400 half plays: most panels of 1 ms would hold both edges."""
    omega, amplitude = 2.0 * np.pi * 10.0, 400.0
    exact = (2 * np.pi + 4 / (amplitude - 1)) / omega
    joint = jb.base_motion_joint(1.0, 2.0, omega**2, 0.0)
    how = {"duration": 40 * exact, "rate": 40 / exact, "y0": amplitude, "dy0": 0.0}
    found, coarse = jb.simulate(joint, **how), jb.simulate(joint, **how, panels_per_sample=3)
    late = [abs(float(path.dy[-1])) / (amplitude * omega) / (40 * 2 * np.pi) for path in (found, coarse)]
    assert late[0] < 1e-7
    assert late[1] > 10 * late[0]
