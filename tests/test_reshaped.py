"""A richer law in place of a simpler one begins at the shape that the trajectory finds likeliest."""

from types import SimpleNamespace

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism import reshaping
from jaxbacklash.criticism import unseen as module
from jaxbacklash.criticism.candidates import Candidate, contained, rank, reshaped
from jaxbacklash.criticism.evidence import demanded, gain
from jaxbacklash.criticism.search import Search
from jaxbacklash.criticism.steps import Step
from jaxbacklash.criticism.unseen import Unseen
from jaxbacklash.criticism.workbench import Workbench
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.parameters import with_values
from tests.hidden import hidden, noisier

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


def test_a_search_that_ends_with_the_simpler_law_asks_for_the_richer_one_at_another_shape():
    truth = {"Tc": 6.0, "Ts": 8.0, "vs": 0.3}
    record, rig, _, _ = hidden("stribeck", "multisine", 5, **truth)
    base, free, _ = base_system(noisier(record, 30.0, 1), "joint", rig.inertia)
    bench = Workbench(noisier(record, 30.0, 1), base, free, 0.2)
    loose = bench.fit({"coulomb_joint": jb.CoulombJoint(6.0)}, patience=60)
    coulomb = bench.fit(bench.effects(loose), loose, tied=True, patience=60)
    search = Search(bench)
    nowhere = with_values(bench.laws["stribeck"](), {"Tc": coulomb.value["coulomb_joint.Tc"], "Ts": 20.0, "vs": 1e-5})
    stuck = search.keep(bench.fit({"stribeck": nowhere}, coulomb, tied=True))
    assert gain(coulomb, stuck) < demanded(bench)  # there it does nothing, and no step leads away
    path = reshaping.reshaped_at_last(search, [Step(coulomb, "coulomb_joint", (), ())])
    assert [(s.added, s.dropped) for s in path[1:]] == [("stribeck", ("coulomb_joint",))]
    np.testing.assert_allclose([path[-1].trial.value[f"stribeck.{n}"] for n in truth], list(truth.values()), rtol=0.2)


def test_a_search_that_ends_with_the_simpler_law_keeps_it_where_that_is_the_truth():
    record, rig, _, _ = hidden("coulomb_joint", "multisine", 5, Tc=6.0)
    base, free, _ = base_system(record, "joint", rig.inertia)
    bench = Workbench(record, base, free, 0.2)
    loose = bench.fit({"coulomb_joint": jb.CoulombJoint(6.0)}, patience=60)
    steps = [Step(bench.fit(bench.effects(loose), loose, tied=True, patience=60), "coulomb_joint", (), ())]
    assert reshaping.reshaped_at_last(Search(bench), steps) is steps


@pytest.mark.parametrize(
    ("promise", "cost", "shape", "tries", "taken"),
    [
        (5.0, 900.0, True, 0, False),  # no promise
        (50.0, 900.0, True, 1, True),
        (50.0, 900.0, False, 1, False),  # by a shape that the record does not determine
        (50.0, 999.0, True, 1, False),  # it has brought too little
    ],
)
def test_the_richer_law_is_taken_where_it_brings_what_is_demanded_by_a_shape_of_its_own(
    monkeypatch, promise, cost, shape, tries, taken
):
    fitted = []
    laws = {"stribeck": jb.effects.Stribeck, "coulomb_joint": jb.CoulombJoint} | {f"other{n}": jb.Gravity for n in range(20)}
    bench = SimpleNamespace(laws=laws, static=laws, outright=(), slowest=0.0)
    bench.effects = lambda trial: {"coulomb_joint": jb.CoulombJoint(3.0)}
    bench.fit = lambda effects, *_, **__: fitted.append(effects) or Model(frozenset(effects), cost=cost)
    search = Search(bench)
    coulomb = Model(frozenset({"coulomb_joint"}), cost=1000.0)
    asked = Candidate("stribeck", jb.effects.Stribeck(-1.0, 4.0, 0.2), promise, 1.0, {})
    monkeypatch.setattr(reshaping, "reshaped", lambda *of: asked)
    monkeypatch.setattr(reshaping, "shapeless", lambda *of: not shape)
    monkeypatch.setattr(search, "softly", lambda trial: trial)
    monkeypatch.setattr(search, "prune", lambda trial, spare: (trial, ()))
    steps = [Step(coulomb, "coulomb_joint", (), ())]
    path = reshaping.reshaped_at_last(search, steps)
    assert len(fitted) == tries
    assert (path[-1].trial.names == {"stribeck"}) == taken
    apart = [Step(Model(coulomb.names, cost=1000.0, tied=False), "coulomb_joint", (), ())]
    assert reshaping.reshaped_at_last(search, apart) is apart
