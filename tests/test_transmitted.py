"""Records of transmitted force: prescribed motion in, force out, the link unseen and held by dry friction."""

import json
import warnings
from functools import lru_cache

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.model_builder import ModelBuilder
from jaxbacklash.effects import CoulombGround
from jaxbacklash.fitting.estimates import judge
from jaxbacklash.fitting.score import score
from jaxbacklash.fitting.setup import base_system, first_guess
from jaxbacklash.records import oriented, parse_columns, parse_units, read_record
from jaxbacklash.regression.force_loop import read_loop, read_plateau, stop
from jaxbacklash.signals import noise_of_differences
from tests.independent.held_link import HeldLink, measured, modulated_sine

from .test_cli import call as call  # the fixture that runs the command line

LINK = HeldLink(inertia=200.0, backlash=3e-3, stiffness=2e6, damping=6000.0, friction=4000.0)
TRUTH = {"inertia": 200.0, "backlash": 3e-3, "stiffness": 2e6, "damping": 6000.0, "coulomb_ground.Tc": 4000.0}
NOISE = {"x": 1e-6, "T": 8.0}
NAMES = {"columns": parse_columns("t=t_s,x=x_in,T=F_kip"), "units": parse_units("x=in,T=kip")}


@lru_cache
def clean(amplitude=0.015):
    return measured(LINK, amplitude, 0.5, duration=6.0, rate=256.0)


def record_of(seed=0, amplitude=0.015, sign=1.0):
    table, rng = clean(amplitude), np.random.default_rng(seed)
    noisy = {name: table[name] + size * rng.standard_normal(table["t"].size) for name, size in NOISE.items()}
    return jb.Record(table["t"], noisy | {"T": sign * noisy["T"]})


def model():
    joint = jb.base_motion_joint(200.0, 3e-3, 2e6, 6000.0)
    return jb.System(joint.inertia, joint.contact, joint.damper, observed="T").with_effects(CoulombGround(4000.0))


def test_the_referee_balances_its_forces():
    table = clean()
    sliding = np.flatnonzero(np.abs(np.diff(table["y"])) > 1e-9)
    resting = np.flatnonzero(np.diff(table["y"]) == 0.0)
    assert sliding.size > 100
    assert resting.size > 100
    assert np.abs(table["T"][resting]).max() <= LINK.friction * (1 + 1e-9)
    x, dx = modulated_sine(0.015, 0.5, 6.0)
    assert dx(0.7) == pytest.approx((x(0.7 + 1e-6) - x(0.7 - 1e-6)) / 2e-6, rel=1e-6)
    # Work of the base goes into friction, damper and springs: the loop's area is what the link rubbed away, and a little more.
    work = -np.trapezoid(table["T"], table["x"])
    rubbed = LINK.friction * np.sum(np.abs(np.diff(table["y"])))
    assert rubbed < work < 1.1 * rubbed


def test_stop_keeps_within_its_width():
    np.testing.assert_allclose(stop(np.array([0.0, 1.0, 5.0, 4.0, 0.0]), 2.0), [0.0, -1.0, -2.0, -1.0, 2.0])


def test_a_force_loop_shows_play_stiffness_and_friction():
    loop = read_loop(record_of())
    assert loop.backlash == pytest.approx(3e-3, rel=0.03)
    assert loop.stiffness == pytest.approx(2e6, rel=0.06)
    assert loop.sliding == pytest.approx(4000.0, rel=0.02)
    assert loop.share < 0.01
    # A tenth of the sliding force presses the contact in by 0.2 mm on either side.
    assert loop.plateau.median == pytest.approx(3.4e-3, rel=0.03)


def test_a_force_that_stays_on_one_side_has_no_plateau():
    x = np.sin(np.linspace(0.0, 20.0, 500))
    found = read_plateau(x, 2.0 + x)
    assert found.median is None
    assert "never passes" in found.as_json("m")["why"]


@pytest.mark.parametrize("seed", range(3))
def test_noise_on_a_signal_with_corners(seed):
    rng = np.random.default_rng(seed)
    force = clean()["T"] + 8.0 * rng.standard_normal(clean()["T"].size)
    assert noise_of_differences(force) == pytest.approx(8.0, rel=0.2)
    assert noise_of_differences(rng.standard_normal(20_000)) == pytest.approx(1.0, rel=0.05)


def test_a_force_measured_the_other_way_round_is_turned():
    good, turned = record_of(), record_of(sign=-1.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert oriented(good) is good
    with pytest.warns(UserWarning, match="positive work on the base"):
        np.testing.assert_array_equal(oriented(turned).channels["T"], good.channels["T"])
    # A spring gives back what it took: nothing tells its sign.
    elastic = good.replace(T=good.channels["x"] * 1e5)
    assert oriented(elastic) is elastic


@pytest.mark.slow
def test_the_true_model_predicts_the_referee_to_its_noise():
    found = jb.compare(model(), record_of(3), translational=True)
    assert found.score.rms == pytest.approx(1.0, abs=0.2)
    assert found.score.median == pytest.approx(1.0, abs=0.2)
    assert found.noise == pytest.approx(8.0, rel=0.2)
    assert "noise of T" in str(found)
    assert str(found).count(" N\n") == 1


def test_fit_finds_joint_inertia_and_friction():
    found = jb.fit(record_of(1), effects=["coulomb_ground"], translational=True, starts=2, heldout=record_of(2))
    assert not found.per_inertia
    assert found.score.rms == pytest.approx(1.0, abs=0.2)
    assert found.heldout.rms == pytest.approx(1.0, abs=0.2)
    assert {name: found.parameters[name].unit for name in ("inertia", "stiffness")} == {"inertia": "kg", "stiffness": "N/m"}
    for name, value in TRUTH.items():
        estimate = found.parameters[name]
        assert abs(estimate.value - value) < 4.0 * estimate.stderr, f"{name}: {estimate}"
        assert estimate.stderr < 0.02 * value


def test_a_wrong_model_gets_wide_intervals_and_says_so():
    soft = record_of(4)
    # A gap in the drive train of the sensor: forces below 300 N are not seen.
    seen = soft.channels["T"]
    found = jb.fit(soft.replace(T=seen - np.clip(seen, -300.0, 300.0)), effects=["coulomb_ground"], translational=True, starts=1)
    assert not found.adequate
    assert found.score.rms > 1.5
    right = jb.fit(soft, effects=["coulomb_ground"], translational=True, starts=1)
    assert found.parameters["backlash"].stderr > 5.0 * right.parameters["backlash"].stderr


@pytest.mark.slow
def test_a_contact_between_the_samples_of_a_link_that_is_not_seen():
    """A force that turns round within a sample asks for a contact as hard; of a link's travel in it nothing was measured."""
    t = np.arange(0.0, 4.0, 0.004)
    x = 0.02 * np.sin(2.0 * np.pi * t)
    force = -30.0 * np.tanh(400.0 * np.gradient(x, t)) + 0.3 * np.random.default_rng(0).standard_normal(t.size)
    found = jb.fit(jb.Record(t, {"x": x, "T": force}), inertia=0.5, effects=["coulomb_ground"], starts=1)
    assert found.parameters["coulomb_ground.Tc"].value == pytest.approx(30.0, rel=0.05)


@pytest.mark.slow
def test_a_link_that_is_not_seen_has_no_new_start_in_every_window():
    record = record_of()
    system, names, _ = base_system(record, "joint", None)  # without the friction that holds the link
    builder = ModelBuilder(record, system, names, 0.2)
    problem, _ = builder.problem({}, system)
    told = {t: score(problem, first_guess(problem), builder.layout, group=builder.group, through=t)[0][0] for t in (False, True)}
    assert told[True].rms > 3.0 * told[False].rms
    assert told[True].window_rms.shape == told[False].window_rms.shape


def test_a_contact_that_carries_force_was_met_however_soft_it_begins():
    stderr = {"stiffness": 0.3 * TRUTH["stiffness"], "backlash": 1e-4}
    found = judge(model(), list(stderr), stderr, [record_of()], per_inertia=False, translational=True)
    assert found["backlash"].verdict == "found"
    assert found["stiffness"].verdict == "not determined"
    assert "contact shows" in found["stiffness"].why
    stderr["backlash"] = 2e-3
    found = judge(model(), list(stderr), stderr, [record_of()], per_inertia=False, translational=True)
    assert "exceeds half" in found["backlash"].why


def test_a_force_on_one_side_alone_is_not_told_as_a_motion_inside_the_play():
    record = record_of()
    pushed = record.replace(T=np.maximum(record.channels["T"], 0.0))
    stderr = {"stiffness": 0.3 * TRUTH["stiffness"], "backlash": 1e-4}
    found = judge(model(), list(stderr), stderr, [pushed], per_inertia=False, translational=True)
    for estimate in found.values():
        assert estimate.value is None
        assert "never leaves" not in estimate.why
        assert "on one side only" in estimate.why


@pytest.mark.slow
def test_intervals_hold_the_truth():
    inside = {name: 0 for name in TRUTH}
    for seed in range(24):
        found = jb.fit(record_of(100 + seed), effects=["coulomb_ground"], translational=True, starts=1)
        for name, value in TRUTH.items():
            low, high = found.parameters[name].ci95
            inside[name] += low <= value <= high
    # Of 24 intervals at 95 %, fewer than 19 would come once in 500 times.
    assert min(inside.values()) >= 19, inside


@pytest.mark.slow
def test_refine_names_the_friction(call, tmp_path):
    table = clean()
    for name, seed in (("one", 1), ("two", 2)):
        record = record_of(seed)
        np.savez(tmp_path / f"{name}.npz", t=table["t"], **record.channels)
    words = ["refine", tmp_path / "one.npz", "--heldout", tmp_path / "two.npz", "--translation", "--json"]
    code, out, err = call(*words, "--out", tmp_path / "out")
    assert code == 0, err
    result = json.loads(out)
    assert result["effects"] == ["coulomb_ground"]
    last = result["stages"][-1]
    assert last["rms_over_noise"] == pytest.approx(1.0, abs=0.2)
    assert last["heldout_rms_over_noise"] == pytest.approx(1.0, abs=0.2)
    assert result["stages"][0]["rms_over_noise"] > 10.0
    assert last["parameters"]["backlash"]["value"] == pytest.approx(3e-3, rel=0.01)
    assert "Force loop" in (tmp_path / "out" / "report.html").read_text()


@pytest.mark.shared
def test_the_friction_damper_shows_its_play(shared):
    found = {}
    for path in sorted((shared / "real" / "ARTS").glob("*30lbtension*.npz")):
        with pytest.warns(UserWarning, match="positive work on the base"):
            record = oriented(read_record(path, **NAMES))
        found[path.stem.split("_")[-1]] = read_loop(record)
    slow = [loop for name, loop in found.items() if name.startswith("0.") and "1.5amp" not in name]
    assert len(slow) == 4
    # PROVENANCE: 0.12-0.15 in by the same threshold, quasi-static, and less at speed.
    for loop in slow:
        assert 3.0e-3 < loop.plateau.median < 3.9e-3
        assert 9e3 < loop.sliding < 11e3
        assert loop.share < 0.03
    fast = found["2Hz30lbtension0.5amplitude"]
    assert fast.plateau.median < min(loop.plateau.median for loop in slow)


@pytest.mark.slow
@pytest.mark.shared
def test_the_friction_damper_is_fitted_on_one_test_and_checked_on_another(shared):
    folder = shared / "real" / "ARTS"
    tried, checked = (read_record(folder / f"dataset-2_char_{n}.npz", **NAMES) for n in (
        "1Hz30lbtension1amplitude", "2Hz30lbtension0.5amplitude"
    ))  # fmt: skip
    with pytest.warns(UserWarning, match="positive work"):
        fitted = jb.fit(tried, effects=["coulomb_ground"], translational=True, starts=1, heldout=checked)
    assert not fitted.adequate  # ringing and a soft contact are not in the model, and it says so
    estimate = fitted.parameters["coulomb_ground.Tc"]
    assert estimate.value == pytest.approx(9.6e3, rel=0.08)
    assert 3e-3 < fitted.system.contact.backlash < 6e-3
    assert fitted.heldout.rms > 1.0
