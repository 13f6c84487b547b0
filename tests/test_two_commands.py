"""From an instrument's file to a fitted play in two commands, the second printed by the first."""

import json
import shlex

import numpy as np
import pytest
from scipy import io

from tests.in_process import call
from tests.odd_files.good import BACKLASH, measured

RECORD = measured(np.random.default_rng(7))
T, X, Z = RECORD.t, RECORD.channels["x"], RECORD.channels["z"]
PAGE = "\n".join


def scope(path):
    """A scope's export: a preamble of its settings, then TIME and two channels."""
    head = ["Model,MDO3024", "Firmware Version,1.30", "", "Horizontal Units,s,,", f"Sample Interval,{T[1] - T[0]:g},,", ",,,"]
    rows = [f"{t:.4f},{x:.7f},{z:.7f}" for t, x, z in zip(T, X, Z)]
    path.write_text(PAGE([*head, "TIME,CH1,CH2", *rows]) + "\n")


def labview(path):
    """A LabVIEW measurement file: two headers, an empty column of comments, times from the header's interval."""
    head = [
        "LabVIEW Measurement\t", "Writer_Version\t2", "Reader_Version\t2", "Separator\tTab", "Decimal_Separator\t.",
        "Multi_Headings\tNo", "X_Columns\tOne", "Time_Pref\tRelative", "Date\t2025/03/05", "Time\t10:03:29.5",
        "***End_of_Header***\t", "", "Channels\t2\t\t", f"Samples\t{T.size}\t{T.size}\t", "Y_Unit_Label\tdeg\tdeg\t",
        "X_Dimension\tTime\tTime\t", "X0\t0.0\t0.0\t",
        f"Delta_X\t{T[1] - T[0]:g}\t{T[1] - T[0]:g}\t", "***End_of_Header***\t\t\t",
    ]  # fmt: skip
    rows = [f"{t:.6f}\t{x:.6f}\t{z:.6f}\t" for t, x, z in zip(T, np.degrees(X), np.degrees(Z))]
    path.write_text(PAGE([*head, "X_Value\tBase\tRelative\tComment", *rows]) + "\n")


def simulink(path):
    """Simulink's structure with time, as a To Workspace block saves it."""
    signals = {"values": np.column_stack([X, Z]), "dimensions": 2.0, "label": "base, relative"}
    io.savemat(path, {"out": {"time": T[:, None], "signals": signals, "blockName": "rig/To Workspace"}})


def controller(path):
    """A robot controller's log: semicolons, decimal commas, milliseconds, degrees in a row of units, a footer."""
    rows = [f"{1e3 * t:.1f};{x:.6f};{y:.6f};0".replace(".", ",") for t, x, y in zip(T, np.degrees(X), np.degrees(X + Z))]
    head = ["Controller KX-4;Trace 17", "Program;BACKLASH_TEST", "Zeit;Motor_A1;Abtrieb_A1;Status", "ms;deg;deg;-"]
    path.write_text(PAGE([*head, *rows, "Ende der Aufzeichnung"]) + "\n", encoding="cp1252")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("write", "name"),
    [(scope, "tek0007.csv"), (labview, "run.lvm"), (simulink, "out.mat"), (controller, "Spur 17.csv")],
    ids=["scope", "LabVIEW", "Simulink", "controller"],
)
def test_two_commands_lead_from_a_file_to_its_play(tmp_path, write, name):
    write(tmp_path / name)
    looked = call(["look", name], tmp_path)
    assert looked.code == 0
    last = looked.out.rstrip().splitlines()[-1]
    assert last.startswith("next: jaxbacklash fit ")
    words = shlex.split(last.removeprefix("next: "))
    fitted = call([*words[1:], "--effects", "gravity", "--json"], tmp_path)
    assert fitted.code == 0, fitted.err
    play = json.loads(fitted.out)["stages"][-1]["parameters"]["backlash"]
    assert abs(play["value"] - BACKLASH) < 3.5 * play["stderr"]
    assert play["stderr"] < 0.01 * BACKLASH
