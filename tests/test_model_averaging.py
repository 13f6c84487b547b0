"""Intervals that allow for models which the record cannot tell apart: against the mixture of their distributions."""

from types import SimpleNamespace

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.model_averaging import averaged, between
from jaxbacklash.fitting.result import Fit

JOINT = {"backlash": 0.02, "stiffness": 1e4, "damping": 5.0}


def model(criterion, **values):
    return SimpleNamespace(value=values, criterion=criterion, deflation=1.0)


def test_the_spread_is_that_of_the_mixture():
    """Drawn: a model by its weight, then the parameters it has; about the values kept, their mean square is what is said."""
    kept = model(100.0, **JOINT, **{"dahl.Fc": 2.0})
    others = [model(101.0, **{**JOINT, "damping": 6.0}), model(98.5, **{**JOINT, "backlash": 0.0203, "damping": 4.0}, k1=3.0)]
    weights = np.exp(-0.5 * np.array([100.0, 101.0, 98.5]))
    weights /= weights.sum()
    values = np.array([[m.value.get(n, kept.value[n]) for n in kept.value] for m in (kept, *others)])
    drawn = values[np.random.default_rng(1).choice(3, 200_000, p=weights)] - values[0]
    np.testing.assert_allclose(between(kept, others), drawn.T @ drawn / len(drawn), rtol=0.02)
    assert between(kept, others)[3, 3] == 0.0  # nobody else has it


@pytest.mark.parametrize("behind", [0.0, 6.0])
def test_a_fit_allows_for_what_does_as_well(behind):
    system = jb.base_motion_joint(inertia=3.0, **JOINT)
    t = np.linspace(0.0, 2.0, 1001)
    record = jb.Record(t, {"x": 0.1 * np.sin(9.0 * t), "z": 0.03 * np.sin(9.0 * t)})
    own = np.diag([1e-6, 50.0, 0.02]) ** 2
    fit = Fit(system, tuple(JOINT), {}, (), None, (record,), (), (), own, 1, 1, True, 0.0, 0, None, "joint", False, False)
    kept, other = model(0.0, **JOINT), model(behind, **{**JOINT, "damping": 5.4})
    found = averaged(fit, kept, [other])
    share = 1.0 / (1.0 + np.exp(0.5 * behind))
    assert found.parameters["damping"].stderr == pytest.approx(np.hypot(0.02, 0.4 * np.sqrt(share)))
    assert found.parameters["damping"].value == pytest.approx(5.0)
    assert found.parameters["stiffness"].stderr == pytest.approx(50.0)
    assert np.all(np.linalg.eigvalsh(found.covariance) > 0.0)


def test_without_others_that_compare_nothing_changes():
    fit, kept = object(), model(0.0, **JOINT)
    assert averaged(fit, kept, []) is fit
    assert averaged(fit, kept, [model(0.0, **JOINT)]) is fit
