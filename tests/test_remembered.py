"""What a law remembers goes on from window to window, even where windows are free to begin where their samples put the link."""

from types import SimpleNamespace

import equinox as eqx
import numpy as np
import pytest

from jaxbacklash.criticism.tried import Tried
from jaxbacklash.criticism.workbench import Workbench
from jaxbacklash.effects import BoucWen, Dahl, FlexibleLink, Lugre
from jaxbacklash.fitting.levenberg import Levenberg, minimise
from jaxbacklash.fitting.problem import Unknowns
from jaxbacklash.fitting.search import freedom
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.fitting.shooting import KEPT, _first_remembered, tie_weights
from jaxbacklash.mechanics import canonical_name
from tests.hidden import hidden, noisier


@pytest.fixture(scope="module")
def bench():
    record, rig, _, _ = hidden("dahl", "multisine", 21, seconds=8.0, sigma=2000.0, Fc=6.0)
    base, free, _ = base_system(record, "joint", rig.inertia)
    return Workbench(record, base, free, 0.2)


@pytest.fixture(scope="module")
def free(bench):
    return bench.fit({"dahl": Dahl(1.0, 500.0)}, patience=60)


def windows_in_use(bench):
    return bench.layout.windows[0]


def test_reach_is_told_in_the_order_of_the_states(bench):
    system = bench.base.with_effects(Lugre(), FlexibleLink())
    assert system.state_names == ("y", "dy", "flexible_link.y2", "flexible_link.dy2", "lugre.s")
    assert system.reach == (np.inf, np.inf, np.inf, np.inf, Lugre.reach)


@pytest.mark.parametrize("effect", [Dahl(1.0, 1000.0), BoucWen(1000.0, 1.0), Lugre(1000.0, Fc=1.0, Fs=4.9)], ids=canonical_name)
def test_no_memory_leaves_its_reach(effect):
    """Back and forth, fast and slowly, from rest and from the other end: friction at rest is at most ``Fs`` in LuGre's law."""
    for speed in (1e-3, 0.1, 10.0):
        s, dt = -1.0, 1e-5
        for k in range(3000):
            dz = speed if (k // 1000) % 2 == 0 else -speed
            s += dt * float(effect.rate(SimpleNamespace(dz=np.float64(dz), state=(np.float64(s),)))[0])
            assert abs(s) <= effect.reach * (1.0 + 1e-6)


def test_free_windows_hand_on_what_is_remembered(bench, free):
    """The motion jumps as the noise has it, the memory hardly does; and the fit finds what was hidden."""
    problem, _ = bench.problem(bench.effects(free), free.system)
    assert float(problem.tie) == 0.0
    start = Unknowns(np.zeros(problem.directions.shape[1]), free.unknowns.starts, free.unknowns.coefficients)
    ends = np.asarray(minimise(problem, start, Levenberg(limit=1)).stats["predicted"].end).T
    n = windows_in_use(bench)
    jumps = ends[:, : n - 1] - np.asarray(free.unknowns.starts)[:, 1:n]
    assert np.max(np.abs(jumps[2])) < 0.1
    assert np.max(np.abs(jumps[0])) > 0.0
    assert np.max(np.abs(free.unknowns.starts[2, :n])) <= 1.05
    assert free.value["dahl.Fc"] == pytest.approx(6.0, rel=0.02)
    assert free.value["dahl.sigma"] == pytest.approx(2000.0, rel=0.05)
    assert 0.95 < free.misfit < 1.05


@pytest.mark.parametrize(("kind", "seed"), [("multisine", 22), ("chirp", 24)])
def test_no_record_begins_beyond_all_reach(kind, seed):
    """No window comes before the first, and nothing else held what it remembers: it ran to 64 times the sliding torque, and no
    search of one trajectory got through."""
    record, rig, _, _ = hidden("dahl", kind, seed, seconds=8.0, sigma=2000.0, Fc=6.0)
    record = noisier(record, 30, seed)
    base, names, _ = base_system(record, "joint", rig.inertia)
    bench = Workbench(record, base, names, 0.2)
    free = bench.fit({"dahl": Dahl(6.0, 2000.0)}, patience=60)
    tied = bench.fit(bench.effects(free), free, tied=True, patience=60)
    for trial in (free, tied):
        assert trial.done
        assert abs(trial.unknowns.starts[2, 0]) < 1.05
        assert 0.95 < trial.misfit < 1.05


def test_the_hold_on_the_first_memory_is_the_slope_of_its_cost(bench):
    problem, _ = bench.problem({"lugre": Lugre(), "flexible_link": FlexibleLink()}, bench.base)
    starts = np.zeros((bench.windows.count, 5))
    starts[:, 2:4], h = 1e3, 1e-6
    alone = [0, windows_in_use(bench)]  # the first, and the last, which only ends the input
    for s in (0.3, -4.9, 7.0, -30.0):
        at = [np.where(np.arange(5) == 4, s + d, starts) for d in (-h, 0.0, h)]
        (low, _, _), (_, slope, curvature), (high, _, _) = (_first_remembered(problem, x) for x in at)
        assert np.sum(slope) == pytest.approx((float(high) - float(low)) / (2 * h), rel=1e-6)
        np.testing.assert_allclose(curvature[alone, 4], (1.0 + KEPT**2 * (abs(s) > Lugre.reach)) / Lugre.reach**2)
        assert np.count_nonzero(slope) == np.count_nonzero(curvature) == len(alone)


def test_only_what_has_a_reach_is_tied_where_windows_are_free(bench):
    for effect, kept in ((Dahl(), [KEPT]), (Lugre(), [KEPT / Lugre.reach]), (BoucWen(), [KEPT]), (FlexibleLink(), [0.0, 0.0])):
        problem, _ = bench.problem({canonical_name(effect): effect}, bench.base)
        weights = np.asarray(tie_weights(problem, 2 + len(kept)))
        np.testing.assert_allclose(weights[0], [0.0, 0.0, *kept])
        assert not np.any(weights[windows_in_use(bench) - 1])
        sharp = np.asarray(tie_weights(eqx.tree_at(lambda p: p.tie, problem, np.asarray(100.0)), 2 + len(kept)))
        np.testing.assert_allclose(sharp[0, :2], 100.0 * bench.windows.drop)
        np.testing.assert_allclose(sharp[0, 2:], 1e4 * np.array(kept) if any(kept) else 100.0 * bench.windows.drop[1])


def test_what_is_handed_on_is_no_freedom(bench, free):
    """A flexible link has two numbers to choose in every free window, which count; friction's memory has one in the record."""
    n = windows_in_use(bench)
    plain, rubbing, bending = (
        freedom(bench.problem(effects, bench.base)[0])
        for effects in ({}, {"dahl": Dahl()}, {"flexible_link": FlexibleLink()})
    )
    assert plain - rubbing == 1.0
    assert plain - bending == 2.0 * n
    assert free.penalty == pytest.approx(len(free.free) * np.log(bench.layout.samples[0]))
    search = Tried(bench)
    assert [search.soaks(n) for n in ("dahl", "lugre", "bouc_wen", "coulomb_joint", "flexible_link")] == [False] * 4 + [True]
