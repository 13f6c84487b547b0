"""`jaxbacklash lost-motion` as users and scripts meet it, what `fit` and `look` say of slow records, and the pictures."""

import json

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.plot.drawing import svg_of
from jaxbacklash.report.cards import html

from .independent.slow_links import played
from .test_cli import call as call  # the fixture that runs the command line
from .test_cli import sentence
from .test_lost_motion import ONE, PLAY, T, rig


@pytest.fixture(scope="module")
def slow(tmp_path_factory):
    """A motor's and a link's encoder across a gear of 35, as a drive's logger names them."""
    x, y = rig()
    path = tmp_path_factory.mktemp("slow") / "slow.csv"
    columns = np.column_stack([T, np.round(35.0 * x / 1e-3) * 1e-3, y])
    np.savetxt(path, columns, delimiter=",", header="t,motor,link", comments="", fmt="%.9g")
    return path


def test_two_encoders_across_a_gear(call, slow, tmp_path):
    code, out, err = call("lost-motion", slow, "--ratio", 35, "--out", tmp_path / "found", "--json")
    assert (code, err) == (0, "")
    result = json.loads(out)
    assert result == json.loads((tmp_path / "found/result.json").read_text())
    low, high = result["backlash"]["ci95"]
    assert low <= PLAY <= high
    assert result["parameters"]["backlash"]["value"] == result["backlash"]["value"]
    assert result["verdict"] == "read"
    assert result["includes_wind_up"] is True
    assert {one["holds"] for one in result["conditions"]} <= {True, None}
    assert np.mean(result["over_angle"]["lost_motion"]) == pytest.approx(PLAY, rel=0.05)
    page = (tmp_path / "found/report.html").read_text()
    assert "<svg" in page
    assert "Prediction error" not in page
    assert "condition: slow" in page
    code, out, err = call("lost-motion", slow, "--ratio", 35, "--columns", "motor=#2,link=#3")
    assert code == 0
    assert "total play b" in out


@pytest.mark.parametrize("ratio", [None, "0.0285714", "20"])
def test_a_ratio_that_is_missing_or_wrong_is_told(call, slow, ratio):
    code, out, err = call("lost-motion", slow, *(["--ratio", ratio] if ratio else []))
    assert (code, out) == (2, "")
    assert "--ratio 35" in sentence(err)


def test_an_encoder_the_other_way_round(call, slow):
    code, _, err = call("lost-motion", slow, "--ratio", 35, "--sign", "y")
    assert code == 2
    assert "opposite" in sentence(err)


def test_a_record_that_does_not_show_its_play(call, slow, tmp_path):
    code, _, err = call("lost-motion", slow, "--ratio", 35, "--to", 8, "--out", tmp_path)
    assert code == 1
    assert "too few reversals" in sentence(err)
    assert "Way out: record more strokes" in sentence(err)
    result = json.loads((tmp_path / "result.json").read_text())
    assert result["backlash"]["value"] is None
    assert "too few reversals" in result["backlash"]["why"]
    assert (tmp_path / "report.html").exists()


def test_wind_up_and_translation(call, tmp_path):
    x, y = rig()
    path = tmp_path / "slide.csv"
    np.savetxt(path, np.column_stack([T, x, y - x]), delimiter=",", header="t,x,z", comments="", fmt="%.9g")
    code, out, _ = call("lost-motion", path, "--wind-up", 0.001, "--translation", "--json")
    assert code == 0
    result = json.loads(out)
    assert result["backlash"]["unit"] == "m"
    assert result["backlash"]["value"] == pytest.approx(PLAY - 0.001, rel=0.02)
    assert result["lost_motion"]["value"] == pytest.approx(PLAY, rel=0.02)


def test_a_record_of_other_channels_is_refused(call, tmp_path):
    path = tmp_path / "force.csv"
    np.savetxt(path, np.column_stack([T, np.sin(T), np.cos(T)]), delimiter=",", header="t,x,T", comments="", fmt="%.9g")
    code, _, err = call("lost-motion", path)
    assert code == 2
    assert "two positions" in sentence(err)


@pytest.mark.slow
def test_look_and_fit_name_the_command(call, slow, tmp_path):
    code, out, _ = call("look", slow)
    assert code == 0
    assert "next: jaxbacklash lost-motion" in out
    x, y = rig()
    record = jb.Record(T, {"x": x, "z": y - x}, path="slow.csv")
    found = jb.fit(record, starts=1)
    causes = jb.find_causes(found)
    assert [cause.name for cause in causes] == ["slow"]
    assert causes[0].remedy == "jaxbacklash lost-motion slow.csv"
    for name in ("backlash", "stiffness"):
        if found.parameters[name].value is None:
            assert "jaxbacklash lost-motion" in found.parameters[name].why
            assert "never leaves" not in found.parameters[name].why


def test_results_show_themselves():
    x, y = rig()
    found = jb.lost_motion(jb.Record(T, {"x": x, "y": y}), gear_ratio=35.0)
    page = html(found)
    assert "lost motion" in page
    assert page.count("<svg") == 1
    frame = found.to_dataframe()
    assert frame.loc["backlash", "low"] < PLAY < frame.loc["backlash", "high"]
    left, right = jb.plot.lost_motion(found)
    assert left.get_xlabel() == "x [rad]"
    assert right.get_ylabel() == "lost motion [rad]"
    still = jb.lost_motion(jb.Record(T, {"x": 0.005 * np.sin(T), "y": 1e-6 * played(np.sin(T), 0.1 * ONE, ONE)}))
    assert "not counted" in svg_of(jb.plot.lost_motion, still)
