"""Models handed on to other simulators: MuJoCo moves as the model does; what a target cannot carry is refused."""

import re

import numpy as np
import pytest

import jaxbacklash as jb

from .in_process import call

SECONDS = 2.0


def rig(**laws):
    return jb.drive(6e-5, 1.5e-4, 50.0, 0.08, 0.012, 1500.0, 0.8).with_effects(*laws.values())


def push(t):
    return 0.05 * np.sin(2 * np.pi * 3.0 * t) + 0.03 * np.sin(2 * np.pi * 8.0 * t + 1.0)


def in_mujoco(system, torque):
    """Relative motion z [rad] every millisecond under a torque held for as long."""
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is an extra: pip install jaxbacklash[mujoco]")
    model = mujoco.MjModel.from_xml_string(jb.exported(system, "mjcf"))
    data = mujoco.MjData(model)
    z = []
    for held in torque:
        data.ctrl[:] = held
        mujoco.mj_forward(model, data)
        z.append(data.ten_length[0])
        mujoco.mj_step(model, data, nstep=round(1e-3 / model.opt.timestep))
    return np.array(z)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("laws", "share"),
    [
        ({}, 2e-3),
        ({"weight": jb.Gravity(-2.0, 0.3), "preload": jb.Preload(0.1)}, 5e-3),
        ({"weight": jb.Gravity(1.5)}, 2e-3),
        ({"off": jb.AsymmetricGap(0.001), "inside": jb.GapSpring(5.0)}, 1e-2),
        ({"rubs": jb.CoulombMotor(0.01)}, 5e-3),
    ],
    ids=["joint", "hanging", "upright", "gap", "friction"],
)
def test_mujoco_moves_as_the_model(laws, share):
    torque = push(np.arange(int(1000 * SECONDS)) / 1000.0)
    system = rig(**laws)
    other = in_mujoco(system, torque)
    seen = jb.simulate(system, jb.HeldTorque(0.0, 1e-3, torque), duration=SECONDS - 1e-3, rate=4000.0)
    motor, link = np.asarray(seen.observed)[::4].T
    own = link - motor / 50.0
    assert np.std(own) > 0.3 * 0.012
    # As shares of the play; MuJoCo steps over an edge of the play without looking for it.
    assert np.max(np.abs(other - own)) < share * 0.012


def test_a_link_that_a_force_drives():
    base = jb.base_motion_joint(3.16, 0.026, 15000.0, 20.0)
    system = jb.System(base.inertia, base.contact, base.damper, observed="y")
    text = jb.exported(system, "mjcf")
    assert '<motor name="F" joint="link"/>' in text
    assert "motor" not in jb.exported(system, "modelica")


@pytest.mark.parametrize("target", ["mjcf", "modelica"])
def test_what_no_target_can_carry_is_refused(target):
    with pytest.raises(jb.BadInput, match="moves as prescribed"):
        jb.exported(jb.base_motion_joint(3.16, 0.026, 15000.0, 20.0), target)
    with pytest.raises(jb.BadInput, match=f"cubic_stiffness has no exact place in {target}"):
        jb.exported(rig(cubic=jb.CubicStiffness(1e6)), target)


def test_modelica_has_every_part_that_it_connects():
    text = jb.exported(rig(weight=jb.Gravity(-2.0), rubs=jb.CoulombMotor(0.01), inside=jb.GapSpring(5.0)), "modelica")
    parts = set(re.findall(r"^  [A-Z][\w.]+ (\w+)", text, flags=re.MULTILINE))
    joined = {end.partition(".")[0] for pair in re.findall(r"connect\((.+), (.+)\);", text) for end in pair}
    assert joined == parts
    assert "ElastoBacklash contact(c=1500.0, d=0, b=0.012, phi_rel0=0.0)" in text
    assert "gear(ratio=50.0)" in text


def test_the_command(tmp_path):
    (tmp_path / "rig.toml").write_text(jb.dump_model(rig()))
    told = call(["export", "rig.toml", "--to", "mjcf", "--out", "rig.xml"], tmp_path)
    assert told.code == 0, told.err
    assert (tmp_path / "rig.xml").read_text() == jb.exported(rig(), "mjcf")
    assert call(["export", "rig.toml", "--to", "modelica"], tmp_path).out == jb.exported(rig(), "modelica")
    for words, said in (
        (["--to", "urdf"], "--to urdf: not a target, wanted mjcf or modelica"),
        (["--to", ""], "names no target"),
    ):
        refused = call(["export", "rig.toml", *words], tmp_path)
        assert refused.code == 2
        assert said in refused.err
        assert refused.err.count("\n") == 1
