"""The experiment that is proposed separates two models, as a joint that has the one effect shows."""

import numpy as np
import pytest

pytest.importorskip("numba")

from jaxbacklash.criticism.experiment import RAMP, SECONDS, error, separate, within_reach
from jaxbacklash.criticism.workbench import Workbench
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.mechanics import catalogue
from jaxbacklash.records import Record
from tests.independent.generator import make_excitation, measure, simulate_truth
from tests.independent.motions import SteppedSine
from tests.independent.rigs import Excitation, Rig

RIG = Rig(inertia=3.1, backlash=0.025, stiffness=12500.0, damping=20.0)
SIGMA, RATE = 1e-4, 500.0


def bench_of(effects, excitation, seconds, seed=5):
    rng = np.random.default_rng(seed)
    seen = measure(simulate_truth(RIG, effects, excitation, RATE, seconds), rng, SIGMA, SIGMA)
    record = Record(seen["t"], {"x": seen["x"], "z": seen["z"]})
    base, free, _ = base_system(record, "joint", RIG.inertia)
    return Workbench(record, base, free, 0.2)


def fitted(bench, name, **values):
    trial = bench.fit({name: catalogue()[name](**values)}, patience=40)
    return bench.fit(bench.effects(trial), trial, tied=True, patience=40)


def test_what_it_promises_is_what_the_joint_shows():
    hidden = {"cubic_stiffness": {"k3": 3e6}}
    bench = bench_of(hidden, make_excitation(np.random.default_rng(1), "multisine", 8.0, scale=0.7), 8.0)
    kept, rival = fitted(bench, "cubic_stiffness", k3=2e6), fitted(bench, "hunt_crossley", chi=100.0)
    found = separate(bench, kept, rival)
    assert found is not None
    assert found.parts
    assert "let a sine" in str(found)
    best = found.best
    # Simulated by other means, with another ramp.
    sine = SteppedSine(best.frequency, (best.amplitude,), hold=SECONDS + 1.0, ramp=RAMP)
    shown = bench_of(hidden, Excitation("sine", sine), SECONDS, seed=6)
    errors = [error(shown, bench, trial) for trial in (kept, rival)]
    assert errors[0] == pytest.approx(1.0, abs=0.05)
    assert errors[1] == pytest.approx(best.misfit, rel=0.2)


def test_what_nothing_separates_is_said():
    bench = bench_of({"asymmetric_gap": {"z0": 0.001}}, make_excitation(np.random.default_rng(2), "multisine", 8.0), 8.0)
    found = separate(bench, fitted(bench, "asymmetric_gap", z0=0.001), fitted(bench, "sensor_offset", z_s=0.001))
    assert found is not None
    assert not found.parts
    assert "No sine within what this rig has done" in str(found)


def test_the_rig_is_asked_for_no_more_than_it_has_shown():
    bench = bench_of({}, make_excitation(np.random.default_rng(3), "chirp", 8.0), 8.0)
    x = bench.record.channels["x"]
    speed = np.max(np.abs(np.gradient(x, bench.record.dt)))
    sines = list(within_reach(bench.record))
    assert len(sines) == 6
    for amplitude, frequency in sines:
        assert 0.0 < amplitude <= np.max(np.abs(x - np.mean(x)))
        assert amplitude * 2.0 * np.pi * frequency <= speed
