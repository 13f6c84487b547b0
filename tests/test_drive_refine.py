"""Which laws a drive lacks: its balance at the motor, what may be proposed, and searches on records of another program."""

import json
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.laws_for import laws_for
from jaxbacklash.effects import Cogging, CoulombMotor, Gravity
from jaxbacklash.fitting.fit import prepare
from jaxbacklash.fitting.setup import make_problem
from jaxbacklash.mechanics import AbstractEffect, catalogue
from jaxbacklash.one_encoder.carried import filtered
from jaxbacklash.parameters import values, with_values
from jaxbacklash.regression.motor_form import MotorForm
from jaxbacklash.regression.spectrum import read_off
from jaxbacklash.regression.weak_form import WeakForm
from jaxbacklash.residuals.at_motor import missing_at_motor
from jaxbacklash.system import System
from tests.independent.drives import DriveRig, random_rig, servo_record

pytest.importorskip("numba", reason="the other program needs numba")
PRACTICE = Path(__file__).resolve().parents[2] / "shared" / "records_drives"
NAMES = tuple(f.name for f in fields(DriveRig))
FREE = ("inertia", "backlash", "stiffness", "damping", "motor_inertia", "motor_damping")


def made(effects, seed=3, seconds=6.0, which=("motor", "link")):
    rig = random_rig(np.random.default_rng(seed))
    seen = servo_record(rig, effects(rig) if callable(effects) else effects, np.random.default_rng(seed), seconds)
    return rig, jb.Record(seen["t"], {n: seen[n] for n in ("torque", *which)}, ratio=rig.ratio)


def drive_of(rig, *effects):
    own = jb.drive(*(getattr(rig, n) for n in ("motor_inertia", "motor_damping", "ratio", "inertia", "backlash", "stiffness",
                                                "damping")), observed="motor link")  # fmt: skip
    return own.with_effects(*effects)


def test_the_true_drive_leaves_nothing_at_its_motor():
    rig, record = made(lambda rig: {"gravity": {"G": -8.0 * rig.inertia}, "coulomb_motor": {"Tc": 4.0 * rig.inertia / rig.ratio}})
    form = MotorForm(record)
    true = drive_of(rig, Gravity(-8.0 * rig.inertia), CoulombMotor(4.0 * rig.inertia / rig.ratio))
    left, by = form.missing(true, FREE)
    without, _ = form.missing(true.without("coulomb_motor"), FREE)
    assert np.std(left) < 0.1 * np.std(without)
    assert by.shape == (left.size, len(FREE))
    assert np.all(by[:, 1:4] == 0.0)  # the joint cancels


@pytest.mark.parametrize("seed", range(6))
def test_what_is_missing_at_the_motor_is_told_apart_from_noise(seed):
    rig, clean = made({}, seed=seed)
    friction = 3.0 * rig.inertia / rig.ratio
    assert not missing_at_motor(drive_of(rig), FREE, clean).evident
    _, rubbing = made({"coulomb_motor": {"Tc": friction}}, seed=seed)
    found = missing_at_motor(drive_of(rig), FREE, rubbing)
    assert found.evident
    assert found.by_direction > 0.9
    assert "goes with the direction in which the motor turns" in str(found)
    assert 0.2 * friction < found.rms < friction  # its viscous part is taken for the motor's own
    assert missing_at_motor(drive_of(rig).on_its_base(), FREE, rubbing) is None


def test_how_the_rest_at_the_motor_falls_is_what_differences_say():
    rig, record = made({"coulomb_motor": {"Tc": 1e-3}})
    form = MotorForm(record)
    at = drive_of(rig, Gravity(-1.0), CoulombMotor(2e-3))
    names = ("inertia", "motor_inertia", "motor_damping", "gravity.G", "coulomb_motor.Tc")
    left, by = form.missing(at, names)
    found = values(at)
    for column, name in zip(by.T, names):
        step = 1e-3 * abs(float(found[name]))
        moved, _ = form.missing(with_values(at, {name: float(found[name]) + step}), names)
        np.testing.assert_allclose(-(moved - left) / step, column, rtol=1e-5, atol=1e-9 * np.max(np.abs(column)))


def test_the_order_of_cogging_is_read_off_the_angle_of_the_motor():
    rig, record = made(lambda rig: {"cogging": {"A": 2.0 * rig.inertia / rig.ratio, "P": 6.0, "phi": 0.4}}, seed=5)
    found = read_off(MotorForm(record), drive_of(rig), FREE, Cogging)
    assert float(found.P) == 6.0
    assert float(found.A) == pytest.approx(2.0 * rig.inertia / rig.ratio, rel=0.3)
    assert float(found.phi) == pytest.approx(0.4, abs=0.2)


def test_a_drives_link_cannot_be_explained_by_no_torque_at_all():
    """With nothing measured that pushes the link, its inertia is no free parameter of the regression."""
    rig, record = made({})
    off = drive_of(replace(rig, stiffness=1.5 * rig.stiffness))
    left, by = WeakForm(record).missing(off, FREE)
    assert np.all(by[:, 0] == 0.0)
    rest = left - by @ np.linalg.lstsq(by, left, rcond=None)[0]
    assert 0.0 < np.std(rest) < np.std(left)


def test_what_is_proposed_for_a_drive():
    rig = drive_of(random_rig(np.random.default_rng(0)))
    proposed = laws_for(rig)
    assert {"coulomb_motor", "cogging", "gravity", "transmission_error", "coulomb_joint"} <= set(proposed)
    assert not any(law.states or law.observe is not AbstractEffect.observe for law in proposed.values())
    assert not {"coulomb_motor", "cogging"} & set(laws_for(rig.on_its_base()))


def test_laws_that_do_nothing_do_not_change_what_the_filter_finds():
    rig, record = made({}, seconds=3.0, which=("motor",))
    own = drive_of(rig)
    own = System(own.inertia, own.contact, own.damper, {}, "motor", motor=own.motor)
    starts = []
    for system in (own, own.with_effects(catalogue()["gravity"](), catalogue()["preload"]())):
        windows, _, _ = prepare(system, [record], None)
        problem = make_problem(system, windows, ("inertia",))
        starts.append(filtered(problem, np.zeros(1))[0])
    np.testing.assert_array_equal(*starts)


@pytest.mark.slow
@pytest.mark.parametrize(
    "hidden",
    [{"coulomb_motor": {"Tc": 4.0}}, {"gravity": {"G": -8.0, "phi0": 0.3}, "coulomb_joint": {"Tc": 2.0}}, {}],
    ids=["coulomb_motor", "gravity+coulomb_joint", "nothing"],
)
def test_what_hides_in_a_drive_is_named(hidden):
    def effects(rig):
        size = lambda name: rig.inertia / (rig.ratio if name == "coulomb_motor" else 1.0)  # noqa: E731
        return {n: {k: v if k == "phi0" else v * size(n) for k, v in own.items()} for n, own in hidden.items()}

    rig, record = made(effects, seed=11)
    found = jb.refine(record)
    assert set(found.effects) == set(hidden)
    assert found.verdict.complete
    off = [(e.value - getattr(rig, n)) / e.stderr for n, e in found.fit.parameters.items() if n in NAMES]
    assert len(off) == 6
    assert max(map(abs, off)) < 4.0


@pytest.mark.shared
@pytest.mark.slow
@pytest.mark.parametrize("name", ["q01", "q02", "q03", "q04", "q05", "q06"])
def test_practice(name):
    truth = json.loads((PRACTICE / name / "answer.json").read_text())
    told = {"ratio": truth["ratio"]} | ({} if truth["kt"] is None else {"kt": truth["kt"]})
    record, heldout = (jb.read_record(PRACTICE / name / f"{part}.csv", **told) for part in ("train", "heldout"))
    found = jb.refine(record, heldout=heldout)
    assert set(found.effects) == set(truth["effects"])
    assert found.verdict.complete
