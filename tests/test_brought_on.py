"""An effect that does nothing but bring on a search that had stuck is not kept."""

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism import brought_on
from jaxbacklash.criticism.brought_on import without_what_brought_on
from jaxbacklash.criticism.search import Search, Step

from .number_models import Model
from .test_search_steps import Bench

STUCK = Model(frozenset(), cost=500.0)
ONE, TWO = Model(frozenset({"gravity"}), cost=300.0), Model(frozenset({"gravity", "preload"}), cost=100.0)
PATH = [Step(STUCK, None, (), ()), Step(ONE, "gravity", (), ()), Step(TWO, "preload", (), ())]


def searching(monkeypatch, left, size):
    """A search in which leaving out effects leaves the costs ``left``, all effects ``size`` standard errors from zero."""
    search, on = Search(Bench()), []

    def forward(start, steps, least):
        on.append((start, least))
        return steps

    monkeypatch.setattr(search, "without", lambda trial, name: left[trial.names - {name}])
    monkeypatch.setattr(search, "forward", forward)
    monkeypatch.setattr(brought_on, "significance", lambda trial, name: size)
    return search, on


def test_the_path_goes_on_from_the_models_that_no_longer_stick(monkeypatch):
    left = {names: Model(names, cost=101.0) for names in (ONE.names, STUCK.names)}
    search, on = searching(monkeypatch, left, 1.0)
    found = without_what_brought_on(search, PATH, 0.25, 8.0)
    assert [s.trial for s in found] == [left[STUCK.names]]
    assert on == [(left[ONE.names], 0.25), (left[STUCK.names], 0.25)]


@pytest.mark.parametrize(("cost", "size"), [(299.5, 1.0), (101.0, 9.0)], ids=["as before", "far from zero"])
def test_what_is_missed_or_far_from_zero_stays(monkeypatch, cost, size):
    search, on = searching(monkeypatch, {ONE.names: Model(ONE.names, cost=cost)}, size)
    assert without_what_brought_on(search, PATH, 0.25, 8.0) is PATH
    assert not on


@pytest.mark.slow
def test_a_play_shaken_by_a_rough_force_needs_no_effect():
    """As wide as the motion: at first some windows start on its wrong side. The force is held, 64 Runge-Kutta steps a sample."""
    rng, rate, samples = np.random.default_rng([91, 12]), 610.0, 8000
    mass, damping, stiffness, half = 1.7237564, 11.458323, 63304.606, 0.056266521
    push = 4500.0 * rng.standard_normal(samples)
    h, y, v, path = 1.0 / (64.0 * rate), 0.0, 0.0, []

    def pull(y, v, now):
        return (now - damping * v - stiffness * (y - min(max(y, -half), half))) / mass

    for now in push:
        path.append(y)
        for _ in range(64):
            a = pull(y, v, now)
            b = pull(y + 0.5 * h * v, v + 0.5 * h * a, now)
            c = pull(y + 0.5 * h * (v + 0.5 * h * a), v + 0.5 * h * b, now)
            d = pull(y + h * (v + 0.5 * h * b), v + h * c, now)
            y, v = y + h * v + h * h / 6.0 * (a + b + c), v + h / 6.0 * (a + 2.0 * (b + c) + d)
    seen = np.array(path) + 1e-3 * np.std(path) * rng.standard_normal(samples)
    record = jb.Record(np.arange(samples) / rate, {"F": push, "y": seen}, confirmed=frozenset("tFy"))
    with pytest.warns(UserWarning, match="held from each sample to the next"):
        found = jb.refine(record, translational=True)
    assert found.effects == ()
    assert found.verdict.complete
    play = found.stages[-1].fit.parameters["backlash"]
    assert play.value == pytest.approx(2.0 * half, abs=4.0 * play.stderr)
