"""Which law of a family with a memory stands first."""

from types import SimpleNamespace

import numpy as np
import pytest

from jaxbacklash.criticism import memories
from jaxbacklash.criticism.evidence import demanded
from jaxbacklash.effects import Contact, Damper
from jaxbacklash.effects.hysteresis import Dahl, Lugre
from jaxbacklash.system import System


@pytest.fixture
def bench():
    """No effect in the model yet, and a quick look that is told what to find."""
    laws = {"dahl": Dahl, "lugre": Lugre}
    return SimpleNamespace(laws=laws, quick=SimpleNamespace(blind=False, motion=None), effects=lambda trial: {})


@pytest.mark.parametrize(("ahead", "first"), [(0.5, "dahl"), (0.9, "dahl"), (1.1, "lugre"), (-1.0, "dahl")])
def test_the_simplest_goes_first_unless_another_is_likelier_by_what_an_addition_must_bring(monkeypatch, bench, ahead, first):
    leads = {Dahl: 900.0, Lugre: 900.0 + ahead * demanded(bench)}
    counts = {Dahl: 2, Lugre: 5}

    def tune(quick, system, free, variants):
        kind = type(variants[0])
        return memories.Tuned(variants[0], system, np.zeros(3), counts[kind])

    monkeypatch.setattr(memories, "tune", tune)
    monkeypatch.setattr(memories, "lead", lambda quick, free, tuned, system, rivals: leads[type(tuned.effect)])
    joint = System(3.0, Contact(0.02, 1e4), Damper(10.0), {}, "z")
    trial = SimpleNamespace(names=frozenset(), system=joint, free=("backlash", "stiffness"))
    seen = []
    found = memories.members(bench, trial, ["dahl", "lugre"], seen=seen.append)
    assert found[0].name == first
    assert sorted(m.name for m in found) == ["dahl", "lugre"]
    assert [m.name for m in seen] == ["dahl"]
