"""Reading records of drives: columns, gear, current, and what is wrong with them said in one sentence."""

import re

import numpy as np
import pytest

import jaxbacklash as jb

from .in_process import call

RATIO = 50.0


@pytest.fixture(scope="module")
def seen():
    rig = jb.drive(6e-5, 1.5e-4, RATIO, 0.08, 0.012, 1500.0, 0.8)
    drive = jb.MotorTorque(jb.Multisine(np.array([0.03, 0.05]), 2 * np.pi * np.array([0.7, 2.3]), np.array([0.3, 1.0])))
    motion = jb.simulate(rig, drive, duration=6.0, rate=500.0)
    rng = np.random.default_rng(0)
    motor, link = (np.asarray(motion.observed)[:, i] + 1e-5 * rng.standard_normal(motion.t.size) for i in (0, 1))
    return {"t": np.asarray(motion.t), "torque": np.asarray(motion.drive.torque), "motor": motor, "link": link}


@pytest.fixture
def written(seen, tmp_path):
    def write(head=None, **changed):
        columns = {name: values for name, values in (seen | changed).items() if values is not None}
        file = tmp_path / "run.csv"
        np.savetxt(file, np.stack(list(columns.values()), axis=1), delimiter=",", header=head or ",".join(columns), comments="")
        return file

    return write


def test_a_drive_is_read(written, seen):
    record = jb.read_record(written(), ratio=RATIO)
    assert (record.kind, record.ratio, record.per_kt) == ("drive", RATIO, False)
    np.testing.assert_allclose(record.channels["motor"], seen["motor"])


def test_one_encoder_is_enough(written):
    assert jb.read_record(written(link=None), ratio=RATIO).observed_names == ("motor",)
    assert jb.read_record(written(motor=None), ratio=RATIO).observed_names == ("link",)


def test_a_current_is_a_torque_once_kt_is_known(written, seen):
    file = written("t,current,motor,link")
    with pytest.warns(UserWarning, match=r"taken as a torque of 0\.1 N m for an ampere"):
        record = jb.read_record(file, ratio=RATIO, kt=0.1)
    np.testing.assert_allclose(record.channels["torque"], 0.1 * seen["torque"])
    with pytest.warns(UserWarning, match="per kt; say --kt"):
        assert jb.read_record(file, ratio=RATIO).per_kt


def test_motor_and_link_alone_are_a_base_and_its_link(written, seen):
    record = jb.read_record(written(torque=None), ratio=RATIO)
    assert record.kind == "base_motion"
    np.testing.assert_allclose(record.channels["x"], seen["motor"] / RATIO)


def test_columns_of_other_names_and_units(written, seen):
    file = written("time_s,Iq,enc_m,enc_l", link=np.degrees(seen["link"]))
    told = {"t": "time_s", "torque": "Iq", "motor": "enc_m", "link": "enc_l"}
    record = jb.read_record(file, columns=told, units={"link": "deg"}, ratio=RATIO)
    np.testing.assert_allclose(record.channels["link"], seen["link"], atol=1e-12)


BAD = {
    "no ratio": ({}, (), r"column link: follows the motor at 1/[45]\d\.?\d* in slow motion, as behind a gear; pass --ratio 5\d"),
    "ratio of another gear": ({}, ("--ratio", "30"), r"--ratio 30 says otherwise.* pass --ratio 5\d"),
    "inverse ratio": ({}, ("--ratio", "0.02"), r"--ratio 0\.02 is the inverse of that; wanted turns of the motor"),
    "no ratio and one encoder": ({"link": "none"}, (), "a drive without its gear ratio; say --ratio N"),
    "link the other way round": ({"link": "turned"}, ("--ratio", "50"), "turns against the motor .* pass --sign link"),
    "motor that wraps": ({"motor": "wrapped"}, ("--ratio", "50"), "column motor: jumps by 2 pi .* pass --unwrap motor"),
    "kt without a current": ({}, ("--ratio", "50", "--kt", "0.1"), "found no current, for which --kt gives the torque"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_what_is_wrong_is_said_in_a_sentence(case, written, seen, tmp_path):
    changed, options, said = BAD[case]
    ways = {"turned": lambda values: -values, "wrapped": lambda values: np.mod(values, 2 * np.pi), "none": lambda values: None}
    made = {name: ways[way](seen[name]) for name, way in changed.items()}
    told = call(["fit", str(written(**made)), *options], tmp_path)
    assert told.code == 2
    assert told.err.count("\n") == 1
    assert re.search(said, told.err), told.err


def test_torque_in_percent_is_refused(written, tmp_path):
    told = call(["fit", str(written("t,torque [%],motor,link")), "--ratio", "50"], tmp_path)
    assert told.code == 2
    assert 'the unit "%", wanted one of N m' in told.err
    assert "--scale torque=FACTOR" in told.err


def test_a_drive_beside_another_experiment_is_refused(written, tmp_path):
    told = call(["fit", str(written()), "--columns", "x=motor,torque=torque,link=link"], tmp_path)
    assert told.code == 2
    assert "not two experiments in one" in told.err


def test_a_model_of_a_drive_is_simulated_with_its_torque(tmp_path):
    rig = jb.drive(6e-5, 1.5e-4, RATIO, 0.08, 0.012, 1500.0, 0.8)
    (tmp_path / "rig.toml").write_text(jb.dump_model(rig))
    words = ["simulate", "rig.toml", "--excitation", "harmonic:amplitude=0.05,frequency=2", "--duration", "2", "--rate", "500"]
    assert call([*words, "--out", "run.csv"], tmp_path).code == 0
    made = jb.read_record(tmp_path / "run.csv", ratio=RATIO)
    assert made.kind == "drive"
    again = ["simulate", "rig.toml", "--excitation", "run.csv", "--rate", "500", "--out", "again.csv"]
    assert call(again, tmp_path).code == 0
    held = jb.read_record(tmp_path / "again.csv", ratio=RATIO)
    # Held, each sample of the torque is half a sample late.
    assert np.std(held.channels["motor"] - made.channels["motor"]) < 0.1 * np.std(made.channels["motor"])


def test_look_tells_a_drive_and_its_gear(written, tmp_path):
    told = call(["look", str(written())], tmp_path)
    assert told.code == 0
    assert "it seems to be a drive: torque at its motor" in told.out
    assert re.search(r"next: jaxbacklash fit \S+ --ratio 5\d", told.out), told.out


@pytest.mark.parametrize(
    ("without", "words"),
    [
        ((), "torque and both encoders: it tells inertia and friction of the motor"),
        (("link",), "does not tell friction of the motor from that of the joint"),
        (("motor",), "ten to a hundred times less sharply"),
    ],
)
def test_what_columns_tell_is_said_before_a_fit(written, without, words):
    with pytest.warns(UserWarning, match=words):
        jb.read_record(written(**dict.fromkeys(without)), ratio=RATIO)
