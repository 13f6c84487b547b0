"""The loop names what is hidden, leaves clean records alone, and admits what it does not know."""

import json
from pathlib import Path

import numpy as np
import pytest

import jaxbacklash as jb

pytest.importorskip("numba")

from jaxbacklash.records import Record, read_record
from tests.independent.generator import make_excitation, measure, simulate_truth
from tests.independent.rigs import Rig

RIG = Rig(inertia=3.1, backlash=0.025, stiffness=12500.0, damping=20.0)
SHARED = Path(__file__).parents[2] / "shared" / "records"
DURATION = 10.0

HIDDEN = {
    "nothing": {},
    "gravity": {"gravity": {"G": -30.0}},
    "coulomb_joint": {"coulomb_joint": {"Tc": 3.5}},
    "gap_spring and preload": {"gap_spring": {"k1": 400.0, "z0": 0.0}, "preload": {"T0": 6.0}},
}
ONE_WITH_ANOTHER = {"preload"}
"""A load moves the place where a spring across the joint rests, and nothing else: the spring alone names both."""
SLOW = ("coulomb_joint", "gap_spring and preload")


def record(effects, seed=3, sigma=3e-5):
    rng = np.random.default_rng(seed)
    truth = simulate_truth(RIG, effects, make_excitation(rng, "multisine", DURATION), 500.0, DURATION)
    seen = measure(truth, rng, sigma, sigma)
    return Record(seen["t"], {"x": seen["x"], "z": seen["z"]})


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] if n in SLOW else []) for n in HIDDEN])
def test_names_what_is_hidden(name):
    told = []
    found = jb.refine(record(HIDDEN[name]), inertia=RIG.inertia, settled=told.append)
    assert set(found.effects) == set(HIDDEN[name]) - ONE_WITH_ANOTHER
    assert [fit is found.fit for fit in told] == [False] * (len(told) - 1) + [True]
    assert found.verdict.complete
    assert found.fit.score.median < 1.05
    for parameter in ("backlash", "stiffness", "damping"):
        estimate = found.fit.parameters[parameter]
        assert abs(estimate.value - getattr(RIG, parameter)) < 4.0 * estimate.stderr


@pytest.mark.slow
def test_names_friction_with_a_memory_and_nothing_beside_it():
    hidden = {"lugre": {"sigma0": 4000.0, "sigma1": 3.0, "Fc": 4.0, "Fs": 7.0, "vs": 0.1}}
    found = jb.refine(record(hidden), inertia=RIG.inertia)
    assert len(found.effects) == 1
    assert found.effects[0] in ("dahl", "lugre", "bouc_wen")
    assert found.verdict.complete


@pytest.mark.slow
def test_admits_what_it_does_not_know():
    found = jb.refine(record({"rumble": {"A": 3.0}}), inertia=RIG.inertia)
    assert not found.verdict.complete
    assert "ncomplete" in found.verdict.text


@pytest.mark.slow
@pytest.mark.skipif(not SHARED.is_dir(), reason="the practice records are not beside the project")
@pytest.mark.parametrize("name", ["p01", "p04", "p09", "p13", "p16"])
def test_practice_records(name):
    answer = json.loads((SHARED / name / "answer.json").read_text())
    held = read_record(SHARED / name / "heldout.csv")
    found = jb.refine(read_record(SHARED / name / "train.csv"), heldout=held, inertia=answer["truth"]["J"])
    assert sorted(found.effects) == sorted(answer["effects"])
    assert found.verdict.complete
    assert found.fit.score.median < 1.05
    assert found.fit.heldout.median < 1.1


@pytest.mark.slow
def test_what_a_held_out_record_does_not_bear_out_is_not_added():
    """The second record is of the same joint after what had pulled at it was taken away."""
    found = jb.refine(record(HIDDEN["gravity"]), heldout=record({}, seed=4), inertia=RIG.inertia)
    assert found.effects == ()
    assert not found.verdict.complete
    assert "gravity would lower the error here" in found.verdict.text
    assert found.verdict.text.endswith("it is not added.")
