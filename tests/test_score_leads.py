"""A score is not spoilt by what a law remembers, where a fit had let its windows go or nothing but the record is known."""

import numpy as np
import pytest

from jaxbacklash.effects import Dahl
from jaxbacklash.fitting.compare import compare
from jaxbacklash.fitting.score import score
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.parameters import with_values
from jaxbacklash.shooting.problem import Unknowns
from tests.hidden import fitter, hidden, noisier


@pytest.fixture(scope="module")
def fitted():
    """What fits a record, the problem of a joint that rubs as Dahl says, and the unknowns of its fitted trajectory."""
    record, rig, _, _ = hidden("dahl", "multisine", 21, seconds=8.0, sigma=2000.0, Fc=6.0)
    own = fitter(record, rig.inertia)
    model = own.fit_model({"dahl": Dahl(6.0, 2000.0)})
    problem, _ = own.problem(own.effects(model), model.system)
    return own, problem, Unknowns(np.zeros(problem.directions.shape[1]), model.unknowns.starts, model.unknowns.coefficients)


def jumping(unknowns, *windows, to=7000.0):
    starts = np.array(unknowns.starts)
    starts[2, list(windows)] = to
    return Unknowns(unknowns.theta, starts, unknowns.coefficients)


@pytest.mark.parametrize("every", [1, 6], ids=["all", "a few"])
def test_windows_whose_memory_jumps_are_joined_again(fitted, every):
    own, problem, unknowns = fitted
    right = score(problem, unknowns, own.layout, group=own.group)[0][0]
    assert right.rms < 1.05
    inner = [k for k in range(own.layout.windows[0]) if k % own.group][::every]
    found = score(problem, jumping(unknowns, *inner), own.layout, group=own.group)[0][0]
    assert found.rms == pytest.approx(right.rms, rel=0.02)
    assert found.median == pytest.approx(right.median, rel=0.02)


KINDS = ("chirp", 21, 1), ("multisine", 22, 1), ("modulated", 22, 1), ("chirp", 22, 30)


@pytest.mark.parametrize(("kind", "seed", "times"), KINDS)
def test_a_true_model_predicts_a_record_of_which_nothing_else_is_known(kind, seed, times):
    record, rig, _, _ = hidden("dahl", kind, seed, seconds=8.0, sigma=2000.0, Fc=6.0)
    base, _, _ = base_system(record, "joint", rig.inertia)
    true = with_values(base, {name: getattr(rig, name) for name in ("backlash", "stiffness", "damping")})
    score = compare(true.with_effects(Dahl(6.0, 2000.0)), noisier(record, times, seed)).score
    assert score.median < 1.05
    assert score.rms < 1.05
