"""A joint that moves further than is believed without being told the unit: what is told once holds for all that is made of it."""

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.excitation import Harmonic
from jaxbacklash.records import Record
from jaxbacklash.simulation import as_record
from tests.hidden import hidden

TIMES = 40.0
"""A joint without weight and friction moves so many times as far where its play and its base are so many times as large."""


@pytest.mark.slow
def test_a_confirmed_record_is_refined_to_its_end():
    record, rig, _, _ = hidden(None, "chirp", 5)
    wide = {name: TIMES * values for name, values in record.channels.items()}
    assert max(np.ptp(values) for values in wide.values()) > 2.5
    with pytest.raises(jb.BadInput, match="radians"):
        Record(record.t, wide)
    found = jb.refine(Record(record.t, wide, confirmed=frozenset(wide)), inertia=rig.inertia)
    assert found.effects == ()
    assert found.verdict.complete
    assert float(found.fit.system.contact.backlash) == pytest.approx(TIMES * rig.backlash, rel=0.01)


def test_a_simulated_motion_is_in_radians_however_large():
    joint = jb.base_motion_joint(inertia=3.0, backlash=4.0, stiffness=1e4, damping=20.0)
    record = as_record(jb.simulate(joint, Harmonic(3.0, 5.0), duration=3.0, rate=200.0), joint)
    assert np.ptp(record.channels["z"]) > 2.5
