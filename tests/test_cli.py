"""The command line as a person meets it: results, exit codes, one sentence for every mistake."""

import json

import numpy as np
import pytest

from jaxbacklash import base_motion_joint, dump_model, read_record, simulate, write_record
from jaxbacklash.effects import Gravity
from jaxbacklash.excitation import Multisine
from jaxbacklash.simulation import as_record

from . import in_process
from .test_bad_input import CASES, table, without


@pytest.fixture
def call(monkeypatch, tmp_path):
    """Run the command line with the given words; returns exit code, stdout and stderr."""
    monkeypatch.setenv("JAXBACKLASH_CACHE", str(tmp_path / "cache"))
    monkeypatch.chdir(tmp_path)

    def run(*words):
        told = in_process.call([str(word) for word in words], tmp_path)
        return told.code, told.out, told.err

    return run


@pytest.fixture(scope="module")
def joint(tmp_path_factory):
    """A folder with a model of a hanging link, a noisy record of it and a second one."""
    folder = tmp_path_factory.mktemp("joint")
    system = base_motion_joint(3.0, 0.024, 12000.0, 15.0).with_effects(Gravity(-30.0))
    (folder / "model.toml").write_text(dump_model(system))
    rng = np.random.default_rng(11)
    for name, phase in (("one", 0.3), ("two", 1.1)):
        drive = Multisine(np.array([0.05, 0.03, 0.02]), 2 * np.pi * np.array([1.1, 2.7, 4.3]), phase * np.arange(3))
        clean = as_record(simulate(system, drive, duration=6.0, rate=500.0), system)
        noisy = clean.replace(**{n: v + 3e-5 * rng.standard_normal(v.size) for n, v in clean.channels.items()})
        write_record(noisy, folder / f"{name}.csv")
    return folder


def sentence(err):
    lines = [line for line in err.splitlines() if not line.startswith("warning:")]
    assert len(lines) == 1, err
    assert "Traceback" not in err
    return lines[0]


@pytest.mark.parametrize(("write", "fragments"), [case[1:] for case in CASES], ids=[case[0] for case in CASES])
def test_a_bad_record_ends_with_code_2(call, tmp_path, write, fragments):
    code, out, err = call(*write(tmp_path))
    assert code == 2
    assert out == ""
    text = sentence(err)
    for fragment in fragments:
        assert " ".join(fragment.split()) in text


MISTAKES = {
    "no such command": (["fitt", "rec.csv"], "fitt"),
    "no such option": (["fit", "rec.csv", "--inertai", "3"], "--inertai"),
    "no record": (["fit"], "RECORDS is missing"),
    "inertia not a number": (["fit", "rec.csv", "--inertia", "heavy"], "--inertia"),
    "inertia negative": (["fit", "rec.csv", "--inertia", "-3"], "--inertia -3"),
    "inertia zero": (["fit", "rec.csv", "--inertia", "0"], "positive"),
    "unknown model": (["fit", "rec.csv", "--model", "cubic"], "--model cubic"),
    "unknown effect": (["fit", "rec.csv", "--effects", "gravty"], "gravty"),
    "window too short": (["fit", "rec.csv", "--window", "0.001"], "--window 0.001"),
    "no starts": (["fit", "rec.csv", "--starts", "0"], "--starts 0"),
    "held-out missing": (["fit", "rec.csv", "--heldout", "nothere.csv"], "nothere.csv"),
    "out is a file": (["fit", "rec.csv", "--out", "rec.csv"], "rec.csv"),
    "model file missing": (["compare", "nothere.toml", "rec.csv"], "nothere.toml"),
    "model file broken": (["compare", "broken.toml", "rec.csv"], "broken.toml"),
    "model file without model": (["compare", "empty.toml", "rec.csv"], "[model]"),
    "model file with a stray entry": (["compare", "stray.toml", "rec.csv"], "stifness"),
    "model file with text": (["compare", "text.toml", "rec.csv"], "finite number"),
    "model file with an unknown effect": (["compare", "effect.toml", "rec.csv"], "gravty"),
    "model file with a negative play": (["compare", "negative.toml", "rec.csv"], "backlash"),
    "both inertias": (["fit", "rec.csv", "--model", "good.toml", "--inertia", "3"], "--inertia"),
    "unknown excitation": (["simulate", "good.toml", "--excitation", "noise:amplitude=1", "--out", "a.csv"], "noise"),
    "excitation lacks an entry": (["simulate", "good.toml", "--excitation", "chirp:amplitude=1", "--out", "a.csv"], "f0"),
    "excitation is no number": (
        ["simulate", "good.toml", "--excitation", "harmonic:amplitude=big,frequency=2", "--out", "a.csv"], "big",
    ),
    "negative duration": (["simulate", "good.toml", "--duration", "-1", "--out", "a.csv"], "--duration -1"),
    "negative noise": (["simulate", "good.toml", "--noise", "-1", "--out", "a.csv"], "--noise -1"),
    "record to write has no known ending": (["simulate", "good.toml", "--duration", "1", "--out", "a.docx"], ".docx"),
    "bad mapping": (["fit", "rec.csv", "--columns", "t:time"], "--columns"),
    "transmitted torque only": (["fit", "torque.csv"], "motion of the link"),
    "diagnose without a record": (["diagnose"], "record"),
    "diagnose two records": (["diagnose", "rec.csv", "rec.csv"], "rec.csv"),
    "diagnose an unknown model": (["diagnose", "rec.csv", "--model", "cubic"], "--model cubic"),
    "diagnose an unknown effect": (["diagnose", "rec.csv", "--effects", "gravty"], "gravty"),
    "diagnose with a window too long": (["diagnose", "rec.csv", "--window", "60"], "--window 60"),
    "diagnose with both inertias": (["diagnose", "rec.csv", "--model", "good.toml", "--inertia", "3"], "--inertia"),
    "diagnose a transmitted torque": (["diagnose", "torque.csv"], "motion of the link"),
    "refine without a record": (["refine"], "record"),
    "refine with an effect": (["refine", "rec.csv", "--effects", "gravity"], "--effects"),
    "refine an unknown model": (["refine", "rec.csv", "--model", "cubic"], "--model cubic"),
    "refine a model file that is missing": (["refine", "rec.csv", "--model", "nothere.toml"], "nothere.toml"),
    "refine with both inertias": (["refine", "rec.csv", "--model", "good.toml", "--inertia", "3"], "--inertia"),
    "refine with a negative inertia": (["refine", "rec.csv", "--inertia", "-3"], "--inertia -3"),
    "refine with a window too short": (["refine", "rec.csv", "--window", "0.001"], "--window 0.001"),
    "refine with a held-out record that is missing": (["refine", "rec.csv", "--heldout", "nothere.csv"], "nothere.csv"),
    "refine with a held-out record of another kind": (["refine", "rec.csv", "--heldout", "torque.csv"], "wanted a record of"),
    "refine into a file": (["refine", "rec.csv", "--out", "rec.csv"], "rec.csv"),
    "refine with laws that are missing": (["refine", "rec.csv", "--laws", "nothere.py"], "nothere.py"),
    "refine a transmitted torque": (["refine", "torque.csv"], "motion of the link"),
}  # fmt: skip


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_on_the_command_line_ends_with_code_2(call, tmp_path, name):
    table(without())(tmp_path)
    model = "[model]\ninertia = 3.0\nbacklash = 0.02\nstiffness = 1e4\ndamping = 9.0\n"
    files = {
        "good": model,
        "broken": "[model\n",
        "empty": "",
        "stray": model + "stifness = 3\n",
        "text": model.replace("9.0", '"much"'),
        "effect": model + "[effects.gravty]\nG = 3.0\n",
        "negative": model.replace("0.02", "-0.02"),
    }
    for stem, text in files.items():
        (tmp_path / f"{stem}.toml").write_text(text)
    record = read_record(tmp_path / "rec.csv")
    lines = ["t,x,T", *(f"{t},{x},{9 * z}" for t, x, z in zip(record.t, record.channels["x"], record.channels["z"]))]
    (tmp_path / "torque.csv").write_text("\n".join(lines))
    words, fragment = MISTAKES[name]
    code, out, err = call(*words)
    assert code == 2, err
    assert fragment in sentence(err)
    assert out == ""


def test_fit_writes_what_the_contract_says(call, joint, tmp_path):
    words = ["fit", joint / "one.csv", "--inertia", "3.0", "--effects", "gravity", "--heldout", joint / "two.csv"]
    code, out, err = call(*words, "--out", tmp_path / "out", "--json", "--starts", "2")
    assert code == 0, err
    result = json.loads(out)
    assert json.loads((tmp_path / "out" / "result.json").read_text()) == result
    assert result["schema"] == 1
    assert result["command"] == "fit"
    assert result["record"]["samples"] == 3001
    assert set(result["noise"]) == {"z", "x"}
    (stage,) = result["stages"]
    for key in ("rms_over_noise", "median_over_noise", "heldout_rms_over_noise", "heldout_median_over_noise"):
        assert stage[key] == pytest.approx(1.0, abs=0.08)
    assert result["effects"] == stage["effects"] == ["gravity"]
    assert result["verdict"] == "complete"
    truth = {"backlash": 0.024, "stiffness": 12000.0, "damping": 15.0, "gravity.G": -30.0}
    assert set(stage["parameters"]) == set(truth)
    for name, value in truth.items():
        found = stage["parameters"][name]
        assert abs(found["value"] - value) < 4 * found["stderr"]
        assert found["ci95"][0] < found["value"] < found["ci95"][1]
    page = (tmp_path / "out" / "report.html").read_text()
    assert page.count("<svg") >= 4
    assert "http://" not in page.replace("http://www.w3.org", "")

    code, out, err = call("compare", tmp_path / "out" / "model.toml", joint / "two.csv", "--json")
    assert code == 0, err
    again = json.loads(out)
    assert again["stages"][0]["rms_over_noise"] == pytest.approx(stage["heldout_rms_over_noise"], rel=0.02)

    code, out, _ = call(*words, "--json", "--starts", "2")
    repeated = json.loads(out)
    assert repeated["stages"] == result["stages"]


def test_without_inertia_values_are_per_unit_inertia(call, joint):
    code, out, _ = call("fit", joint / "one.csv", "--effects", "gravity", "--starts", "1", "--json")
    assert code == 0
    result = json.loads(out)
    assert result["per_inertia"]
    found = result["stages"][0]["parameters"]
    assert found["stiffness"]["unit"] == "1/s^2"
    assert found["stiffness"]["value"] == pytest.approx(4000.0, rel=1e-3)
    assert found["backlash"]["value"] == pytest.approx(0.024, rel=1e-3)
    code, out, _ = call("fit", joint / "one.csv", "--effects", "gravity", "--starts", "1")
    assert "per unit inertia" in out


def test_simulate_writes_a_record_that_fits(call, joint, tmp_path):
    words = ["--excitation", "multisine:amplitude=0.04,low=1,high=5,lines=5", "--duration", "4", "--noise", "3e-5"]
    code, out, err = call("simulate", joint / "model.toml", *words, "--out", tmp_path / "sim.npz")
    assert code == 0, err
    record = read_record(tmp_path / "sim.npz")
    assert record.samples == 2001
    assert "2001 samples" in out
    code, out, _ = call("compare", joint / "model.toml", tmp_path / "sim.npz")
    assert code == 0
    assert "to its noise" in out


OWN_LAW = '''
import jax.numpy as jnp
from jaxbacklash import AbstractEffect, param


class SpeedSquared(AbstractEffect):
    """A torque against the square of the relative speed."""

    strength: float = param(unit="N m s^2/rad^2", null=0.0, lower=0.0, scale=1.0)

    def torque(self, now):
        return -self.strength * now.dz * jnp.abs(now.dz)
'''


def test_an_effect_of_ones_own(call, joint, tmp_path):
    """Fifteen lines: fitted, named, reported with its unit, written to the model file and read back."""
    (tmp_path / "own.py").write_text(OWN_LAW)
    words = ["fit", joint / "one.csv", "--inertia", "3", "--laws", tmp_path / "own.py", "--starts", "1", "--out", tmp_path / "o"]
    code, out, err = call(*words, "--effects", "gravity,speed_squared", "--json")
    assert code == 0, err
    found = json.loads(out)["stages"][0]["parameters"]["speed_squared.strength"]
    assert found["unit"] == "N m s^2/rad^2"
    assert abs(found["value"]) < 5 * found["stderr"]
    code, out, _ = call("compare", tmp_path / "o" / "model.toml", joint / "two.csv", "--laws", tmp_path / "own.py", "--json")
    assert code == 0
    assert json.loads(out)["effects"] == ["gravity", "speed_squared"]
    (tmp_path / "none.py").write_text("x = 1")
    code, _, err = call("fit", joint / "one.csv", "--laws", tmp_path / "none.py")
    assert code == 2
    assert "defines no effect" in sentence(err)


def test_help_has_an_example(call):
    for command in ("fit", "compare", "diagnose", "refine", "simulate", "demo"):
        code, out, _ = call(command, "--help")
        assert code == 0
        assert "Example: jaxbacklash" in " ".join(out.split())


def test_no_word_at_all_shows_the_help(call):
    code, out, err = call()
    assert code == 2
    assert out == ""
    assert "refine" in err
    assert "skeleton" in err
