"""A strength that stands at the end of the range that physics allows explains nothing."""

from types import SimpleNamespace

import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.evidence import at_a_limit
from jaxbacklash.criticism.verdict import judge_rest


@pytest.mark.parametrize(("g", "limit"), [(2.0, True), (0.5, True), (1.0, False), (1.9, False)])
def test_a_strength_at_the_end_of_its_range_explains_nothing(g, limit):
    joint = jb.base_motion_joint(inertia=3.0, backlash=0.02, stiffness=1e4, damping=20.0)
    names, system = frozenset({"sensor_gain"}), joint.with_effects(jb.SensorGain(g))
    final = SimpleNamespace(system=system, names=names, free=("sensor_gain.g",), misfit=1.0, freedom=1e4)
    score = SimpleNamespace(rms=1.0, median=1.0, nrmse=0.01, observed="z")
    said = judge_rest(final, [SimpleNamespace(score=score, heldout=None)] * 2)
    assert at_a_limit(final, "sensor_gain") == limit
    assert said.complete == (not limit)
    assert ("end of its range" in said.text) == limit
