"""The error as a share of what was measured, which stands beside the error over the noise: one definition, told everywhere."""

import json
import re
from types import SimpleNamespace

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.refinement import Refinement
from jaxbacklash.criticism.steps import Stage
from jaxbacklash.criticism.verdict import Verdict
from jaxbacklash.fitting.compare import Comparison
from jaxbacklash.fitting.score import Score, error_in_words, nrmse, percent
from jaxbacklash.model_file import dump_model
from jaxbacklash.report.result import as_json, comparison_json
from jaxbacklash.report.summary import summarise
from jaxbacklash.residuals.words import headline

from .report_samples import result
from .test_cli import call as call  # the fixture that runs the command line
from .test_fit import joint, measured


def score(share, *, rms=133.0, observed="z", offset=5.0):
    """A sine about an offset, and a prediction off by this share of it."""
    t = np.arange(1000) / 500.0
    motion = offset + 0.02 * np.sin(2 * np.pi * 4.0 * t)
    wrong = motion + share * 0.02 * np.sin(2 * np.pi * 8.0 * t)
    times = np.arange(0.0, 2.0, 0.2)
    return Score(rms, 0.9 * rms, np.full(times.size, rms), times, t, motion, wrong, (motion - wrong) / 1e-5, observed=observed)


def test_the_share_is_the_rms_of_the_error_over_the_standard_deviation():
    assert score(0.12).nrmse == pytest.approx(0.12, rel=1e-6)  # wherever the motion's middle lies
    rng = np.random.default_rng(0)
    seen, said = rng.normal(3.0, 2.0, 500), rng.normal(size=500)
    missed, spread = (sum((a - b) ** 2 for a, b in zip(seen, other)) for other in (said, [seen.mean()] * 500))
    assert nrmse(seen, said) == pytest.approx(np.sqrt(missed / spread), rel=1e-12)
    assert nrmse(1e6 * seen, 1e6 * said) == pytest.approx(np.sqrt(missed / spread), rel=1e-12)
    assert nrmse(seen, np.full(500, seen.mean())) == pytest.approx(1.0)  # what a model that says nothing misses


@pytest.mark.parametrize(
    ("share", "text"), [(0.12, "12 %"), (0.00213, "0.21 %"), (0.9949, "99 %"), (1.0, "100 %"), (13.3, "1330 %"), (1e9, "1e+11 %")]
)
def test_a_share_reads_with_two_digits(share, text):
    assert percent(share) == text


def test_both_errors_stand_side_by_side():
    assert error_in_words(score(0.12)) == "133 times the noise, 12 % of the motion"
    assert error_in_words(score(0.12, observed="T")) == "133 times the noise, 12 % of the force"


def test_a_channel_that_never_moves_has_no_share():
    still = score(0.0)
    still = Score(2.0, 2.0, still.window_rms, still.window_times, still.t, 0 * still.t, 0 * still.t, still.residual)
    assert error_in_words(still) == "2 times the noise"


def test_a_comparison_tells_it():
    record = jb.Record(score(0.12).t, {"z": score(0.12).measured})
    found = Comparison(joint(), record, score(0.12), 1e-5, False)
    assert "misses this record by 133 times the noise, 12 % of the motion (median window 120)" in str(found)
    assert comparison_json(found, "model.toml")["stages"][0]["nrmse"] == pytest.approx(0.12)


@pytest.fixture(scope="module")
def fitted():
    """A plain fit of a joint that rubs on the ground, with another such record held out."""
    rubs = joint().with_effects(jb.CoulombGround(30.0))
    one, two = (measured(rubs, [0.05, 0.02, 0.01], duration=4.0, seed=s) for s in (0, 1))
    return jb.fit(one, inertia=3.16, starts=1, heldout=two)


def direct(score):
    return float(np.sqrt(np.mean((score.measured - score.predicted) ** 2)) / np.std(score.measured))


def test_a_fit_tells_it_in_text_result_and_page(fitted):
    own, held = direct(fitted.score), direct(fitted.heldout)
    assert own > 1e-3
    text = str(fitted)
    beside = f"{fitted.score.rms:.3g} times the noise, {percent(own)} of the motion"
    assert f"prediction error over windows: {beside}" in text
    assert beside in text.splitlines()[-1]  # the verdict
    assert f"on the held-out record: {fitted.heldout.rms:.3g} times the noise, {percent(held)} of the motion" in text
    told = as_json(fitted)
    json.dumps(told, allow_nan=False)
    stage = told["stages"][0]
    assert stage["nrmse"] == pytest.approx(own, rel=1e-12)
    assert stage["heldout_nrmse"] == pytest.approx(held, rel=1e-12)
    assert {"rms", "rms_over_noise", "median_over_noise", "heldout_rms_over_noise", "heldout_median_over_noise"} <= set(stage)
    page = summarise(told)
    (tile,) = (tile for tile in page["tiles"] if tile["label"] == "prediction error")
    assert f"{percent(own)} of the motion" in tile["rest"]
    assert dict(page["scores"])["share of the motion"] == percent(own)
    assert dict(page["scores"])["held-out share of the motion"] == percent(held)


def test_a_refinement_and_a_diagnosis_tell_it(fitted):
    found = Refinement((Stage(None, (), fitted, (), {}),), (), Verdict(False, "Incomplete.", False))
    (row,) = (line for line in str(found).splitlines() if line.startswith("  base model"))
    own, held = (percent(direct(s)) for s in (fitted.score, fitted.heldout))
    assert re.search(rf"{re.escape(own)} .*{re.escape(held)}", row)
    told = headline(fitted, SimpleNamespace(rms=2.0, unit="N m"))
    assert f"times the noise, {own} of the motion" in told


def test_a_page_without_the_share_is_still_a_page():
    older = result()
    for stage in older["stages"]:
        stage.pop("nrmse", None), stage.pop("heldout_nrmse", None)
    page = summarise(older)
    assert "1.00 would be noise alone" in page["tiles"][-1]["rest"]
    assert dict(page["scores"])["share of the motion"] == "–"


def test_compare_prints_it(call, fitted, tmp_path):
    (tmp_path / "model.toml").write_text(dump_model(joint()))
    jb.write_record(fitted.records[0], tmp_path / "one.csv")
    code, out, err = call("compare", tmp_path / "model.toml", tmp_path / "one.csv")
    assert code == 0, err
    assert re.search(r"times the noise, [\d.]+ % of the motion", out)
