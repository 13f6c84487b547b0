"""What a law remembers goes on from window to window, even where windows are free to begin where their samples put the link."""

from types import SimpleNamespace

import equinox as eqx
import numpy as np
import pytest

from jaxbacklash.effects import BoucWen, Dahl, FlexibleLink, Lugre
from jaxbacklash.fitting.setup import first_guess, make_problem
from jaxbacklash.mechanics import canonical_name
from jaxbacklash.parameters import values
from jaxbacklash.shooting.information import freedom
from jaxbacklash.shooting.levenberg import Levenberg, minimise
from jaxbacklash.shooting.multiple_shooting import KEPT, _first_remembered, tie_weights
from jaxbacklash.shooting.windows import cut
from tests.hidden import fitter, hidden, noisier


@pytest.fixture(scope="module")
def own():
    record, rig, _, _ = hidden("dahl", "multisine", 21, seconds=8.0, sigma=2000.0, Fc=6.0)
    return fitter(record, rig.inertia)


@pytest.fixture(scope="module")
def free(own):
    """Dahl's law fitted to windows that are free to begin where their samples put the link: the problem, and its minimum."""
    windows, _ = cut([own.record], 0.1)
    problem = make_problem(own.base.with_effects(Dahl(1.0, 500.0)), windows, (*own.base_free, "dahl.Fc", "dahl.sigma"))
    return problem, minimise(problem, first_guess(problem), Levenberg(limit=60))


def windows_in_use(own):
    return own.layout.windows[0]


def test_reach_is_told_in_the_order_of_the_states(own):
    system = own.base.with_effects(Lugre(), FlexibleLink())
    assert system.state_names == ("y", "dy", "flexible_link.y2", "flexible_link.dy2", "lugre.s")
    assert system.reach == (np.inf, np.inf, np.inf, np.inf, Lugre.reach)


@pytest.mark.slow
@pytest.mark.parametrize("effect", [Dahl(1.0, 1000.0), BoucWen(1000.0, 1.0), Lugre(1000.0, Fc=1.0, Fs=4.9)], ids=canonical_name)
def test_no_memory_leaves_its_reach(effect):
    """Back and forth, fast and slowly, from rest and from the other end: friction at rest is at most ``Fs`` in LuGre's law."""
    for speed in (1e-3, 0.1, 10.0):
        s, dt = -1.0, 1e-5
        for k in range(3000):
            dz = speed if (k // 1000) % 2 == 0 else -speed
            s += dt * float(effect.rate(SimpleNamespace(dz=np.float64(dz), state=(np.float64(s),)))[0])
            assert abs(s) <= effect.reach * (1.0 + 1e-6)


@pytest.mark.slow
def test_what_is_remembered_goes_on_through_free_windows(free):
    """The motion jumps as the noise has it, the memory hardly does; and the fit finds what was hidden."""
    problem, minimum = free
    assert float(problem.tie) == 0.0
    ends = np.asarray(minimum.stats["predicted"].end).T
    n = int(problem.windows.used) - 1
    starts = np.asarray(minimum.value.starts)
    jumps = ends[:, : n - 1] - starts[:, 1:n]
    assert np.max(np.abs(jumps[2])) < 0.2
    assert np.max(np.abs(jumps[0])) > 0.0
    assert np.max(np.abs(starts[2, :n])) <= 1.05
    found = values(problem.rebuild(minimum.value.theta))
    assert found["dahl.Fc"] == pytest.approx(6.0, rel=0.02)
    assert found["dahl.sigma"] == pytest.approx(2000.0, rel=0.05)
    assert 0.95 < np.sqrt(2.0 * float(minimum.stats["cost"]) / freedom(problem)) < 1.05


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "seed"), [("multisine", 22), ("chirp", 24)])
def test_no_record_begins_beyond_all_reach(kind, seed):
    """No window comes before the first, and nothing else held what it remembers: it ran to 64 times the sliding torque, and no
    search of one trajectory got through."""
    record, rig, _, _ = hidden("dahl", kind, seed, seconds=8.0, sigma=2000.0, Fc=6.0)
    record = noisier(record, 30, seed)
    model = fitter(record, rig.inertia).fit_model({"dahl": Dahl(6.0, 2000.0)})
    assert model.converged
    assert abs(model.unknowns.starts[2, 0]) < 1.05
    assert 0.95 < model.misfit < 1.05


def test_the_hold_on_the_first_memory_is_the_slope_of_its_cost(own):
    problem, _ = own.problem({"lugre": Lugre(), "flexible_link": FlexibleLink()}, own.base)
    starts = np.zeros((own.windows.count, 5))
    starts[:, 2:4], h = 1e3, 1e-6
    alone = [0, windows_in_use(own)]  # the first, and the last, which only ends the input
    for s in (0.3, -4.9, 7.0, -30.0):
        at = [np.where(np.arange(5) == 4, s + d, starts) for d in (-h, 0.0, h)]
        (low, _, _), (_, slope, curvature), (high, _, _) = (_first_remembered(problem, x) for x in at)
        assert np.sum(slope) == pytest.approx((float(high) - float(low)) / (2 * h), rel=1e-6)
        np.testing.assert_allclose(curvature[alone, 4], (1.0 + KEPT**2 * (abs(s) > Lugre.reach)) / Lugre.reach**2)
        assert np.count_nonzero(slope) == np.count_nonzero(curvature) == len(alone)


def test_only_what_has_a_reach_is_tied_where_windows_are_free(own):
    for effect, kept in ((Dahl(), [KEPT]), (Lugre(), [KEPT / Lugre.reach]), (BoucWen(), [KEPT]), (FlexibleLink(), [0.0, 0.0])):
        problem, _ = own.problem({canonical_name(effect): effect}, own.base)
        weights = np.asarray(tie_weights(problem, 2 + len(kept)))
        np.testing.assert_allclose(weights[0], [0.0, 0.0, *kept])
        assert not np.any(weights[windows_in_use(own) - 1])
        sharp = np.asarray(tie_weights(eqx.tree_at(lambda p: p.tie, problem, np.asarray(100.0)), 2 + len(kept)))
        np.testing.assert_allclose(sharp[0, :2], 100.0 * own.windows.drop)
        np.testing.assert_allclose(sharp[0, 2:], 1e4 * np.array(kept) if any(kept) else 100.0 * own.windows.drop[1])


def test_what_goes_on_from_window_to_window_is_no_freedom(own):
    """A flexible link has two numbers to choose in every free window, which count; friction's memory has one in the record."""
    n = windows_in_use(own)
    plain, rubbing, bending = (
        freedom(own.problem(effects, own.base)[0]) for effects in ({}, {"dahl": Dahl()}, {"flexible_link": FlexibleLink()})
    )
    assert plain - rubbing == 1.0
    assert plain - bending == 2.0 * n
