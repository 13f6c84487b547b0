"""Every format through `look` and `fit`: the play of a simulated joint is found from each, whatever wrote the file."""

import json

import numpy as np
import pytest
from scipy import io

from jaxbacklash import base_motion_joint, simulate
from jaxbacklash.effects import Gravity
from jaxbacklash.excitation import Multisine
from jaxbacklash.records.formats.guard import quiet
from jaxbacklash.simulation import as_record

from .in_process import call
from .logger_files import NAMED, RADIANS, WRITERS

PLAY = 0.024


def write_npz(path, table):
    np.savez(path, **{name: values if name == "t" else np.radians(values) for name, values in table.items()})


def write_npy(path, table):
    np.save(path, np.column_stack([table["t"], np.radians(table["x"]), np.radians(table["z"])]))


def write_struct(path, table):
    """Simulink's structure with time, two signals with labels."""
    signals = np.empty((1, 2), dtype=[("values", "O"), ("label", "O")])
    for number, name in enumerate(("x", "z")):
        signals[0, number] = (np.radians(table[name])[:, None], name)
    io.savemat(path, {"simout": {"time": table["t"][:, None], "signals": signals}})


def write_timetable(path, table):
    import matio
    import pandas

    motions = pandas.DataFrame({name: np.radians(table[name]) for name in ("x", "z")})
    matio.save_to_mat(str(path), {"TT": motions.set_index(pandas.to_timedelta(table["t"], unit="s"))}, version="v7.3")


def write_lvm(path, table):
    rows = ["\t".join(f"{value:.9f}" for value in row) for row in zip(*table.values(), strict=True)]
    head = ["LabVIEW Measurement", "Writer_Version\t2", "Separator\tTab", "Decimal_Separator\t.", "X_Columns\tOne"]
    head += ["Time_Pref\tRelative", "***End_of_Header***", "", "Channels\t2", f"Samples\t{len(rows)}\t{len(rows)}"]
    head += ["X_Dimension\tTime\tTime", "Delta_X\t0.002\t0.002", "***End_of_Header***", "X_Value\tx [deg]\tz [deg]\tComment"]
    path.write_text("\n".join(head + rows) + "\n")


FILES = WRITERS | {
    "rec.npz": write_npz,
    "rec.npy": write_npy,
    "struct.mat": write_struct,
    "table.mat": write_timetable,
    "rec.lvm": write_lvm,
}
COLUMNS = {name: f"x={x},z={z}" for name, (x, z) in NAMED.items()} | {
    "rec.xlsx": "",
    "rec.npy": "t=#1,x=#2,z=#3",
    "rec.tdms": "x=Log/x,z=Log/z",
    "rec.h5": "t=run/t,x=run/x,z=run/z",
    "struct.mat": "t=time,x=signals(1).values,z=signals(2).values",
    "table.mat": "t=Time",
    "rec.lvm": "t=X_Value",
}


@pytest.fixture(scope="module")
def table():
    """Times [s] and motions [deg] of a hanging link with play, measured with noise."""
    system = base_motion_joint(3.0, PLAY, 12000.0, 15.0).with_effects(Gravity(-30.0))
    drive = Multisine(np.array([0.05, 0.03, 0.02]), 2 * np.pi * np.array([1.1, 2.7, 4.3]), 0.3 * np.arange(3))
    record = as_record(simulate(system, drive, duration=6.0, rate=500.0), system)
    rng = np.random.default_rng(11)
    noisy = {name: np.degrees(record.channels[name] + 3e-5 * rng.standard_normal(record.t.size)) for name in ("x", "z")}
    return {"t": np.arange(record.t.size) / 500.0, **noisy}


@pytest.mark.slow
@pytest.mark.parametrize("name", FILES)
def test_each_format_through_look_and_fit(tmp_path, name, table):
    path = tmp_path / name
    with quiet():
        FILES[name](path, table)

    def run(*words):
        told = call([str(word) for word in words], tmp_path)
        assert told.code == 0, told.err
        return told

    looked = json.loads(run("look", path, "--json").out)
    assert looked["rate_hz"] == pytest.approx(500.0, rel=1e-6)
    assert looked["rows"] == table["t"].size
    assert len(looked["columns"]) >= 2
    columns = ["--columns", COLUMNS[name]] if COLUMNS.get(name) else []
    units = ["--unit", "x=deg,z=deg"] if name == "rec.wav" else []
    told = run("fit", path, "--inertia", 3, "--effects", "gravity", "--json", *columns, *units)
    found = json.loads(told.out)
    low, high = found["stages"][0]["parameters"]["backlash"]["ci95"]
    assert low < PLAY < high
    assert high - low < 0.02 * PLAY
    if name not in RADIANS | {"rec.wav", "rec.npz", "rec.npy", "struct.mat", "table.mat"}:
        assert "deg" in told.err
