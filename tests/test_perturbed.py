"""A blurred sensor beside a fitted delay: seen where a channel was read along straight lines, and no torque then."""

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

import jaxbacklash as jb
from jaxbacklash.criticism.perturbed import blurred
from jaxbacklash.criticism.unnamed import unnamed
from jaxbacklash.records import Record

from .hidden import NOISE, fitter, hidden

pytestmark = pytest.mark.slow


def read_late(seed, line):
    """The fitter of every second sample of a record, z a sample and a half late and read along a line between two samples or as
    it was, and the joint with a delay fitted to it."""
    record, rig, _, truth = hidden(None, "stepped", seed)
    t, z, speed = record.t[::2], truth["z"][::2], (truth["v"] - truth["dx"])[::2]
    delay = 1.5 * (t[1] - t[0])
    late = np.maximum(t - delay, 0.0)
    shown = np.interp(late, t, z) if line else CubicHermiteSpline(t, z, speed)(late)
    shown = shown + NOISE * np.random.default_rng(3).standard_normal(t.size)
    own = fitter(Record(t, {"x": record.channels["x"][::2], "z": shown}), rig.inertia)
    return own, own.fit_model({"sensor_delay": jb.SensorDelay(delay)})


@pytest.mark.parametrize("line", [False, True])
def test_a_delay_that_is_read_along_a_line_between_samples_blurs(line):
    taken = blurred(*read_late(2, line))
    assert taken > 50.0 if line else taken < 8.0


def test_what_a_blur_explains_as_well_is_no_unnamed_torque(monkeypatch):
    own, model = read_late(5, True)
    assert unnamed(own, model) is None
    monkeypatch.setattr("jaxbacklash.criticism.unnamed.blurred", lambda *_: 0.0)
    assert unnamed(own, model) is not None
