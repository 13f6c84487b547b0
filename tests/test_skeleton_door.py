"""`jaxbacklash skeleton` as users and scripts meet it, and the skeletons beside a fit."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.plot.drawing import svg_of
from jaxbacklash.report.result import cross_check as cross_check_json
from jaxbacklash.report.skeleton_report import skeleton_panels
from jaxbacklash.second_opinion import cross_check

from .test_bad_input import CASES
from .test_cli import call as call  # the fixture that runs the command line
from .test_cli import sentence
from .test_report import browse


@pytest.fixture(scope="module")
def sweep(tmp_path_factory):
    """A short twin of the paper's experiment, as a file and as a record."""
    pytest.importorskip("numba", reason="the generator needs numba")
    from .twin import twin

    path = tmp_path_factory.mktemp("sweep") / "sweep.csv"
    rig, record, _ = twin(1, seconds=20.0)
    jb.write_record(record, path)
    return SimpleNamespace(path=path, rig=rig, record=record)


@pytest.mark.parametrize(("write", "fragments"), [case[1:] for case in CASES], ids=[case[0] for case in CASES])
def test_a_bad_record_ends_with_code_2(call, tmp_path, write, fragments):
    code, out, err = call("skeleton", *write(tmp_path)[1:])
    assert code == 2
    assert out == ""
    for fragment in fragments:
        assert " ".join(fragment.split()) in sentence(err)


def test_command_leaves_result_and_page(call, sweep, tmp_path):
    code, out, _ = call("skeleton", sweep.path, "--inertia", "3.16", "--out", tmp_path / "skeleton")
    assert code == 0
    assert "total play b" in out
    result = json.loads((tmp_path / "skeleton" / "result.json").read_text())
    for method in ("hilbert", "wavelet"):
        play = result[method]["backlash"]
        assert abs(play["value"] / sweep.rig.backlash - 1.0) < 0.02
        assert play["stderr"] > 0.0
        assert play["unit"] == "rad"
        assert set(result[method]) >= {"backlash", "stiffness", "damping"}
    assert 0.0 < result["masked_fraction"] < 1.0
    assert result["warnings"]
    page = (tmp_path / "skeleton" / "report.html").read_text()
    for title in ("Envelopes", "Instantaneous frequency", "Ridge", "Restoring force", "Backbone and damping"):
        assert title in page
    assert page.count("<svg") == 5


def test_json_alone_on_stdout(call, sweep):
    code, out, _ = call("skeleton", sweep.path, "--json")
    assert code == 0
    result = json.loads(out)
    assert result["command"] == "skeleton"
    assert result["per_inertia"]
    assert result["wavelet"]["stiffness"]["unit"] == "1/s^2"


@pytest.mark.slow
def test_page_in_a_browser(call, sweep, tmp_path):
    call("skeleton", sweep.path, "--inertia", "3.16", "--out", tmp_path)
    dom = browse(tmp_path / "report.html", tmp_path / "profile", "--virtual-time-budget=5000", "--dump-dom")
    assert dom.count("<svg") >= 5


def test_a_multisine_is_told_and_drawn(tmp_path):
    t = np.arange(0.0, 12.0, 2e-3)
    x = sum(0.003 * np.sin(2 * np.pi * f * t + f * f) for f in np.linspace(1.0, 9.0, 17))
    found = jb.skeleton(jb.Record(t, {"x": x, "z": 0.7 * np.roll(x, 30)}))
    panels = skeleton_panels(found)
    assert [panel.anchor for panel in panels][:2] == ["envelopes", "frequency"]
    assert all(panel.figure_svg.startswith("<svg") for panel in panels)
    for draw in (jb.plot.backbone, jb.plot.skeleton):
        assert svg_of(draw, found).startswith("<svg")


# ---- Beside a fit ----


@pytest.fixture(scope="module")
def fitted(sweep):
    return jb.fit(sweep.record, inertia=sweep.rig.inertia, starts=1)


def test_skeletons_agree_with_the_fit(fitted):
    check = cross_check_json(fitted)
    assert check["agrees"] is True
    assert set(check) >= {"hilbert", "wavelet", "agrees", "text", "equation_error"}
    assert "agree" in check["text"]
    for method in ("hilbert", "wavelet"):
        value = check[method]["backlash"]["value"]
        assert value == pytest.approx(fitted.parameters["backlash"].value, rel=0.02)
    json.dumps(check, allow_nan=False)


def test_a_fit_that_is_off_is_contradicted(fitted):
    from dataclasses import replace

    wrong = replace(fitted.parameters["backlash"], value=1.08 * fitted.parameters["backlash"].value)
    check = cross_check(replace(fitted, parameters=fitted.parameters | {"backlash": wrong}))
    assert check.agrees is False
    assert {name for _, name, _ in check.apart} == {"backlash"}
    assert "assumption" in check.text or "misses something" in check.text


def test_where_skeletons_cannot_judge_they_say_why(fitted, sweep):
    from dataclasses import replace

    t = sweep.record.t
    x = sum(0.003 * np.sin(2 * np.pi * f * t + f * f) for f in np.linspace(1.0, 9.0, 17))
    other = jb.Record(t, {"x": x, "z": 0.7 * np.roll(x, 30)})
    check = cross_check(replace(fitted, records=(other,))).as_json()
    assert check["agrees"] is None
    assert "one at a time" in check["why"] or "no oscillation" in check["why"]
    assert check["hilbert"]["backlash"]["value"] is None
    assert check["hilbert"]["backlash"]["why"]


@pytest.mark.slow
def test_effects_of_the_fit_are_told_to_the_skeletons():
    pytest.importorskip("numba", reason="the generator needs numba")
    from .twin import twin

    rig, record, _ = twin(3, seconds=20.0, effects={"gravity": {"G": -40.0}})
    found = jb.fit(record, inertia=rig.inertia, effects=["gravity"], starts=1)
    check = cross_check(found)
    assert check.agrees is True
    assert check.skeletons.wavelet.parameters["backlash"].value == pytest.approx(rig.backlash, rel=3e-3)
