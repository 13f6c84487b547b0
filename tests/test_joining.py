"""Windows that a model explains only apart, and searches that fall short of what was promised: what is done about either."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from jaxbacklash.criticism.candidates import Candidate
from jaxbacklash.criticism.joining import one_piece
from jaxbacklash.criticism.refine import refine
from jaxbacklash.criticism.search import Search
from jaxbacklash.criticism.steps import Step
from jaxbacklash.mechanics import catalogue

from .number_models import Model

BENCH = SimpleNamespace(outright=(), laws=catalogue(), record=SimpleNamespace(samples=1000), grips=lambda names: False)


def searched(monkeypatch, ends: dict[frozenset[str], Model], needless=frozenset()):
    """A search that settles on ``ends``, drops what is ``needless`` and finds nothing further; what it was asked to join."""
    search, asked = Search(BENCH), []

    def settle(trial):
        asked.append(trial.names)
        return ends.get(trial.names, trial)

    def prune(trial, spare=None):
        return replace(trial, names=trial.names - needless), tuple(sorted(trial.names & needless))

    monkeypatch.setattr(search, "settle", settle)
    monkeypatch.setattr(search, "prune", prune)
    monkeypatch.setattr(search, "forward", lambda start, steps, least: steps)
    monkeypatch.setattr(search, "add", lambda before, c: replace(before, names=before.names | {c.name}))
    return search, asked


def promising(name, gain):
    return Candidate(name, catalogue()[name](), gain, 1.0, {})


APART = Model(frozenset({"flexible_link"}), cost=100.0, tied=False)


@pytest.mark.parametrize("misfit", [1.01, 1.1, 3.0])
@pytest.mark.parametrize("fitted", [True, False])
def test_windows_explained_apart_are_joined_by_what_lets_one_trajectory_follow(monkeypatch, misfit, fitted):
    """The addition brings nothing on free windows; it is kept where the path from it ends in one trajectory that explains."""
    both = replace(APART, names=APART.names | {"gap_spring"}, cost=99.0)
    search, asked = searched(monkeypatch, {both.names: replace(both, tied=True, misfit=misfit)})
    evidence = {"gap_drift": -9.0, "gap_spring": -0.3} if fitted else {}
    ranking = () if fitted else (promising("gap_drift", 3.0), promising("gap_spring", 1.0), promising("gravity", 0.0))
    if fitted:
        search.known[both.names, False] = both
    steps = one_piece(search, [Step(APART, "flexible_link", (), ranking, evidence)], 0.25)
    kept = misfit < 1.03
    assert [s.added for s in steps] == (["flexible_link", "gap_spring"] if kept else ["flexible_link"])
    assert steps[-1].trial.tied == kept
    assert APART.names | {"gravity"} not in asked  # it promises nothing


@pytest.mark.parametrize("needless", [("gap_spring",), ("gap_spring", "gravity")])
def test_what_only_led_to_one_trajectory_does_not_stay(monkeypatch, needless):
    """Nor does what came before and is needless in one trajectory; that it went is told."""
    last = replace(APART, names=APART.names | {"gravity"})
    both = replace(last, names=last.names | {"gap_spring"}, cost=99.0)
    search, _ = searched(monkeypatch, {both.names: replace(both, tied=True)}, frozenset(needless))
    (step,) = one_piece(search, [Step(last, "flexible_link", ("preload",), (promising("gap_spring", 2.0),))], 0.25)
    assert step.added == "flexible_link"
    assert step.trial.tied
    assert step.trial.names == last.names - set(needless)
    assert step.dropped == ("preload", *needless[1:])


@pytest.mark.parametrize("last", [replace(APART, tied=True), replace(APART, misfit=1.5)])
def test_what_is_one_trajectory_or_explains_nothing_is_not_joined(monkeypatch, last):
    search, asked = searched(monkeypatch, {})
    steps = [Step(last, "flexible_link", (), (promising("gap_spring", 30.0),))]
    assert one_piece(search, steps, 0.25) is steps
    assert not asked


@pytest.mark.parametrize(
    ("beside", "promise", "fell", "shaken"),
    [
        ("coulomb_ground", 48.0, 7.0, True),
        ("coulomb_ground", 48.0, 40.0, False),  # brought what it promised
        ("coulomb_ground", 9.0, 1.0, False),  # promised too little
        ("gravity", 48.0, 7.0, False),  # nothing to stick at
    ],
)
def test_beside_dry_friction_what_falls_short_of_its_promise_is_softened(monkeypatch, beside, promise, fell, shaken):
    before = Model(frozenset({beside}), cost=1000.0)
    names = before.names | {"sensor_gain"}
    after, better = Model(names, cost=1000.0 - 0.5 * fell), Model(names, cost=976.0)
    search = Search(BENCH)
    monkeypatch.setattr(search, "softly", lambda trial: better)
    monkeypatch.setattr(search, "anew", lambda trial: trial)
    ranking = [promising("quadratic_drag", 60.0), promising("sensor_gain", promise)]
    tried = {"sensor_gain": after, "preload": replace(after, names=before.names | {"preload"})}
    found = search.as_promised(before, ranking, tried)
    assert found["sensor_gain"] is (better if shaken else after)
    assert found["preload"] is tried["preload"]
    assert search.as_promised(replace(before, tied=False), ranking, tried) == tried


@pytest.mark.slow
@pytest.mark.parametrize("number", [30, 70])
def test_what_free_windows_hide_and_what_friction_holds_up_is_found(number):
    """30: the joint alone explains every window apart, and no trajectory of it follows. 70: a weak gain beside dry friction."""
    pytest.importorskip("numba", reason="the independent simulation of strangers is compiled by numba")
    from benchmarks.effect_strangers import make_case

    case = make_case(number, 10.0, 11)
    assert set(refine(case.record, inertia=case.rig.inertia).effects) == set(case.hidden)
