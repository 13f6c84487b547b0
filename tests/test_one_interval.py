"""One model of one record has one interval, whether `fit` or `refine` asks for it."""

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.refine import _Judge
from tests.hidden import fitter, hidden


def refined_base(record, inertia):
    """The base model as `refine` tells it."""
    own = fitter(record, inertia, window=None)
    return _Judge(own, None, "joint", False, False, None)(own.fit_model({}))


@pytest.mark.slow
def test_fit_and_refine_give_one_interval():
    record, rig, _, _ = hidden(None, "multisine", 7, seconds=8.0)
    fitted = jb.fit(record, inertia=rig.inertia, starts=1)
    refined = refined_base(record, rig.inertia)
    assert refined.tied
    assert fitted.tied
    assert fitted.adequate
    for name, one in fitted.parameters.items():
        other = refined.parameters[name]
        assert one.stderr == pytest.approx(other.stderr, rel=0.05), name
        assert abs(one.value - other.value) < 0.3 * one.stderr
    assert np.allclose(fitted.covariance, fitted.covariance.T)


@pytest.mark.slow
def test_fit_and_refine_give_one_standard_error_of_a_model_that_lacks_something_and_no_interval():
    record, _ = jb.demo_records()
    fitted, refined = jb.fit(record, inertia=3.16, starts=1), refined_base(record, 3.16)
    for found in (fitted, refined):
        assert not found.tied
        assert not found.adequate
        assert "95 %" not in str(found).split("parameters")[-1]
    for name, one in fitted.parameters.items():
        other = refined.parameters[name]
        assert one.stderr == pytest.approx(other.stderr, rel=0.05), name
        assert abs(one.value - other.value) < 0.1 * one.stderr
