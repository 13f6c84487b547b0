"""Friction that gives in the place of dry friction that no trajectory follows, on models that are only numbers."""

import math
from types import SimpleNamespace

import pytest

from jaxbacklash.criticism import yielding as module
from jaxbacklash.criticism.search import Search
from jaxbacklash.criticism.steps import Step
from jaxbacklash.criticism.tried import Tried
from jaxbacklash.criticism.yielding import given_at_last, gives_after_all, sharp_as_well, yielding
from jaxbacklash.effects import CoulombJoint, Dahl, Lugre

from .number_models import Model


def model(cost, *, tied=True, misfit=1.0, **effects):
    return Model(frozenset(effects), cost, tied, misfit=misfit, effects=effects, system=SimpleNamespace(effects=effects))


class Bench:
    """Answers fits of each law from a list, and notes with what they began."""

    def __init__(self, **answers):
        self.answers, self.begun = answers, []
        self.laws = {"coulomb_joint": CoulombJoint, "dahl": Dahl}
        self.static = {"coulomb_joint": CoulombJoint}
        self.outright, self.slowest, self.is_cut, self.quick = (), 0.0, False, SimpleNamespace(motion=None, blind=False)

    def effects(self, trial):
        return dict(trial.effects)

    def grips(self, names):
        return False

    def fit(self, effects, start=None, **how):
        (name,) = effects
        if not how.get("tied"):
            return model(90.0, tied=False, **effects)
        self.begun.append(effects[name])
        return self.answers[name].pop(0)

    def fit_softly(self, trial, *_):
        return trial


@pytest.fixture(autouse=True)
def presliding(monkeypatch):
    monkeypatch.setattr(module, "may_replace", lambda bench, trial, name, others, sure: [True] * len(others))
    monkeypatch.setattr(Dahl, "guesses", classmethod(lambda cls, system, motion=None: [cls(1.0, 1e3), cls(1.0, 1e4)]))


def found(final, *, shapeless=False, monkeypatch, **answers):
    monkeypatch.setattr(module, "shapeless", lambda *_: shapeless)
    bench = Bench(**answers)
    search = Tried(bench)
    return yielding(search, final), bench


def models(cost, misfit=1.0):
    dry, gives = CoulombJoint(3.0), Dahl(3.5, 2e3)
    sharp = model(cost, misfit=misfit, coulomb_joint=dry)
    return model(100.0, tied=False, coulomb_joint=dry), model(100.0, dahl=gives), sharp


def test_one_trajectory_is_left_alone(monkeypatch):
    _, soft, sharp = models(100.0)
    assert found(sharp, monkeypatch=monkeypatch)[0] is None
    assert found(soft, monkeypatch=monkeypatch)[0] is None


def test_friction_that_gives_takes_the_place_of_what_no_trajectory_follows(monkeypatch):
    loose, soft, stuck = models(1e5, misfit=9.0)
    lost = model(1e5, misfit=9.0, dahl=Dahl(3.0, 3e3))
    (name, trial), bench = found(loose, monkeypatch=monkeypatch, dahl=[lost, soft], coulomb_joint=[stuck])
    assert name == "dahl"
    assert trial is soft
    assert [(float(law.Fc), float(law.sigma)) for law in bench.begun[:2]] == [(3.0, 3e3), (3.0, 3e4)]
    assert float(bench.begun[2].Tc) == pytest.approx(3.5)


def test_another_of_the_family_is_tried_where_the_first_follows_nothing(monkeypatch):
    """It holds twice as much as it slides with: no trajectory of Dahl's friction followed, and it was named Coulomb's."""
    monkeypatch.setattr(module, "shapeless", lambda *_: False)
    guess, right = ({"sigma0": 3e3, "sigma1": 5.0, "Fc": level, "Fs": 1.5 * level, "vs": 0.12} for level in (1.0, 5.5))
    monkeypatch.setattr(Lugre, "guesses", classmethod(lambda cls, system, motion=None: [cls(**guess)]))
    loose, _, stuck = models(1e5, misfit=9.0)
    lost, soft = model(1e5, misfit=9.0, dahl=Dahl(3.0, 3e3)), model(100.0, lugre=Lugre(**right))
    bench = Bench(dahl=[lost, lost], lugre=[soft], coulomb_joint=[stuck])
    bench.laws["lugre"] = Lugre
    assert yielding(Tried(bench), loose) == ("lugre", soft)
    (begun,) = [law for law in bench.begun if isinstance(law, Lugre)]
    assert (float(begun.Fs), float(begun.Fc)) == (3.0, 2.0)  # at the level of the dry friction


@pytest.mark.parametrize(("lost", "name"), [(0.1, "coulomb_joint"), (200.0, "dahl")])
def test_dry_friction_that_follows_from_there_is_kept_unless_it_leaves_clearly_more(monkeypatch, lost, name):
    loose, soft, sharp = models(100.0 + lost)
    assert found(loose, monkeypatch=monkeypatch, dahl=[soft], coulomb_joint=[sharp])[0][0] == name


def test_a_law_whose_shape_the_record_does_not_tell_is_no_answer(monkeypatch):
    loose, soft, stuck = models(1e5, misfit=9.0)
    assert found(loose, monkeypatch=monkeypatch, shapeless=True, dahl=[soft], coulomb_joint=[stuck])[0] is None


@pytest.mark.parametrize(
    ("apart", "cost", "misfit", "as_well"),
    [(1.0, 100.3, 1.0, True), (1.0, 110.0, 1.0, False), (1.0, 99.0, 1.2, False), (1.4, 101.0, 1.0, False)],
    ids=["does as well", "is behind", "leaves a rest", "is ruled out by free windows"],
)
def test_dry_friction_takes_the_place_of_what_gives_where_it_does_as_well(monkeypatch, apart, cost, misfit, as_well):
    """Its kin may have led there: what gives was then never held against dry friction itself."""
    _, soft, sharp = models(cost, misfit=misfit)
    bench = Bench(coulomb_joint=[sharp])
    search = Tried(bench)
    search.known[frozenset({"coulomb_joint"}), False] = model(90.0, tied=False, misfit=apart, coulomb_joint=CoulombJoint(3.0))
    assert sharp_as_well(search, soft) == (("coulomb_joint", sharp) if as_well else None)
    assert [float(law.Tc) for law in bench.begun] == ([] if apart > 1.1 else [pytest.approx(3.5)])


def test_what_the_quick_look_puts_far_behind_is_not_fitted(monkeypatch):
    monkeypatch.setattr(module, "may_replace", lambda bench, trial, name, others, sure: [False] * len(others))
    _, soft, sharp = models(100.0)
    bench = Bench(coulomb_joint=[sharp])
    assert sharp_as_well(Tried(bench), soft) is None
    assert not bench.begun


def test_dry_friction_and_free_windows_are_left_alone():
    loose, _, sharp = models(100.0)
    assert sharp_as_well(Tried(Bench()), sharp) is None
    assert sharp_as_well(Tried(Bench()), loose) is None


@pytest.mark.parametrize(
    ("cost", "misfit", "shapeless", "kept"),
    [(80.0, 1.0, False, True), (99.9, 1.0, False, False), (80.0, 1.0, True, False), (80.0, 9.0, False, False)],
    ids=["clearly better", "as good", "its shape is not determined", "no trajectory"],
)
def test_what_looked_like_growth_near_rest_may_be_friction_that_gives(monkeypatch, cost, misfit, shapeless, kept):
    """LuGre's friction beside weight was named Coulomb's, at 9945 against 9727: Stribeck's had been given up for its shape."""
    monkeypatch.setattr(module, "shapeless", lambda *_: shapeless)
    dry, soft = model(100.0, coulomb_joint=CoulombJoint(3.0)), model(cost, misfit=misfit, dahl=Dahl(3.5, 2e3))
    search = Search(Bench(dahl=[soft, soft]))
    monkeypatch.setattr(search, "prune", lambda trial, **_: (trial, ()))
    monkeypatch.setattr(search, "with_kin", lambda steps: steps)
    path = gives_after_all(search, [Step(dry, "coulomb_joint", ("stribeck",), ())])
    assert path[-1].trial.names == ({"dahl"} if kept else {"coulomb_joint"})
    assert path[-1].dropped == (("coulomb_joint",) if kept else ("stribeck",))


@pytest.mark.parametrize(("falls", "asked"), [([math.nan, 20.0, -1.0], True), ([-40.0, 1.0, -80.0], False)])
def test_one_trajectory_of_dry_friction_is_asked_whether_it_gives(monkeypatch, falls, asked):
    """Bouc-Wen's beside a sensor's gain: the search had tried LuGre's alone, which had stuck, and ended with Coulomb's at 9830,
    where Dahl's comes to 9761."""

    class Asked:
        along = None

        def __init__(self, bench, trial):
            self.falls = list(falls)

        def gained(self, torque):
            return self.falls.pop(0)

    monkeypatch.setattr(module, "Sounding", Asked)
    monkeypatch.setattr(module, "own_torques", lambda laws, *_: [0.0] * max(len(laws), 3 if len(laws) > 1 else 1))
    tried = []
    monkeypatch.setattr(module, "gives_after_all", lambda search, steps: tried.append(1) or steps)
    search = Search(Bench())
    search.bench.base_free = ()
    for trial in (model(100.0, coulomb_joint=CoulombJoint(3.0)), model(100.0, tied=False, coulomb_joint=CoulombJoint(3.0))):
        given_at_last(search, [Step(trial, "coulomb_joint", (), ())])
    assert tried == [1] * asked  # windows apart are not asked
