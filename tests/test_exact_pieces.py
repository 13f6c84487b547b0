"""Exact steps of the linear-piecewise oscillator: against scipy with events, against located steps, and their error bars."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxbacklash.dynamics.errorbars import BATCHES, STUDENT, batch_error
from jaxbacklash.dynamics.family import CASES, PaperCase
from jaxbacklash.dynamics.follow import follow
from jaxbacklash.dynamics.maps import paper_map
from jaxbacklash.dynamics.normal_form import normal_form, why_not
from jaxbacklash.dynamics.plan import Plan
from jaxbacklash.effects import AsymmetricGap, ContactDamping, CubicStiffness, GapSpring, Preload
from jaxbacklash.excitation import Chirp, Harmonic
from jaxbacklash.models import base_motion_joint, case_1, case_2, dimensionless, two_link
from jaxbacklash.solvers import linear_pieces
from jaxbacklash.solvers.exact_periods import advance_periods, begin

from .independent import exponents, taylor

advance = jax.jit(advance_periods)


@pytest.fixture(scope="module")
def pairs():
    """Cells from all over the map, each followed for six periods by exact steps and by scipy."""
    rng = np.random.default_rng(3)
    cells = [exponents.Cell(a, z) for a, z in zip(rng.uniform(1.0, 5.0, 12), rng.uniform(0.005, 0.03, 12))]
    cells += [exponents.Cell(0.6458, 0.0227, 0.2272, 1.0 / 31.0), exponents.Cell(2.0, 0.02, 0.2, cc=0.3)]
    given = {"inverse_alpha": np.array([c.inverse_alpha for c in cells]), "zeta": np.array([c.zeta for c in cells])}
    system, drive = PaperCase(1, Omega=0.2).build(given)
    system = system.with_effects(GapSpring(np.array([c.k1 for c in cells])), ContactDamping(np.array([c.cc for c in cells])))
    drive = Harmonic(drive.amplitude, np.array([c.Omega for c in cells]), 0.0, as_force=True)
    form = normal_form(system, drive)
    lanes = len(cells)
    y, ours = begin(jnp.zeros(lanes), jnp.zeros(lanes)), []
    for k in range(6):
        y = advance(form.pieces, form.phase, y, float(k), 1.0)
        ours.append(np.stack([y.p, y.v, y.growth]))
    theirs = [exponents.follow(cell, 6, 0, rtol=1e-11, atol=1e-13) for cell in cells]
    return np.array(ours), np.array([np.column_stack([s[1:], g[1:]]) for _, s, g in theirs])


def test_the_motion_is_that_of_scipy_with_events(pairs):
    ours, theirs = pairs
    away = np.abs(ours[:, :2] - theirs[:, :, :2].transpose(1, 2, 0)).max(axis=1)
    assert away[0].max() < 1e-8  # after one period; from there small differences may grow as the tangent does
    room = 1e-8 * np.exp(np.maximum.accumulate(np.maximum(ours[:, 2], 0.0), axis=0)) * np.arange(1, 7)[:, None]
    assert np.all(away < 10.0 * room)


def test_the_tangent_vector_is_that_of_scipy_with_events(pairs):
    ours, theirs = pairs
    away = np.abs(ours[:, 2] - theirs[:, :, 2].T)
    assert away[0].max() < 1e-6
    assert np.median(away[2]) < 1e-6


def test_the_tangent_vector_is_the_derivative_of_the_motion():
    system, drive = PaperCase(1).build({"inverse_alpha": np.array([1.4, 2.0, 3.3, 4.8])})
    pieces = jax.tree.map(lambda leaf: leaf * jnp.ones(4), normal_form(system, drive).pieces)
    centre = advance(pieces, 0.0, begin(jnp.zeros(4), jnp.zeros(4)), 0.0, 2.0)
    step = 1e-6
    up, down = (advance(pieces, 0.0, begin(jnp.full(4, s), jnp.zeros(4)), 0.0, 2.0) for s in (step, -step))
    slope = np.stack([up.p - down.p, up.v - down.v]) / (2.0 * step)
    tangent = np.exp(centre.growth) * np.stack([centre.dp, centre.dv])
    np.testing.assert_allclose(tangent, slope, rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("damping", [0.04, 0.005])
def test_a_leg_ends_on_the_edge_however_it_gets_there(damping):
    """Steep, grazing, or back through the edge it came from: what a lane that leaves its branch misses the edge by."""
    rng, lanes = np.random.default_rng(1), 1024
    one = np.ones(lanes)
    numbers = damping * one, 0.0 * one, 0.0 * one, one, 0.0 * one, 1.0 / rng.uniform(1.0, 5.0, lanes), 0.2 * one
    pieces = linear_pieces.LinearPieces(*(jnp.asarray(n) for n in numbers))
    phase = rng.uniform(0.0, 2.0 * np.pi, lanes)
    start = *rng.uniform(-0.5, 0.5, (2, lanes)), one, 0.0 * one, 0.0 * one, np.cos(phase), np.sin(phase), 1e9 * one
    now, missed = linear_pieces.Motion(*(jnp.asarray(n) for n in start)), []
    both = linear_pieces.branches(pieces)
    step = jax.jit(lambda now: linear_pieces.leg(pieces, both, now))
    for _ in range(200):
        after = step(now)
        edge = jnp.where(now.side == 0.0, after.side, now.side)
        missed.append(np.abs(np.asarray(after.p - edge))[np.asarray(after.side != now.side)])
        now = after._replace(left=jnp.asarray(1e9 * one))
    missed = np.concatenate(missed)
    assert missed.size > 50 * lanes
    assert missed.max() < 1e-6


def test_a_cell_that_grazes_has_the_exponent_of_an_independent_program():
    """At 1/alpha = 2.244 a motion of six periods leaves a contact slowly and turns back just inside the play."""
    pytest.importorskip("numba", reason="the Taylor series need numba")
    cell, start = exponents.Cell(2.2441471571906355, 0.02), (0.49946405, 0.09593101)
    _, growth, _ = taylor.follow(cell, 300, start)
    system, drive = PaperCase(1).build({"inverse_alpha": np.array([cell.inverse_alpha])})
    found, _ = follow(system, drive, np.array([start[0]]), np.array([start[1]]), Plan(300, 0, 6))
    assert float(found.lyapunov[0]) == pytest.approx((growth[-1] - growth[0]) / (300 * 2.0 * np.pi / 0.2), abs=1e-9)


def systems():
    force = Harmonic(0.8, 0.21, 0.3, as_force=True)
    shaken = Harmonic(0.05, 2.0 * np.pi * 1.54, 0.4)
    rig = (3.0, 0.026, 11000.0, 20.0)
    yield pytest.param(base_motion_joint(*rig), shaken, id="base motion", marks=pytest.mark.slow)
    yield pytest.param(two_link(*rig, 30.0, linearised=True), shaken, id="two link", marks=pytest.mark.slow)
    yield pytest.param(*case_2(), id="case 2", marks=pytest.mark.slow)
    plain = PaperCase(2).build({})[0]
    everything = (Preload(0.05), AsymmetricGap(0.2), GapSpring(0.1, 0.3), ContactDamping(0.2))
    yield pytest.param(plain.with_effects(*everything), force, id="all that is linear")


@pytest.mark.parametrize(("system", "drive"), list(systems()))
def test_exact_and_located_steps_agree(system, drive):
    """The located steps close in on the exact ones at the order of their own error."""
    plan, one = Plan(21, 0, 21), np.zeros(1)
    exact, name = follow(system, drive, one, one, plan)
    assert name == "exact linear pieces"
    coarse, other = follow(system, drive, one, one, plan, exact=False, panels=256)
    assert other != name
    fine, _ = follow(system, drive, one, one, plan, exact=False, panels=1024)
    size = np.abs(exact.p[:2]).max()
    errors = [np.abs(np.asarray(found.p - exact.p))[:2].max() / size for found in (coarse, fine)]
    assert errors[1] < 1e-6
    assert errors[1] < 0.1 * errors[0]


def test_what_is_not_linear_goes_the_general_way():
    system, drive = case_1()
    assert why_not(system, drive) is None
    assert "cubic_stiffness" in why_not(system.with_effects(CubicStiffness(1e6)), drive)
    assert "harmonic" in why_not(system, Chirp(1.0, 0.0, 5.0, 10.0, as_force=True))
    assert "load" in why_not(system.with_effects(Preload(1.0)), drive)
    assert "resonance" in why_not(base_motion_joint(1.0, 0.01, 1600.0, 0.0), Harmonic(0.1, 40.0))
    with pytest.raises(ValueError, match="cubic_stiffness"):
        follow(system.with_effects(CubicStiffness(1e6)), drive, np.zeros(1), np.zeros(1), Plan(), exact=True)


def test_the_cases_are_those_of_table_1():
    for case, made in ((1, case_1()), (2, case_2())):
        found = dimensionless(*made)
        assert CASES[case]["zeta"] == pytest.approx(found.zeta, rel=1e-12)
        assert CASES[case]["Omega"] == pytest.approx(found.Omega, rel=1e-12)
        assert CASES[case]["inverse_alpha"] == pytest.approx(1.0 / found.alpha, rel=1e-12)


@pytest.mark.slow
def test_dimensional_and_dimensionless_maps_are_one():
    system, drive = case_1()
    plan, one = Plan(60, 20, 8), np.zeros(1)
    found, _ = follow(system, drive, one, one, plan)
    map_ = paper_map(1, {"inverse_alpha": [2.0, 3.6], "zeta": [0.02]}, periods=60, skip=20, samples=8)
    # At 1/alpha = 2 the motion is chaotic, so rounding decides its far end: the early samples are compared by another start.
    early, _ = follow(system, drive, one, one, Plan(20, 0, 20))
    small, _ = follow(*PaperCase(1).build({"inverse_alpha": np.array([2.0])}), one, one, Plan(20, 0, 20))
    np.testing.assert_allclose(np.asarray(early.p)[:3] / 0.005, np.asarray(small.p)[:3], atol=1e-7)
    assert float(found.lyapunov[0]) / 200.0 == pytest.approx(float(map_.lyapunov[0, 0]), abs=0.02)
    assert float(map_.lyapunov[1, 0]) == pytest.approx(-0.02, abs=2e-3)


def test_error_bars_are_widened_by_students_quantile():
    from scipy import stats

    expected = stats.t.ppf(stats.norm.cdf(1.0), np.arange(1, BATCHES))
    np.testing.assert_allclose(STUDENT, expected, atol=6e-4)


def test_error_bars_hold_what_they_say():
    """Over many runs of correlated growth the true mean lies within one error bar in two of three."""
    rng = np.random.default_rng(8)
    noise = rng.standard_normal((600, 2000))
    for k in range(1, 600):
        noise[k] += 0.7 * noise[k - 1]
    growth = np.concatenate([np.zeros((1, 2000)), np.cumsum(noise[200:], axis=0)])
    times = np.arange(401.0)
    mean, error = growth[-1] / 400.0, np.asarray(batch_error(times, jnp.asarray(growth)))
    assert np.mean(np.abs(mean) < error) == pytest.approx(0.683, abs=0.05)
    assert np.mean(np.abs(mean) < 2.0 * error) > 0.93


def test_one_program_serves_all_numbers():
    from jaxbacklash.dynamics.follow import follow_exact

    axes = {"inverse_alpha": np.linspace(1.0, 2.0, 8), "zeta": np.linspace(0.01, 0.02, 4)}
    paper_map(1, axes, periods=40, skip=5, samples=4)
    before = follow_exact._cache_size()
    paper_map(2, {name: 1.1 * values for name, values in axes.items()}, periods=40, skip=5, samples=4, start=(0.5, 0.1))
    assert follow_exact._cache_size() == before
