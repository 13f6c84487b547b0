"""Dry friction with a width: the same problem otherwise, and the nearer to dry friction the smaller the width."""

from dataclasses import replace

import equinox as eqx
import numpy as np
import pytest

from jaxbacklash.fitting.continuation import softer
from jaxbacklash.fitting.fit import prepare
from jaxbacklash.fitting.friction_homotopy import sliding_speeds, with_friction_widths
from jaxbacklash.fitting.setup import base_system, first_guess, make_problem
from jaxbacklash.mechanics import catalogue
from jaxbacklash.parameters import values
from jaxbacklash.shooting.multiple_shooting import predictions
from jaxbacklash.shooting.windows import Windows

from .hidden import hidden


def test_the_smaller_the_width_the_nearer_to_dry_friction():
    record, rig, effects, _ = hidden("coulomb_joint", "chirp", 5, 4.0)
    base, free, _ = base_system(record, "joint", rig.inertia)
    system = replace(base, effects={n: catalogue()[n](**v) for n, v in effects.items()})
    problem = make_problem(system, prepare(system, [record], 0.2)[0], free)
    guess = first_guess(problem)
    run = eqx.filter_jit(predictions)
    dry = np.asarray(run(problem, guess).motion)
    apart = []
    for width in (0.1, 0.03, 0.01):
        wide = with_friction_widths(problem, {"coulomb_joint": width})
        assert wide.system.slides == ()
        assert float(values(wide.rebuild(guess.theta))["coulomb_joint.width"]) == width
        apart.append(float(np.sqrt(np.mean((np.asarray(run(wide, guess).motion) - dry) ** 2))))
    assert apart[0] > 1.5 * apart[1] > 1.5**2 * apart[2] > 0.0
    # All else is the same problem.
    assert isinstance(wide.windows, Windows)
    assert bool(eqx.tree_equal(wide.windows, problem.windows))
    assert problem.system.slides == ("joint",)
    # A law that states no width is left as it is.
    assert np.array_equal(with_friction_widths(problem, {"gravity": 0.1}).base, problem.base)


def test_friction_that_falls_with_speed_is_softened_over_less_than_its_own_speed():
    # Over as much as that it would be another law, whose fit makes up for what the softening took.
    record, rig, *_ = hidden("stribeck", "chirp", 5, 4.0)
    base, free, _ = base_system(record, "joint", rig.inertia)
    system = replace(base, effects={"stribeck": catalogue()["stribeck"](1.0, 2.0, 0.1)})
    problem = make_problem(system, prepare(system, [record], 0.2)[0], [*free, "stribeck.vs"])
    guess = first_guess(problem)
    sliding = sliding_speeds(problem)["stribeck"]
    assert sliding > 0.3
    width = lambda at: float(values(at.rebuild(guess.theta))["stribeck.width"])  # noqa: E731
    assert width(softer(problem, {"stribeck": sliding}, 0.02, guess)) == pytest.approx(0.02 * 0.1)
    assert width(softer(problem, {"stribeck": 0.05}, 0.02, guess)) == pytest.approx(0.02 * 0.05)
