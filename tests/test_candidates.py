"""The score test of absent laws: what it promises, and what promises nothing."""

import numpy as np
import pytest

from jaxbacklash.criticism.candidates import likeliest_sine, predicted_gain, score_test
from jaxbacklash.criticism.evidence import gain
from jaxbacklash.criticism.perturbed import model_record
from jaxbacklash.shooting.multiple_shooting import Prediction

from .hidden import fitter, hidden, noisier


def test_a_candidate_whose_trajectory_runs_away_promises_nothing():
    step, fall = predicted_gain(np.array([[1.0, np.inf], [np.inf, 2.0]]), np.array([1.0, 1.0]), 1)
    assert fall == 0.0
    assert np.array_equal(step, np.zeros(2))


def test_a_model_that_has_run_away_is_seen_as_the_record_there():
    """Also where its numbers are still finite, and no record of theirs could be."""
    record, rig, _, _ = hidden(None, "multisine", 4, 4.0)
    own = fitter(record, rig.inertia)
    shape = np.shape(own.windows.measured)
    z = np.where(np.arange(shape[0])[:, None] < 3, 1e300, np.asarray(own.windows.measured))
    z[5] += 1e-4
    along = model_record(own, Prediction(z, np.zeros((shape[0], 0)), np.zeros((shape[0], 2)))).channels["z"]
    assert np.array_equal(along[: 3 * shape[1]], record.channels["z"][: 3 * shape[1]])
    assert along[5 * shape[1] : 6 * shape[1]] == pytest.approx(record.channels["z"][5 * shape[1] : 6 * shape[1]] + 1e-4)


def test_what_it_promises_of_a_weak_law_comes_true():
    record, rig, _, _ = hidden("gravity", "multisine", 4, 6.0, G=0.3)
    own = fitter(record, rig.inertia)
    alone = own.fit_model({})
    (promised,) = score_test(own, alone, ["gravity"])
    found = own.fit_model({"gravity": promised.effect}, alone)
    brought = gain(alone, found) + np.log(record.samples)
    assert promised.gain == pytest.approx(brought, rel=0.2)
    assert float(promised.effect.G) == pytest.approx(found.value["gravity.G"], rel=0.2)
    assert 0.0 < promised.share <= 1.0


@pytest.mark.parametrize("seed", [4, 7])
def test_a_hum_is_read_off_a_fitted_trajectory_though_noise_hides_it(seed):
    """A tenth of the torque that drives the link, under thirty times the noise of the other tests."""
    record, rig, _, _ = hidden("disturbance", "multisine", seed, 8.0, A=6.0, omega=49.0, phi=0.7)
    own = fitter(noisier(record, 30.0, seed), rig.inertia)
    alone = own.fit_model({})
    found = likeliest_sine(own, alone)
    assert found.frequency == pytest.approx(49.0, abs=np.pi / 8.0 / 2.0)
    assert found.gain > 30.0
    (promised,) = score_test(own, alone, ["disturbance"])
    kept = own.fit_model({"disturbance": promised.effect}, alone)
    assert kept.value["disturbance.omega"] == pytest.approx(49.0, abs=0.05)
    assert abs(kept.value["disturbance.A"]) == pytest.approx(6.0, rel=0.1)


def test_a_strength_that_physics_forbids_promises_nothing():
    record, rig, _, _ = hidden("quadratic_drag", "multisine", 4, 6.0)
    own = fitter(record, rig.inertia)
    alone = own.fit_model({})
    found = score_test(own, alone, sorted(own.static))
    assert {c.name for c in found} == set(own.static)
    for one in found:
        assert one.gain >= 0.0
        assert np.isfinite(one.gain)
