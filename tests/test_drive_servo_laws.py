"""Which laws a drive lacks whose servo was told a position command: its balance at the motor, torques beside the command, and
searches on records of another program."""

import json
from dataclasses import replace
from types import SimpleNamespace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.effects import CoulombMotor, Gravity, Preload
from jaxbacklash.fitting.fit import prepare
from jaxbacklash.fitting.setup import first_guess, make_problem
from jaxbacklash.parameters import values, with_values
from jaxbacklash.regression.motor_form import MotorForm
from jaxbacklash.residuals import Findings
from jaxbacklash.residuals.at_motor import as_pushed, missing_at_motor
from jaxbacklash.shooting.multiple_shooting import shoot
from jaxbacklash.simulation import as_record
from tests.independent.drives import followed, packed, random_rig, run_commanded

from .in_process import call
from .test_drive_servo import gains, per_motor, recorded, servo

pytest.importorskip("numba", reason="the other program needs numba")
FREE = ("inertia", "backlash", "stiffness", "damping", "Kp", "Kd")


def limit_of(rig):
    return 2.0 * rig.backlash * gains(rig)[0]


def short(rig=None, which=("motor", "link")):
    """A record of less than a second of a simulated servo."""
    rig = rig or servo()
    t = np.arange(800) / 1000.0
    told = 0.04 * np.sin(2.0 * np.pi * 2.0 * t) + 0.03 * np.sin(2.0 * np.pi * 5.0 * t + 1.0)
    record = as_record(jb.simulate(rig, jb.HeldTorque(0.0, 0.001, told), duration=0.799, rate=1000.0), rig)
    return replace(record, channels={n: record.channels[n] for n in ("command", *which)})


@pytest.mark.parametrize("limited", [False, True])
def test_the_true_servo_leaves_nothing_at_its_motor(limited):
    rig = random_rig(np.random.default_rng(7))
    friction, limit = 4.0 * rig.inertia / rig.ratio, limit_of(rig) if limited else None
    record = recorded(rig, 7, 4.0, effects={"coulomb_motor": {"Tc": friction}}, limit=limit or 1e9)
    true = servo(rig, limit).with_effects(CoulombMotor(friction))
    form = MotorForm(record)
    left, by = form.missing(true, FREE)
    without, _ = form.missing(true.without("coulomb_motor"), FREE)
    assert np.std(left) < 0.1 * np.std(without)
    assert by.shape == (left.size, len(FREE))
    assert np.all(by[:, 1:4] == 0.0)  # the joint cancels


def test_how_the_rest_at_the_motor_falls_with_the_gains_is_what_differences_say():
    rig = random_rig(np.random.default_rng(7))
    limit = limit_of(rig)
    form = MotorForm(recorded(rig, 7, 3.0, limit=limit))
    at = servo(rig, limit).with_effects(Gravity(-1.0), CoulombMotor(2e-3))
    names = ("inertia", "motor_inertia", "motor_damping", "Kp", "Kd", "tmax", "gravity.G", "coulomb_motor.Tc")
    left, by = form.missing(at, names)
    found = values(at)
    for column, name in zip(by.T, names):
        step = 1e-6 * abs(float(found[name]))
        moved, _ = form.missing(with_values(at, {name: float(found[name]) + step}), names)
        np.testing.assert_allclose(-(moved - left) / step, column, rtol=1e-3, atol=1e-4 * np.max(np.abs(column)))


@pytest.mark.parametrize("seed", [3, 4])
def test_what_is_missing_at_the_motor_is_told_apart_from_noise(seed):
    rig = random_rig(np.random.default_rng(seed))
    assert not missing_at_motor(servo(rig), FREE, recorded(rig, seed, 5.0)).evident
    friction = 3.0 * rig.inertia / rig.ratio
    found = missing_at_motor(servo(rig), FREE, recorded(rig, seed, 5.0, effects={"coulomb_motor": {"Tc": friction}}))
    assert found.evident
    assert found.by_direction > 0.9
    assert 0.2 * friction < found.rms < friction
    assert np.std(found.torque - found.goes) < 0.4 * np.std(found.torque)
    # The picture shows that torque, not the link's, which lacks none.
    here = Findings(("",), (), SimpleNamespace(record=np.zeros(1, int)), None, 9.0, 9.0, found)
    _, stretch = jb.plot.missing_torque(here)
    drawn = {line.get_label(): line.get_ydata() for line in stretch.get_lines()}
    assert np.isin(drawn["missing torque"], found.torque).all()
    assert "as a function of the motor's direction" in drawn


@pytest.mark.parametrize("limited", [False, True])
def test_a_command_as_the_torque_that_was_made_of_it(limited):
    rig = random_rig(np.random.default_rng(5))
    Kp, Kd, limit = gains(rig, limit_of(rig) if limited else 1e9)
    record = recorded(rig, 5, 3.0, ("motor",), limit=limit)
    pushed, free, same = as_pushed(servo(rig, limit if limited else None), (*FREE, "tmax"), record)
    assert type(pushed.motor) is jb.Motor
    assert free == ("inertia", "backlash", "stiffness", "damping", "motor_damping")
    assert (same.input_name, same.observed_names, same.ratio) == ("torque", ("motor",), rig.ratio)
    command = followed(rig, np.random.default_rng(5), 3.0, 1000.0)[0] / rig.ratio
    states = run_commanded(packed(rig, {}), np.zeros(6), command, np.array([Kp, Kd, limit]), 1e-3, 100)
    made = np.clip(Kp * (command - states[:, 0] / rig.ratio) - Kd * states[:, 1], -limit, limit)
    told = same.channels["torque"] - (0.0 if limited else Kd * states[:, 1])
    assert np.std(told - made) < 0.03 * np.std(made)  # half a sample apart


@pytest.mark.slow
def test_a_torque_on_the_link_beside_a_command_and_one_at_the_motor_beside_a_torque():
    load, rig = 0.3, servo()

    def motion(system, record, change):
        windows, _, _ = prepare(system, [record], None)
        problem = make_problem(system, change(windows), ("inertia",))
        return np.asarray(jax.jit(lambda p, u: shoot(p, u).predicted.motion)(problem, first_guess(problem)))

    def loaded(windows):
        return replace(windows, force=jnp.asarray(windows.force) + load)

    same = lambda windows: windows  # noqa: E731
    found, bare = motion(rig, short(), loaded), motion(rig, short(), same)
    np.testing.assert_allclose(found, motion(rig.with_effects(Preload(load)), short(), same), atol=1e-9)
    assert np.max(np.abs(found - bare)) > 1e-4

    pushed, _, record = as_pushed(rig, FREE, short())
    more = record.replace(torque=record.channels["torque"] + 0.01)
    at_motor = lambda windows: replace(windows, force=jnp.asarray(windows.force) + 0.01, at_motor=True)  # noqa: E731
    there = jnp.asarray(prepare(pushed, [record], None)[0].weight) > 0.0
    found, wanted = motion(pushed, record, at_motor), motion(pushed, more, same)
    np.testing.assert_allclose(np.where(there, found, 0.0), np.where(there, wanted, 0.0), atol=1e-9)


@pytest.mark.parametrize("what", ["diagnose", "missing_torque"])
def test_the_link_alone_is_refused_in_a_sentence(what, tmp_path):
    record = short()
    seen = {"t": record.t, "torque": 1e-3 * np.sin(9.0 * record.t), "link": record.channels["link"]}
    np.savetxt(tmp_path / "run.csv", np.stack(list(seen.values()), axis=1), delimiter=",", header=",".join(seen), comments="")
    said = f"is of a drive with the encoder of the link alone, which {what} does not take so far; wanted the motor's encoder"
    if what == "diagnose":
        told = call([what, "run.csv", "--ratio", "50"], tmp_path)
        assert told.code == 2
        assert said in told.err.splitlines()[-1]
        return
    fit = jb.Fit(**dict.fromkeys(jb.Fit.__dataclass_fields__) | {"records": (jb.read_record(tmp_path / "run.csv", ratio=50.0),)})
    with pytest.raises(jb.BadInput, match=said):
        jb.missing_torque(fit)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "hidden", "which"),
    [
        (11, {"coulomb_motor": {"Tc": 4.0}}, ("motor", "link")),
        (21, {"gravity": {"G": -8.0, "phi0": 0.3}}, ("motor", "link")),
        (27, {}, ("motor",)),
    ],
    ids=["coulomb_motor", "gravity", "nothing"],
)
def test_what_a_servo_lacks_is_named_from_what_it_was_told(seed, hidden, which):
    rig = random_rig(np.random.default_rng(seed))
    size = {n: rig.inertia / (rig.ratio if n == "coulomb_motor" else 1.0) for n in hidden}
    effects = {n: {k: v if k == "phi0" else v * size[n] for k, v in own.items()} for n, own in hidden.items()}
    found = jb.refine(recorded(rig, seed, 7.0, which, effects))
    assert set(found.effects) == set(hidden)
    assert found.verdict.complete
    truth = per_motor(rig) | {
        f"{n}.{k}": v / rig.motor_inertia for n, own in effects.items() for k, v in own.items() if k != "phi0"
    }
    off = {n: (e.value - truth[n]) / e.stderr for n, e in found.fit.parameters.items() if n in truth}
    assert set(FREE) <= set(off)
    assert max(map(abs, off.values())) < 4.5, off
    assert "per unit inertia of the motor" in str(found)


@pytest.mark.slow
@pytest.mark.parametrize("which", [("motor", "link"), ("motor",)])
def test_where_a_servo_fails_at_the_door(which, tmp_path):
    rig = random_rig(np.random.default_rng(28))
    friction = 4.0 * rig.inertia / rig.ratio
    record = recorded(rig, 28, 5.0, which, {"coulomb_motor": {"Tc": friction}})
    seen = {"t": record.t, **record.channels}
    np.savetxt(tmp_path / "run.csv", np.stack(list(seen.values()), axis=1), delimiter=",", header=",".join(seen), comments="")
    told = call(["diagnose", "run.csv", "--ratio", f"{rig.ratio:g}", "--starts", "1", "--out", "why", "--json"], tmp_path)
    assert told.code == 0, told.err
    result = json.loads(told.out)
    assert result["verdict"] == "incomplete"
    assert "goes with the direction in which the motor turns" in result["findings"][0]
    assert result["latent_torque"]["at_motor"]["by_direction"] > 0.5
    assert 0.2 * friction < rig.motor_inertia * result["latent_torque"]["at_motor"]["rms"] < 1.2 * friction
    assert result["latent_torque"]["port"] == ("motor" if len(which) == 1 else "link")
    assert result["stages"][0]["candidates"][0]["name"] == "coulomb_motor"
    assert len(which) == 2 or "does not tell the two apart" in result["findings"][1]
    assert (tmp_path / "why" / "report.html").exists()
