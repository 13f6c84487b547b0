"""A richer law in place of a simpler one begins at the shape that the trajectory finds likeliest."""

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.candidates import contained, rank, reshaped
from jaxbacklash.criticism.workbench import Workbench
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.parameters import with_values
from tests.hidden import hidden

TRUTH = {"Tc": 6.0, "Ts": 12.0, "vs": 0.2}


@pytest.fixture(scope="module")
def beside_coulomb():
    record, rig, _, _ = hidden("stribeck", "multisine", 5, **TRUTH)
    base, free, _ = base_system(record, "joint", rig.inertia)
    bench = Workbench(record, base, free, 0.2)
    loose = bench.fit({"coulomb_joint": jb.CoulombJoint(6.0)}, patience=60)
    return bench, bench.fit(bench.effects(loose), loose, tied=True, patience=60)


def test_its_strengths_are_what_it_adds_to_the_simpler_law(beside_coulomb):
    bench, coulomb = beside_coulomb
    held = coulomb.value["coulomb_joint.Tc"]
    law = bench.laws["stribeck"]
    assert contained(bench, coulomb, law) == {"coulomb_joint.Tc": held}
    assert contained(bench, coulomb, bench.laws["gravity"]) == {}
    found = reshaped(bench, coulomb, "stribeck")
    assert "coulomb_joint.Tc" not in found.moved
    assert found.gain > 100.0
    assert float(found.effect.Ts) + held == pytest.approx(TRUTH["Ts"], rel=0.5)
    # In fast sliding less is left than the one level that Coulomb friction had to settle for.
    assert -held < float(found.effect.Tc) < 0.0


def test_beside_the_simpler_law_it_would_have_to_be_above_nothing(beside_coulomb):
    """The ranking for the user adds it to what is there, which a fall with speed cannot do: there its bounds hold for itself."""
    bench, coulomb = beside_coulomb
    beside = next(c for c in rank(bench, coulomb) if c.name == "stribeck")
    assert float(beside.effect.Tc) >= 0.0


def test_it_takes_the_shape_that_the_trajectory_asks_for(beside_coulomb, monkeypatch):
    bench, coulomb = beside_coulomb
    shapes = [jb.effects.Stribeck(1.0, 2.0, vs) for vs in (3.0, TRUTH["vs"], 0.01)]
    monkeypatch.setattr(bench.laws["stribeck"], "guesses", classmethod(lambda cls, system, motion=None: shapes))
    found = reshaped(bench, coulomb, "stribeck")
    assert float(found.effect.vs) == TRUTH["vs"]
    held = coulomb.value["coulomb_joint.Tc"]
    effect = with_values(found.effect, {n: float(getattr(found.effect, n)) + held for n in ("Tc", "Ts")})
    fitted = bench.fit({"stribeck": effect}, coulomb, tied=True, patience=60)
    assert fitted.cost < coulomb.cost - 50.0
    np.testing.assert_allclose([fitted.value[f"stribeck.{n}"] for n in TRUTH], list(TRUTH.values()), rtol=0.1)
