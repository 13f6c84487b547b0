"""The spline of a base motion has the knots that the motion needs, whatever room a window has for them."""

import numpy as np
import pytest
from scipy.interpolate import BSpline

from jaxbacklash.criticism.model_fitter import ModelFitter
from jaxbacklash.fitting.setup import base_system, first_guess, make_problem
from jaxbacklash.mechanics import catalogue
from jaxbacklash.parameters import with_values
from jaxbacklash.records import Record
from jaxbacklash.shooting.information import inverse_information
from jaxbacklash.shooting.levenberg import Levenberg, minimise
from jaxbacklash.shooting.windows import LEAST_INTERVALS, cut
from jaxbacklash.signals import DEGREE, choose_intervals, fit_spline, knots
from tests.independent.generator import measure, simulate_truth
from tests.independent.motions import SteppedSine
from tests.independent.rigs import Excitation, Rig

SLOWER = 2.5  # than in the laboratory


def seen(draw, *, rate=600.0, duration=16.0, noise=(1.2e-3, 7e-4)):
    """A slow joint with dry friction under a slow drive, heavily noisy; its rig, friction and record t, x, z."""
    pytest.importorskip("numba", reason="the generator needs numba")
    rig, friction = Rig(3.2, 0.024, 14600.0, 15.6), {"coulomb_joint": {"Tc": 6.4}}
    drive = Excitation("stepped", base=SteppedSine(3.2, (0.032, 0.044, 0.046, 0.036)))
    truth = simulate_truth(rig, friction, drive, rate, duration)
    channels = measure(truth, np.random.default_rng([draw, 99]), *noise)
    record = Record(channels["t"] * SLOWER, {n: channels[n] for n in "xz"})
    slow = Rig(rig.inertia, rig.backlash, rig.stiffness / SLOWER**2, rig.damping / SLOWER)
    return slow, {"coulomb_joint": {"Tc": 6.4 / SLOWER**2}}, record


@pytest.mark.parametrize("parts", [1, 2, 3, 4, 8])
def test_a_spline_of_finer_knots_is_the_same_spline(parts):
    t = np.arange(1000) / 250.0
    coarse = fit_spline(t, np.random.default_rng(3).standard_normal(t.size), 0.0, 0.1)
    fine = coarse.refined(parts)
    inside = t[t < 0.1 * (coarse.coefficients.size - DEGREE)]
    same = BSpline(knots(0.0, 0.1 / parts, fine.size), fine, DEGREE)
    for order in (0, 1, 4):
        np.testing.assert_allclose(same(inside, order), coarse(inside, order), rtol=1e-9, atol=1e-9 * 10.0**order)


def test_a_slow_motion_gets_few_knots_and_a_small_fast_one_on_top_is_not_lost():
    t, rng = np.arange(10_000) / 500.0, np.random.default_rng(8)
    slow, noise = np.sin(2.0 * np.pi * 0.6 * t), 1e-3 * rng.standard_normal(t.size)
    assert choose_intervals(t, slow + noise, 0.1) <= 3
    fast = 0.01 * np.sin(2.0 * np.pi * 20.0 * t)
    assert choose_intervals(t, slow + fast + noise, 0.1) >= 8
    assert choose_intervals(t, fast + noise, 0.1) >= 8


@pytest.mark.slow
def test_the_fitted_input_has_no_corner_where_no_knot_is_needed():
    rig, _, record = seen(0)
    windows, layout = cut([record], 0.1)
    length = windows.samples * record.dt
    needed = choose_intervals(record.t, record.channels["x"], length)
    assert needed <= LEAST_INTERVALS // 2
    assert windows.intervals == LEAST_INTERVALS
    base, free, _ = base_system(record, "joint", rig.inertia)
    problem = make_problem(base, windows, free)
    found = minimise(problem, first_guess(problem), Levenberg(limit=10)).value
    moved = np.asarray(found.coefficients) - np.asarray(windows.coefficients)
    assert np.max(np.abs(moved)) > 0.01 * layout.input_noise[0]
    coefficients = np.asarray(found.coefficients)[: layout.windows[0]].ravel()
    corners = np.diff(coefficients, DEGREE + 1)  # row i is the corner at knot i + 1
    parts = LEAST_INTERVALS // next(n for n in (1, 2, 4, 8) if n >= needed)
    at = np.arange(corners.size) + 1
    assert np.std(corners[at % parts != 0]) < 1e-2 * np.std(corners[at % parts == 0])


@pytest.mark.slow
def test_noise_in_a_slow_drive_does_not_smear_dry_friction():
    # With eighty knots a second, three times as many as the drive needs, damping was 2.8 standard errors too small on average
    # and friction 3.2 too large.
    scores = []
    for draw in range(12):
        rig, friction, record = seen(draw)
        base, free, _ = base_system(record, "joint", rig.inertia)
        truth = {"backlash": rig.backlash, "stiffness": rig.stiffness, "damping": rig.damping}
        law = catalogue()["coulomb_joint"](**friction["coulomb_joint"])
        model = ModelFitter(record, with_values(base, truth), free, 0.2).fit_model({"coulomb_joint": law})
        q = len(model.free)
        error = np.sqrt(np.diag(inverse_information(model.information[:q, :q]))) * model.scales[:q]
        true = truth | {"coulomb_joint.Tc": friction["coulomb_joint"]["Tc"]}
        scores.append([(model.value[n] - true[n]) / e for n, e in zip(model.free, error)])
    off = np.array(scores)
    # Twelve draws: a mean of standard scores has a standard deviation of 0.29, their own spread one of 0.2.
    assert np.all(np.abs(np.mean(off, axis=0)) < 1.0), np.mean(off, axis=0)
    assert np.all(np.std(off, axis=0) < 1.7), np.std(off, axis=0)
