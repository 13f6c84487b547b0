"""The quick look at what is missing: a shape that runs away along the motion is passed over, without a word from NumPy."""

import warnings

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism import quick_look
from jaxbacklash.criticism.quick_look import QuickLook
from jaxbacklash.criticism.tuning import lead, tune
from jaxbacklash.criticism.yielding import FAR
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.mechanics import catalogue
from jaxbacklash.parameters import with_values
from tests.hidden import hidden, noisier


@pytest.mark.parametrize("far", [1e200, np.inf, np.nan])
def test_a_shape_that_runs_away_speaks_for_nothing(monkeypatch, far):
    record, rig, _, _ = hidden("gravity", "chirp", 5, G=-40.0)
    joint, free, _ = base_system(record, "joint", rig.inertia)
    shapes = [jb.Gravity(-20.0), jb.Gravity(-30.0)]

    def own_torques(shapes, system, m):
        torques = real(shapes, system, m)
        torques[0, -50:] = far
        return torques

    seen = QuickLook(record).evidence(joint, free, shapes)
    real = quick_look.own_torques
    monkeypatch.setattr(quick_look, "own_torques", own_torques)
    look = QuickLook(record)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert look.choose(joint, free, shapes) == [shapes[1]]
        assert look.evidence(joint, free, shapes) == pytest.approx(seen)
    assert seen > 100.0


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize(("name", "times"), [("dahl", 1.0), ("dahl", 10.0), ("coulomb_joint", 1.0), ("coulomb_joint", 30.0)])
def test_dry_friction_is_far_behind_what_gives_only_where_that_is_the_truth(name, times, seed):
    """Noise turns dry friction over, so that it is behind a little where it is the truth."""
    record, rig, _, _ = hidden(name, "chirp", 40 + seed)
    record = noisier(record, times, seed) if times > 1.0 else record
    joint, free, _ = base_system(record, "joint", rig.inertia)
    truth = {"backlash": rig.backlash, "stiffness": rig.stiffness, "damping": rig.damping}
    joint, look = with_values(joint, truth), QuickLook(record)
    tuned = tune(look, joint, free, jb.Dahl.guesses(joint, look.motion))
    behind = lead(look, free, tuned, joint, [([jb.CoulombJoint(1.0)], 1)]) / (2.0 * np.log(len(catalogue())))
    assert behind > FAR if name == "dahl" else behind < 0.5 * FAR
