"""What a law with internal states promises and does not keep costs no long search, on models that are only numbers."""

from types import SimpleNamespace

import pytest

from jaxbacklash.criticism import unseen as module
from jaxbacklash.criticism.memories import Member
from jaxbacklash.criticism.search import Search
from jaxbacklash.criticism.steps import Step
from jaxbacklash.criticism.unseen import KEPT, Unseen
from jaxbacklash.effects import CoulombJoint, Dahl, FlexibleLink, Gravity
from jaxbacklash.system import System

from .number_models import Model


class Bench:
    """Answers every fit from a list, and notes whether it was tied."""

    def __init__(self, *answers: Model) -> None:
        self.answers, self.asked = list(answers), []
        self.laws = {"coulomb_joint": CoulombJoint, "dahl": Dahl, "flexible_link": FlexibleLink, "gravity": Gravity}
        self.outright, self.is_cut, self.record = (), False, SimpleNamespace(samples=10_000)

    def effects(self, trial):
        return dict.fromkeys(trial.names, "as fitted")

    def grips(self, names):
        return False

    def fit(self, effects, start=None, *, tied=False, **_):
        self.asked.append((frozenset(effects), tied))
        return self.answers.pop(0)


@pytest.fixture(autouse=True)
def plainly(monkeypatch):
    """Evidence by the criterion alone, which asks for no record."""
    for place in ("tried", "search"):
        monkeypatch.setattr(f"jaxbacklash.criticism.{place}.gain", lambda before, after: before.criterion - after.criterion)


@pytest.mark.parametrize(("share", "goes_on"), [(-1.0, False), (0.5 * KEPT, False), (2.0 * KEPT, True)])
def test_a_search_goes_on_from_what_keeps_a_part_of_its_promise(monkeypatch, share, goes_on):
    alone, fall, link = Model(frozenset(), cost=1000.0), 100.0, frozenset({"flexible_link"})
    monkeypatch.setattr(module, "promises", lambda bench, trial, law, least: [(fall, law())])
    search, gone_on = Unseen(Bench(Model(link, cost=1000.0 - 0.5 * share * fall))), []
    monkeypatch.setattr(search, "imitated", lambda before, after: False)
    monkeypatch.setattr(search, "retied", lambda trial: gone_on.append(trial) or Model(link, cost=800.0))
    monkeypatch.setattr(search, "loaded", lambda trial, name: [])
    found = search.unseen(alone, 10.0)
    assert (found is not None) == bool(gone_on) == goes_on
    assert found is None or found[1].cost == 800.0
    assert ((link, True) in search.known) == goes_on  # what a first fit has missed is no fit of this law


@pytest.mark.parametrize(("strong", "kept"), [((900.0, 700.0), 700.0), ((900.0,), 800.0), ((799.5,), 800.0), ((), 800.0)])
def test_a_strong_law_is_kept_where_it_does_better_than_what_small_steps_lead_to(monkeypatch, strong, kept):
    alone, link, gone_on = Model(frozenset(), cost=1000.0), frozenset({"flexible_link"}), []
    monkeypatch.setattr(module, "promises", lambda bench, trial, law, least: [(100.0, law())])
    search = Unseen(Bench(Model(link, cost=800.0)))
    monkeypatch.setattr(search, "imitated", lambda before, after: False)
    monkeypatch.setattr(search, "retied", lambda trial: gone_on.append(trial.cost) or trial)
    monkeypatch.setattr(search, "loaded", lambda trial, name: [Model(link, cost=cost) for cost in strong])
    assert search.unseen(alone, 10.0)[1].cost == kept
    assert gone_on == [800.0, 700.0][: 1 if kept == 800.0 else 2]


@pytest.mark.parametrize("least", [0.0, 500.0])
def test_a_promise_is_asked_to_outweigh_a_part_of_the_laws_own_parameters(monkeypatch, least):
    asked = []
    monkeypatch.setattr(module, "promises", lambda bench, trial, law, at_least: asked.append(at_least) or [])
    search = Unseen(Bench())
    assert search.unseen(Model(frozenset(), cost=1000.0), least) is None
    # Three parameters of its own against ten thousand samples: 27.6, and what is demanded beside, of which half is a promise.
    assert asked == [pytest.approx(max(least, 0.5 * (3 * 9.21 + module.demanded(search.bench))), rel=1e-3)]


@pytest.mark.parametrize(("behind", "explains", "ties"), [(20.0, True, 1), (1.0, True, 2), (20.0, False, 2)])
def test_a_memory_of_friction_that_free_windows_rule_out_is_tied_once(behind, explains, ties):
    """First as the model it takes the place of is, and not again from free windows that are behind."""
    names = frozenset({"dahl"})
    current = Model(frozenset({"coulomb_joint"}), cost=110.0, misfit=1.0 if explains else 2.0)
    stuck, apart = Model(names, cost=1e6, misfit=90.0), Model(names, cost=100.0 + 0.5 * behind, tied=False)
    search = Search(Bench(stuck, apart, *[Model(names, cost=apart.cost + 1.0)] * (ties - 1)))
    search.known[current.names, False] = Model(current.names, cost=100.0, tied=False)
    member = Member("dahl", {}, SimpleNamespace(effect=Dahl(), system=System), 50.0, None)
    assert search.placed(current, member, tied=True).tied == (ties == 2)
    assert search.bench.asked == [(names, True), (names, False), (names, True)][: 1 + ties]


@pytest.mark.parametrize("ruled_out", [True, False])
def test_windows_that_stay_apart_call_for_free_ones_only_where_those_say_nothing_yet(monkeypatch, ruled_out):
    current = Model(frozenset({"coulomb_joint"}), cost=110.0)
    apart = Model(frozenset({"dahl"}), cost=90.0, tied=False)
    search, loosened = Search(Bench()), []
    monkeypatch.setattr("jaxbacklash.criticism.search.rank", lambda *_: [])
    monkeypatch.setattr("jaxbacklash.criticism.search.may_join", lambda *_: [])
    monkeypatch.setattr(search, "attempts", lambda trial, ranking: {"dahl": apart})
    monkeypatch.setattr(search, "ruled_out", lambda final, names: ruled_out)
    monkeypatch.setattr(search, "loosened", lambda trial: loosened.append(trial) or trial)
    monkeypatch.setattr(search, "finished", lambda trial, tried: {})
    search.forward(current, [Step(current, None, (), ())], 0.1)
    assert bool(loosened) != ruled_out


def test_free_windows_that_rule_a_law_out_are_no_evidence_against_one_trajectory(monkeypatch):
    """They have starts to choose: their sum of squares is far below that of any trajectory, the right one's too."""
    current = Model(frozenset({"coulomb_joint"}), cost=200.0)
    apart, tied = Model(frozenset({"dahl"}), cost=90.0, tied=False), Model(frozenset({"gravity"}), cost=201.0)
    search = Search(Bench())
    search.known[current.names, False] = Model(current.names, cost=50.0, tied=False)
    search.known[apart.names, False] = apart
    monkeypatch.setattr("jaxbacklash.criticism.search.rank", lambda *_: [])
    monkeypatch.setattr("jaxbacklash.criticism.search.may_join", lambda *_: [])
    monkeypatch.setattr(search, "attempts", lambda trial, ranking: {"dahl": apart, "gravity": tied})
    monkeypatch.setattr(search, "finished", lambda trial, tried: tried)
    steps = search.forward(current, [Step(current, None, (), ())], 0.1)
    assert [s.trial for s in steps] == [current]
    assert set(steps[0].evidence) == {"gravity"}


@pytest.mark.parametrize(("tied", "fitted"), [(True, False), (False, True)])
def test_a_law_with_states_in_free_windows_stops_no_search_for_what_one_trajectory_lacks(tied, fitted):
    """Friction's memory, in one piece or apart, leaves noise beside a trajectory: only in one piece it settles the matter."""
    search, added = Search(Bench()), []
    current = Model(frozenset(), cost=500.0, misfit=1.016)
    search.may_help = lambda *_: True
    search.memories = lambda *_: {"dahl": Model(frozenset({"dahl"}), cost=200.0, tied=tied)}
    search.given = lambda *_: {}
    search.richer = lambda *_: {}
    search.add = lambda before, c, rival=None: added.append((c.name, rival)) or Model(frozenset({c.name}), cost=220.0)
    ranking = [SimpleNamespace(name="gravity", gain=480.0, predicted=1.0, parameters=1, effect=Gravity())]
    assert list(search.attempts(current, ranking)) == ["dahl", *(["gravity"] if fitted else [])]
    assert added == ([("gravity", None)] if fitted else [])
