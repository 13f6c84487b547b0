"""What the search does where a fit has stuck, on models that are only numbers."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jaxbacklash.criticism.candidates import _gain
from jaxbacklash.criticism.search import Search, Step
from jaxbacklash.criticism.tried import BARELY, SLIGHT
from jaxbacklash.effects import CoulombJoint, Gravity, Stribeck
from jaxbacklash.sensors import SensorGain

from .number_models import Model


class Bench:
    """Answers every fit from a list, and notes what was asked for."""

    def __init__(self, *answers: Model) -> None:
        self.answers, self.asked = list(answers), []
        self.laws = {name: SimpleNamespace(states=(), absorbs=(), slides=False) for name in ("gravity", "preload")}
        self.outright, self.slowest, self.is_cut = (), 0.0, False

    def effects(self, trial):
        return dict.fromkeys(trial.names, "as fitted")

    def grips(self, names):
        return False

    def fit(self, effects, start=None, *, tied=False, patience=25, **how):
        if "joint" in how:  # begun again from the data: it comes to nothing
            return Model(frozenset(effects), cost=math.inf)
        self.asked.append((frozenset(effects), tied))
        return self.answers.pop(0)

    def fit_softly(self, trial, *_):
        return trial

    def contained(self, name):
        return self.laws[name].absorbs

    def rests(self, port):
        return True


@pytest.mark.parametrize("costs", [(130.0, 90.0), (90.0,), (130.0, 140.0)])
def test_a_larger_model_that_fits_worse_begins_again_near_the_smaller_one(monkeypatch, costs):
    before, both = Model(frozenset({"preload"}), cost=100.0, tied=False), frozenset({"preload", "gravity"})
    search, begun = Search(Bench()), []

    def fit(effects, *_, **__):
        begun.append(float(effects["gravity"].G))
        return Model(both, cost=costs[len(begun) - 1], tied=False, free=("backlash", "gravity.G"))

    monkeypatch.setattr(search.bench, "fit", fit)
    candidate = SimpleNamespace(name="gravity", effect=Gravity(G=20.0))
    assert search.add(before, candidate).cost == min(costs)
    assert begun == pytest.approx([20.0, 20.0 * SLIGHT][: len(costs)])


def test_what_promises_little_beside_one_trajectory_begins_where_that_has_arrived(monkeypatch):
    before, both = Model(frozenset({"preload"}), cost=100.0), frozenset({"preload", "gravity"})
    search, begun = Search(Bench()), []

    def fit(effects, *_, tied, **__):
        begun.append((float(effects["gravity"].G), tied))
        return Model(both, cost=99.9)

    monkeypatch.setattr(search.bench, "fit", fit)
    monkeypatch.setattr(search, "promised", lambda *_, **__: 0.7)
    assert search.add(before, SimpleNamespace(name="gravity", effect=Gravity(G=20.0))).cost == 99.9
    assert begun == [(pytest.approx(20.0 * BARELY), True)]


def test_a_gain_that_promises_little_begins_near_one(monkeypatch):
    """What takes nothing away is not zero for every law."""
    before, begun = Model(frozenset({"preload"}), cost=100.0), []
    search = Search(Bench())

    def fit(effects, *_, **__):
        begun.append(float(effects["sensor_gain"].g))
        return Model(frozenset({"preload", "sensor_gain"}), cost=99.9)

    monkeypatch.setattr(search.bench, "fit", fit)
    monkeypatch.setattr(search, "promised", lambda *_, **__: 0.7)
    search.add(before, SimpleNamespace(name="sensor_gain", effect=SensorGain(g=1.02)))
    assert begun == [pytest.approx(1.0 + 0.02 * BARELY, rel=1e-12)]


def test_of_those_that_promise_as_much_the_simplest_is_fitted_first():
    search, fitted = Search(Bench()), []
    current = Model(frozenset(), cost=1e5, misfit=10.0, tied=False)
    laws = {"preload": (99.0, 3), "gravity": (95.0, 1), "drag": (80.0, 1)}
    ranking = [
        SimpleNamespace(name=name, gain=gain, predicted=1.0, parameters=count, effect=Gravity())
        for name, (gain, count) in laws.items()
    ]
    found = {name: Model(frozenset({name}), cost=100.0, tied=False, misfit=2.0) for name in laws}
    search.bench.laws["drag"] = search.bench.laws["gravity"]
    search.may_help = lambda *_: True
    search.rubs = lambda *_: False
    search.memories = lambda *_: {}
    search.add = lambda before, c, rival=None: fitted.append(c.name) or found[c.name]
    assert search.attempts(current, ranking) == found
    assert fitted == ["gravity", "preload", "drag"]


def significant(monkeypatch, size):
    monkeypatch.setattr("jaxbacklash.criticism.search.significance", lambda trial, name: size)
    monkeypatch.setattr("jaxbacklash.criticism.tried.significance", lambda trial, name: size)
    monkeypatch.setattr("jaxbacklash.criticism.search.led_on", lambda *_: False)


def test_a_model_known_from_a_stuck_fit_is_fitted_again(monkeypatch):
    significant(monkeypatch, 1.4)
    both = Model(frozenset({"gravity", "preload"}), cost=100.0, free=("backlash", "a", "b"))
    search = Search(Bench(Model(frozenset({"gravity"}), cost=101.0)))
    search.known[frozenset({"gravity"}), True] = Model(frozenset({"gravity"}), cost=1e8)
    assert search.without(both, "preload").cost == 101.0
    assert search.bench.asked == [(frozenset({"gravity"}), True)]


def test_a_model_known_well_is_not_fitted_again(monkeypatch):
    significant(monkeypatch, 3.0)
    both = Model(frozenset({"gravity", "preload"}), cost=100.0)
    search = Search(Bench())
    search.known[frozenset({"gravity"}), True] = Model(frozenset({"gravity"}), cost=104.0)
    assert search.without(both, "preload").cost == 104.0
    assert not search.bench.asked


@pytest.mark.parametrize(("done", "cost"), [(False, 101.0), (True, 1e4)])
def test_a_model_left_on_its_way_far_above_is_fitted_to_the_end(monkeypatch, done, cost):
    significant(monkeypatch, 3.0)
    both = Model(frozenset({"gravity", "preload"}), cost=100.0)
    above = Model(frozenset({"gravity"}), cost=1e4, done=done)
    search = Search(Bench(above, Model(frozenset({"gravity"}), cost=101.0)))
    assert search.without(both, "preload").cost == cost


def test_a_tied_fit_that_sticks_is_let_go_first():
    before = Model(frozenset(), cost=100.0)
    stuck = Model(frozenset({"gravity"}), cost=1e6, misfit=50.0, done=False)
    free = Model(frozenset({"gravity"}), cost=80.0, tied=False)
    found = Model(frozenset({"gravity"}), cost=90.0)
    search = Search(Bench(stuck, free, found))
    assert search.joined({"gravity": "as fitted"}, before) is found
    assert [tied for _, tied in search.bench.asked] == [True, False, True]
    assert search.known[frozenset({"gravity"}), False] is free


@pytest.mark.parametrize("slides", [False, True])
def test_a_tied_fit_that_creeps_goes_by_free_windows(slides):
    """But for dry friction, whose fits hardly ever end by themselves and which has a way of its own."""
    before = Model(frozenset(), cost=100.0)
    creeping = Model(frozenset({"gravity"}), cost=95.0, misfit=0.99, done=False)
    free = Model(frozenset({"gravity"}), cost=80.0, tied=False)
    arrived = Model(frozenset({"gravity"}), cost=85.0, misfit=0.95)
    search = Search(Bench(creeping, free, arrived))
    search.bench.laws["gravity"].slides = slides
    assert search.joined({"gravity": "as fitted"}, before) is (creeping if slides else arrived)
    assert [tied for _, tied in search.bench.asked] == ([True] if slides else [True, False, True])


@pytest.mark.parametrize(
    ("costs", "best"), [((90.0, 89.5, 89.6), 89.5), ((110.0, 105.0), 100.0), ((110.0, 80.0, 79.5, 81.0), 79.5)]
)
def test_a_tied_model_goes_by_its_own_free_windows(costs, best):
    """Once more where that helped; where it did not, by the parameters of the free windows, its law's states followed anew."""
    names = frozenset({"gravity"})
    tied, free = Model(names, cost=100.0), Model(names, cost=70.0, tied=False, system="moved")
    search, begun, left = Search(Bench()), [], list(costs)

    def fit(effects, start, *, tied=False, followed=False, joint=None, **_):
        if not tied:
            return free
        assert (start is free, joint) == ((False, "moved") if followed else (True, None))
        begun.append(followed)
        return Model(names, cost=left.pop(0))

    search.bench.fit = fit
    assert search.retied(tied).cost == best
    assert begun == {89.5: [False, False, True], 100.0: [False, True], 79.5: [False, True, False, True]}[best]
    assert not left


@pytest.mark.parametrize(("size", "again"), [(2.0, True), (10.0, False)])
def test_more_than_an_effect_can_account_for_is_first_looked_for_without_it(monkeypatch, size, again):
    """An effect two standard errors from zero takes 2 off the cost; where 40 fall with it, the search had not arrived."""
    significant(monkeypatch, size)
    before = Model(frozenset({"preload"}), cost=100.0)
    after = Model(frozenset({"preload", "gravity"}), cost=60.0, free=("backlash", "gravity.G"))
    arrived = Model(frozenset({"preload"}), cost=62.0)
    search = Search(Bench(arrived))
    search.known[before.names, True] = before
    assert search.relieved(before, after) is (arrived if again else before)
    assert len(search.bench.asked) == again


def test_a_tied_fit_that_stuck_is_not_believed_over_free_windows():
    free = Model(frozenset({"gravity"}), cost=100.0, tied=False, misfit=1.0)
    stuck = Model(frozenset({"gravity"}), cost=150.0, misfit=1.2, done=False)
    held, creeps = Search(Bench(stuck)), Search(Bench(stuck, replace(stuck, cost=149.5)))
    held.bench.laws["gravity"].slides, held.bench.is_cut = True, True
    assert held.settle(free) is free
    # Without corners it is as low as it comes.
    assert creeps.settle(free).cost == 149.5
    honest = Model(frozenset({"gravity"}), cost=150.0, misfit=1.2, done=True)
    assert Search(Bench(honest)).settle(free) is honest
    creeping = Model(frozenset({"gravity"}), cost=180.0, misfit=1.24, done=False)
    assert Search(Bench(creeping, stuck, honest)).settle(free) is honest


def test_close_candidates_are_finished_before_one_is_chosen():
    current = Model(frozenset(), cost=1000.0)
    ahead = Model(frozenset({"gravity"}), cost=110.0, done=False)
    close = Model(frozenset({"preload"}), cost=120.0, done=False)
    better = Model(frozenset({"preload"}), cost=90.0)
    search = Search(Bench(ahead, better))
    tried = search.finished(current, {"gravity": ahead, "preload": close})
    assert tried["preload"] is better
    far = Model(frozenset({"preload"}), cost=900.0, done=False)
    search = Search(Bench())
    assert search.finished(current, {"gravity": ahead, "preload": far})["preload"] is far
    assert not search.bench.asked


@pytest.mark.parametrize(("behind", "times"), [(40.0, 1), (2.0, 2)])
def test_what_cannot_replace_a_simpler_rival_is_fitted_roughly(monkeypatch, behind, times):
    before = Model(frozenset(), cost=1000.0, tied=False)
    rival = Model(frozenset({"preload"}), cost=100.0, tied=False, free=("backlash", "T0"))
    free = ("backlash", "G", "phase")
    rough = Model(frozenset({"gravity"}), cost=100.0 + 0.5 * (behind - 10.0), tied=False, free=free)
    search = Search(Bench(rough, replace(rough, cost=80.0)))
    found = search.add(before, SimpleNamespace(name="gravity", effect=Gravity(G=20.0)), rival)
    assert len(search.bench.asked) == times
    assert found.cost == (rough.cost if times == 1 else 80.0)


@pytest.mark.parametrize(("fall", "misfit", "imitated"), [(50.0, 1.01, True), (150.0, 1.01, False), (50.0, 1.2, False)])
def test_what_a_blurred_sensor_explains_as_well_is_no_evidence(monkeypatch, fall, misfit, imitated):
    monkeypatch.setattr("jaxbacklash.criticism.unseen.blurred", lambda bench, trial: 100.0)
    before = Model(frozenset({"preload"}), cost=1000.0, misfit=misfit)
    after = Model(frozenset({"gravity", "preload"}), cost=1000.0 - 0.5 * fall)
    assert Search(Bench()).imitated(before, after) == imitated


class Law(SimpleNamespace):
    """A law by what it contains."""

    def __call__(self):
        return self


def test_a_law_is_reduced_to_the_simpler_one_that_does_as_well(monkeypatch):
    significant(monkeypatch, 100.0)
    monkeypatch.setattr("jaxbacklash.criticism.search.gain", lambda before, after: before.criterion - after.criterion)
    at = {"bound": False}
    monkeypatch.setattr("jaxbacklash.criticism.search.shapeless", lambda trial, name, slowest: at["bound"])
    rich = Model(frozenset({"stribeck"}), cost=100.0, free=("backlash", "Tc", "Ts"), tied=False)
    plain = Model(frozenset({"coulomb_joint"}), cost=100.4, free=("backlash", "Tc"), tied=False)
    search = Search(Bench())
    search.bench.laws = laws(stribeck=("coulomb_joint",), coulomb_joint=())
    monkeypatch.setattr(search, "simplified", lambda final, name, other: plain)
    monkeypatch.setattr(search, "settle", lambda trial: trial)
    steps = search.reduced([Step(rich, "stribeck", (), ())])
    assert [(s.trial, s.added, s.dropped) for s in steps[1:]] == [(plain, "coulomb_joint", ("stribeck",))]
    worse = replace(plain, cost=150.0)
    monkeypatch.setattr(search, "simplified", lambda final, name, other: worse)
    assert len(search.reduced([Step(rich, "stribeck", (), ())])) == 1
    at["bound"] = True
    assert len(search.reduced([Step(rich, "stribeck", (), ())])) == 2
    stuck = replace(worse, misfit=1.1)
    monkeypatch.setattr(search, "simplified", lambda final, name, other: stuck)
    assert len(search.reduced([Step(rich, "stribeck", (), ())])) == 1


@pytest.mark.parametrize(("ahead", "rests", "kept"), [(4.0, False, False), (60.0, False, True), (60.0, True, False)])
def test_a_law_of_undetermined_shape_stays_where_it_clearly_acts(monkeypatch, ahead, rests, kept):
    """But where the link rests for long, what it adds there says nothing."""
    significant(monkeypatch, 100.0)
    rich = Model(frozenset({"stribeck"}), cost=100.0, free=("backlash", "Tc", "Ts", "vs"))
    plain = Model(frozenset({"coulomb_joint"}), cost=100.0 + 10.0 + 0.5 * ahead, free=("backlash", "Tc"))
    search = Search(Bench())
    search.bench.laws = laws(stribeck=("coulomb_joint",), coulomb_joint=())
    search.bench.rests = lambda port: rests
    monkeypatch.setattr("jaxbacklash.criticism.search.shapeless", lambda trial, name, slowest: True)
    monkeypatch.setattr(search, "simplified", lambda final, name, other: plain)
    monkeypatch.setattr(search, "settle", lambda trial: trial)
    asked = []  # whether what near rest seemed to add is friction that gives; see `test_yielding`
    monkeypatch.setattr("jaxbacklash.criticism.search.gives_after_all", lambda search, steps: asked.append(1) or steps)
    path = search.reduced([Step(rich, "stribeck", (), ())])
    assert (path[-1].trial is rich) == (not asked) == kept


def test_what_fell_behind_on_free_windows_is_not_tied(monkeypatch):
    monkeypatch.setattr("jaxbacklash.criticism.search.gain", lambda before, after: before.criterion - after.criterion)
    search = Search(Bench())
    final = Model(frozenset({"gravity"}), cost=100.0)
    rival = frozenset({"preload"})
    assert not search.ruled_out(final, rival)
    search.known[final.names, False] = Model(final.names, cost=90.0, tied=False)
    search.known[rival, False] = Model(rival, cost=99.0, tied=False)
    assert search.ruled_out(final, rival)
    search.known[rival, False] = Model(rival, cost=99.0, tied=False, done=False)
    assert not search.ruled_out(final, rival)
    search.known[rival, False] = Model(rival, cost=90.5, tied=False)
    assert not search.ruled_out(final, rival)


@pytest.mark.parametrize(("behind", "misfit", "given_up"), [(20.0, 1.0, True), (1.0, 1.0, False), (20.0, 2.0, False)])
def test_a_richer_law_clearly_behind_a_simpler_one_that_explains_is_not_fitted_on(monkeypatch, behind, misfit, given_up):
    monkeypatch.setattr("jaxbacklash.criticism.tried.gain", lambda before, after: before.criterion - after.criterion)
    monkeypatch.setattr("jaxbacklash.criticism.search.gain", lambda before, after: before.criterion - after.criterion)
    plain = Model(frozenset({"coulomb_joint"}), cost=100.0, tied=False, done=False, misfit=misfit)
    rich = Model(frozenset({"stribeck"}), cost=100.0 + 0.5 * behind, tied=False, done=False, misfit=misfit)
    search, finished = Search(Bench()), []
    search.bench.laws = laws(stribeck=("coulomb_joint",), coulomb_joint=())
    monkeypatch.setattr(search, "unstuck", lambda before, tried: tried)
    monkeypatch.setattr(search, "finish", lambda trial: finished.append(min(trial.names)) or trial)
    search.finished(Model(frozenset(), cost=1e4, tied=False), {"coulomb_joint": plain, "stribeck": rich})
    assert sorted(finished) == ([] if given_up else ["coulomb_joint", "stribeck"])
    # Where its simpler law is kept, one trajectory of the richer one is not asked for.
    search.known = {(plain.names, False): plain, (rich.names, False): rich}
    assert search.ruled_out(replace(plain, tied=True), rich.names) == given_up


@pytest.mark.parametrize(("misfit", "kept"), [(40.0, False), (1.2, True)])
def test_what_no_trajectory_follows_is_no_explanation(monkeypatch, misfit, kept):
    """Free windows begin with an internal state of their own: far from the noise that soaks up anything."""
    search = Search(Bench())
    search.bench.laws["lugre"] = SimpleNamespace(states=("w",), absorbs=(), reach=math.inf)
    monkeypatch.setattr("jaxbacklash.criticism.search.measures_only", lambda law: False)
    friction = Model(frozenset({"preload"}), cost=1e5, misfit=200.0, tied=False)
    soaking = Model(frozenset({"preload", "lugre"}), cost=1e3, misfit=misfit, tied=False)
    steps = [Step(replace(friction, names=frozenset()), None, (), ()), Step(friction, "preload", (), ())]
    steps[0] = replace(steps[0], trial=replace(steps[0].trial, misfit=900.0))
    trimmed = search.trim([*steps, Step(soaking, "lugre", (), ())])
    assert [s.added for s in trimmed] == [None, "preload", *(["lugre"] if kept else [])]


def laws(**absorbs):
    torque = lambda self: 0.0  # noqa: E731
    return {n: SimpleNamespace(states=(), absorbs=a, slides=True, torque=torque, port="joint") for n, a in absorbs.items()}


@pytest.mark.parametrize("ahead", [5.0, 50.0])
def test_models_that_take_each_others_place_come_to_an_end(monkeypatch, ahead):
    """A law stands in for a simpler one that it contains, is reduced to it, and would stand in again."""
    simple, rich = Model(frozenset({"simple"}), cost=100.0), Model(frozenset({"rich"}), cost=100.0 - 0.5 * ahead)
    significant(monkeypatch, 100.0)
    search, asked = Search(Bench()), []
    search.bench.laws = laws(simple=(), rich=("simple",), other=())
    monkeypatch.setattr(search, "instead", lambda steps, name: asked.append(name) or [rich if name == "simple" else simple])
    monkeypatch.setattr(search, "reduced", lambda steps: [*steps, Step(simple, "simple", ("rich",), ())])
    steps, level = search.swap([Step(simple, "simple", (), ())])
    assert steps[-1].trial.names == simple.names
    assert (("rich",) in level)
    assert len(asked) == 1


@pytest.mark.parametrize(("ahead", "taken"), [(1.0, False), (2.1, False), (10.0, True)])
def test_a_richer_relative_replaces_a_law_only_where_it_is_clearly_better(monkeypatch, ahead, taken):
    simple, rich = Model(frozenset({"simple"}), cost=100.0), Model(frozenset({"rich"}), cost=100.0 - 0.5 * ahead)
    significant(monkeypatch, 100.0)
    search = Search(Bench())
    search.bench.laws = laws(simple=(), rich=("simple",), other=())
    monkeypatch.setattr(search, "instead", lambda steps, name: [rich] if name == "simple" else [])
    monkeypatch.setattr(search, "reduced", lambda steps: steps)
    steps, _ = search.swap([Step(simple, "simple", (), ())])
    assert (steps[-1].trial is rich) == taken


def test_what_a_replacement_makes_needless_goes_with_what_it_replaces(monkeypatch):
    """A wrong law and one that made up for it explain as much as the right one; the second is needless beside that."""
    significant(monkeypatch, 0.5)
    wrong = Model(frozenset({"simple", "other"}), cost=100.0, free=("backlash", "a", "b"))
    right = Model(frozenset({"rich", "other"}), cost=90.0, free=("backlash", "c", "b"))
    without_new = Model(frozenset({"other"}), cost=95.0, free=("backlash", "b"))
    alone = Model(frozenset({"rich"}), cost=90.5, free=("backlash", "c"))
    search = Search(Bench())
    search.known = {(m.names, True): m for m in (without_new, alone, Model(frozenset(), cost=500.0))}
    search.bench.laws = laws(simple=(), rich=(), other=())
    monkeypatch.setattr(search, "without", lambda before, name: search.known[before.names - {name}, True])
    monkeypatch.setattr("jaxbacklash.criticism.search.gain", lambda before, after: before.criterion - after.criterion)
    monkeypatch.setattr(search, "instead", lambda steps, name: [right] if name == "simple" else [])
    monkeypatch.setattr(search, "reduced", lambda steps: steps)
    steps, _ = search.swap([Step(wrong, "simple", (), ())])
    assert (steps[-1].trial.names, steps[-1].added, steps[-1].dropped) == ({"rich"}, "rich", ("other",))


@pytest.mark.parametrize(("predicted", "searches"), [(1.0, 1), (1e3, 3)])
def test_what_promises_too_little_is_not_looked_for_by_free_windows(predicted, searches):
    before = Model(frozenset({"preload"}), cost=100.0)
    stuck = Model(frozenset({"gravity", "preload"}), cost=1e6, misfit=50.0, done=False)
    search = Search(Bench(stuck, replace(stuck, cost=80.0, tied=False), replace(stuck, cost=90.0)))
    search.bench.record = SimpleNamespace(samples=1000)
    search.add(before, SimpleNamespace(name="gravity", effect=Gravity(G=20.0), gain=predicted))
    assert len(search.bench.asked) == searches


@pytest.mark.parametrize(
    ("elsewhere", "from_here", "ties"),
    [
        (Model(frozenset({"coulomb_joint"}), cost=200.0, tied=False, misfit=1.4), 190.0, False),
        (Model(frozenset({"coulomb_joint"}), cost=200.0, tied=False, misfit=1.4), 100.2, True),
        (Model(frozenset({"coulomb_joint"}), cost=130.0, tied=False, misfit=1.0), None, True),
        (None, None, True),
    ],
    ids=["behind from here too", "was stuck", "explains", "unknown"],
)
def test_a_simpler_law_that_free_windows_leave_behind_is_not_looked_for_as_one_trajectory(elsewhere, from_here, ties):
    laws = {"stribeck": Stribeck, "coulomb_joint": CoulombJoint}
    final, plain = Model(frozenset({"stribeck"}), cost=110.0), frozenset({"coulomb_joint"})
    answers = [] if from_here is None else [Model(plain, cost=from_here, tied=False, misfit=1.4)]
    tied = Model(plain, cost=150.0)
    search = Search(Bench(*answers, *([tied] if ties else [])))
    search.bench.laws = laws
    search.bench.effects = lambda trial: {"stribeck": Stribeck()}
    search.known[final.names, False] = Model(final.names, cost=100.0, tied=False)
    if elsewhere is not None:
        search.known[plain, False] = elsewhere
    found = search.simplified(final, "stribeck", "coulomb_joint")
    assert found.tied == ties
    assert search.bench.asked == [(plain, False)] * len(answers) + [(plain, True)] * ties


def test_a_law_at_the_limit_of_its_shape_gives_way_to_a_simpler_one_that_promised_little(monkeypatch):
    monkeypatch.setattr("jaxbacklash.criticism.search.at_a_bound", lambda trial, name: at["bound"])
    at = {"bound": True}
    final = Model(frozenset({"torque_ripple"}), cost=100.0, free=("backlash", "A", "N", "phi"))
    promises = {"torque_ripple": (900.0, 3), "preload": (100.0, 1), "gravity": (1.0, 1), "stribeck": (0.5, 3)}
    ranking = tuple(SimpleNamespace(name=n, gain=g, parameters=p, effect=n) for n, (g, p) in promises.items())
    search = Search(Bench())
    laws = {n: Law(states=(), absorbs=(), family=None, torque=None, reshape=None) for n in promises}
    search.bench.laws = laws
    monkeypatch.setattr("jaxbacklash.criticism.search.families", lambda bench: {})
    steps = [Step(Model(frozenset(), cost=1000.0), None, (), ranking), Step(final, "torque_ripple", (), ())]
    monkeypatch.setattr(search, "joined", lambda effects, before: Model(frozenset(effects), cost=100.0))
    assert [sorted(t.names) for t in search.instead(steps, "torque_ripple")] == [["preload"], ["gravity"]]
    at["bound"] = False
    assert not list(search.instead(steps, "torque_ripple"))


def test_what_is_still_on_its_way_is_finished_before_it_is_tied():
    names = frozenset({"gravity"})
    begun = Model(names, cost=500.0, tied=False, done=False, misfit=1.4)
    finished, tied = Model(names, cost=100.0, tied=False), Model(names, cost=100.5)
    search = Search(Bench(finished, tied))
    assert search.settle(begun) == tied
    assert search.bench.asked == [(names, False), (names, True)]


@pytest.mark.parametrize("cost", [70.0, 101.0])
def test_a_replacement_that_is_needless_itself_goes_too(monkeypatch, cost):
    """A law in the place of what had held another up, if only to as much: that other one does alone."""
    significant(monkeypatch, 0.5)
    wrong = Model(frozenset({"right", "stands in"}), cost=100.0, free=("backlash", "a", "b"))
    other = Model(frozenset({"right", "new"}), cost=cost, free=("backlash", "a", "c"))
    alone, lost = Model(frozenset({"right"}), cost=cost + 0.5, free=("backlash", "a")), Model(frozenset({"new"}), cost=900.0)
    search = Search(Bench())
    known = {m.names: m for m in (alone, lost, Model(frozenset(), cost=1000.0))}
    search.bench.laws = laws(**{"right": (), "stands in": (), "new": ()})
    monkeypatch.setattr(search, "without", lambda before, name: known[before.names - {name}])
    monkeypatch.setattr("jaxbacklash.criticism.search.gain", lambda before, after: before.criterion - after.criterion)
    monkeypatch.setattr(search, "instead", lambda steps, name: [other] if name == "stands in" else [])
    monkeypatch.setattr(search, "reduced", lambda steps: steps)
    steps, _ = search.swap([Step(wrong, "right", ("nibbled",), ())])
    assert (steps[-1].trial, steps[-1].added, steps[-1].dropped) == (alone, "right", ("nibbled", "stands in"))


@pytest.mark.parametrize(("misfits", "left"), [((1.4, 1.2, 1.02), 1.02), ((1.4, 1.39), 1.4), ((2.5,), 2.1)])
def test_windows_that_friction_has_stuck_begin_again_from_the_data(misfits, left):
    names = frozenset({"rubs"})
    stuck = Model(names, cost=500.0, tied=False, misfit=2.1)
    search = Search(Bench(*(Model(names, cost=100.0 * m, tied=False, misfit=m) for m in misfits)))
    search.bench.laws = laws(rubs=())
    search.bench.fit = lambda effects, joint, patience, *, tied: tied or search.bench.answers.pop(0)
    assert search.renewed(stuck).misfit == left
    assert not search.bench.answers


def test_no_law_with_states_is_tried_beside_a_link_that_is_not_seen_and_floats():
    """In windows apart such a link follows any force: what a state of its own explains there is nothing."""
    bench = SimpleNamespace(outright=("coulomb_ground",), grips=lambda names: "coulomb_ground" in names, laws={})
    search = Search.__new__(Search)
    search.bench = bench
    assert search.hidden(SimpleNamespace(names=frozenset({"gravity"}), misfit=300.0)) == []


def test_a_candidate_whose_trajectory_runs_away_promises_nothing():
    step, gain = _gain(np.array([[1.0, np.inf], [np.inf, 2.0]]), np.array([1.0, 1.0]), 1)
    assert gain == 0.0
    assert np.array_equal(step, np.zeros(2))
