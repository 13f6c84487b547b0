"""Maps, sweeps and basins of systems without exact steps: beside the exact ones, and beside scipy and numba where none are."""

from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("xarray")

from jaxbacklash.dynamics.basins import basins
from jaxbacklash.dynamics.bifurcation import bifurcation, sweep
from jaxbacklash.dynamics.family import NamedParameters, PaperCase
from jaxbacklash.dynamics.follow import COURSE, LOCATED, follow
from jaxbacklash.dynamics.located import PANELS, default_panels, fastest
from jaxbacklash.dynamics.maps import run_map
from jaxbacklash.dynamics.plan import Plan
from jaxbacklash.dynamics.request import request
from jaxbacklash.effects import ContactDamping, CoulombJoint, CubicStiffness, FlexibleLink, Gravity
from jaxbacklash.errors import BadInput
from jaxbacklash.excitation import Chirp, Harmonic, Sampled
from jaxbacklash.models import base_motion_joint

from .independent import events, generator, motions, rigs
from .laws import LAWS

RIG = (3.0, 0.026, 11000.0, 20.0)


@pytest.mark.parametrize("case", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_sweeps_by_both_ways_agree(case):
    """Where a sweep is on a periodic motion, the general way finds the same points and the same exponent."""
    values = np.array([2.9, 3.0, 3.1]) if case == 1 else np.array([0.95, 1.0, 1.05])
    given, plan = PaperCase(case).build({"inverse_alpha": values}), Plan(60, 40, 20)
    exact = [np.asarray(part) for part in sweep(*given, (0.0, 0.0), plan)]
    general = [np.asarray(part) for part in sweep(*given, (0.0, 0.0), plan, exact=False, panels=512)]
    assert [part.shape for part in exact] == [part.shape for part in general] == [(3, 20, 2), (3, 20, 2), (3, 2), (3, 2)]
    # A motion of several periods may be met in another of its phases: points are compared as sets.
    one, other = (np.sort(found[0][:, -6:], axis=1) for found in (exact, general))
    settled = np.abs(exact[0][:, -6:] - exact[0][:, -12:-6]).max(axis=1) < 1e-6
    assert settled.sum() >= 3
    assert np.abs(one - other).max(axis=1)[settled].max() < 1e-4
    assert np.median(np.abs(exact[2] - general[2])[settled]) < 2e-3


@pytest.mark.slow
def test_bifurcations_by_both_ways_agree():
    """All three ways of a diagram, where they are settled on one motion."""
    values = np.array([2.9, 3.0, 3.1])
    options = {"settle": 40, "samples": 20, "start_periods": 60, "starts": [(0.0, 0.0), (2.0, 0.0)]}
    exact = bifurcation(PaperCase(1), "inverse_alpha", values, **options)
    general = bifurcation(PaperCase(1), "inverse_alpha", values, **options, exact=False, panels=512)
    assert exact.attrs["solver"] != general.attrs["solver"] == LOCATED
    for way in ("swept_up", "swept_down", "from_starts"):
        settled = (exact[f"{way}_period"] > 0) & (general[f"{way}_period"] == exact[f"{way}_period"])
        assert settled.sum() >= 0.5 * settled.size
        one, other = (np.sort(found[way].values[-6:], axis=0)[..., settled.values] for found in (exact, general))
        assert np.abs(one - other).max() < 1e-4


@dataclass(frozen=True)
class Hardening(events.Joint):
    """The joint with gravity as sin y, a contact that hardens, and a damper of the contact."""

    G: float = 0.0
    k3: float = 0.0
    cc: float = 0.0

    def acceleration(self, side, t, y, v):
        x, dx, _ = self.base.derivatives(t)
        depth = abs(side) * (y - x - side * self.half_play)
        torque = self.G * np.sin(y) - self.k3 * depth**3 - abs(side) * self.cc * (v - dx)
        return super().acceleration(side, t, y, v) + torque / self.inertia


def harmonic(amplitude, frequency):
    """The same base motion for us and for the independent programs."""
    drive = Harmonic(amplitude, 2.0 * np.pi * frequency)
    return drive, motions.ModulatedSine(amplitude, frequency, depth=0.0, phase=0.5 * np.pi, ramp=0.0)


@pytest.mark.slow
def test_a_nonlinear_joint_is_that_of_scipy():
    """Samples once a period over twenty, and the exponent against two motions of scipy's that begin a little apart."""
    drive, base = harmonic(0.05, 3.0)
    effects = {"G": 28.0, "k3": 3e7, "cc": 15.0}
    system = base_motion_joint(*RIG).with_effects(Gravity(28.0), CubicStiffness(3e7), ContactDamping(15.0))
    t, step = np.arange(1, 21) / 3.0, 1e-6
    joints = [Hardening(*RIG, base=base, y0=0.06 + s, v0=0.0, **effects) for s in (0.0, step, -step)]
    paths = [events.simulate(joint, t, rtol=1e-10, atol=1e-12) for joint in joints]
    assert len(events.switches(joints[0], t[-1], rtol=1e-8, atol=1e-10)[0]) > 20
    found, name = follow(system, drive, np.full(1, 0.06), np.zeros(1), Plan(20, 0, 20), panels=1024)
    assert name == LOCATED
    away = np.abs(np.asarray(found.p)[:, 0] - (paths[0][0] - base.x(t)))
    grown = np.hypot(paths[1][0] - paths[2][0], paths[1][1] - paths[2][1]) / (2.0 * step)
    assert away[0] < 1e-8
    assert np.all(away < 1e-7 * np.maximum(1.0, np.maximum.accumulate(grown)))
    if step * grown.max() < 1e-4:  # else the two are no tangent any more
        assert float(found.lyapunov[0]) == pytest.approx(np.log(grown[-1]) / t[-1], abs=0.02)


@pytest.mark.slow
def test_a_sweep_with_dry_friction_is_that_of_numba():
    """Gravity, cubic contact, contact damping and Coulomb friction in the joint, which sticks in every period."""
    pytest.importorskip("numba")
    drive, base = harmonic(0.05, 3.0)
    effects = {"gravity": {"G": -28.0}, "cubic_stiffness": {"k3": 3e7}, "contact_damping": {"cc": 15.0}}
    system = base_motion_joint(*RIG).with_effects(Gravity(-28.0), CubicStiffness(3e7), ContactDamping(15.0), CoulombJoint(4.0))
    values = np.array([4.0, 6.0, 8.0])
    found = bifurcation(
        NamedParameters(system, drive), "coulomb_joint.Tc", values, settle=30, samples=20, start_periods=40,
        start=(0.0, 0.0), starts=[(0.05, 0.0)], panels=512,
    )  # fmt: skip
    assert found.attrs["solver"] == LOCATED
    assert found.swept_up.attrs["units"] == "rad"
    excitation = rigs.Excitation("steady", base=base, force=motions.Rest(), y0=0.05, v0=0.0)
    for k, Tc in enumerate(values):
        truth = generator.simulate_truth(
            rigs.Rig(*RIG), effects | {"coulomb_joint": {"Tc": Tc}}, excitation, rate=30.0, duration=40.0 / 3.0
        )
        z = truth["z"][::10][1:][-20:]
        assert found.from_starts_period.values[0, k] > 0
        np.testing.assert_allclose(found.from_starts.values[:, 0, k], z, atol=2e-6)


GROUPS = {
    "loads": ("gravity", "preload", "torque_ripple", "gap_spring", "sensor_gain", "sensor_offset", "learned_torque"),
    "contact": ("asymmetric_gap", "asymmetric_stiffness", "cubic_stiffness", "contact_damping", "hunt_crossley", "gap_drift"),
    "friction": ("coulomb_joint", "coulomb_ground", "quadratic_drag", "stiffness_drift", "sensor_delay", "linear_gravity"),
    "rigs": (
        "transmission_error",
        "load_friction",
        "contact_exponent",
        "damping_drift",
        "friction_drift",
        "clock_drift",
        "relaxation",
        "sensor_filter",
        "disturbance",
    ),
    "hidden states": ("dahl", "flexible_link", "stribeck"),
    "hysteresis": ("lugre", "bouc_wen"),
    "plays": ("second_play",),
}


def test_every_law_is_in_a_group():
    assert sorted(name for group in GROUPS.values() for name in group) == sorted(LAWS)


@pytest.mark.slow
@pytest.mark.parametrize("group", GROUPS)
def test_every_law_can_stand_in_a_map(group):
    system = base_motion_joint(*RIG).with_effects(*(LAWS[name] for name in GROUPS[group]))
    family = NamedParameters(system, Harmonic(0.05, 2.0 * np.pi * 3.0))
    axes = {"backlash": [0.02, 0.03], "drive.amplitude": [0.03, 0.06]}
    map_ = run_map(request(family, axes, periods=24, skip=4, samples=8))
    assert map_.attrs["solver"] == LOCATED
    assert np.isfinite(map_.lyapunov.values).all()
    assert np.isfinite(map_.poincare.values).all()
    assert np.ptp(map_.poincare.values) > 1e-4


@pytest.mark.slow
def test_measured_and_swept_drives_in_a_map():
    """The exact way along polynomials and the general one agree; the chirp's amplitude is an axis like any other."""
    t = np.arange(600) / 400.0
    omega = 2.0 * np.pi * 3.0
    measured = Sampled(
        jnp.asarray(0.0), jnp.asarray(1.0 / 400.0), jnp.asarray(0.05 * np.sin(omega * t)),
        jnp.asarray(0.05 * omega * np.cos(omega * t)), jnp.zeros(t.size),
    )  # fmt: skip
    family = NamedParameters(base_motion_joint(*RIG), measured)
    axes, options = {"backlash": [0.02, 0.026, 0.03]}, {"periods": 24, "skip": 4, "samples": 20, "period": 0.06}
    exact = run_map(request(family, axes, **options))
    general = run_map(request(family, axes, **options, exact=False, panels=128))
    assert (exact.attrs["solver"], general.attrs["solver"]) == (COURSE, LOCATED)
    np.testing.assert_allclose(exact.poincare, general.poincare, atol=1e-6)
    np.testing.assert_allclose(exact.lyapunov, general.lyapunov, atol=1e-3)
    swept = NamedParameters(base_motion_joint(*RIG).with_effects(Gravity(-28.0)), Chirp(0.05, 1.0, 6.0, 2.0))
    map_ = run_map(request(swept, {"drive.amplitude": [0.02, 0.05]}, **options))
    assert map_.attrs["solver"] == LOCATED
    assert np.isfinite(map_.lyapunov).all()
    with pytest.raises(BadInput, match="Sampled"):
        bifurcation(family, "backlash", [0.02, 0.03], period=0.06)


@pytest.mark.slow
def test_basins_of_a_joint_in_radians():
    """Two rests of a link under gravity, one on either side of its play: half a play apart is not one place."""
    system = base_motion_joint(*RIG).with_effects(Gravity(28.0))
    family = NamedParameters(system, Harmonic(1e-4, 2.0 * np.pi * 3.0))
    found = basins(family, {}, [-0.02, 0.02], [0.0], periods=60, samples=20)
    assert [a.period for a in found.attractors] == [1, 1]
    assert {np.sign(float(a.p[0])) for a in found.attractors} == {-1.0, 1.0}
    assert found.number[0, 0] != found.number[1, 0]


def test_panels_follow_the_fastest_motion():
    plain = base_motion_joint(*RIG)
    assert fastest(plain) == pytest.approx(np.sqrt(11000.0 / 3.0), rel=1e-3)
    assert default_panels(plain, 0.1) == PANELS
    quick = plain.with_effects(FlexibleLink(0.02, 0.02 * 900.0**2, 0.0))
    assert fastest(quick) > 900.0
    assert default_panels(quick, 1.0) > 40 * 900.0 / (2.0 * np.pi)
