"""A drive against an independent program: its coordinates, every port, dry friction at three of them, and the derivatives."""

import importlib.util
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.mechanics import Drive, catalogue
from jaxbacklash.parameters import ravel, specs, unravel
from jaxbacklash.solvers import run_panels
from tests.independent.drives import COLUMNS, DriveRig, followed, packed, run_held

from .test_gradients import central

pytestmark = pytest.mark.skipif(importlib.util.find_spec("numba") is None, reason="the other program needs numba")

RIG = DriveRig(6.0e-5, 1.5e-4, 50.0, 0.08, 0.012, 1500.0, 0.8)
LAWS = {
    "coulomb_motor": {"Tc": 0.012},
    "cogging": {"A": 0.02, "P": 7.0, "phi": 0.4},
    "coulomb_joint": {"Tc": 0.3},
    "coulomb_ground": {"Tc": 0.25},
    "gravity": {"G": -2.0, "phi0": 0.3},
    "preload": {"T0": 0.4},
    "torque_ripple": {"A": 0.3, "N": 20.0, "phi": 0.3},
    "transmission_error": {"e": 5e-4, "M": 20.0, "psi": 0.2},
    "cubic_stiffness": {"k3": 2e7},
    "contact_damping": {"cc": 0.6},
    "quadratic_drag": {"q": 0.05},
    "asymmetric_gap": {"z0": 0.001},
    "gap_spring": {"k1": 30.0},
    "load_friction": {"mu": 0.1},
    "second_play": {"J2": 0.03, "k2": 900.0, "c2": 0.15, "b2": 0.006},
}
STATES = (2, 3, 0, 1, 4, 5)
"""Columns of the other program's states that are y, dy, th, dth and those of a second link."""
DRY = ("coulomb_motor", "coulomb_joint", "coulomb_ground", "load_friction")
SMOOTH = tuple(name for name in LAWS if name not in (*DRY, "second_play"))
RATE, WINDOW, SECONDS, PARTS = 1000.0, 100, 3.0, 1000
CASES = {
    "bare": (), "motor": DRY[:1], "joint": DRY[1:2], "ground": DRY[2:3], "motor-joint": DRY[:2], "three ports": DRY[:3],
    "smooth laws": SMOOTH, "all laws": tuple(LAWS), "second play": ("second_play",),
    "second play-motor": ("second_play", *DRY[:1]),
}  # fmt: skip


def system(names):
    rig = jb.drive(*(getattr(RIG, n) for n in DriveRig.__dataclass_fields__))
    return rig.with_effects(*(catalogue()[name](**LAWS[name]) for name in names))


def torque():
    """What would move the axis as a multisine does, without play and friction, as a controller holds it."""
    _, speed = followed(RIG, np.random.default_rng(3), SECONDS, RATE)
    inertia = RIG.motor_inertia + RIG.inertia / RIG.ratio**2
    return 0.35 * (np.gradient(speed, 1.0 / RATE) * inertia + RIG.motor_damping * speed)


@pytest.fixture(scope="module")
def push():
    return torque()


def truth(names, push, parts=PARTS):
    return run_held(packed(RIG, {name: LAWS[name] for name in names}), np.zeros(6), push, 1.0 / RATE, parts)


@partial(jax.jit, static_argnames="finer")
def run(rig, states, push, finer):
    def one(state, push):
        push = jnp.repeat(push, finer)[: 1 - finer or None]
        zero = jnp.zeros_like(push)
        _, path = run_panels(rig, 0.0, state, Drive(zero, zero, zero, None, push), 1.0 / RATE / finer, finer, rig.switches)
        return jnp.stack(path[:4])

    return jax.vmap(one)(states, push)


@pytest.mark.parametrize(
    "case", [c if c in ("bare", "motor", "second play") else pytest.param(c, marks=pytest.mark.slow) for c in CASES]
)
def test_windows_follow_the_other_program(case, push):
    """Windows of a tenth of a second, each begun from the true state: what is left is the steps' error, and the other's.

    Steps of a sample; where several ports rub, or one beside a second play, which may all turn within one, of a quarter.
    """
    names = CASES[case]
    states = truth(names, push)
    first = WINDOW * np.arange(push.size // WINDOW)
    grid = first[:, None] + np.arange(WINDOW)
    begin = tuple(jnp.asarray(states[first, at]) for at in STATES[: 6 if "second_play" in names else 4])
    edges = np.append(push, push[-1])[first[:, None] + np.arange(WINDOW + 1)]
    found = np.asarray(run(system(names), begin, jnp.asarray(edges), 4 if len(set(names) & {*DRY, "second_play"}) > 1 else 1))
    error_y = np.abs(found[:, 0] - states[grid, 2])
    error_th = np.abs(found[:, 2] - states[grid, 0]) / RIG.ratio
    assert np.ptp(states[:, 2] - states[:, 0] / RIG.ratio) > 1.2 * RIG.backlash  # both edges are met
    for error in (error_y, error_th):
        assert np.median(error) < 1e-7
        assert np.quantile(error, 0.99) < 2e-6


def test_friction_sticks_at_each_port(push):
    """In the runs above motor, link and joint each stand still for a while, and two at once, or nothing was tested."""
    states = truth(DRY[:3], push)
    motor, link = states[:, 1] == 0.0, np.abs(states[:, 3]) < 1e-12
    joint = np.abs(states[:, 3] - states[:, 1] / RIG.ratio) < 1e-12
    for still in (motor & ~link, link & ~motor, joint & ~motor, motor & link):
        assert 0.001 < np.mean(still) < 0.9


def test_a_drive_that_hardly_moves_is_a_base_that_moves_as_prescribed():
    """A motor a million times as heavy as the link, turning at a steady speed, is a base at a steady speed."""
    joint = jb.base_motion_joint(0.08, 0.012, 1500.0, 0.8).with_effects(jb.Gravity(-2.0), jb.CoulombJoint(0.1))
    heavy = jb.drive(1e8, 0.0, 10.0, 0.08, 0.012, 1500.0, 0.8).with_effects(jb.Gravity(-2.0), jb.CoulombJoint(0.1))
    t = np.arange(1001) / 1000.0
    base = jb.Sampled(0.0, 0.001, jnp.asarray(0.3 * t), jnp.full(t.size, 0.3), jnp.zeros(t.size))
    prescribed = jb.simulate(joint, base, duration=1.0, rate=1000.0, y0=0.0, dy0=0.0)
    rest = jb.simulate(heavy, jb.HeldTorque(0.0, 0.001, np.zeros(2)), duration=1.0, rate=1000.0, y0=0.0, dy0=0.0, dth0=3.0)
    assert float(jnp.max(jnp.abs(prescribed.z))) > 0.006
    np.testing.assert_allclose(rest.y, prescribed.y, atol=2e-8)


def test_rates_in_parameters_and_state():
    """Derivatives of the equations of motion by every parameter and state, in the play and beyond either edge."""
    rig = system(tuple(LAWS))
    scale = np.maximum(np.abs(ravel(rig)), 1e-6)
    keep = [i for i, spec in enumerate(specs(rig).values()) if not spec.fixed] + list(range(scale.size, scale.size + 6))

    def rates(vector):
        found = unravel(rig, vector[: scale.size] * scale)
        state = tuple(vector[scale.size + i] for i in range(6))
        return jnp.stack(found.rates(0.4, state, Drive(0.0, 0.0, 0.1, None, 0.05)))

    exact, values = jax.jit(jax.jacfwd(rates)), jax.jit(rates)
    for z, dz in ((0.002, 0.3), (0.009, -0.4), (-0.008, 0.5)):
        th, dth = 4.0, 20.0
        at = np.concatenate([ravel(rig) / scale, [th / 50.0 + z, dth / 50.0 + dz, th, dth, th / 50.0 - 1.5 * z, 0.1]])
        difference = central(lambda v: np.asarray(values(v)), at)
        error = np.abs(np.asarray(exact(at)) - difference)[:, keep]
        assert np.max(error / (np.abs(difference[:, keep]).max(axis=1, keepdims=True) + 1e-3)) < 1e-6


@pytest.mark.parametrize(("case", "most"), [("smooth laws", 1e-4), ("motor", 2e-3), ("second play", 1e-4)])
def test_derivatives_across_contacts(case, most, push):
    """Derivatives of the motion by every parameter, through contacts and stops of the motor, against differences."""
    rig = system(CASES[case])
    vector = ravel(rig)
    free = np.array([i for i, spec in enumerate(specs(rig).values()) if not spec.fixed])
    states = truth(CASES[case], push, 100)
    z = states[:, 2] - states[:, 0] / RIG.ratio
    first = max(range(0, push.size - 200, 50), key=lambda k: min(z[k : k + 200].max(), -z[k : k + 200].min()))
    held = jnp.asarray(push[first : first + 201])
    zero = jnp.zeros_like(held)
    begin = tuple(jnp.asarray(states[first, at]) for at in STATES[: len(rig.state_names)])

    @jax.jit
    def motion(values):
        moved = unravel(rig, vector * jnp.ones(vector.size).at[free].set(values))
        _, path = run_panels(moved, 0.0, begin, Drive(zero, zero, zero, None, held), 1.0 / RATE, 1, True)
        return jnp.stack([path[0], path[2] / RIG.ratio])[:, ::5]

    one = np.ones(free.size)
    y, x = np.asarray(motion(one))
    assert (y - x).max() > 0.5 * RIG.backlash
    assert (y - x).min() < -0.5 * RIG.backlash
    exact = np.asarray(jax.jit(jax.jacfwd(motion))(one)).reshape(-1, free.size)
    difference = central(lambda v: np.asarray(motion(v)).ravel(), one, rel=1e-5)
    error = np.abs(exact - difference) / (np.abs(difference).max(axis=0) + 1e-12)
    assert np.quantile(error, 0.98) < most


def test_every_law_here_is_in_the_other_program():
    assert set(LAWS) == set(COLUMNS)
