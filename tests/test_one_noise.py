"""The noise of a record, and what a model misses it by, are the same whichever command is asked."""

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.refine import _Judge
from jaxbacklash.criticism.workbench import Workbench
from jaxbacklash.fitting.left_over import quieter
from jaxbacklash.fitting.setup import base_system
from tests.test_noise_level import shaken

LEVEL = 5e-7


@pytest.fixture(scope="module")
def shaken_twice():
    """A mass on a hardening spring under a force of noise, and the same rig again; their motion hides the noise."""
    records = []
    for seed in (0, 1):
        t, force, motion = shaken(level=LEVEL, seed=seed, seconds=4.0)
        records.append(jb.Record(t, {"F": force, "y": motion}))
    return records


def hardening(record, heldout=None):
    """The workbench of a refinement, and the model that explains the record, one trajectory, before the noise is looked at."""
    base, free, _ = base_system(record, "linear", None)
    bench = Workbench(record, base, free, None, beside=heldout)
    law = jb.fit(record, model="linear", effects=["cubic_stiffness"], starts=1).system
    first = bench.fit(dict(law.effects), joint=law, patience=60)
    return bench, bench.fit(bench.effects(first), first, tied=True, patience=60)


def settled(bench, trial):
    """The search's rounds: the noise is taken from the model, and the model fitted again."""
    for _ in range(4):
        if (factor := bench.too_loud(trial)) == 1.0:
            return trial
        bench.quieter(factor)
        trial = bench.fit(bench.effects(trial), trial, tied=True, patience=60)
    raise AssertionError("the noise does not settle")


def test_fit_and_refine_find_one_noise_under_a_force_of_noise(shaken_twice):
    record = shaken_twice[0]
    fitted = jb.fit(record, model="linear", effects=["cubic_stiffness"], starts=1)
    assert fitted.noise[0] < 0.5 * fitted.noise_alone[0]  # the samples alone cannot tell it
    bench, trial = hardening(record)
    trial = settled(bench, trial)
    refined = _Judge(bench, None, "linear", False, True, None, lambda fit: None)(trial)
    assert refined.noise[0] == pytest.approx(fitted.noise[0], rel=0.02)
    assert refined.noise_alone == pytest.approx(fitted.noise_alone)
    assert refined.known_noise == pytest.approx(fitted.known_noise, rel=0.02)
    assert refined.noise[0] == pytest.approx(LEVEL, rel=0.2)
    for name, one in fitted.parameters.items():
        assert refined.parameters[name].stderr == pytest.approx(one.stderr, rel=0.05)


def test_noise_is_taken_for_less_only_beyond_chance():
    t = np.arange(10_000) / 100.0

    def factor(samples, rms):
        seen = 0.1 * np.sin(t[:samples]) + 1e-3 * np.random.default_rng(0).standard_normal(samples)
        record = jb.Record(t[:samples], {"z": seen})
        return quieter([1.0], [type("Score", (), {"rms": rms})], [record])[0]

    assert [factor(600, 0.94), factor(600, 0.9)] == [1.0, 0.9]
    assert [factor(10_000, 0.98), factor(10_000, 0.96)] == [1.0, 0.96]
