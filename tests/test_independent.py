"""The referee checked against what is known exactly, and the fast generator against the referee."""

import importlib.util

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from tests.independent import events
from tests.independent.generator import force_record, make_effects, make_excitation, make_rig, measure, simulate_truth
from tests.independent.motions import Chirp, ModulatedSine, Multisine, Rest, SteppedSine
from tests.independent.rigs import OUTSIDE_STRENGTHS, STRENGTHS, Excitation, Rig

J, B, K, C = 3.16, 0.0262, 13000.0, 12.0
STEADY = SteppedSine(2.5, (0.04,))
needs_numba = pytest.mark.skipif(importlib.util.find_spec("numba") is None, reason="the generator needs numba")


def dead_zone(z, backlash):
    return z - np.clip(z, -backlash / 2, backlash / 2)


def energy(y, v, C_gravity=0.0):
    return 0.5 * J * v**2 + 0.5 * K * dead_zone(y, B) ** 2 + J * C_gravity * np.cos(y)


@pytest.mark.parametrize("amplitude", [0.0135, 0.02, 0.03, 0.1])
def test_free_vibration_has_the_exact_period_and_keeps_its_energy(amplitude):
    omega = np.sqrt(K / J)
    period = 2 * np.pi / omega + 4 * (B / 2) / (omega * (amplitude - B / 2))
    system = events.free_vibration(J, B, K, amplitude)
    times, sides = events.switches(system, 4.2 * period)
    assert list(sides[:4]) == [0, -1, 0, 1]
    np.testing.assert_allclose(times[4:] - times[:-4], period, rtol=1e-11)
    e = energy(*events.simulate(system, np.linspace(0, 4 * period, 500)))
    np.testing.assert_allclose(e, e[0], rtol=1e-9)


def test_a_link_under_gravity_keeps_its_energy():
    system = events.TwoLink(J, B, K, 0.0, y0=0.03, C=-14.0)
    e = energy(*events.simulate(system, np.linspace(0, 3, 500)), C_gravity=-14.0)
    np.testing.assert_allclose(e, e[0], atol=1e-10)


def test_linear_and_sine_gravity_agree_for_small_angles():
    t = np.linspace(0, 0.5, 100)
    pair = [events.simulate(events.TwoLink(J, B, K, C, y0=0.02, C=-14.0, linear=kind), t)[0] for kind in (True, False)]
    assert 0 < np.max(np.abs(pair[0] - pair[1])) < 1e-6


def test_without_play_the_oscillator_is_the_linear_one():
    m, c, k, force, w = 1.0, 8.0, 1000.0, 100.0, 40.0
    t = np.linspace(0, 3, 400)
    y, v = events.simulate(events.ForcedOscillator(m, c, k, 0.0, 1e9, force, w), t)
    steady = force / (k - m * w**2 + 1j * c * w)
    decay, free = c / (2 * m), np.sqrt(k / m - (c / (2 * m)) ** 2)
    a = -steady.real
    b = (decay * a + w * steady.imag) / free
    exact = (steady * np.exp(1j * w * t)).real + np.exp(-decay * t) * (a * np.cos(free * t) + b * np.sin(free * t))
    np.testing.assert_allclose(y, exact, atol=1e-12)
    np.testing.assert_allclose(np.trapezoid(v, t), y[-1], atol=2e-4)


@pytest.mark.parametrize("case", [events.case1, events.case2])
def test_two_tolerances_agree_until_chaos_tells_them_apart(case):
    t = np.linspace(0, 1, 500)
    fine, coarse = events.simulate(case(), t)[0], events.simulate(case(), t, rtol=1e-10, atol=1e-12)[0]
    np.testing.assert_allclose(fine, coarse, atol=2e-8)


@pytest.mark.parametrize("max_step", [1e-3, 3e-3, 2e-2])
def test_a_grazing_touch_is_not_missed(max_step):
    """A touch of 0.1 ms on a 0.2 s swing: four switches a period, however long the steps may be."""
    x0, k1 = 0.005, 1000.0
    system = events.ForcedOscillator(1.0, 0.0, k1, 31000.0, x0, amplitude=0.0, y0=0.0, v0=np.sqrt(k1) * x0 * (1 + 1e-6))
    period = 2 * np.pi / np.sqrt(k1)
    times, sides = events.switches(system, 5.05 * period, max_step=max_step)
    assert list(sides) == [1, 0, -1, 0] * 5
    assert np.all((times[1::2] - times[::2] > 5e-5) & (times[1::2] - times[::2] < 2e-4))


@pytest.mark.parametrize(
    "motion",
    [
        Chirp(0.07, 0.05, 0.6, 4.0, order=1.5),
        Multisine(np.array([0.02, 0.01]), np.array([1.0, 3.0]), np.array([0.3, 1.0])),
        SteppedSine(3.1, (0.02, 0.03, 0.05), hold=1.0),
        ModulatedSine(0.03, 3.0),
    ],
)
def test_motions_have_the_derivatives_they_claim(motion):
    t, h = np.linspace(0.01, 2.99, 337), 1e-5
    np.testing.assert_allclose((motion.x(t + h) - motion.x(t - h)) / (2 * h), motion.dx(t), atol=1e-6)
    np.testing.assert_allclose((motion.dx(t + h) - motion.dx(t - h)) / (2 * h), motion.ddx(t), atol=1e-5)


@needs_numba
@pytest.mark.parametrize("kind", ["chirp", "multisine", "stepped", "modulated"])
@pytest.mark.parametrize(("seed", "seconds"), [(0, 5.0), (1, 2.0)])  # the second multisine is chaotic: a shorter look
def test_the_generator_agrees_with_the_referee(kind, seed, seconds):
    rng = np.random.default_rng(seed)
    rig, excitation = make_rig(rng), make_excitation(rng, kind)
    truth = simulate_truth(rig, {}, excitation, 500.0, seconds)
    joint = events.Joint(rig.inertia, rig.backlash, rig.stiffness, rig.damping, excitation.base)
    y, v = events.simulate(joint, truth["t"])
    np.testing.assert_allclose(truth["y"], y, atol=1e-9)
    np.testing.assert_allclose(truth["v"], v, atol=1e-7)


@needs_numba
def test_the_generator_agrees_on_gravity_and_on_case_1():
    excitation = Excitation("stepped", STEADY)
    truth = simulate_truth(Rig(J, B, K, C), {"gravity": {"G": -45.0}}, excitation, 500.0, 3.0)
    y, _ = events.simulate(events.TwoLink(J, B, K, C, STEADY, C=-45.0 / J), truth["t"])
    np.testing.assert_allclose(truth["y"], y, atol=1e-9)
    cosine = SteppedSine(40 / (2 * np.pi), (100.0,), phase=np.pi / 2, ramp=0.0)
    truth = simulate_truth(Rig(1.0, 0.01, 40000.0, 8.0), {}, Excitation("force", force=cosine), 500.0, 1.0)
    np.testing.assert_allclose(truth["y"], events.simulate(events.case1(), truth["t"])[0], atol=1e-8)


JUMPING = ("coulomb_joint", "stribeck", "coulomb_ground", "play_step")
"""Where one of the two steps over a jump that it does not look for."""
WIDTH = 2e-6  # rad/s, of the tanh that stands for the sign in the plain laws; the creep it allows bounds the agreement


def plain_law(name, q, t, z, w, y, v, delta, s):
    """The catalogue's torque [N m], and the rate of its hidden state, as its table has them; sgn is a narrow tanh."""
    sign = np.tanh(w / WIDTH)
    bristle = q.get("Fc", 1.0) + (q.get("Fs", 1.0) - q.get("Fc", 1.0)) * np.exp(-((w / q.get("vs", 1.0)) ** 2))
    lugre = w - q.get("sigma0", 0.0) * abs(w) * s / bristle
    laws = {
        "gravity": lambda: q["G"] * np.sin(y),
        "preload": lambda: q["T0"],
        "gap_spring": lambda: -q["k1"] * z,
        "asymmetric_stiffness": lambda: -K * q["a"] * abs(delta),
        "cubic_stiffness": lambda: -q["k3"] * delta**3,
        "contact_damping": lambda: -q["cc"] * w * (delta != 0),
        "hunt_crossley": lambda: -q["chi"] * abs(delta) * w,
        "coulomb_joint": lambda: -q["Tc"] * sign,
        "stribeck": lambda: -(q["Tc"] + (q["Ts"] - q["Tc"]) * np.exp(-((w / q["vs"]) ** 2))) * sign,
        "coulomb_ground": lambda: -q["Tc"] * np.tanh(v / WIDTH),
        "quadratic_drag": lambda: -q["q"] * abs(v) * v,
        "torque_ripple": lambda: q["A"] * np.sin(q["N"] * y + q["phi"]),
        "dahl": lambda: (-s, q["sigma"] * w * (1 - s / q["Fc"] * np.sign(w))),
        "lugre": lambda: (-q["sigma0"] * s - q["sigma1"] * lugre, lugre),
        "bouc_wen": lambda: (
            -s,
            q["sigma"] * (w - abs(s / q["Fc"]) ** q["n"] * (q["beta"] * abs(w) * np.sign(s) + (1 - q["beta"]) * w)),
        ),
        "unknown_disturbance": lambda: q["A"] * np.sin(q["w"] * t + q["phi"]),
        "speed_stiffness": lambda: -q["s"] * abs(w) * delta,
        "pulsing_stiffness": lambda: -K * q["a"] * np.sin(q["w"] * t) * delta,
        "end_stop": lambda: -q["K"] * max(y - q["y1"], 0.0),
        "detent": lambda: -q["A"] * (y / q["width"]) * np.exp(0.5 - (y / q["width"]) ** 2 / 2),
        "rumble": lambda: q["A"] * sum(np.sin(2 * np.pi * f * t + n**2) for n, f in enumerate((3.1, 4.7, 7.3, 11.2, 16.9))),
        "one_way_damping": lambda: -q["c1"] * max(w, 0.0),
        "squeeze_film": lambda: -q["c1"] * w * np.exp(-max(B / 2 - abs(z), 0.0) / q["h"]),
    }
    found = laws[name]() if name in laws else 0.0
    return found if isinstance(found, tuple) else (found, 0.0)


def plain_simulation(name, q, excitation, t_out):
    """z (n,) [rad] of the joint with one law, from a stiff solver that knows nothing of switches."""
    flexible = name in ("flexible_link", "second_play")
    J2, k2, c2 = (q["J2"], q["k2"], q["c2"]) if flexible else (1.0, 0.0, 0.0)

    def rate(t, u):
        y, v, s, y2, v2 = u
        x, dx, _ = excitation.base.derivatives(t)
        z, w = y - x, v - dx
        play = B * (1 + (q["r"] * t if name == "gap_drift" else 0.0)) * (1 + (q["a"] * (t > 0.6) if name == "play_step" else 0.0))
        k = K * (1 + (q["r"] * t if name == "stiffness_drift" else 0.0))
        delta = dead_zone(z - (q["z0"] if name == "asymmetric_gap" else 0.0), play)
        torque, ds = plain_law(name, q, t, z, w, y, v, delta, s)
        link = k2 * dead_zone(y - y2, q.get("b2", 0.0)) + c2 * (v - v2)
        return [v, (torque - link - k * delta - C * w) / J, ds, v2, link / J2]

    out = solve_ivp(rate, (0, t_out[-1]), [0.0] * 5, "LSODA", t_out, rtol=1e-9, atol=1e-11, max_step=1e-3)
    return out.y[0] - excitation.base.x(t_out)


@needs_numba
@pytest.mark.parametrize(
    "name", [name for name in (*STRENGTHS, *OUTSIDE_STRENGTHS, "second_play") if not name.startswith("sensor")]
)
def test_every_law_of_the_generator_is_the_one_in_the_table(name):
    rng = np.random.default_rng(3)
    excitation, effects = make_excitation(rng, "multisine"), make_effects(rng, name)
    if name == "play_step":
        effects[name]["t1"] = 0.6  # within the look
    truth = simulate_truth(Rig(J, B, K, C), effects, excitation, 250.0, 1.2)
    plain = plain_simulation(name, effects[name], excitation, truth["t"])
    error = np.max(np.abs(plain - truth["z"]))
    without = simulate_truth(Rig(J, B, K, C), {}, excitation, 250.0, 1.2)
    assert np.max(np.abs(without["z"] - truth["z"])) > 3e-4
    assert error < (2e-5 if name in JUMPING else 1e-7)


@needs_numba
def test_dry_friction_stops_a_link_where_it_should_and_holds_it():
    start, brake = 0.5, 2.0
    coast = Rig(J, 10.0, K, 0.0)
    for name in ("coulomb_joint", "coulomb_ground"):
        out = simulate_truth(coast, {name: {"Tc": brake}}, Excitation("free", v0=start), 1000.0, 1.5)
        moving = out["t"] < J * start / brake
        np.testing.assert_allclose(out["v"], np.where(moving, start - brake / J * out["t"], 0.0), atol=1e-9)
        assert abs(out["y"][-1] - J * start**2 / (2 * brake)) < 1e-9


@needs_numba
def test_sticking_ends_when_friction_can_no_longer_hold():
    """Pushed ever harder, the link lets go at the static level; held to a moving base, it is carried along."""
    push = SteppedSine(0.25, (8.0,), ramp=0.0)
    out = simulate_truth(Rig(J, 10.0, K, 0.0), {"stribeck": {"Tc": 2.0, "Ts": 5.0, "vs": 0.1}},
                         Excitation("push", force=push), 1000.0, 0.6)  # fmt: skip
    release = np.arcsin(5.0 / 8.0) / (2 * np.pi * 0.25)
    assert np.all(out["y"][out["t"] < release] == 0)
    assert np.all(out["v"][out["t"] > release + 2e-3] > 0)
    gentle = Excitation("carry", SteppedSine(0.5, (0.05,)))
    out = simulate_truth(Rig(J, 10.0, K, 0.0), {"coulomb_joint": {"Tc": 50.0}}, gentle, 1000.0, 3.0)
    np.testing.assert_allclose(out["z"], 0.0, atol=1e-12)


@needs_numba
def test_records_are_repeatable_and_measured_as_stated():
    def record(seed):
        rng = np.random.default_rng(seed)
        effects = make_effects(rng, "sensor_delay", "sensor_gain", "sensor_offset")
        truth = simulate_truth(make_rig(rng), effects, make_excitation(rng, "multisine"), 500.0, 4.0)
        return truth, effects, measure(truth, rng, 3e-5, 6e-5), measure(truth, rng, 3e-5, 3e-5, 2 * np.pi / 32768)

    truth, effects, noisy, counted = record(5)
    np.testing.assert_array_equal(noisy["z"], record(5)[2]["z"])
    assert abs(np.std(noisy["z"] - truth["z_seen"]) / 6e-5 - 1) < 0.1
    assert abs(np.std(noisy["x"] - truth["x"]) / 3e-5 - 1) < 0.1
    counts = counted["z"] / (2 * np.pi / 32768)
    np.testing.assert_allclose(counts, np.round(counts), atol=1e-6)
    late = CubicSpline(truth["t"], truth["z"])(truth["t"] - effects["sensor_delay"]["tau"])
    expected = effects["sensor_gain"]["g"] * late + effects["sensor_offset"]["z_s"]
    np.testing.assert_allclose(truth["z_seen"][10:], expected[10:], atol=1e-5)


@needs_numba
@pytest.mark.parametrize("kind", ["force_chirp", "force_multisine", "free_decay"])
def test_records_without_base_motion(kind):
    rng = np.random.default_rng(2)
    rig, excitation = make_rig(rng), make_excitation(rng, kind)
    assert isinstance(excitation.base, Rest)
    record = force_record(rig, {}, excitation, 500.0, 3.0, rng, 0.5, 3e-5)
    assert set(record) == {"t", "F", "y"}
    assert np.max(np.abs(record["y"])) > rig.backlash / 2


@needs_numba
def test_unknown_names_are_refused():
    rig, excitation = Rig(J, B, K, C), Excitation("stepped", STEADY)
    with pytest.raises(ValueError, match="no effect is called 'gravitation'"):
        simulate_truth(rig, {"gravitation": {"G": 1.0}}, excitation, 500.0, 0.1)
    with pytest.raises(ValueError, match="gravity has no parameter g"):
        simulate_truth(rig, {"gravity": {"g": 1.0}}, excitation, 500.0, 0.1)
