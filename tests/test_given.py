"""Friction that gives, tried beside dry friction where the quick look tells them apart too badly, on models of numbers."""

from types import SimpleNamespace

import numpy as np
import pytest

from jaxbacklash.criticism import unseen as module
from jaxbacklash.criticism.candidates import Candidate
from jaxbacklash.criticism.search import Search
from jaxbacklash.criticism.unseen import Unseen
from jaxbacklash.effects import Contact, CoulombGround, CoulombJoint, Dahl, Damper, Gravity, Stribeck
from jaxbacklash.system import System

from .number_models import Model

JOINT = System(3.0, Contact(0.02, 1e4), Damper(10.0), {}, "z")


def model(cost, *, tied=True, misfit=1.0, **effects):
    return Model(frozenset(effects), cost, tied, misfit=misfit, effects=effects, system=JOINT.with_effects(*effects.values()))


class Bench:
    """Answers each fit from a list, and notes with what it began."""

    def __init__(self, *answers):
        self.answers, self.begun = list(answers), []
        self.laws = {"coulomb_joint": CoulombJoint, "coulomb_ground": CoulombGround, "gravity": Gravity, "dahl": Dahl}
        self.quick, self.record = SimpleNamespace(motion=None, blind=False), SimpleNamespace(samples=5000)

    def effects(self, trial):
        return dict(trial.effects)

    def fit(self, effects, start, **how):
        assert how["tied"]
        self.begun.append(effects)
        return model(self.answers.pop(0), **effects)


def given(monkeypatch, trial, hears, *answers):
    monkeypatch.setattr(module, "told", lambda *_: hears)
    bench = Bench(*answers)
    search = Unseen(bench)
    return search.given(trial), bench, search


def test_the_better_of_two_guesses_stands_beside_what_stays(monkeypatch):
    trial = model(100.0, coulomb_joint=CoulombJoint(3.0), gravity=Gravity(-30.0))
    found, bench, search = given(monkeypatch, trial, 5.0, 90.0, 70.0)
    assert list(found) == ["dahl"]
    assert found["dahl"].cost == 70.0
    assert [sorted(effects) for effects in bench.begun] == [["dahl", "gravity"]] * 2
    levels = [float(effects["dahl"].Fc) for effects in bench.begun]
    gives = [float(effects["dahl"].Fc / effects["dahl"].sigma) for effects in bench.begun]
    assert levels == pytest.approx([3.0, 3.0])
    assert gives == pytest.approx(np.array([0.08, 0.02]) * 0.02)
    assert search.given(trial) == found  # and none is fitted twice
    assert len(bench.begun) == 2


def test_what_the_quick_look_tells_apart_costs_no_fit(monkeypatch):
    found, bench, _ = given(monkeypatch, model(100.0, coulomb_joint=CoulombJoint(3.0)), 500.0)
    assert not found
    assert not bench.begun


def test_a_law_that_states_no_torque_is_not_compared(monkeypatch):
    found, bench, _ = given(monkeypatch, model(100.0, coulomb_joint=CoulombJoint(0.0)), 0.0)
    assert not found
    assert not bench.begun


@pytest.mark.parametrize(
    "trial",
    [
        model(100.0, gravity=Gravity(-30.0)),
        model(100.0, coulomb_ground=CoulombGround(3.0)),
        model(100.0, coulomb_joint=CoulombJoint(3.0), tied=False),
        model(1e5, coulomb_joint=CoulombJoint(3.0), misfit=9.0),
    ],
)
def test_only_friction_in_the_joint_that_one_trajectory_follows_is_asked(monkeypatch, trial):
    assert not given(monkeypatch, trial, 0.0)[0]


@pytest.mark.parametrize(("hears", "tried"), [(5.0, True), (500.0, False)])
def test_a_richer_relative_is_tried_where_the_quick_look_could_not_tell(monkeypatch, hears, tried):
    """Of a law that explains: one trajectory with corners judges it badly from outside."""
    monkeypatch.setattr(module, "told", lambda *_: hears)
    trial = model(100.0, coulomb_joint=CoulombJoint(3.0))
    search = Search(Bench())
    search.bench.laws["stribeck"] = Stribeck
    search.bench.outright = ()
    added = []
    monkeypatch.setattr(search, "may_help", lambda *_: False)
    monkeypatch.setattr(search, "given", lambda *_: {})
    monkeypatch.setattr(module, "reshaped", lambda *_: Candidate("stribeck", Stribeck(), 0.0, 1.0, {}))
    monkeypatch.setattr(search, "add", lambda before, c: added.append(c.name) or model(90.0, stribeck=Stribeck(3.0, 4.0, 0.1)))
    ranking = [SimpleNamespace(name=n, gain=0.0, predicted=1.0) for n in ("gravity", "stribeck")]
    assert list(search.attempts(trial, ranking)) == (["stribeck"] if tried else [])
    assert added == (["stribeck"] if tried else [])
    guesses = search.untold(trial, "coulomb_joint", "stribeck")
    assert [float(law.Ts) for law in guesses] == pytest.approx([3.0] * len(guesses))  # at the same level
