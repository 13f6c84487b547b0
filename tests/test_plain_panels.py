"""Panels of a linear joint: those that stay on a side of the play by its map, and all of them differentiated one by one."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxbacklash.effects.loads import Gravity
from jaxbacklash.fitting.fit import prepare
from jaxbacklash.fitting.setup import make_problem
from jaxbacklash.models import base_motion_joint, linear_oscillator
from jaxbacklash.records import Record
from jaxbacklash.shooting.panel_tangents import panel_matrices, plain_of
from jaxbacklash.solvers.plain_panels import is_linear

JOINTS = {"play": base_motion_joint(3.0, 0.026, 13000.0, 12.0), "no play": linear_oscillator(3.0, 13000.0, 12.0)}
DRIVES = {"base motion": ("x", "z"), "force": ("F", "y")}
CASES = [(joint, drive) for joint in JOINTS for drive in DRIVES]


def record(drive, rng):
    """Any motion will do: the panels are begun anywhere."""
    t = np.arange(1000) / 500.0
    first, second = DRIVES[drive]
    size = 300.0 if drive == "force" else 0.3
    return Record(
        t, {first: size * np.sin(9.0 * t) + 1e-3 * size * rng.normal(size=t.size), second: 0.02 * np.sin(9.0 * t - 0.2)}
    )


@pytest.mark.parametrize(("joint", "drive"), [CASES[0], *(pytest.param(*case, marks=pytest.mark.slow) for case in CASES[1:])])
def test_the_map_of_a_side_is_that_of_its_panels(joint, drive):
    """At random states across the play: on a side, from side to side, and through the play within one panel."""
    rng = np.random.default_rng(7)
    system = JOINTS[joint]
    windows = prepare(system, [record(drive, rng)], 0.2)[0]
    free = [name for name in ("backlash", "stiffness", "damping") if joint == "play" or name != "backlash"]
    problem = make_problem(system, windows, free)
    count, edges = windows.force.shape
    x, dx = (rng.normal(0.0, size, (count, edges)) for size in (0.01, 2.0))
    moving = 0.0 if windows.by_force else 1.0
    states = (
        moving * x[:, :-1] + rng.normal(0.0, 0.014, (count, edges - 1)),
        moving * dx[:, :-1] + rng.normal(0.0, 3.0, (count, edges - 1)),
    )
    scale = 1.0 if moving else 1e4
    theta = 0.1 * rng.normal(size=problem.directions.shape[1])

    def both(states, u, du):
        plain = plain_of(windows, problem.rebuild, theta)
        found = lambda plain: panel_matrices(windows, problem.rebuild, theta, problem.active, plain, states, u, du)  # noqa: E731
        return found(plain), found(None)

    by_map, one_by_one = jax.jit(both)(tuple(map(jnp.asarray, states)), scale * x, scale * dx)
    size = np.maximum(np.max(np.abs(one_by_one), axis=(0, 3), keepdims=True), 1e-300)  # some directions are not there
    np.testing.assert_allclose(by_map / size, one_by_one / size, atol=1e-12)
    assert int(problem.active) == len(free)


def test_what_bends_a_joint_is_not_linear():
    assert is_linear(JOINTS["play"])
    assert is_linear(JOINTS["no play"])
    assert not is_linear(JOINTS["play"].with_effects(Gravity(-20.0)))
