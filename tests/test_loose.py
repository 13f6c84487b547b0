"""Another path on free windows, where one trajectory does not follow what free windows leave."""

from types import SimpleNamespace

import pytest

from jaxbacklash.criticism import loose
from jaxbacklash.criticism.search import Search, Step

from .number_models import Model
from .test_search_steps import Bench

BASE = Model(frozenset(), cost=500.0, misfit=1.1)
WRONG = Model(frozenset({"preload"}), cost=200.0, misfit=1.05)
RIGHT = Model(frozenset({"gravity"}), cost=90.0, tied=False, misfit=0.99)
STEPS = [Step(BASE, None, (), ()), Step(WRONG, "preload", (), ())]


def searching(monkeypatch, tied, *, free=0.99):
    """A search whose free windows name gravity, which ``tied`` is one trajectory of; ``free`` the misfit of the wrong model's."""
    search, seen = Search(Bench()), []
    apart = Model(BASE.names, cost=400.0, tied=False), Model(WRONG.names, cost=150.0, tied=False, misfit=free)
    loosened = {trial.names: trial for trial in apart}

    def forward(start, steps, least):
        seen.append((search.apart, start))
        return [*steps, Step(RIGHT, "gravity", (), ())] if search.apart else steps

    monkeypatch.setattr(search, "loosened", lambda trial: loosened[trial.names])
    monkeypatch.setattr(search, "forward", forward)
    monkeypatch.setattr(search, "settle", lambda trial: tied)
    monkeypatch.setattr(search, "prune", lambda trial: (trial, ()))
    monkeypatch.setattr(loose, "_around", lambda search, trial: iter([trial]))
    return search, seen


def test_what_free_windows_name_is_kept_as_one_trajectory(monkeypatch):
    tied = Model(RIGHT.names, cost=100.0, misfit=1.0)
    search, seen = searching(monkeypatch, tied)
    path = loose.by_free_windows(search, STEPS, 0.25)
    assert [s.trial.names for s in path] == [BASE.names, RIGHT.names]
    assert path[-1].trial is tied
    assert seen[0] == (True, search.loosened(BASE))
    assert seen[1] == (False, tied)  # and what else is missing is looked for from there


@pytest.mark.parametrize(
    ("cost", "how"),
    [(199.5, {"misfit": 1.0}), (100.0, {"misfit": 1.05}), (100.0, {"tied": False})],
    ids=["no better", "leaves a rest", "no trajectory"],
)
def test_a_path_that_leads_to_no_better_trajectory_is_left(monkeypatch, cost, how):
    search, _ = searching(monkeypatch, Model(RIGHT.names, cost=cost, **how))
    assert loose.by_free_windows(search, STEPS, 0.25) is STEPS
    assert not search.apart


def test_a_trajectory_that_follows_its_free_windows_is_not_doubted(monkeypatch):
    search, seen = searching(monkeypatch, None, free=1.045)
    assert loose.by_free_windows(search, STEPS, 0.25) is STEPS
    assert not seen


def test_apart_windows_stay_free(monkeypatch):
    search = Search(Bench())
    search.apart = True
    assert search.settle(RIGHT) is RIGHT
    search.apart = False
    search.bench.answers = [Model(RIGHT.names, cost=95.0)]
    assert search.settle(RIGHT).tied


def test_the_flag_goes_with_an_error(monkeypatch):
    search, _ = searching(monkeypatch, None)

    def fails(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(search, "forward", fails)
    with pytest.raises(KeyboardInterrupt):
        loose.by_free_windows(search, STEPS, 0.25)
    assert not search.apart


def test_every_effect_has_a_chance_to_be_another(monkeypatch):
    """Of a model, and of what stands in the place of each of its effects, the first few."""
    search = Search(Bench())
    both, rest = Model(frozenset({"gravity", "preload"}), 100.0, tied=False), Model(frozenset({"preload"}), 150.0, tied=False)
    added = []
    monkeypatch.setattr(search, "without", lambda trial, name: rest)
    monkeypatch.setattr(search, "add", lambda before, c: added.append(c.name) or SimpleNamespace(names=before.names | {c.name}))
    ranked = [SimpleNamespace(name=n) for n in ("preload", "gap_spring", "gravity", "drag", "ripple", "last")]
    monkeypatch.setattr(loose, "may_join", lambda bench, trial: [c.name for c in ranked])
    monkeypatch.setattr(loose, "rank", lambda bench, trial, names: [c for c in ranked if c.name in names])
    found = list(loose._around(search, both))
    assert found[0] is both
    assert added == ["gap_spring", "drag", "ripple"] * 2


DRAG = frozenset({"gravity"})  # the model that one trajectory does not follow well: what laws with a state seem to add to it


@pytest.mark.parametrize(
    ("trajectory", "along", "soaks"),
    [
        (Model(DRAG | {"lugre"}, cost=6e6), 6100.0, True),
        (Model(DRAG | {"lugre"}, cost=6300.0), 6100.0, False),  # its trajectory misses less than that of the model without
        (None, 6100.0, False),  # nobody knows
        (Model(DRAG | {"lugre"}, cost=6e6), 6350.0, False),  # the trajectory gains less than free windows do
    ],
    ids=["no trajectory", "a trajectory", "none looked for", "more apart"],
)
def test_free_windows_that_only_a_memory_helps_are_not_followed(trajectory, along, soaks):
    """Drag beside Stribeck's friction: with Coulomb's, LuGre's took 50 off free windows, and its trajectory ran away; Stribeck's
    took 500 off the trajectory."""
    search = Search(Bench())
    search.bench.laws |= {n: SimpleNamespace(states=states) for n, states in {"lugre": ("u",), "stribeck": ()}.items()}
    if trajectory is not None:
        search.keep(trajectory)
    current, apart = Model(DRAG, cost=6354.0), Model(DRAG, cost=5409.0, tied=False)
    others = {"lugre": Model(DRAG | {"lugre"}, cost=5384.0, tied=False)}
    tried = {"stribeck": Model(DRAG | {"stribeck"}, cost=along)}
    assert loose.soaked_up(search, current, tried, apart, others) is soaks


def test_what_free_windows_are_helped_by_without_a_memory_is_followed():
    search = Search(Bench())
    search.bench.laws |= {"lugre": SimpleNamespace(states=("u",))}
    search.keep(Model(DRAG | {"lugre"}, cost=6e6))
    apart, tried = Model(DRAG, cost=5409.0, tied=False), {"preload": Model(DRAG | {"preload"}, cost=6100.0)}
    others = {n: Model(DRAG | {n}, cost=5384.0, tied=False) for n in ("lugre", "preload")}
    assert not loose.soaked_up(search, Model(DRAG, cost=6354.0), tried, apart, others)
    assert not loose.soaked_up(search, Model(DRAG, cost=6354.0), tried, apart, {})


@pytest.mark.parametrize(
    ("law", "tied", "gone_on"),
    [("dahl", False, True), ("preload", False, False), ("dahl", True, False)],
    ids=["a law that soaks", "a law without a state", "one trajectory"],
)
def test_what_had_no_turn_beside_a_law_that_soaks_gets_it(monkeypatch, law, tied, gone_on):
    """An axis with friction at its ground and an offset: Dahl's took the offset's place in windows apart, was trimmed, and the
    offset that had been tried beside it was never added."""
    search, seen = Search(Bench()), []
    search.bench.laws["dahl"] = SimpleNamespace(states=("s",))
    base, first = Model(frozenset(), 9e4, tied=False, misfit=30.0), Model(frozenset({"gravity"}), 9e3, tied=tied, misfit=9.0)
    soaks = Model(frozenset({"gravity", law}), 900.0, tied=False, misfit=3.0)
    after = Model(frozenset({"gravity", "preload"}), 2e3, tied=False, misfit=4.0)
    steps = [Step(base, None, (), ()), Step(first, "gravity", (), ()), Step(soaks, law, (), ())]

    def forward(start, path, least):
        seen.append((search.apart, start))
        return [*path, Step(after, "preload", (), ())]

    monkeypatch.setattr(search, "trim", lambda path: path[:-1] if path[-1].trial is soaks else path)
    monkeypatch.setattr(search, "forward", forward)
    found = loose.without_soaking(search, steps, 0.25)
    assert seen == ([(True, first)] if gone_on else [])
    assert [s.added for s in found] == [None, "gravity", *(["preload"] if gone_on else [])]
    assert not search.apart
