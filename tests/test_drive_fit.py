"""Fits of drives with an encoder on motor and link, on records of another program and of practice; of one encoder, see
`tests.test_drive_one_encoder`."""

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

import jaxbacklash as jb
from tests.independent.drives import DriveRig, random_rig, servo_record

HERE = pytest.mark.skipif(importlib.util.find_spec("numba") is None, reason="the other program needs numba")
PRACTICE = Path(__file__).resolve().parents[2] / "shared" / "records_drives"
NAMES = tuple(DriveRig.__dataclass_fields__)


def as_record(rig, seed, effects=None, seconds=6.0):
    seen = servo_record(rig, effects or {}, np.random.default_rng(seed), seconds)
    return jb.Record(seen.pop("t"), seen, ratio=rig.ratio)


def errors(fit, truth):
    """Errors of what was found, in its standard errors."""
    return {n: (e.value - truth[n]) / e.stderr for n, e in fit.parameters.items() if n in truth}


@HERE
@pytest.mark.slow
def test_a_drive_is_found_from_its_record_alone():
    rig = random_rig(np.random.default_rng(1))
    record = as_record(rig, 1)
    fit = jb.fit(record, starts=1, heldout=as_record(rig, 2))
    assert fit.adequate
    assert fit.score.rms == pytest.approx(1.0, abs=0.03)
    assert fit.heldout.rms == pytest.approx(1.0, abs=0.03)
    found = errors(fit, {name: getattr(rig, name) for name in NAMES})
    assert set(found) == set(NAMES) - {"ratio"}
    assert max(abs(e) for e in found.values()) < 4.0
    assert fit.parameters["backlash"].stderr < 1e-3 * rig.backlash
    assert fit.parameters["motor_inertia"].unit == "kg m^2"
    seen = jb.compare(fit.system, as_record(rig, 3))
    assert seen.adequate


@HERE
@pytest.mark.slow
def test_friction_of_the_motor_and_weight_of_the_link():
    rig = random_rig(np.random.default_rng(2))
    friction, weight = 0.1 * rig.inertia * 40.0 / rig.ratio, -9.0 * rig.inertia
    record = as_record(rig, 4, {"coulomb_motor": {"Tc": friction}, "gravity": {"G": weight}})
    fit = jb.fit(record, starts=1, effects=["coulomb_motor", "gravity"])
    assert fit.adequate
    found = errors(fit, {name: getattr(rig, name) for name in NAMES} | {"coulomb_motor.Tc": friction, "gravity.G": weight})
    assert {"coulomb_motor.Tc", "gravity.G", "motor_damping"} <= set(found)
    assert max(abs(e) for e in found.values()) < 4.0


@pytest.mark.shared
@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "effects"),
    [
        ("q01", ()),
        ("q02", ("coulomb_motor",)),
        ("q03", (jb.Gravity(-1.0, 0.01),)),
        ("q04", ("coulomb_motor",)),
        ("q05", ("coulomb_motor", "gravity")),
    ],
)
def test_practice(name, effects):
    truth = json.loads((PRACTICE / name / "answer.json").read_text())
    told = {"ratio": truth["ratio"]} | ({} if truth["kt"] is None else {"kt": truth["kt"]})
    record, heldout = (jb.read_record(PRACTICE / name / f"{part}.csv", **told) for part in ("train", "heldout"))
    fit = jb.fit(record, effects=effects, heldout=heldout, starts=1)
    assert fit.adequate
    # Of a link that is not seen, beside dry friction, a score from nothing may stall in a window or two.
    assert fit.heldout.rms < (1.05 if len(record.observed_names) == 2 else 1.1)
    names = {"Tcm": "coulomb_motor.Tc", "G": "gravity.G", "gph": "gravity.phi0"}
    found = errors(fit, {names.get(n, n): value for n, value in truth["truth"].items()})
    assert len(found) >= 6
    assert max(abs(e) for e in found.values()) < 4.0


def quick(rig=None):
    rig = rig or jb.drive(6e-5, 1.5e-4, 50.0, 0.08, 0.012, 1500.0, 0.8)
    t = np.arange(800) / 1000.0
    push = 0.05 * np.sin(2 * np.pi * 3.0 * t) + 0.03 * np.sin(2 * np.pi * 8.0 * t + 1.0)
    from jaxbacklash.simulation import as_record

    return rig, as_record(jb.simulate(rig, jb.HeldTorque(0.0, 0.001, push), duration=0.799, rate=1000.0), rig)


def test_a_simulated_drive_as_a_record():
    _, record = quick()
    assert (record.kind, record.input_name, record.observed_names, record.ratio) == ("drive", "torque", ("motor", "link"), 50.0)
    np.testing.assert_allclose(record.relative, record.channels["link"] - record.channels["motor"] / 50.0)
    seen = record.on_its_base()
    assert seen.kind == "base_motion"
    np.testing.assert_allclose(seen.relative, record.relative)


@pytest.mark.parametrize("law", ["sensor_delay", "sensor_gain"])
def test_laws_of_the_measuring_chain_are_refused(law):
    _, record = quick()
    with pytest.raises(jb.BadInput, match=f"--effects {law}: the measuring chain of a drive"):
        jb.fit(record, effects=[law])


def test_laws_of_a_motor_where_there_is_none_are_refused():
    _, record = quick()
    with pytest.raises(jb.BadInput, match="--effects coulomb_motor: acts on the motor of a drive"):
        jb.fit(record.on_its_base(), effects=["coulomb_motor"])


def test_what_needs_both_encoders_says_so():
    _, record = quick()
    one = jb.Record(record.t, {n: record.channels[n] for n in ("torque", "motor")}, "run.csv", ratio=50.0)
    with pytest.raises(jb.BadInput, match=r"run\.csv: is of a drive with the encoder of the motor alone, .* both enc"):
        jb.skeleton(one)


def test_a_comparison_wants_both_of_a_drive():
    rig, record = quick()
    with pytest.raises(jb.BadInput, match="the model is of a drive with its motor, the record is not"):
        jb.compare(rig, record.on_its_base())
    with pytest.raises(jb.BadInput, match="is of a gear of 50, the model of 30"):
        jb.compare(jb.drive(6e-5, 1.5e-4, 30.0, 0.08, 0.012, 1500.0, 0.8), record)


def test_a_drive_as_a_model_file(tmp_path):
    rig = quick()[0].with_effects(jb.CoulombMotor(0.01), jb.Gravity(-2.0, 0.3))
    file = tmp_path / "rig.toml"
    file.write_text(jb.dump_model(rig))
    again = jb.load_model(file)
    assert again.observed == "motor link"
    assert jb.dump_model(again) == file.read_text()
    assert float(again.motor.ratio) == 50.0


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('observed = "motor"\ninertia = 1.0\nstiffness = 2.0\ndamping = 0.1\nratio = 3.0', "lacks motor_damping"),
        ('observed = "z"\ninertia = 1.0\nmotor_inertia = 1.0\nmotor_damping = 0.1\nratio = 3.0', "observed is 'z'"),
        ('observed = "link"\ninertia = 1.0\nmotor_inertia = 1.0\nmotor_damping = 0.1\nratio = 0.0', "ratio is 0"),
        ('observed = "z"\ninertia = 1.0\n[effects.coulomb_motor]\nTc = 1.0', "coulomb_motor. acts on a motor"),
    ],
)
def test_model_files_that_are_no_drive(text, said, tmp_path):
    file = tmp_path / "rig.toml"
    file.write_text(f"[model]\n{text}\n")
    with pytest.raises(jb.BadInput, match=said):
        jb.load_model(file)


@pytest.mark.slow
def test_without_kt_everything_is_per_kt():
    rig, record = quick()
    current = jb.Record(record.t, record.channels | {"torque": record.channels["torque"] / 0.1}, ratio=50.0, per_kt=True)
    fit = jb.fit(current, system=rig_per(rig, 0.1), free=("inertia", *WITH_KT), starts=1)
    assert fit.parameters["stiffness"].unit == "N m/rad per N m/A"
    assert fit.parameters["motor_inertia"].unit == "kg m^2 per N m/A"
    assert fit.parameters["backlash"].unit == "rad"
    assert float(fit.parameters["stiffness"].value) == pytest.approx(1500.0 / 0.1, rel=1e-3)
    assert "per N m/A of the motor" in str(fit)


WITH_KT = ("backlash", "stiffness", "damping", "motor_inertia", "motor_damping")


def rig_per(rig, kt):
    """A drive whose torques and inertias are those of ``rig`` over kt."""
    from jaxbacklash.parameters import values, with_values

    scaled = ("inertia", "stiffness", "damping", "motor_inertia", "motor_damping")
    return with_values(rig, {name: value / kt for name, value in values(rig).items() if name in scaled})
