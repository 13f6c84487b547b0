"""`chaos` on the command line: any even table, its result.json, its page, and one sentence for every mistake."""

import json
import math

import numpy as np
import pytest

from jaxbacklash.records import read_series

from .independent.chaotic import HENON
from .report_samples import numbers
from .test_cli import call as call  # the fixture that runs the command line
from .test_cli import sentence
from .test_timeseries_driven import DT, swept


def write(path, names, *columns):
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=names, comments="")
    return path


@pytest.fixture(scope="module")
def driven(tmp_path_factory):
    """A map's iterates beside a made-up drive of period 0.25 s."""
    folder = tmp_path_factory.mktemp("chaos")
    t = 0.01 * np.arange(1500)
    z = 1e-3 * HENON.series(1500, 1, 3)[0]
    return write(folder / "driven.csv", "t,x,z", t, 0.1 * np.sin(2.0 * np.pi * 4.0 * t), z)


def test_result_and_page(call, driven, tmp_path):
    code, out, err = call("chaos", driven, "--out", tmp_path / "out", "--json")
    assert (code, err) == (0, "")
    found = json.loads(out)
    assert json.loads((tmp_path / "out" / "result.json").read_text()) == found
    assert found["verdict"] == "chaotic"
    assert all(map(math.isfinite, numbers(found)))
    grows = found["lyapunov"]
    assert grows["unit"] == "1/s"
    assert grows["value"] == pytest.approx(41.9, rel=0.1)
    assert grows["ci95"][0] < 41.9 < grows["ci95"][1]
    assert grows["bit_per_s"] == pytest.approx(grows["value"] / math.log(2.0))
    assert grows["per_period"] == pytest.approx(0.25 * grows["value"], rel=0.01)
    assert found["delay_samples"] == 1
    assert found["dimension"]["raw"] == 2
    assert found["surrogates"]["kind"] == "iaaft"
    assert found["surrogates"]["p_value"] == pytest.approx(0.025)
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert page.count("<svg") >= 7
    assert "http" not in page.replace("http://www.w3.org", "")


@pytest.mark.slow
def test_a_drive_that_never_repeats_makes_the_answer_conditional(call, tmp_path):
    x, z, exact = swept(0.055)
    path = write(tmp_path / "sweep.csv", "t,x,z", DT * np.arange(x.size), x, z)
    code, out, err = call("chaos", path, "--out", tmp_path / "out", "--json", "--no-clean")
    assert (code, err) == (0, "")
    found = json.loads(out)
    assert found["verdict"] == "chaotic"
    assert "under the same base motion separate" in found["verdict_text"]
    assert found["lyapunov"]["conditional_on_drive"] is True
    assert found["lyapunov"]["value"] == pytest.approx(exact, rel=0.25)
    assert found["driven"]["two_motions"] == "separate"
    assert all(map(math.isfinite, numbers(found)))
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "Under the measured drive" in page


def test_a_converted_channel_is_labelled_with_what_it_was_converted_to(tmp_path):
    path = write(tmp_path / "degrees.csv", "t,z", 0.01 * np.arange(600), np.sin(np.arange(600.0)))
    found = read_series(path, units={"z": "deg"})
    assert found.unit == "rad"
    assert np.ptp(found.values) == pytest.approx(2.0 * np.pi / 180.0, rel=1e-3)
    assert read_series(path).unit == ""


def test_text_without_a_drive(call, tmp_path):
    series = np.sin(0.3 * np.arange(1000)) + 0.02 * np.random.default_rng(2).standard_normal(1000)
    path = write(tmp_path / "free.csv", "t,volts,note", np.arange(1000.0), series, np.zeros(1000))
    code, out, err = call("chaos", path, "--channel", "volts", "--no-clean")
    assert (code, err) == (0, "")
    assert "regular" in out
    assert "largest Lyapunov exponent       none" in out


def test_a_value_that_is_absent_says_why(call, tmp_path):
    noise = np.random.default_rng(3).standard_normal(1000)
    path = write(tmp_path / "noise.csv", "intensity", noise)
    code, out, _ = call("chaos", path, "--rate", "100", "--json", "--no-clean")
    found = json.loads(out)
    assert code == 0
    assert found["verdict"] == "stochastic"
    assert found["lyapunov"]["value"] is None
    assert found["lyapunov"]["why"]
    assert found["record"]["rate_hz"] == pytest.approx(100.0)


@pytest.mark.parametrize(
    ("header", "words", "said"),
    [
        ("t,a,b", [], "--channel"),
        ("t,a,b", ["--channel", "c"], 'no column "c"'),
        ("s,a,b", ["--channel", "a"], "no time column t"),
        ("t,z,b", ["--surrogates", "other"], "iaaft"),
        ("t,z,b", ["--surrogate-count", "5"], "at least 19"),
        ("t,z,b", ["--rate", "-1"], "wanted"),
    ],
)
def test_mistakes_end_in_one_sentence(call, tmp_path, header, words, said):
    path = write(tmp_path / "bad.csv", header, np.arange(600.0), *np.random.default_rng(4).standard_normal((2, 600)))
    code, out, err = call("chaos", path, *words)
    assert code == 2
    assert out == ""
    assert said in sentence(err)


def test_a_long_series_that_is_sampled_too_finely_is_given_a_rate(call, tmp_path):
    t = np.arange(450_000) / 50e3
    z = 0.01 * np.sin(2.0 * np.pi * 3.0 * t) + 1e-6 * np.random.default_rng(0).standard_normal(t.size)
    np.savez(tmp_path / "fine.npz", t=t, z=z)
    code, _, err = call("chaos", tmp_path / "fine.npz", "--channel", "z")
    assert code == 2
    assert "450000 samples at 50000 Hz; the motion needs" in sentence(err)
    rate = sentence(err).rpartition("--resample-rate ")[2].rstrip(".`")
    assert 60.0 <= float(rate) <= 1000.0


def test_uneven_times_are_refused(call, tmp_path):
    t = np.sort(np.random.default_rng(5).uniform(0.0, 10.0, 800))
    code, _, err = call("chaos", write(tmp_path / "uneven.csv", "t,z", t, np.sin(t)))
    assert code == 2
    assert "even steps" in sentence(err)
