"""What is compiled beside a search: that it is what the search asks for, and that it is the right friction."""

import threading
from types import SimpleNamespace

import pytest

from jaxbacklash import compiled, refine
from jaxbacklash.criticism.foresight import Foresight
from jaxbacklash.criticism.refine import _Judge
from jaxbacklash.criticism.workbench import Workbench
from jaxbacklash.fitting import levenberg
from jaxbacklash.fitting.setup import base_system

from .hidden import hidden


@pytest.mark.parametrize(("effect", "expected"), [("coulomb_joint",) * 2, ("coulomb_ground",) * 2, ("gravity", None)])
def test_friction_is_foreseen_where_it_is(effect, expected):
    record, rig, _, _ = hidden(effect, "chirp", 3, 8.0)
    base, free, _ = base_system(record, "joint", rig.inertia)
    bench = Workbench(record, base, free, 0.2)
    assert Foresight(bench).friction()[0] == expected


GIVING = [("coulomb_joint", None), ("stribeck", None), ("dahl", ["dahl"]), ("lugre", ["dahl"])]


@pytest.mark.parametrize(("effect", "expected"), GIVING)
def test_friction_that_gives_is_foreseen_where_it_is(effect, expected):
    record, rig, _, _ = hidden(effect, "chirp", 3, 8.0)
    base, free, _ = base_system(record, "joint", rig.inertia)
    bench = Workbench(record, base, free, 0.2)
    ahead = Foresight(bench)
    found = ahead.giving(ahead.friction()[1])
    assert (found if found is None else list(found)) == expected


@pytest.mark.parametrize(("effect", "expected"), [("flexible_link", ["flexible_link"]), ("gravity", None), ("gap_spring", None)])
def test_a_link_that_bends_is_foreseen_where_it_does(effect, expected):
    record, rig, _, _ = hidden(effect, "chirp", 3, 8.0)
    base, free, _ = base_system(record, "joint", rig.inertia)
    bench = Workbench(record, base, free, 0.2)
    found = Foresight(bench).bends()
    assert (found if found is None else list(found)) == expected


@pytest.mark.slow
@pytest.mark.parametrize("effect", ["coulomb_joint", "dahl", "flexible_link"])
def test_a_search_finds_its_programs_in_the_making(cache, monkeypatch, effect):
    """The catalogue's program and that of the effect are begun beside the search, and it asks for no other."""
    levenberg._minimise.programs.clear()
    begun, find = [], compiled._find

    def noted(function, *rest):
        if function.__name__ == "_minimise":
            begun.append(threading.current_thread() is threading.main_thread())
        return find(function, *rest)

    monkeypatch.setattr(compiled, "_find", noted)
    record, rig, _, _ = hidden(effect, "chirp", 3, 8.0)
    found = refine(record, inertia=rig.inertia)
    assert found.effects == (effect,)
    assert begun.count(False) == 2


def test_a_likely_model_is_told_once_and_again_if_its_windows_changed(monkeypatch):
    monkeypatch.setattr(_Judge, "__call__", lambda judge, trial: (trial.name, judge.bench.windows))
    told, bench = [], SimpleNamespace(windows="whole")
    judge = _Judge(bench, None, "joint", False, False, None, told.append)
    first, last = SimpleNamespace(name="first"), SimpleNamespace(name="last")
    for trial in (first, last, last):
        judge.tell(trial)
    assert told == [("first", "whole"), ("last", "whole")]
    bench.windows = "cut"
    assert judge.tell(last) == ("last", "cut")
    assert told[2:] == [("last", "cut")]
