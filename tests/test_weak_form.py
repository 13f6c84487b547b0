"""Weak-form regression: a shape that runs away along the motion is passed over, without a word from NumPy."""

import warnings

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.regression import weak_form
from jaxbacklash.regression.weak_form import WeakForm
from tests.hidden import hidden


@pytest.mark.parametrize("far", [1e200, np.inf, np.nan])
def test_a_shape_that_runs_away_speaks_for_nothing(monkeypatch, far):
    record, rig, _, _ = hidden("gravity", "chirp", 5, G=-40.0)
    joint, free, _ = base_system(record, "joint", rig.inertia)
    shapes = [jb.Gravity(-20.0), jb.Gravity(-30.0)]

    def own_torques(shapes, system, m):
        torques = real(shapes, system, m)
        torques[0, -50:] = far
        return torques

    seen = WeakForm(record).evidence(joint, free, shapes)
    real = weak_form.own_torques
    monkeypatch.setattr(weak_form, "own_torques", own_torques)
    form = WeakForm(record)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert form.choose(joint, free, shapes) == [shapes[1]]
        assert form.evidence(joint, free, shapes) == pytest.approx(seen)
    assert seen > 100.0
