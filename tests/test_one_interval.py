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


@pytest.mark.parametrize("missing", ["cubic_stiffness", None], ids=["incomplete", "right"])
def test_fit_and_refine_give_one_interval(missing):
    record, rig, _, _ = hidden(missing, "multisine", 7, seconds=8.0)
    fitted = jb.fit(record, inertia=rig.inertia, starts=1)
    refined = refined_base(record, rig.inertia)
    assert refined.tied == fitted.tied == (missing is None)
    assert fitted.adequate == (missing is None)
    for name, one in fitted.parameters.items():
        other = refined.parameters[name]
        assert one.stderr == pytest.approx(other.stderr, rel=0.05), name
        assert abs(one.value - other.value) < 0.3 * one.stderr
    assert np.allclose(fitted.covariance, fitted.covariance.T)
