"""The noise of a record, and what a model misses it by, are the same whichever command is asked."""

import json

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.refine import _Judge
from jaxbacklash.fitting.left_over import quieter
from jaxbacklash.model_file import noise_known
from tests.hidden import fitter, hidden
from tests.in_process import call
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
    """The fitter of a refinement, and the model that explains the record before the noise is looked at."""
    own = fitter(record, None, "linear", heldout, None)
    law = jb.fit(record, model="linear", effects=["cubic_stiffness"], starts=1).system
    return own, own.fit_model(dict(law.effects))


def settled(own, model):
    """The search's rounds: the noise is taken from the model, and the model fitted again."""
    for _ in range(4):
        if (factor := own.too_loud(model)) == 1.0:
            return model
        own.quieter(factor)
        model = own.fit_model(own.effects(model), model)
    raise AssertionError("the noise does not settle")


@pytest.mark.slow
def test_fit_and_refine_find_one_noise_under_a_force_of_noise(shaken_twice):
    record = shaken_twice[0]
    fitted = jb.fit(record, model="linear", effects=["cubic_stiffness"], starts=1)
    assert fitted.noise[0] < 0.5 * fitted.noise_alone[0]  # the samples alone cannot tell it
    own, model = hardening(record)
    model = settled(own, model)
    refined = _Judge(own, None, "linear", False, True, None)(model)
    assert refined.noise[0] == pytest.approx(fitted.noise[0], rel=0.02)
    assert refined.noise_alone == pytest.approx(fitted.noise_alone)
    assert refined.known_noise == pytest.approx(fitted.known_noise, rel=0.02)
    assert refined.noise[0] == pytest.approx(LEVEL, rel=0.2)
    for name, one in fitted.parameters.items():
        assert refined.parameters[name].stderr == pytest.approx(one.stderr, rel=0.05)


@pytest.mark.slow
def test_compare_tells_of_an_incomplete_model_what_refine_did(shaken_twice, tmp_path):
    """The noise was found beside a model that explains; one that does not is as wrong for `compare` as in the table."""
    record, heldout = shaken_twice
    own, model = hardening(record, heldout)
    settled(own, model)
    refined = _Judge(own, heldout, "linear", False, True, None)(own.fit_model({}))
    assert refined.heldout.rms > 10.0
    told(refined, record, heldout, tmp_path)


@pytest.mark.slow
def test_compare_tells_what_refine_did_of_windows_that_no_model_joins(tmp_path):
    record, rig, _, _ = hidden("cubic_stiffness", "multisine", 7, seconds=8.0)
    heldout, _, _, _ = hidden("cubic_stiffness", "chirp", 7, seconds=8.0)
    own = fitter(record, rig.inertia, beside=heldout, window=None)
    refined = _Judge(own, heldout, "joint", False, False, None)(own.fit_model({}))
    assert refined.heldout.rms > 10.0
    told(refined, record, heldout, tmp_path)
    fitted = jb.fit(record, inertia=rig.inertia, heldout=heldout, starts=1)
    told(fitted, record, heldout, tmp_path)


def told(fit, record, heldout, folder):
    """`compare` of the model that was written tells both errors to one percent."""
    between = jb.records.force.between(fit.records) if "F" in record.channels else None
    text = jb.dump_model(fit.system, between=between, known_noise=fit.known_noise)
    (folder / "model.toml").write_text(text)
    assert noise_known(folder / "model.toml") == (fit.known_noise if fit.known_noise[0] < 1.0 else (1.0, 0.0))
    for file, score in ((record, fit.score), (heldout, fit.heldout)):
        jb.write_record(file, folder / "rec.csv")
        found = call(["compare", "model.toml", "rec.csv", "--json"], folder)
        assert found.code == 0, found.err
        stage = json.loads(found.out)["stages"][0]
        assert stage["rms_over_noise"] == pytest.approx(score.rms, rel=0.01)
        assert stage["median_over_noise"] == pytest.approx(score.median, rel=0.01)


def test_noise_is_taken_for_less_only_beyond_chance():
    t = np.arange(10_000) / 100.0

    def factor(samples, rms):
        seen = 0.1 * np.sin(t[:samples]) + 1e-3 * np.random.default_rng(0).standard_normal(samples)
        record = jb.Record(t[:samples], {"z": seen})
        return quieter([1.0], [type("Score", (), {"rms": rms})], [record])[0]

    assert [factor(600, 0.94), factor(600, 0.9)] == [1.0, 0.9]
    assert [factor(10_000, 0.98), factor(10_000, 0.96)] == [1.0, 0.96]


def test_a_noise_that_cannot_be_is_refused(tmp_path):
    text = jb.dump_model(jb.System(1.0, None, None, {}, "z"), known_noise=(0.5, 1e-4))
    (tmp_path / "m.toml").write_text(text)
    assert noise_known(tmp_path / "m.toml") == (0.5, 1e-4)
    (tmp_path / "m.toml").write_text(text.replace("factor = 0.5", "factor = 1.5"))
    with pytest.raises(jb.BadInput, match=r"\[noise\] has factor 1.5"):
        jb.load_model(tmp_path / "m.toml")
