"""A model that was left above one it contains, on models that are only numbers."""

import math
from types import SimpleNamespace

import pytest

from jaxbacklash.criticism.search import Search, Step
from jaxbacklash.effects import Stribeck

from .number_models import Model
from .test_search_steps import Bench


@pytest.mark.parametrize(("known", "costs", "asked"), [(500.0, [60.0], 1), (500.0, [600.0], 1), (90.0, [], 0)])
def test_a_richer_law_that_stuck_begins_again_once_from_the_simpler_one_that_got_further(monkeypatch, known, costs, asked):
    """Stribeck's friction begun where there is none ended above what Coulomb's leaves, which it contains."""
    before = Model(frozenset({"coulomb_joint"}), cost=100.0, tied=False, free=("backlash", "coulomb_joint.Tc"))
    search, names = Search(Bench()), frozenset({"stribeck"})
    search.bench.laws |= {n: SimpleNamespace(states=(), absorbs=(), slides=True) for n in ("coulomb_joint", "stribeck")}
    search.keep(Model(names, cost=known, tied=False))
    begun = []

    def fit(effects, start, **__):
        begun.append(start)
        return Model(frozenset(effects), cost=costs.pop(0), tied=False)

    monkeypatch.setattr(search.bench, "fit", fit)
    monkeypatch.setattr(search, "with_one_more", lambda *_: {"stribeck": Stribeck(Tc=1.0, Ts=1.5)})
    best = min([known, *costs])
    for _ in range(2):
        assert search.add(before, SimpleNamespace(name="stribeck", effect=Stribeck(Tc=1.0, Ts=1.5))).cost == best
    assert begun == [before] * asked


@pytest.mark.parametrize(
    ("slides", "paces", "cost"),
    [(False, [8e3, 95.0], 95.0), (False, [9.99e3, 9.98e3, 95.0], 9.99e3), (True, [8e3, 95.0], 1e4)],
    ids=["on its way", "too slow to arrive", "at corners"],
)
def test_a_trajectory_on_its_way_is_gone_on_with_as_long_as_it_may_arrive(slides, paces, cost):
    """LuGre's friction and weight were left at 6224 and at 7562 after 25 steps each, where 4797 was 60 more away."""
    names = frozenset({"gravity"})
    far = Model(names, cost=1e4, misfit=1.2, done=False)
    free = Model(names, cost=80.0, tied=False)
    on = [Model(names, cost=c, misfit=1.2, done=c < 100.0) for c in paces]
    search = Search(Bench(far, free, far, *on))
    search.bench.laws["gravity"].slides = slides
    assert search.joined({"gravity": None}, Model(frozenset({"preload"}), cost=100.0)).cost == cost


@pytest.mark.parametrize(("joins", "kept"), [(True, "coulomb_joint"), (False, "dahl")])
def test_friction_that_gives_and_joins_nowhere_makes_way_for_dry_friction_that_does(monkeypatch, joins, kept):
    """Coulomb's friction under much noise: Dahl's explained it apart, and no search made one trajectory of that."""
    search = Search(Bench())
    dry = SimpleNamespace(states=(), absorbs=(), slides=True, port="joint", family=None)
    gives = SimpleNamespace(states=("s",), absorbs=(), slides=False, port="joint", family="hysteresis", reach=1.0)
    search.bench.laws |= {"coulomb_joint": dry, "dahl": gives}
    ranking = (SimpleNamespace(name="coulomb_joint", gain=50.0),)
    base = Model(frozenset(), cost=1e3, tied=False, misfit=2.0)
    apart = Model(frozenset({"dahl"}), cost=90.0, tied=False)
    joined = Model(frozenset({"coulomb_joint"}), cost=99.0, tied=joins)
    monkeypatch.setattr(search, "add", lambda before, c, rival=None: Model(frozenset({c.name}), cost=95.0, tied=False))
    monkeypatch.setattr(search, "best", lambda before, tried, least: min(tried, key=lambda n: tried[n].criterion))
    monkeypatch.setattr(search, "settle", lambda trial: joined if trial.names == joined.names else trial)
    monkeypatch.setattr(search, "forward", lambda start, steps, least: steps)
    search.known[apart.names, False] = apart
    # What gives has been tried, and looks better than what is dry: it is not its own other path.
    tried = {"dahl": 400.0}
    path = search.with_static([Step(base, None, (), ranking, tried), Step(apart, "dahl", (), ())])
    assert path[-1].trial.names == {kept}


@pytest.mark.parametrize(
    ("cost", "tied", "state", "reach", "first"),
    [
        (900.0, True, "s", 1.0, {"gravity"}),
        (700.0, True, "s", 1.0, set()),
        (900.0, True, None, 1.0, set()),
        (700.0, False, "s", math.inf, {"gravity", "bouc_wen"}),
    ],
    ids=["its trajectory misses more", "its trajectory is better", "without a state", "no trajectory follows"],
)
def test_what_only_free_windows_gain_by_a_memory_lets_other_effects_go_first(cost, tied, state, reach, first):
    """LuGre's friction stood in on free windows for a spring in the play and friction at the ground."""
    search = Search(Bench())
    for name, states in ("dahl", () if state is None else (state,)), ("bouc_wen", ("s",)):
        search.bench.laws[name] = SimpleNamespace(states=states, absorbs=(), slides=False, reach=reach if name == "dahl" else 1.0)
    before = Model(frozenset(), cost=800.0, tied=False, misfit=1.1)
    help_too = {n: Model(frozenset({n}), cost=750.0, tied=False) for n in ("gravity", "bouc_wen")}
    assert search.plain(before, Model(frozenset({"dahl"}), cost=cost, tied=tied), "dahl", help_too).keys() == first
