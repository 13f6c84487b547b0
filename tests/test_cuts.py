"""Tied searches that dry friction stops: the windows where it does are let go, and the others tell what free ones cannot."""

from types import SimpleNamespace

import numpy as np
import pytest

from jaxbacklash.criticism import cuts, tried
from jaxbacklash.criticism.refine import refine
from jaxbacklash.criticism.workbench import Workbench
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.records import Record

from .hidden import hidden
from .test_search_steps import Bench, Model

RUBBED = frozenset({"coulomb_joint"})


class Rubbing(Bench):
    """A record's models with dry friction among the laws."""

    is_cut = False

    def __init__(self, *answers):
        super().__init__(*answers)
        self.laws["coulomb_joint"] = SimpleNamespace(states=(), absorbs=(), slides=True)
        self.ties = np.ones(8)

    def cut(self, ties):
        self.is_cut = not np.array_equal(ties, self.ties)


def stuck(**changes):
    return Model(RUBBED, cost=150.0, done=False, misfit=1.2, **changes)


@pytest.mark.parametrize(("parted", "whole", "kept"), [(1.004, 1.2, 1), (1.004, 1.005, 2), (1.2, None, None)])
def test_cuts_lead_to_the_whole_trajectory_or_stay_where_it_is_out_of_reach(monkeypatch, parted, whole, kept):
    free = Model(RUBBED, cost=90.0, tied=False)
    answers = [stuck(), Model(RUBBED, cost=100.0, misfit=parted), Model(RUBBED, cost=110.0, misfit=whole)]
    bench = Rubbing(*answers)
    search = tried.Tried(bench)
    search.known[frozenset({"gravity"}), True] = Model(frozenset({"gravity"}), cost=1.0)
    monkeypatch.setattr(tried, "cut_free", lambda bench, free: np.array([0.0, *np.ones(7)]))
    assert search.settle(free) is (free if kept is None else answers[kept])
    assert bench.is_cut == (kept == 1)
    # What was tied without cuts does not compare with what is tied with them.
    assert ((frozenset({"gravity"}), True) in search.known) == (kept != 1)


def test_only_dry_friction_is_a_reason_to_cut(monkeypatch):
    monkeypatch.setattr(tried, "cut_free", lambda *_: pytest.fail("asked"))
    names = frozenset({"preload"})
    free = Model(names, cost=90.0, tied=False)
    stuck = Model(names, cost=150.0, done=False, misfit=1.2)
    assert tried.Tried(Rubbing(stuck, stuck)).settle(free) is stuck


@pytest.mark.slow
def test_a_cut_is_paid_for():
    """Where nothing is wrong a cut lowers the cost as a position and a speed more do by chance, and is charged for them."""
    record, rig, _, _ = hidden(None, "chirp", 5)
    base, free, _ = base_system(record, "joint", rig.inertia)
    bench = Workbench(record, base, free, 0.2)
    whole = bench.fit({}, bench.fit({}, patience=60), tied=True, patience=60)
    ties = np.asarray(bench.ties).copy()
    many = np.flatnonzero(ties)[4::9]
    ties[many] = 0.0
    bench.cut(ties)
    assert bench.is_cut
    parted = bench.fit({}, whole, tied=True, patience=60)
    charged = parted.penalty - whole.penalty
    assert charged == pytest.approx(4.0 * many.size)
    fallen = 2.0 * (whole.cost - parted.cost)
    freed = 2.0 * many.size  # as many squares of a normal number: their mean, and five of their standard deviations
    assert 0.0 < fallen < freed + 5.0 * np.sqrt(2.0 * freed)
    assert parted.criterion > whole.criterion
    bench.cut(bench.ties)
    assert not bench.is_cut


@pytest.mark.slow
def test_gravity_is_found_beside_friction_that_holds_the_link(monkeypatch):
    """A slow chirp that begins below the friction, thirty times the usual noise: free windows do not tell gravity."""
    pytest.importorskip("numba", reason="the independent simulation needs numba")
    from .independent.generator import make_effects, make_excitation, make_rig, measure, simulate_truth

    rng, hidden, sigma = np.random.default_rng(9032), ("gravity", "coulomb_joint"), 9e-4
    rig, values = make_rig(rng), make_effects(rng, *hidden)
    truth = simulate_truth(rig, values, make_excitation(rng, "chirp", 20.0), 500.0, 20.0)
    seen = measure(truth, rng, sigma, sigma, None)
    shares, cut_free = [], cuts.cut_free

    def noted(bench, free):
        ties = cut_free(bench, free)
        shares.append(None if ties is None else 1.0 - ties.sum() / np.asarray(bench.ties).sum())
        return ties

    monkeypatch.setattr(tried, "cut_free", noted)
    found = refine(Record(seen["t"], {"x": seen["x"], "z": seen["z"]}), inertia=rig.inertia)
    assert set(found.effects) == set(hidden)
    assert shares
    assert shares[0] is not None
    assert 0.0 < shares[0] < cuts.SHARE
    assert found.fit.score.median < 1.05
    for name, truth_value in (("backlash", rig.backlash), ("stiffness", rig.stiffness), ("damping", rig.damping)):
        number = found.fit.parameters[name]
        assert abs(number.value - truth_value) < 4.0 * number.stderr
