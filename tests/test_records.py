"""Names, units and kinds of records; what is odd about them; measured data."""

import warnings
from pathlib import Path

import numpy as np
import pytest

from jaxbacklash.errors import BadInput
from jaxbacklash.records import Record, parse_columns, parse_scales, parse_units, read_record

REAL = Path(__file__).parents[1] / ".." / "shared" / "real"
needs_real = pytest.mark.skipif(not REAL.exists(), reason="the measured data are not part of the project")


def motion(samples: int = 1000, rate: float = 500.0) -> dict[str, np.ndarray]:
    t = np.arange(samples) / rate
    noise = np.random.default_rng(3).normal(scale=3e-5, size=(2, samples))
    return {"t": t, "x": 0.1 * np.sin(13 * t) + noise[0], "z": 0.05 * np.sin(29 * t + 0.4) + noise[1]}


def record_of(**channels) -> Record:
    table = motion()
    channels = channels or {"x": table["x"], "z": table["z"]}
    return Record(table["t"], channels)


def write_table(path: Path, table: dict, template: str = "{}", separator: str = ",") -> Path:
    rows = zip(*table.values(), strict=True)
    lines = [separator.join(table), *(separator.join(template.format(value) for value in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n")
    return path


def assert_same(record: Record, other: Record, rtol: float = 0.0) -> None:
    assert record.channels.keys() == other.channels.keys()
    np.testing.assert_allclose(record.t, other.t, rtol=rtol, atol=0)
    for name in other.channels:
        np.testing.assert_allclose(record.channels[name], other.channels[name], rtol=rtol, atol=0)


# ---- Names and units ----


def test_mapped_names_free_the_column_of_that_name(tmp_path):
    table = motion()
    path = write_table(tmp_path / "rec.csv", {"time": table["t"], "x": table["z"], "enc 1": table["x"], "z": 0 * table["x"]})
    record = read_record(path, columns=parse_columns("t=time, x=enc 1,z=x"))
    assert_same(record, record_of())
    assert record.extras.keys() == {"z (unmapped)"}


def test_units_and_scales_multiply(tmp_path):
    table = motion()
    table = {"t": 1e3 * table["t"], "x": np.rad2deg(table["x"]), "z": table["z"] * 1e6 / 2, "T": table["x"]}
    record = read_record(
        write_table(tmp_path / "rec.csv", table),
        units=parse_units(["t=ms,x=deg", "z=µrad,T=kip"]),
        scales=parse_scales("z=2"),
    )
    assert record.kind == "base_motion"
    assert_same(record.replace(T=table["x"]), record_of(**{name: motion()[name] for name in "xz"} | {"T": table["x"]}), 1e-12)
    np.testing.assert_allclose(record.channels["T"], 4448.2216152605 * table["T"])


@pytest.mark.parametrize(("text", "unit"), [("Nm", "N m"), ("N*m", "N m"), ("N.m", "N m"), ("kN m", "kN m"), ("Nmm", "N mm")])
def test_a_torque_has_several_spellings(text, unit):
    assert parse_units(f"F={text}") == {"F": unit}


def test_a_stated_unit_is_believed(tmp_path):
    table = motion()
    path = write_table(tmp_path / "rec.csv", table | {"x": 200 * table["x"], "t": 500 * table["t"]})
    assert read_record(path, units={"x": "rad", "t": "s"}).dt == pytest.approx(1.0)
    with pytest.raises(BadInput, match=r"looks like milliseconds \(1000 Hz\).*--unit t=ms, or --unit t=s"):
        read_record(path, units={"x": "rad"})
    with pytest.raises(BadInput, match="--unit x=deg"):
        read_record(path, units={"t": "s"})


# ---- The record itself ----


@pytest.mark.parametrize(
    ("names", "kind", "driven", "observed"),
    [
        ("xz", "base_motion", "x", "z"),
        ("xy", "base_motion", "x", "y"),
        ("xzy", "base_motion", "x", "z"),
        ("Fy", "force", "F", "y"),
        ("Fz", "force", "F", "z"),
        ("z", "free_decay", None, "z"),
        ("y", "free_decay", None, "y"),
        ("xT", "transmitted", "x", "T"),
    ],
)
def test_the_channels_tell_the_experiment(names, kind, driven, observed):
    table = motion()
    values = {"x": table["x"], "z": table["z"], "y": table["x"] + table["z"], "F": table["x"], "T": table["z"]}
    record = record_of(**{name: values[name] for name in names})
    assert (record.kind, record.input_name, record.observed_name) == (kind, driven, observed)
    assert ("y" in record.extras) == (names == "xzy")


def test_a_record_says_what_it_is():
    record = record_of()
    assert (record.samples, record.dt, record.rate_hz) == (1000, pytest.approx(0.002), pytest.approx(500.0))
    assert record.summary() == "record: base motion, channels t x z, 1000 samples at 500 Hz, 1.998 s"
    part = record.between(0.3, 1.1)
    assert (part.t[0], part.t[-1], part.samples) == (pytest.approx(0.3), pytest.approx(1.1), 401)
    with pytest.raises(BadInput, match="no samples between 5 s and 6 s"):
        record.between(5, 6)
    with pytest.raises(BadInput, match="column z: found 0 in every row"):
        record.replace(z=np.zeros(1000))


def test_oddities_are_warned_of_and_a_coarse_encoder_is_none(tmp_path):
    table = motion(5000)
    clipped = table | {"z": np.clip(table["z"], -0.03, 0.03)}
    rows = np.arange(5000)
    held = {name: values[np.where(rows % 500 > 480, rows // 500 * 500 + 480, rows)] for name, values in table.items()}
    contrary = table | {"y": table["x"] + 0.7 * table["z"]}
    for change, text in [
        (clipped, "looks clipped"),
        (held | {"t": table["t"]}, "look lost"),
        (contrary, "differs from y - x"),
    ]:
        with pytest.warns(UserWarning, match=text):
            read_record(write_table(tmp_path / "rec.csv", change))
    with pytest.raises(BadInput, match="three axes"):
        read_record(write_table(tmp_path / "rec.csv", table | {"y": table["z"]}))
    coarse = {name: np.round(values / 2e-3) * 2e-3 for name, values in table.items()}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read_record(write_table(tmp_path / "rec.csv", coarse | {"t": table["t"]}))


# ---- Measured data ----


@needs_real
@pytest.mark.shared
def test_friction_damper_with_play_reads_with_its_own_names():
    path = sorted((REAL / "ARTS").glob("*.npz"))[0]
    record = read_record(path, columns=parse_columns("t=t_s,x=x_in,T=F_kip"), units=parse_units("x=in,T=kip"))
    assert (record.kind, record.rate_hz) == ("transmitted", pytest.approx(1024))
    assert np.abs(record.channels["x"]).max() == pytest.approx(0.0127, rel=0.05)
    assert 1e4 < np.abs(record.channels["T"]).max() < 1e5
    assert record.extras.keys() == {"v_inps", "Fact1_lb", "Fact2_lb"}


@needs_real
@pytest.mark.shared
@pytest.mark.parametrize("name", ["DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"])
def test_servo_axis_reads_though_its_clock_counts_ticks(name):
    columns, scales = parse_columns("t=t,F=vir,y=qm"), parse_scales("F=35.15065")
    record = read_record(REAL / "EMPS" / name, columns=columns, scales=scales)
    assert (record.kind, record.samples, record.rate_hz) == ("force", 24841, pytest.approx(1000, rel=1e-9))
    assert {"qg"} <= record.extras.keys()
