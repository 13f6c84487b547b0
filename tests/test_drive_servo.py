"""Drives whose servo was told a position command: the other program, derivatives, records and fits, and what is refused."""

import importlib.util
import json
import re
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.mechanics import Drive
from jaxbacklash.parameters import ravel, specs, unravel, values
from jaxbacklash.regression.drive_start import start_of_drive
from jaxbacklash.solvers import run_panels
from tests.independent.drives import DriveRig, commanded_record, followed, packed, random_rig, run_commanded

from .in_process import call
from .test_gradients import central

HERE = pytest.mark.skipif(importlib.util.find_spec("numba") is None, reason="the other program needs numba")
RIG = DriveRig(6.0e-5, 1.5e-4, 50.0, 0.08, 0.012, 1500.0, 0.8)
NAMES = tuple(DriveRig.__dataclass_fields__)
RATE, WINDOW = 1000.0, 100


def gains(rig, limit=1e9):
    """Kp, Kd and tmax of a servo of 6 Hz."""
    omega = 2.0 * np.pi * 6.0
    return rig.motor_inertia * omega**2 * rig.ratio, 1.4 * omega * rig.motor_inertia, limit


def servo(rig=RIG, tmax=None, **more):
    Kp, Kd, _ = gains(rig)
    return jb.drive(*(getattr(rig, n) for n in NAMES), Kp=Kp, Kd=Kd, tmax=tmax, **more)


def recorded(rig, seed, seconds, which=("motor", "link"), effects=None, limit=1e9):
    # The command is exact: the other program's steps of 10 us, whose switches are late by one, would be seen.
    seen = commanded_record(rig, gains(rig, limit), effects or {}, np.random.default_rng(seed), seconds, parts=1000)
    return jb.Record(seen["t"], {n: seen[n] for n in ("command", *which)}, ratio=rig.ratio)


def per_motor(rig):
    """What a record of a command can tell of a rig: all per unit inertia of its motor, whose friction is in Kd."""
    own, (Kp, Kd, _) = rig.motor_inertia, gains(rig)
    told = {n: getattr(rig, n) / own for n in ("inertia", "stiffness", "damping")}
    return told | {"backlash": rig.backlash, "Kp": Kp / own, "Kd": (Kd + rig.motor_damping) / own}


@partial(jax.jit, static_argnames="finer")
def run(rig, states, told, finer=1):
    def one(state, told):
        told = jnp.repeat(told, finer)[: 1 - finer or None]
        zero = jnp.zeros_like(told)
        _, path = run_panels(rig, 0.0, state, Drive(zero, zero, zero, None, told), 1.0 / RATE / finer, finer, rig.switches)
        return jnp.stack(path[:4])

    return jax.vmap(one)(states, told)


def commanded(limit, parts=1000):
    command = followed(RIG, np.random.default_rng(3), 3.0, RATE)[0] / RIG.ratio
    return command, run_commanded(packed(RIG, {}), np.zeros(6), command, np.array(gains(RIG, limit)), 1.0 / RATE, parts)


@HERE
@pytest.mark.parametrize("limit", [1e9, 0.05])
def test_windows_follow_the_other_program(limit):
    """Windows of a tenth of a second from the true state, the command held, with and without a limit of the torque."""
    command, states = commanded(limit)
    push = gains(RIG)[0] * (command - states[:, 0] / RIG.ratio) - gains(RIG)[1] * states[:, 1]
    assert np.mean(np.abs(push) > limit) > 0.1 or limit == 1e9
    first = WINDOW * np.arange(command.size // WINDOW)
    grid = first[:, None] + np.arange(WINDOW)
    begin = tuple(jnp.asarray(states[first, at]) for at in (2, 3, 0, 1))
    edges = np.append(command, command[-1])[first[:, None] + np.arange(WINDOW + 1)]
    found = np.asarray(run(servo(tmax=limit), begin, jnp.asarray(edges)))
    assert np.ptp(states[:, 2] - states[:, 0] / RIG.ratio) > 1.2 * RIG.backlash  # both edges are met
    for error in (np.abs(found[:, 0] - states[grid, 2]), np.abs(found[:, 2] - states[grid, 0]) / RIG.ratio):
        assert np.median(error) < 1e-7
        assert np.quantile(error, 0.99) < 2e-6


@HERE
def test_derivatives_through_contacts_and_the_limit():
    limit = 0.05
    rig, (command, states) = servo(tmax=limit), commanded(limit, 100)
    vector = ravel(rig)
    free = np.array([i for i, spec in enumerate(specs(rig).values()) if not spec.fixed])
    z = states[:, 2] - states[:, 0] / RIG.ratio
    first = max(range(0, command.size - 200, 50), key=lambda k: min(z[k : k + 200].max(), -z[k : k + 200].min()))
    held, begin = jnp.asarray(command[first : first + 201]), tuple(jnp.asarray(states[first, at]) for at in (2, 3, 0, 1))

    @jax.jit
    def motion(scaled):
        moved = unravel(rig, vector * jnp.ones(vector.size).at[free].set(scaled))
        path = run(moved, tuple(s[None] for s in begin), held[None])[0]
        return jnp.stack([path[0], path[2] / RIG.ratio])[:, ::5]

    one = np.ones(free.size)
    exact = np.asarray(jax.jit(jax.jacfwd(motion))(one)).reshape(-1, free.size)
    difference = central(lambda v: np.asarray(motion(v)).ravel(), one, rel=1e-5)
    error = np.abs(exact - difference) / (np.abs(difference).max(axis=0) + 1e-12)
    assert np.abs(difference).max(axis=0)[-1] > 0.0  # the limit is met
    assert np.quantile(error, 0.98) < 1e-3


@HERE
def test_the_start_is_near_and_per_unit_inertia_of_the_motor():
    rig = random_rig(np.random.default_rng(5))
    motor, joint = start_of_drive(recorded(rig, 5, 6.0))
    found = values(motor) | {n: getattr(joint, n) for n in ("inertia", "backlash", "stiffness", "damping")}
    assert (found["motor_inertia"], found["motor_damping"]) == (1.0, 0.0)
    for name, value in per_motor(rig).items():
        assert found[name] == pytest.approx(value, rel=0.1 if name in ("Kp", "Kd", "inertia", "backlash") else 0.5)
    known, same = start_of_drive(recorded(rig, 5, 6.0), rig.inertia)
    assert same.inertia == pytest.approx(rig.inertia)
    assert float(known.motor_inertia) == pytest.approx(rig.motor_inertia, rel=0.1)


@HERE
@pytest.mark.parametrize("share", [0.0, 1.0])
def test_a_limit_is_taken_where_the_record_shows_one(share):
    rig = random_rig(np.random.default_rng(7))
    friction = {"coulomb_motor": {"Tc": 4.0 * rig.inertia / rig.ratio}}
    limit = share * 2.0 * rig.backlash * gains(rig)[0] or 1e9
    motor, _ = start_of_drive(recorded(rig, 7, 6.0, effects=friction, limit=limit))
    assert isinstance(motor, jb.LimitedServo) == (share > 0.0)
    if share:
        assert float(motor.tmax) == pytest.approx(limit / rig.motor_inertia, rel=0.2)


@HERE
@pytest.mark.slow
@pytest.mark.parametrize(("seed", "which"), [(1, ("motor", "link")), (3, ("motor", "link")), (1002, ("motor",))])
def test_a_servo_is_found_from_what_it_was_told(seed, which):
    rig = random_rig(np.random.default_rng(seed))
    fit = jb.fit(recorded(rig, seed, 8.0, which), starts=1, heldout=recorded(rig, seed + 1, 4.0, which))
    assert fit.adequate
    assert fit.tied
    assert fit.heldout.rms == pytest.approx(1.0, abs=0.05)
    truth = per_motor(rig)
    assert set(fit.parameters) == set(truth)
    errors = {n: (e.value - truth[n]) / e.stderr for n, e in fit.parameters.items()}
    assert max(abs(e) for e in errors.values()) < 4.0, errors
    assert fit.parameters["backlash"].unit == "rad"
    assert fit.parameters["Kp"].unit == "1/s^2"
    assert fit.parameters["backlash"].stderr < 1e-3 * rig.backlash
    assert "per unit inertia of the motor" in str(fit)


@HERE
@pytest.mark.slow
def test_a_limited_servo_with_friction_and_a_known_inertia():
    rig = random_rig(np.random.default_rng(7))
    Kp, Kd, _ = gains(rig)
    friction, limit = 4.0 * rig.inertia / rig.ratio, 2.0 * rig.backlash * Kp
    record = recorded(rig, 7, 8.0, effects={"coulomb_motor": {"Tc": friction}}, limit=limit)
    fit = jb.fit(record, starts=1, effects=["coulomb_motor"], inertia=rig.inertia)
    assert fit.adequate
    assert not fit.per_inertia
    truth = {n: getattr(rig, n) for n in NAMES} | {"Kp": Kp, "Kd": Kd, "tmax": limit, "coulomb_motor.Tc": friction}
    errors = {n: (e.value - truth[n]) / e.stderr for n, e in fit.parameters.items() if e.value is not None}
    assert {"motor_inertia", "Kp", "tmax", "coulomb_motor.Tc", "backlash"} <= set(errors)
    assert "inertia" not in fit.free
    assert max(abs(e) for e in errors.values()) < 4.0, errors


@pytest.fixture
def written(tmp_path):
    """A file of a simulated servo with an encoder on motor and link, its columns changed by function or left out."""
    drive = jb.MotorTorque(jb.Multisine(np.array([0.03, 0.05]), 2 * np.pi * np.array([0.7, 2.3]), np.array([0.3, 1.0])))
    motion = jb.simulate(servo(), drive, duration=6.0, rate=500.0)
    rng = np.random.default_rng(0)
    motor, link = (np.asarray(motion.observed)[:, i] + 1e-5 * rng.standard_normal(motion.t.size) for i in (0, 1))
    seen = {"t": np.asarray(motion.t), "command": np.asarray(motion.drive.torque), "motor": motor, "link": link}

    def write(**changed):
        columns = {n: changed.get(n, lambda v: v)(v) for n, v in seen.items()}
        columns = {n: v for n, v in columns.items() if v is not None}
        columns |= {n: of(seen) for n, of in changed.items() if n not in seen}
        head = ",".join(columns)
        np.savetxt(tmp_path / "run.csv", np.stack(list(columns.values()), axis=1), delimiter=",", header=head, comments="")
        return tmp_path / "run.csv"

    return write


def test_a_command_that_no_servo_follows(written):
    record = jb.read_record(written(), ratio=50.0)
    with pytest.raises(jb.BadInput, match="the motor does not move as a servo's does that is told this command"):
        start_of_drive(record.replace(command=50.0 * record.channels["command"]))


def gone(values):
    return None


def test_a_command_is_read(written):
    record = jb.read_record(written(), ratio=50.0)
    assert (record.kind, record.input_name, record.observed_names) == ("drive", "command", ("motor", "link"))
    assert jb.read_record(written(link=gone), ratio=50.0).observed_names == ("motor",)


def test_a_torque_beside_a_command_is_what_drives_unless_the_command_is_mapped(written):
    file = written(torque=lambda seen: 0.1 * np.sin(3.0 * seen["t"]))
    record = jb.read_record(file, ratio=50.0)
    assert record.input_name == "torque"
    assert "command (unmapped)" in record.extras
    assert jb.read_record(file, ratio=50.0, columns={"command": "command"}).input_name == "command"


BAD = {
    "no motor": ({"motor": gone}, (), "found command and link, wanted command with motor"),
    "no ratio": ({}, (), r"follows the motor at 1/[45]\d\.?\d* in slow motion, as behind a gear; pass --ratio 5\d"),
    "at the shaft": ({"command": lambda v: 50.0 * v}, (50,), r"command: is 50 times the place .* pass --scale command=0\.02"),
    "in degrees": ({"command": np.degrees}, (50,), r"column command: is 57\.\d+ times the place to which the motor goes"),
    "the other way round": ({"command": lambda v: -v}, (50,), "the other way round; pass --sign command"),
    "standing still": ({"command": lambda v: 0.0 * v}, (50,), "column command: found 0 in every row"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_what_is_wrong_is_said_in_a_sentence(case, written, tmp_path):
    changed, ratio, said = BAD[case]
    told = call(["fit", str(written(**changed)), *(word for n in ratio for word in ("--ratio", str(n)))], tmp_path)
    assert told.code == 2
    assert told.err.count("\n") == 1
    assert re.search(said, told.err), told.err


def test_look_tells_a_servo(written, tmp_path):
    told = call(["look", str(written())], tmp_path)
    assert told.code == 0
    assert "a drive with a servo: the position that it was told" in told.out
    assert re.search(r"next: jaxbacklash fit \S+ --ratio 5\d", told.out), told.out


@pytest.mark.parametrize("tmax", [None, 0.2])
def test_a_model_file_simulates_what_the_servo_was_told(tmax, tmp_path):
    (tmp_path / "rig.toml").write_text(jb.dump_model(servo(tmax=tmax)))
    again = jb.load_model(tmp_path / "rig.toml")
    assert type(again.motor) is (jb.Servo if tmax is None else jb.LimitedServo)
    assert jb.dump_model(again) == (tmp_path / "rig.toml").read_text()
    words = ["simulate", "rig.toml", "--duration", "2", "--rate", "500"]
    assert call([*words, "--excitation", "harmonic:amplitude=0.05,frequency=2", "--out", "run.csv"], tmp_path).code == 0
    made = jb.read_record(tmp_path / "run.csv", ratio=50.0)
    assert made.input_name == "command"
    assert call([*words, "--excitation", "run.csv", "--out", "again.csv"], tmp_path).code == 0
    held = jb.read_record(tmp_path / "again.csv", ratio=50.0)
    assert np.std(held.channels["link"] - made.channels["link"]) < 0.1 * np.std(made.channels["link"])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("Kd = 0.1\nmotor_inertia = 1.0\nmotor_damping = 0.0\nratio = 3.0", "lacks Kp"),
        ("Kp = 0.0\nKd = 0.1\nmotor_inertia = 1.0\nmotor_damping = 0.0\nratio = 3.0", "Kp is 0, wanted a positive number"),
        ("Kp = 1.0\nKd = -0.1\nmotor_inertia = 1.0\nmotor_damping = 0.0\nratio = 3.0", "Kd is -0.1, wanted a gain"),
        ("tmax = 1.0\nmotor_inertia = 1.0\nmotor_damping = 0.0\nratio = 3.0", "lacks Kd"),
    ],
)
def test_model_files_that_are_no_servo(text, said, tmp_path):
    (tmp_path / "rig.toml").write_text(f'[model]\nobserved = "motor"\ninertia = 1.0\n{text}\n')
    with pytest.raises(jb.BadInput, match=said):
        jb.load_model(tmp_path / "rig.toml")


def test_command_and_torque_are_not_taken_for_each_other(written, tmp_path):
    record = jb.read_record(written(), ratio=50.0)
    plain = jb.drive(*(getattr(RIG, n) for n in NAMES))
    with pytest.raises(jb.BadInput, match="drives by command, and the model is not of a motor with a servo"):
        jb.compare(plain, record)
    with pytest.raises(jb.BadInput, match="drives by command, and the model is not of a motor with a servo"):
        jb.fit(record, system=plain)
    (tmp_path / "rig.toml").write_text(jb.dump_model(plain))
    told = call(["simulate", "rig.toml", "--excitation", "run.csv", "--rate", "500", "--out", "again.csv"], tmp_path)
    assert told.code == 2
    assert "with command, which does not drive this model; wanted the torque at the motor" in told.err


def test_a_servo_is_not_exported():
    with pytest.raises(jb.BadInput, match=r"follows a command by a servo .* jaxbacklash simulate"):
        jb.exported(servo(), "mjcf")


@HERE
@pytest.mark.slow
def test_fit_and_compare_at_the_door(tmp_path):
    rig = random_rig(np.random.default_rng(1))
    for name, seed in (("run", 1), ("other", 2)):
        record = recorded(rig, seed, 5.0)
        columns = {"t": record.t} | record.channels
        np.savetxt(tmp_path / f"{name}.csv", np.stack(list(columns.values()), axis=1), delimiter=",", header=",".join(columns),
                   comments="")  # fmt: skip
    told = call(["fit", "run.csv", "--ratio", "50", "--out", "found", "--json"], tmp_path)
    assert told.code == 0, told.err
    result = json.loads(told.out)
    assert result["per_inertia"]
    assert result["verdict"] == "complete"
    found = result["stages"][-1]["parameters"]
    assert found["Kp"]["ci95"][0] < per_motor(rig)["Kp"] < found["Kp"]["ci95"][1]
    assert "per unit inertia of the motor, whose torque was not measured" in (tmp_path / "found" / "report.html").read_text()
    seen = call(["compare", "found/model.toml", "other.csv", "--ratio", "50", "--json"], tmp_path)
    assert seen.code == 0, seen.err
    assert json.loads(seen.out)["verdict"] == "complete"
