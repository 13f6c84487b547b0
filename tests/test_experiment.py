"""The experiment that is proposed separates two models, as a joint that has the one effect shows."""

import numpy as np
import pytest

pytest.importorskip("numba")

from jaxbacklash.criticism.experiment import SECONDS, error, separate, within_reach
from jaxbacklash.mechanics import catalogue
from jaxbacklash.records import Record
from tests.hidden import fitter
from tests.independent.generator import make_excitation, measure, simulate_truth
from tests.independent.motions import SteppedSine
from tests.independent.rigs import Excitation, Rig

RIG = Rig(inertia=3.1, backlash=0.025, stiffness=12500.0, damping=20.0)
SIGMA, RATE = 1e-4, 500.0


def fitter_of(effects, excitation, seconds, seed=5):
    rng = np.random.default_rng(seed)
    seen = measure(simulate_truth(RIG, effects, excitation, RATE, seconds), rng, SIGMA, SIGMA)
    record = Record(seen["t"], {"x": seen["x"], "z": seen["z"]})
    return fitter(record, RIG.inertia)


def fitted(own, name, **values):
    return own.fit_model({name: catalogue()[name](**values)})


@pytest.mark.slow
def test_what_it_promises_is_what_the_joint_shows():
    hidden = {"cubic_stiffness": {"k3": 3e6}}
    own = fitter_of(hidden, make_excitation(np.random.default_rng(1), "multisine", 8.0, scale=0.7), 8.0)
    kept, rival = fitted(own, "cubic_stiffness", k3=2e6), fitted(own, "hunt_crossley", chi=100.0)
    found = separate(own, kept, rival)
    assert found is not None
    assert found.parts
    assert "let a sine" in str(found)
    best = found.best
    # Simulated by other means, with another ramp.
    sine = SteppedSine(best.frequency, (best.amplitude,), hold=SECONDS + 1.0, ramp=0.1 * SECONDS)
    shown = fitter_of(hidden, Excitation("sine", sine), SECONDS, seed=6)
    errors = [error(shown, own, model) for model in (kept, rival)]
    assert errors[0] == pytest.approx(1.0, abs=0.05)
    assert errors[1] == pytest.approx(best.misfit, rel=0.2)


@pytest.mark.slow
def test_what_nothing_separates_is_said():
    own = fitter_of({"asymmetric_gap": {"z0": 0.001}}, make_excitation(np.random.default_rng(2), "multisine", 8.0), 8.0)
    found = separate(own, fitted(own, "asymmetric_gap", z0=0.001), fitted(own, "sensor_offset", z_s=0.001))
    assert found is not None
    assert not found.parts
    assert "No sine within what this rig has done" in str(found)


def test_the_rig_is_asked_for_no_more_than_it_has_shown():
    own = fitter_of({}, make_excitation(np.random.default_rng(3), "chirp", 8.0), 8.0)
    x = own.record.channels["x"]
    speed = np.max(np.abs(np.gradient(x, own.record.dt)))
    sines = list(within_reach(own.record))
    assert len(sines) == 6
    for amplitude, frequency in sines:
        assert 0.0 < amplitude <= np.max(np.abs(x - np.mean(x)))
        assert amplitude * 2.0 * np.pi * frequency <= speed
