"""Units are found in column names where they cannot be anything else."""

import pytest

from jaxbacklash.records.header_units import is_unit, split_unit


@pytest.mark.parametrize(
    ("name", "bare", "unit"),
    [
        ("Time [s]", "Time", "s"),
        ("Time[ms]", "Time", "ms"),
        ("x (deg)", "x", "deg"),
        ("Angle (°)", "Angle", "°"),
        ("z/rad", "z", "rad"),
        ("phi / deg", "phi", "deg"),
        ("v / (m/s)", "v", "m/s"),
        ("torque, Nm", "torque", "Nm"),
        ("Time, s", "Time", "s"),
        ("Force;N", "Force", "N"),
        ("C1 in V", "C1", "V"),
        ("in s", "", "s"),
        ("Zeit [ms]", "Zeit", "ms"),
        ("Pos_deg", "Pos", "deg"),
        ("t_ms", "t", "ms"),
        ("time_s", "time", "s"),
        ("motor_torque_Nm", "motor_torque", "Nm"),
        ("speed_rad_s", "speed", "rad/s"),
        ("omega_deg_per_s", "omega", "deg/s"),
        ("acc_m_s2", "acc", "m/s^2"),
        ("angleDeg", "angle", "deg"),
        ("Position <mm>", "Position", "mm"),
        ("Time (s) Run #1", "Time Run #1", "s"),
        ("x [counts/rev]", "x", "counts/rev"),
        ("x [gon]", "x", "gon"),
        ("x [Strich]", "x", "Strich"),
        ("Speed (rad/s)", "Speed", "rad/s"),
        ("Torque (N·m)", "Torque", "N·m"),
        ("Torque [lbf-in]", "Torque", "lbf-in"),
        ("Angle deg", "Angle", "deg"),
        ("Accel (m/s²)", "Accel", "m/s²"),
        ("Time (milliseconds)", "Time", "milliseconds"),
        ("Time (sec)", "Time", "sec"),
    ],
)
def test_a_unit_in_a_name_is_split_off(name, bare, unit):
    assert split_unit(name) == (bare, unit)


@pytest.mark.parametrize(
    "name",
    [
        "t",
        "x",
        "theta_m",
        "x_in",
        "z_min",
        "x_rev",
        "F_N",
        "x_s",
        "Encoder (left)",
        "Position (actual)",
        "Channel [0]",
        "Channel [1, 2]",
        "signals(1)",
        "rig/z",
        "m/s",
        "data.pos[3]",
        "Motor, left",
        "x in base",
        "column 3",
        "status",
        "Rad",
        "",
    ],
)
def test_what_may_be_a_name_stays_one(name):
    assert split_unit(name) == (name, "")


@pytest.mark.parametrize(
    "text", ["s", "ms", "µs", "deg", "°", "rad/s^2", "mm/s²", "N m", "N*m", "Nm", "kN", "counts", "1/s", "m/s/s", "oz-in"]
)
def test_units(text):
    assert is_unit(text)


@pytest.mark.parametrize("text", ["left", "x", "t", "1", "", "12", "CH1", "base", "position", "a long text that is none", "y"])
def test_what_is_no_unit(text):
    assert not is_unit(text)
