"""A score says what a model misses by, not what a search of the windows' starts has left behind."""

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.fitting.fit import prepare
from jaxbacklash.fitting.score import score
from jaxbacklash.fitting.setup import base_system, first_guess, free_names, make_problem
from jaxbacklash.parameters import with_values
from jaxbacklash.shooting.problem import Unknowns
from tests.hidden import hidden


@pytest.fixture(scope="module")
def true():
    """The true model of a joint with dry friction, its windows, and where a search of their starts begins."""
    record, rig, _, _ = hidden("coulomb_joint", "multisine", 5, seconds=8.0, Tc=8.0)
    base, _, _ = base_system(record, "joint", rig.inertia)
    joint = with_values(base, {name: getattr(rig, name) for name in ("backlash", "stiffness", "damping")})
    system = joint.with_effects(jb.CoulombJoint(8.0))
    windows, layout, group = prepare(system, [record], 0.2)
    problem = make_problem(system, windows, free_names(system))
    return problem, first_guess(problem), layout, group


@pytest.mark.parametrize(
    ("windows", "off"), [((0,), (0.02, 0.0)), ((0,), (0.3, 30.0)), ((0, 21), (-0.3, -10.0))], ids=["near", "far", "two"]
)
def test_a_few_windows_that_begin_elsewhere_spoil_no_score(true, windows, off):
    problem, guess, layout, group = true
    right = score(problem, guess, layout, group=group)[0][0]
    assert right.rms < 1.05
    starts = np.array(guess.starts)
    starts[:, list(windows)] += np.array(off)[:, None]
    begin = Unknowns(guess.theta, starts, guess.coefficients)
    found = score(problem, begin, layout, group=group)[0][0]
    assert found.rms == pytest.approx(right.rms, rel=0.01)
    assert found.median == pytest.approx(right.median, rel=0.01)
