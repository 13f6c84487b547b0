"""Drives with an encoder on the motor alone, or on the link alone: the other side is found by what it does through the joint."""

import json
from contextlib import suppress

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.fitting.fit import prepare
from jaxbacklash.fitting.setup import free_names, make_problem
from jaxbacklash.one_encoder.carried import carried, one_side
from jaxbacklash.regression.hidden_side import search_hidden
from tests.in_process import call
from tests.independent.drives import DriveRig, random_rig, servo_record

pytest.importorskip("numba", reason="the other program needs numba")
NAMES = [name for name in DriveRig.__dataclass_fields__ if name != "ratio"]


def rig_and_record(seed, which, seconds=20.0, effects=None):
    rng = np.random.default_rng(seed)
    rig = random_rig(rng)
    seen = servo_record(rig, effects(rig) if effects else {}, rng, seconds)
    both = jb.Record(seen.pop("t"), seen, ratio=rig.ratio)
    return rig, both, jb.Record(both.t, {n: both.channels[n] for n in ("torque", which)}, ratio=rig.ratio)


def drive_of(rig):
    return jb.drive(*(getattr(rig, name) for name in ("motor_inertia", "motor_damping", "ratio")),
                    *(getattr(rig, name) for name in ("inertia", "backlash", "stiffness", "damping")))  # fmt: skip


def errors(fit, truth):
    return {n: (e.value - truth[n]) / e.stderr for n, e in fit.parameters.items() if n in truth}


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1002, 1003, 1005])
def test_the_play_is_found_from_the_motor_alone(seed):
    rig, _, record = rig_and_record(seed, "motor")
    fit = jb.fit(record, starts=1)
    assert fit.adequate
    assert fit.tied
    assert fit.score.rms == pytest.approx(1.0, abs=0.05)
    found = errors(fit, {name: getattr(rig, name) for name in NAMES})
    assert set(found) == set(NAMES)
    assert max(abs(e) for e in found.values()) < 4.0
    assert fit.parameters["backlash"].stderr < 3e-4 * rig.backlash


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1002, 1005])
def test_the_link_alone_tells_the_truth_or_that_the_motor_was_not_found(seed):
    rig, _, record = rig_and_record(seed, "link", 8.0)
    fit = None
    with suppress(jb.NoAnswer):
        fit = jb.fit(record, starts=1)
    if fit is not None:
        found = errors(fit, {name: getattr(rig, name) for name in NAMES})
        assert max(abs(e) for e in found.values()) < 4.0


@pytest.mark.slow
def test_dry_friction_of_the_motor_from_the_motor_alone():
    friction = {}

    def effects(rig):
        friction["coulomb_motor.Tc"] = 0.1 * rig.inertia * 40.0 / rig.ratio
        return {"coulomb_motor": {"Tc": friction["coulomb_motor.Tc"]}}

    rig, _, record = rig_and_record(1004, "motor", effects=effects)
    fit = jb.fit(record, starts=1, effects=["coulomb_motor"])
    assert fit.adequate
    found = errors(fit, {name: getattr(rig, name) for name in NAMES} | friction)
    assert set(found) == {*NAMES, "coulomb_motor.Tc"}
    assert max(abs(e) for e in found.values()) < 4.0


def test_the_start_is_near_enough():
    rig, _, record = rig_and_record(1005, "motor", 8.0)
    found = search_hidden(record)
    told = {"motor_inertia": found.motor_inertia, "motor_damping": found.friction} | {n: getattr(found, n) for n in NAMES[2:]}
    off = {n: abs(np.log(told[n] / getattr(rig, n))) for n in NAMES}
    assert max(off[n] for n in ("motor_inertia", "inertia", "backlash", "motor_damping")) < np.log(2.0)
    assert max(off.values()) < np.log(4.0)


@pytest.mark.parametrize("which", ["motor", "link"])
def test_the_filter_finds_the_side_that_is_not_seen(which):
    rig, both, record = rig_and_record(1005, which, 2.0)
    system = jb.System(**{**vars(drive_of(rig)), "observed": which})
    assert one_side(system)
    windows, layout, _ = prepare(system, [record], None)
    problem = make_problem(system, windows, ("inertia", *free_names(system)))
    starts = np.asarray(carried(problem, np.zeros(problem.directions.shape[1]))[0])[:, : layout.windows[0]]
    at = np.round(np.asarray(windows.t0)[: layout.windows[0]] / record.dt).astype(int)
    link, motor = both.channels["link"][at], both.channels["motor"][at] / rig.ratio
    # Within a few hundredths of the play, though nothing but the other encoder is read.
    hidden = starts[0] - link if which == "motor" else starts[2] / rig.ratio - motor
    assert np.sqrt(np.mean(hidden[20:] ** 2)) < 0.1 * rig.backlash
    # A link that goes with its motor would be off by much of it.
    assert np.sqrt(np.mean((link - motor) ** 2)) > 0.3 * rig.backlash


@pytest.mark.slow
def test_the_demo_of_a_drive_finds_its_play(tmp_path):
    told = call(["demo", "--drive", "--out", "found", "--json"], tmp_path)
    assert told.code == 0, told.err
    play = json.loads(told.out)["stages"][-1]["parameters"]["backlash"]
    assert play["ci95"][0] < 0.012 < play["ci95"][1]
    assert play["stderr"] < 1e-5
    assert (tmp_path / "found" / "report.html").exists()
