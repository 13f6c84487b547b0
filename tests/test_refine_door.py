"""`refine` as users and scripts meet it: its result.json, its page in a browser, and an effect of one's own among the ranked."""

import json
import math
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.candidates import Candidate
from jaxbacklash.criticism.ranking import judged, table
from jaxbacklash.report.refine_result import candidates_json

from .report_samples import numbers
from .test_bad_input import CASES
from .test_cli import call as call  # the fixture that runs the command line
from .test_cli import sentence
from .test_report import FRAMES, Tags, browse

ROOT = Path(__file__).resolve().parents[1]
RATE, SECONDS, NOISE = 500.0, 8.0, 3e-5
HUM = {"A": 2.0}

OWN_LAW = '''
import jax.numpy as jnp
from jaxbacklash import AbstractEffect, param


class FloorHum(AbstractEffect):
    """A machine next door shakes the link at five steady rates, T = a sum of sin(w t + n^2)."""

    port = "ground"
    a: float = param(unit="N m", null=0.0, scale=1.0)

    def torque(self, now):
        rates = (3.1, 4.7, 7.3, 11.2, 16.9)  # Hz
        return self.a * sum(jnp.sin(2.0 * jnp.pi * f * now.t + n**2) for n, f in enumerate(rates))
'''


# ---- Bad input ----


@pytest.mark.parametrize("command", ["refine", "diagnose"])
@pytest.mark.parametrize(("write", "fragments"), [case[1:] for case in CASES], ids=[case[0] for case in CASES])
def test_a_bad_record_ends_with_code_2(call, tmp_path, command, write, fragments):
    code, out, err = call(command, *write(tmp_path)[1:])
    assert code == 2
    assert out == ""
    for fragment in fragments:
        assert " ".join(fragment.split()) in sentence(err)


# ---- The ranking in a person's units ----


def score(rms, correlated):
    """A score of a made-up residual: noise, plus a slow wave of the given share."""
    t = np.arange(4000) / RATE
    wave = np.sqrt(2.0) * np.sin(20.0 * t) * np.sqrt(max(rms**2 - 1.0, 0.0)) * correlated
    residual = np.random.default_rng(2).normal(size=t.size) + wave
    return SimpleNamespace(rms=rms, residual=residual, t=t, window_times=np.arange(0.0, 8.0, 0.2))


def test_ranking_speaks_in_errors_and_evidence():
    gains = {"gravity": (12000.0, 1.0), "preload": (600.0, 0.05), "quadratic_drag": (0.0, 0.0)}
    effects = {"gravity": jb.Gravity(-3.0), "preload": jb.Preload(1.0), "quadratic_drag": jb.catalogue()["quadratic_drag"]()}
    found = [Candidate(name, effects[name], gain, share, {}) for name, (gain, share) in gains.items()]
    ranking = judged(score(4.0, 1.0), found[::-1], {"preload": 55.0}, {"preload": 1.0})
    assert [entry.name for entry in ranking] == ["gravity", "preload", "quadratic_drag"]
    best, second, last = ranking
    assert best.predicted_rms_over_noise == pytest.approx(1.0, abs=0.01)
    assert best.evidence == pytest.approx(12000.0 - math.log(4000), rel=0.01)
    assert (second.evidence, second.refitted) == (55.0, True)
    assert 3.0 < second.predicted_rms_over_noise < 4.0
    assert second.rms_over_noise == pytest.approx(1.0)  # its refit left noise, which its prediction had not told
    assert best.rms_over_noise == best.predicted_rms_over_noise
    assert last.predicted_rms_over_noise == pytest.approx(4.0)
    assert last.evidence < 0.0
    assert "physics allows" in last.why
    entries = candidates_json(ranking)
    json.dumps(entries, allow_nan=False)
    assert set(entries[0]) == {
        "name", "predicted_rms_over_noise", "refitted_rms_over_noise", "evidence", "refitted", "why",
    }  # fmt: skip
    assert "gravity" in table(ranking)[1]
    assert len(table(ranking, 2)) == 3


# ---- The whole command, once, on a record of something that no catalogue holds ----


@pytest.fixture(scope="module")
def hum(tmp_path_factory):
    """A folder with two records of a joint that a neighbour's machine shakes, the law for it, and what `refine` left there."""
    pytest.importorskip("numba", reason="the generator needs numba")
    from tests.independent.generator import make_excitation, measure, simulate_truth
    from tests.independent.rigs import Rig

    folder = tmp_path_factory.mktemp("hum")
    rng = np.random.default_rng(4)
    rig = Rig(inertia=3.0, backlash=0.025, stiffness=12000.0, damping=14.0)
    for name in ("train", "heldout"):
        excitation = make_excitation(rng, "multisine", SECONDS, scale=0.8)
        truth = simulate_truth(rig, {"rumble": HUM}, excitation, RATE, SECONDS)
        seen = measure(truth, rng, NOISE, NOISE)
        jb.write_record(jb.Record(seen["t"], {"x": seen["x"], "z": seen["z"]}), folder / f"{name}.csv")
    (folder / "own.py").write_text(OWN_LAW)
    words = ["refine", "train.csv", "--heldout", "heldout.csv", "--inertia", "3", "--laws", "own.py", "--out", "found", "--json"]
    # A process of its own: a class that was loaded once stays in the catalogue of the one that loaded it.
    search = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
    done = subprocess.run(
        [sys.executable, "-m", "jaxbacklash.cli", *words], cwd=folder, capture_output=True, text=True, timeout=600,
        env=os.environ | {"PYTHONPATH": search},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return folder, done


@pytest.mark.slow
def test_an_effect_of_ones_own_is_ranked_named_and_reported(hum):
    folder, done = hum
    assert len(OWN_LAW.split("class")[1].splitlines()) <= 15
    result = json.loads(done.stdout)
    first, *_, last = result["stages"]
    assert first["candidates"][0]["name"] == "floor_hum"
    assert first["candidates"][0]["refitted"]
    assert result["effects"] == last["effects"] == ["floor_hum"]
    assert result["verdict"] == "complete"
    assert "floor_hum" in result["verdict_text"]
    found = last["parameters"]
    assert found["floor_hum.a"]["unit"] == "N m"
    truth = {"floor_hum.a": HUM["A"], "backlash": 0.025, "stiffness": 12000.0, "damping": 14.0}
    for name, value in truth.items():
        assert abs(found[name]["value"] - value) < 4.5 * found[name]["stderr"], name
    assert last["heldout_median_over_noise"] < first["heldout_median_over_noise"]
    assert "[effects.floor_hum]" in (folder / "found" / "model.toml").read_text()
    assert "floor_hum" in (folder / "found" / "report.html").read_text()


@pytest.mark.slow
def test_result_of_refine_is_what_the_contract_says(hum):
    folder, done = hum
    result = json.loads(done.stdout)
    assert json.loads((folder / "found" / "result.json").read_text()) == result
    assert all(math.isfinite(value) for value in numbers(result))
    assert (result["schema"], result["command"]) == (1, "refine")
    assert result["record"]["samples"] == 4001
    assert result["noise"]["z"] == pytest.approx(NOISE, rel=0.1)
    for key in ("stages", "effects", "alternatives", "verdict", "verdict_text", "cross_check", "seconds"):
        assert key in result
    assert result["stages"][0]["added"] is None
    assert result["stages"][0]["effects"] == []
    assert result["stages"][0]["moved"] == {}
    errors = [
        "rms", "rms_over_noise", "heldout_rms_over_noise", "median_over_noise", "heldout_median_over_noise",
    ]  # fmt: skip
    for number, stage in enumerate(result["stages"]):
        assert {*errors, "added", "dropped", "effects", "parameters", "candidates", "moved"} <= set(stage)
        assert all(stage[name] > 0.0 for name in errors)
        for entry in stage["parameters"].values():
            assert {"value", "stderr", "ci95", "unit"} <= set(entry)
            assert entry["value"] is not None or entry["why"]
        names = [entry["name"] for entry in stage["candidates"]]
        assert not set(names) & set(stage["effects"])
        assert len(names) > 10
        rest = [entry["evidence"] for entry in stage["candidates"][1:]]
        assert rest == sorted(rest, reverse=True)
        assert all(entry["predicted_rms_over_noise"] > 0.0 for entry in stage["candidates"])
        if number:
            assert stage["added"] == result["stages"][number - 1]["candidates"][0]["name"]
            for step in stage["moved"].values():
                assert set(step) == {"percent", "stderrs"}
    assert set(result["stages"][-1]["moved"]) == {"backlash", "stiffness", "damping"}
    assert jb.read_record(folder / "train.csv").samples == result["record"]["samples"]


@pytest.mark.slow
def test_page_of_refine_in_a_browser(hum, tmp_path):
    folder, _ = hum
    text = (folder / "found" / "report.html").read_text(encoding="utf-8")
    assert "http" not in text.replace("http://www.w3.org", "")
    titles = [
        "Prediction error, stage by stage", "What is missing in the base model?", "The missing torque in time: the base model",
        "What is left: the base model + floor_hum", "Measured against model", "Look closer", "Restoring force", "Parameters",
    ]  # fmt: skip
    places = [text.find(f"<h2>{title}</h2>") for title in titles]
    assert all(place > 0 for place in places), dict(zip(titles, places))
    assert places == sorted(places)
    page = tmp_path / "report.html"
    page.write_text(text.replace("<head>", "<head>" + FRAMES), encoding="utf-8")
    tags = Tags(browse(page, tmp_path / "profile", "--virtual-time-budget=5000", "--dump-dom")).found
    assert sum(tag == "svg" and a.get("role") == "img" for tag, a in tags) == text.count('<svg role="img"') >= 7
    assert any(a.get("id") == "look-closer" and int(a["data-drawn"]) > 1000 for _, a in tags)
