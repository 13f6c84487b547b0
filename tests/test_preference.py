"""Which of several models that do about as well is kept, on models that are only numbers and the real catalogue's laws."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

from jaxbacklash.criticism.evidence import demanded
from jaxbacklash.criticism.preference import AHEAD, advantage, lead, simplest
from jaxbacklash.criticism.search import Search
from jaxbacklash.mechanics import catalogue

from .number_models import Model

BENCH = SimpleNamespace(laws=catalogue())


def model(*names: str, cost: float = 100.0, parameters: int = 1) -> Model:
    return Model(frozenset(names), cost=cost, free=("backlash", *(f"p{i}" for i in range(parameters))))


@pytest.mark.parametrize(
    ("ahead", "beside", "kept"),
    [
        (0.0, (), "gravity"),
        (0.8 * AHEAD, (), "gravity"),
        (1.2 * AHEAD, (), "sensor_gain"),
        (1.2 * AHEAD, ("coulomb_joint",), "gravity"),
    ],
)
def test_what_acts_goes_before_what_measures_unless_that_is_ahead(ahead, beside, kept):
    acts, measures = model("gravity", *beside), model("sensor_gain", *beside, cost=100.0 - 0.5 * ahead)
    assert simplest(BENCH, {"gravity": acts, "sensor_gain": measures}, demanded(BENCH)) == kept


def test_of_those_that_do_as_well_the_one_with_fewest_parameters():
    slack = demanded(BENCH)
    tried = {"dahl": model("dahl", parameters=2), "lugre": model("lugre", cost=100.0 - 0.4 * slack, parameters=5)}
    assert simplest(BENCH, tried, slack) == "dahl"
    tried["lugre"] = model("lugre", cost=100.0 - 4.0 * slack, parameters=5)
    assert simplest(BENCH, tried, slack) == "lugre"


@pytest.mark.parametrize(
    ("old", "new", "least"),
    [
        (("gravity",), ("preload",), AHEAD),
        (("gravity",), ("sensor_gain",), AHEAD),
        (("gravity", "stribeck"), ("sensor_gain", "stribeck"), demanded(BENCH)),
        (("sensor_gain",), ("gravity",), -AHEAD),
        (("coulomb_joint",), ("stribeck",), demanded(BENCH)),
        (("gravity", "preload"), ("preload",), -demanded(BENCH)),
    ],
)
def test_how_much_better_another_model_must_be(old, new, least):
    assert lead(BENCH, model(*new), model(*old), old[0]) == least


def test_two_effects_are_charged_for_having_been_chosen_twice():
    one, two = model("lugre", cost=100.0), model("contact_damping", "dahl", cost=99.0)
    assert advantage(BENCH, one, two) == pytest.approx(demanded(BENCH) + two.criterion - one.criterion)
    assert advantage(BENCH, two, one) == pytest.approx(-advantage(BENCH, one, two))


@pytest.mark.parametrize(("reach", "waits"), [(math.inf, True), (1.0, False)])
def test_a_law_whose_states_are_free_waits_until_it_explains_or_nothing_else_helps(monkeypatch, reach, waits):
    monkeypatch.setattr("jaxbacklash.criticism.search.gain", lambda before, after: before.criterion - after.criterion)
    current = Model(frozenset(), cost=1000.0, misfit=30.0)
    static = Model(frozenset({"gravity"}), cost=500.0, misfit=17.0)
    soaking = Model(frozenset({"stateful"}), cost=100.0, misfit=7.0)
    search = Search(SimpleNamespace(laws={"gravity": SimpleNamespace(states=(), slides=False)}))
    search.bench.laws["stateful"] = SimpleNamespace(states=("w",), absorbs=(), slides=False, reach=reach)
    monkeypatch.setattr("jaxbacklash.criticism.preference.measures_only", lambda law: False)
    assert search.best(current, {"stateful": soaking, "gravity": static}, 0.25) == ("gravity" if waits else "stateful")
    explains = replace(soaking, misfit=1.0)
    assert search.best(current, {"stateful": explains, "gravity": static}, 0.25) == "stateful"
    nibbling = replace(static, misfit=29.0)
    assert search.best(current, {"stateful": soaking, "gravity": nibbling}, 0.25) == "stateful"
