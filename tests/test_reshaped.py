"""A richer law in place of a simpler one begins at the shape that the trajectory finds likeliest."""

from types import SimpleNamespace

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism import unseen as module
from jaxbacklash.criticism.candidates import Candidate, contained, rank, reshaped
from jaxbacklash.criticism.unseen import Unseen
from jaxbacklash.criticism.workbench import Workbench
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.parameters import with_values
from tests.hidden import hidden

from .number_models import Model

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


@pytest.mark.parametrize(
    ("untold", "gain", "second", "tries", "kept"),
    [
        (False, 10.0, 940.0, 0, None),  # the quick look could tell, and put others first
        (False, 60.0, 940.0, 0, 990.0),  # the trajectory promises it clearly, whatever the quick look says
        (True, 60.0, 940.0, 1, 940.0),
        (True, 60.0, 995.0, 1, 990.0),  # from there it has stuck: what came of the quick look's shape stays
        (True, 10.0, 940.0, 0, 990.0),  # it promises no more than has come already
    ],
)
def test_it_is_tried_beside_the_quick_looks_where_that_cannot_tell(monkeypatch, untold, gain, second, tries, kept):
    names, fitted = frozenset({"stribeck"}), []
    bench = SimpleNamespace(laws={"stribeck": jb.effects.Stribeck, "coulomb_joint": jb.CoulombJoint})
    bench.record = SimpleNamespace(samples=5000)
    bench.effects = lambda trial: {"coulomb_joint": jb.CoulombJoint(3.0)}
    bench.fit = lambda effects, *_, **__: fitted.append(effects) or Model(names, cost=second)
    search = Unseen(bench)
    coulomb, found = Model(frozenset({"coulomb_joint"}), cost=1000.0), Model(names, cost=990.0)
    monkeypatch.setattr(search, "add", lambda before, candidate: search.keep(found))
    monkeypatch.setattr(search, "untold", lambda trial, dry, name: [jb.CoulombJoint()] if untold else [])
    shaped = Candidate("stribeck", jb.effects.Stribeck(-1.0, 4.0, 0.2), gain, 1.0, {})
    monkeypatch.setattr(module, "reshaped", lambda *of: shaped)
    tried = search.richer(coulomb, [Candidate("stribeck", jb.effects.Stribeck(), 0.0, 1.0, {})])
    assert len(fitted) == tries
    assert (tried["stribeck"].cost if tried else None) == kept
    for effects in fitted:
        assert list(effects) == ["stribeck"]
        assert (float(effects["stribeck"].Tc), float(effects["stribeck"].Ts)) == (2.0, 7.0)
