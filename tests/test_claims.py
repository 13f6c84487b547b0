"""What an effect claims by its own standard error, and what it only led a stuck search on to."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.evidence import at_a_limit, claim, led_on, significance, worth
from jaxbacklash.criticism.search import Search
from jaxbacklash.criticism.steps import Step
from jaxbacklash.criticism.verdict import judge_rest
from jaxbacklash.criticism.workbench import Trial
from jaxbacklash.mechanics import catalogue

from .number_models import Model

FREE = ("backlash", "stiffness", "coulomb_joint.Tc", "gravity.G")


def trial(values, schur, cost=1000.0, tied=True):
    """A fitted joint with friction and gravity, by its numbers alone."""
    joint = jb.base_motion_joint(inertia=3.0, backlash=values[0], stiffness=values[1], damping=20.0)
    names = frozenset(name.partition(".")[0] for name in FREE[: len(values)] if "." in name)
    laws = {"coulomb_joint": lambda: jb.CoulombJoint(values[2]), "gravity": lambda: jb.Gravity(values[3])}
    system = joint.with_effects(*(laws[name]() for name in sorted(names)))
    q = len(values)
    return Trial(
        system, names, FREE[:q], None, cost, 1.0, schur[:q, :q], np.zeros(q), np.array([1e-3, 100.0, 0.1, 1.0])[:q],
        tied, True, 10.0 * q, 1.0,
    )  # fmt: skip


def information(seed=1):
    columns = np.random.default_rng(seed).standard_normal((60, 4)) @ np.diag([30.0, 20.0, 10.0, 2.0])
    return columns.T @ columns


def bench(slides=True):
    laws = {"coulomb_joint": SimpleNamespace(slides=slides), "gravity": SimpleNamespace(slides=False)}
    return SimpleNamespace(laws=laws)


def test_a_claim_is_what_leaving_out_costs_a_quadratic():
    """Against the minimum of the quadratic itself, with the strength held at zero; for one strength the square of its errors."""
    schur, values = information(), (0.02, 1e4, 5.0, 0.7)
    fitted = trial(values, schur)
    scaled = 0.7 / fitted.scales[3]
    rest = np.linalg.solve(schur[:3, :3], -schur[:3, 3] * -scaled)
    moved = np.append(rest, -scaled)
    assert claim(fitted, "gravity") == pytest.approx(float(moved @ schur @ moved), rel=1e-9)
    assert claim(fitted, "gravity") == pytest.approx(significance(fitted, "gravity") ** 2, rel=1e-6)
    assert claim(replace(fitted, misfit=2.0, correlation=3.0), "gravity") == pytest.approx(claim(fitted, "gravity") / 12.0)


@pytest.mark.parametrize(("strength", "slides", "led"), [(0.02, True, True), (2.0, True, False), (0.02, False, False)])
def test_what_an_effect_beside_friction_cannot_account_for_is_not_its_evidence(strength, slides, led):
    schur = information()
    before = trial((0.02, 1e4, 5.0), schur, cost=1000.0)
    after = trial((0.02, 1e4, 5.0, strength), schur, cost=950.0)
    assert led_on(bench(slides), before, after, "gravity") == led
    expected = claim(after, "gravity") if led else 100.0 - 10.0
    assert worth(bench(slides), before, after, "gravity") == pytest.approx(expected)
    assert not led_on(bench(slides), replace(before, tied=False), after, "gravity")
    assert not led_on(bench(slides), replace(before, misfit=1.5), after, "gravity")


def test_a_strength_at_the_end_of_its_range_explains_nothing():
    joint = jb.base_motion_joint(inertia=3.0, backlash=0.02, stiffness=1e4, damping=20.0)

    def verdict(g):
        names, system = frozenset({"sensor_gain"}), joint.with_effects(jb.SensorGain(g))
        final = SimpleNamespace(system=system, names=names, free=("sensor_gain.g",), misfit=1.0, cost=5e3)
        score = SimpleNamespace(rms=1.0, median=1.0, nrmse=0.01, observed="z")
        return at_a_limit(final, "sensor_gain"), judge_rest(final, [SimpleNamespace(score=score, heldout=None)] * 2)

    for g, limit in ((2.0, True), (0.5, True), (1.0, False), (1.9, False)):
        at, said = verdict(g)
        assert at == limit
        assert said.complete == (not limit)
        assert ("end of its range" in said.text) == limit


@pytest.mark.parametrize(("reached", "cost", "kept"), [(1.0, 60.0, "static"), (1.0, 99.0, "lugre"), (1.03, 60.0, "lugre")])
def test_a_law_that_no_trajectory_follows_gives_way_to_several_without_states(monkeypatch, reached, cost, kept):
    """The first of those brings less than the law with internal states; only where its path ends better is that taken."""
    before = Model(frozenset({"asymmetric_gap"}), cost=200.0, misfit=1.2)
    spring = Model(frozenset({"asymmetric_gap", "gap_spring"}), cost=150.0, misfit=1.1)
    soft = Model(frozenset({"asymmetric_gap", "lugre"}), cost=100.0, misfit=1.02)
    both = Model(frozenset({"asymmetric_gap", "gap_spring", "coulomb_ground"}), cost=cost)
    laws = {name: catalogue()[name] for name in ("asymmetric_gap", "gap_spring", "coulomb_ground", "dahl", "lugre")}
    search = Search(SimpleNamespace(laws=laws, record=SimpleNamespace(samples=1000), static=laws))
    search.known[soft.names, False] = replace(soft, tied=False, misfit=reached)
    search.known[spring.names, True] = spring
    monkeypatch.setattr(search, "settle", lambda trial: trial)
    monkeypatch.setattr(search, "forward", lambda start, steps, least: [*steps, Step(both, "coulomb_ground", (), ())])
    kin = replace(soft, names=frozenset({"asymmetric_gap", "dahl"}))  # came first, and gave way to another of its family
    tried = {"gap_spring": 90.0, "dahl": 190.0}
    path = [Step(before, None, (), (), tried), Step(kin, "dahl", (), ()), Step(soft, "lugre", (), ())]
    steps = search.with_static(path)
    found = [s.trial for s in steps]
    assert found == ([before, spring, both] if kept == "static" else [before, kin, soft])
    search.known[spring.names, False] = replace(spring, tied=False, misfit=1.0)
    static = [*path, Step(spring, "gap_spring", ("lugre",), ())]
    assert search.with_static(static) is static


def test_a_search_keeps_no_model_twice(monkeypatch):
    """Each of two of a family is better seen from the other, as one is judged on free windows and the other is not."""
    costs = {"dahl": 50.0, "lugre": 40.0}

    def attempts(current, ranking):
        other = {"dahl": "lugre", "lugre": "dahl"}.get(next(iter(current.names), ""), "dahl")
        ahead = current.cost - 20.0  # whatever stands now, the other one is ahead of it
        return {other: Model(frozenset({other}), cost=ahead, tied=False)}

    laws = {name: catalogue()[name] for name in costs}
    search = Search(SimpleNamespace(laws=laws, static={}, outright=()))
    monkeypatch.setattr("jaxbacklash.criticism.search.rank", lambda *_: ())
    for name, does in {
        "attempts": attempts,
        "finished": lambda current, tried: tried,
        "relieved": lambda before, after: before,
        "loosened": lambda trial: replace(trial, tied=False),
        "settle": lambda trial: Model(trial.names, cost=costs[next(iter(trial.names))]),
        "prune": lambda trial, spare=None: (trial, ()),
    }.items():
        monkeypatch.setattr(search, name, does)
    base = Model(frozenset(), cost=500.0)
    steps = search.forward(base, [Step(base, None, (), ())], 0.25)
    assert [sorted(s.trial.names) for s in steps] == [[], ["dahl"], ["lugre"]]
