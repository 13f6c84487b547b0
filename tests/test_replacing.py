"""What takes the place of what in the last model, and what is held against it before, on models that are only numbers."""

from types import SimpleNamespace

import pytest

from jaxbacklash.criticism.search import AHEAD, Search, Step
from jaxbacklash.mechanics import AbstractEffect
from jaxbacklash.sensors import SensorOffset

from .number_models import Model

ACTS = SimpleNamespace(states=(), absorbs=(), slides=False, torque=None, reshape=None, family=None)
MEASURES = SimpleNamespace(
    states=(), absorbs=(), slides=False, torque=AbstractEffect.torque, reshape=AbstractEffect.reshape, family=None
)
GIVES = SimpleNamespace(states=("w",), absorbs=(), slides=False, torque=None, reshape=None, family="friction")


def searched(monkeypatch, **laws):
    """A search among these laws, every effect of which stands far from zero."""
    monkeypatch.setattr("jaxbacklash.criticism.search.significance", lambda trial, name: 100.0)
    bench = SimpleNamespace(laws=laws, outright=(), effects=lambda trial: dict.fromkeys(trial.names, "as fitted"))
    search = Search(bench)
    monkeypatch.setattr(search, "reduced", lambda steps: steps)
    monkeypatch.setattr(search, "shaken", lambda trial: trial)
    return search


def offered(monkeypatch, search, *models):
    """One model after the other in the place of what was kept."""
    left = list(models)
    monkeypatch.setattr(search, "instead", lambda steps, name: [left.pop(0)] if left else [])


def test_a_sensor_whose_error_stands_for_what_acts_is_one_that_only_measures():
    assert SensorOffset.torque is AbstractEffect.torque
    assert SensorOffset.reshape is AbstractEffect.reshape


@pytest.mark.parametrize(("worse", "taken"), [(-1.0, True), (1.0, True), (AHEAD + 1.0, False)])
def test_what_acts_goes_before_what_only_measures_if_it_does_as_well(monkeypatch, worse, taken):
    search = searched(monkeypatch, offset=MEASURES, gap=ACTS)
    measures, acts = Model(frozenset({"offset"}), cost=100.0), Model(frozenset({"gap"}), cost=100.0 + 0.5 * worse)
    offered(monkeypatch, search, acts, measures)
    steps, level = search.swap([Step(measures, "offset", (), ())])
    assert (steps[-1].trial is acts) == taken
    assert (("offset",) in level) == taken


@pytest.mark.parametrize(("better", "taken"), [(0.0, False), (AHEAD + 7.0, True)])
def test_a_search_goes_back_only_to_a_model_that_is_better_than_it_was(monkeypatch, better, taken):
    """It may have been stuck when it was left."""
    search = searched(monkeypatch, one=ACTS, other=ACTS)
    one, other = Model(frozenset({"one"}), cost=100.0), Model(frozenset({"other"}), cost=95.0)
    again = Model(frozenset({"one"}), cost=95.0 - 0.5 * better)
    offered(monkeypatch, search, other, again)
    steps, _ = search.swap([Step(one, "one", (), ())])
    assert steps[-1].trial is (again if taken else other)


@pytest.mark.parametrize(("left", "asked"), [(1.2, True), (1.004, False)])
def test_the_quick_look_has_no_say_where_free_windows_leave_noise_without_a_law(monkeypatch, left, asked):
    """It sees no more than they do, and puts ahead what imitates under noise."""
    search = searched(monkeypatch, gives=GIVES, spring=ACTS)
    final = Model(frozenset({"gives"}), cost=100.0)
    spring = SimpleNamespace(name="spring", gain=80.0, parameters=2, effect="spring")
    first = Step(Model(frozenset(), cost=200.0, misfit=left), None, (), (spring,))
    monkeypatch.setattr("jaxbacklash.criticism.search.may_replace", lambda bench, trial, name, others: [False] * len(others))
    monkeypatch.setattr(search, "joined", lambda effects, before: Model(frozenset(effects), cost=90.0))
    found = list(search.instead([first, Step(final, "gives", (), ())], "gives"))
    assert [sorted(t.names) for t in found] == ([] if asked else [["spring"]])


@pytest.mark.parametrize(("claimed", "alone", "kept"), [(1.0, 100.1, False), (1.0, 180.0, True), (400.0, 100.1, True)])
def test_what_adds_nothing_goes_though_another_has_its_parameter_then(monkeypatch, claimed, alone, kept):
    """A spring with a rest of its own does what one with a preload beside it does; the preload stays where it is one."""
    search = searched(monkeypatch, spring=ACTS, preload=ACTS)
    monkeypatch.setattr("jaxbacklash.criticism.search.significance", lambda trial, name: 1.0 if name == "preload" else 100.0)
    monkeypatch.setattr("jaxbacklash.criticism.search.claim", lambda trial, name: claimed)
    both = Model(frozenset({"spring", "preload"}), cost=100.0, free=("backlash", "spring.k1", "preload.T0"))
    spring = Model(frozenset({"spring"}), cost=alone, free=("backlash", "spring.k1", "spring.z0"))
    monkeypatch.setattr(search, "without", lambda before, name: spring)
    trial, dropped = search.prune(both)
    assert trial is (both if kept else spring)
    assert dropped == (() if kept else ("preload",))


@pytest.mark.parametrize(("left", "tried"), [(1.0, ["likely"]), (1.025, ["likely", "right"])])
def test_what_leaves_more_than_chance_ends_no_comparison(monkeypatch, left, tried):
    """A wrong law may leave little more than noise: what promised half as much may be the right one."""
    search = searched(monkeypatch, likely=ACTS, right=ACTS)
    current = Model(frozenset(), cost=10370.0, misfit=1.06)
    gains = {"likely": 920.0, "right": 530.0}
    ranking = tuple(SimpleNamespace(name=n, gain=g, predicted=1.04, parameters=1) for n, g in gains.items())
    monkeypatch.setattr(search, "may_help", lambda *_: True)
    monkeypatch.setattr(search, "memories", lambda *_: {})
    monkeypatch.setattr(search, "given", lambda *_: {})
    monkeypatch.setattr(search, "richer", lambda *_: {})
    monkeypatch.setattr(search, "rubs", lambda trial: False)
    models = {"likely": Model(frozenset({"likely"}), cost=9600.0, misfit=left), "right": Model(frozenset({"right"}), cost=9200.0)}
    monkeypatch.setattr(search, "add", lambda before, candidate, rival=None: models[candidate.name])
    assert list(search.attempts(current, ranking)) == tried
