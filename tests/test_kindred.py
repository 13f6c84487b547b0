"""Near relatives of friction that gives: told apart by one trajectory where the weak form is blind to them."""

from types import SimpleNamespace

import pytest

from jaxbacklash.criticism import unseen
from jaxbacklash.criticism.evidence import demanded
from jaxbacklash.criticism.under_noise import changes
from jaxbacklash.criticism.unseen import Unseen
from jaxbacklash.criticism.workbench import Workbench
from jaxbacklash.effects.hysteresis import BoucWen, Dahl, Lugre, slope_and_level
from jaxbacklash.fitting.setup import base_system
from tests.hidden import hidden, noisier

OTHERS = ("lugre", "bouc_wen")


def as_dahl(record, rig, law):
    """A bench, and its fit of Dahl's law, begun at the slope and level of another of the family."""
    base, free, _ = base_system(record, "joint", rig.inertia)
    bench = Workbench(record, base, free, 0.2)
    ((slope, level),) = slope_and_level(law)
    alone = bench.fit({"dahl": Dahl(Fc=level, sigma=slope)}, patience=60)
    return bench, bench.fit(bench.effects(alone), alone, tied=True, patience=60)


@pytest.mark.parametrize(("law", "seed"), [pytest.param(Dahl, 1, marks=pytest.mark.slow), (Dahl, 2), (BoucWen, 2)])
def test_a_relative_is_promised_where_it_is_the_truth(law, seed):
    name = {Dahl: "dahl", BoucWen: "bouc_wen"}[law]
    record, rig, values, _ = hidden(name, "multisine", seed)
    bench, dahl = as_dahl(noisier(record, 5.0, seed), rig, law(**values[name]))
    assert dahl.misfit < 1.1
    promised = {other: fall for other, fall, _ in changes(bench, dahl, "dahl", OTHERS, demanded(bench))}
    assert ("bouc_wen" in promised) == (law is BoucWen)


@pytest.mark.slow
def test_what_is_promised_of_a_relative_is_kept():
    record, rig, values, _ = hidden("bouc_wen", "multisine", 2)
    bench, dahl = as_dahl(noisier(record, 5.0, 2), rig, BoucWen(**values["bouc_wen"]))
    ((_, fall, law),) = changes(bench, dahl, "dahl", ["bouc_wen"], demanded(bench))
    found = bench.fit({"bouc_wen": law}, dahl, tied=True, patience=60, followed=True)
    assert 2.0 * (dahl.cost - found.cost) > 0.5 * fall


LOOKED = SimpleNamespace(blind=False, motion=None)


@pytest.mark.parametrize(
    ("misfit", "beside", "tied", "quick", "by_look", "by_trajectory"),
    [
        (0.99, (), True, LOOKED, False, True),
        (1.2, (), True, LOOKED, True, True),
        (0.99, ("gravity",), True, LOOKED, True, True),
        (1.2, (), False, LOOKED, True, False),
        (0.99, (), True, SimpleNamespace(blind=True, motion=None), False, False),
    ],
)
def test_who_is_asked_for_the_kin_of_a_law(monkeypatch, misfit, beside, tied, quick, by_look, by_trajectory):
    """The quick look where there is more to the model or something missing; the trajectory where there is one."""
    asked = []
    bench = SimpleNamespace(laws={"dahl": Dahl, "lugre": Lugre, "bouc_wen": BoucWen}, quick=quick, outright=())
    found = SimpleNamespace(name="lugre")
    monkeypatch.setattr(unseen, "members", lambda *args: asked.append("look") or [found])
    monkeypatch.setattr(unseen, "without", lambda *args: ({}, None, ()))

    def promised(bench, trial, name, others, least):
        asked.append("trajectory")
        return [(other, 20.0, bench.laws[other]()) for other in others]

    monkeypatch.setattr(unseen, "changes", promised)
    trial = SimpleNamespace(names=frozenset({"dahl", *beside}), misfit=misfit, tied=tied, system=None)
    kin = [m.name for m in Unseen(bench).kindred(trial, "dahl")]
    assert ("look" in asked, "trajectory" in asked) == (by_look, by_trajectory)
    assert sorted(kin) == ["bouc_wen", "lugre"] if by_trajectory else kin == ["lugre"] * by_look


@pytest.mark.parametrize("ahead", [-0.9, 0.9, 5.0])
def test_a_relative_that_does_as_well_is_named_beside_the_one_kept(ahead):
    bench = SimpleNamespace(laws={"dahl": Dahl, "lugre": Lugre, "bouc_wen": BoucWen})
    search = Unseen(bench)

    def model(criterion, *names, misfit=0.99, tied=True):
        trial = SimpleNamespace(names=frozenset(names), criterion=criterion, misfit=misfit, tied=tied)
        search.known[trial.names, tied] = trial
        return trial

    final = model(100.0, "dahl", "gravity")
    as_good = model(100.0 - ahead * demanded(bench), "bouc_wen", "gravity")
    model(100.0 + 1.1 * demanded(bench), "lugre", "gravity")
    model(100.0, "lugre")
    assert search.kin_as_good(final) == {("bouc_wen", "gravity"): as_good}
    assert search.kin_as_good(SimpleNamespace(**{**vars(final), "tied": False})) == {}
