"""A rate that is stated beside a column of times: what contradicts it, and what to paste then."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from jaxbacklash.errors import BadInput
from jaxbacklash.records.files import read_table
from jaxbacklash.records.options import ReadOptions
from jaxbacklash.records.reader import record_of
from jaxbacklash.records.remedies import applied

RATE = 500.0
ROWS = np.arange(3000)
EVEN = ROWS / RATE
BURSTS = ROWS // 10 * 10 / RATE + ROWS % 10 * 2e-5
REPEATED = ROWS // 10 * 10 / RATE

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")


def written(folder: Path, t: np.ndarray, header: str = "t,x,z") -> Path:
    """A file of base motion at these times."""
    moved = np.arange(t.size) / RATE
    noise = 1e-5 * np.random.default_rng(0).standard_normal((2, t.size))
    x, z = 0.1 * np.sin(9.0 * moved) + noise[0], 0.02 * np.cos(17.0 * moved) + noise[1]
    path = folder / "run.csv"
    rows = (",".join(f"{value:.9g}" for value in row) for row in zip(t, x, z, strict=True))
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def read(path: Path, options: ReadOptions):
    return record_of(read_table(path, options), options, path.name)


def refused(path: Path, options: ReadOptions) -> BadInput:
    with pytest.raises(BadInput) as caught:
        read(path, options)
    return caught.value


@pytest.mark.parametrize("t", [EVEN, BURSTS, REPEATED], ids=["even", "bursts", "repeated"])
@pytest.mark.parametrize(("stated", "factor", "true"), [("ms", 1.0, "s"), ("s", 1e3, "ms"), ("", 1e3, "ms"), ("us", 1.0, "s")])
def test_a_unit_that_alone_explains_the_difference_is_what_to_paste(tmp_path, t, stated, factor, true):
    path = written(tmp_path, factor * t, f"t [{stated}],x,z" if stated else "t,x,z")
    options = ReadOptions(rate=RATE)
    why = refused(path, options)
    assert why.remedy == f"--unit t={true}"
    assert why.remedy in str(why)
    assert read(path, applied(options, why.remedy)).rate_hz == pytest.approx(RATE, rel=1e-9)


def test_another_rate_is_refused_with_that_of_the_times(tmp_path):
    why = refused(written(tmp_path, EVEN * RATE / 490.0), ReadOptions(rate=RATE))
    assert "--rate 490" in str(why)
    assert not why.remedy


@pytest.mark.parametrize("size", [10, 16, 25])
@pytest.mark.parametrize("apart", [0.0, 2e-5], ids=["repeated", "bursts"])
def test_a_short_record_may_begin_or_end_within_a_packet(tmp_path, size, apart):
    """Its first and last stamp tell its length to a packet only: 300 rows in packets of 16 look like 519 Hz."""
    rows = np.arange(300)
    path = written(tmp_path, rows // size * size / RATE + rows % size * apart)
    assert read(path, ReadOptions(rate=RATE)).rate_hz == pytest.approx(RATE, rel=1e-9)
    assert "one rate" in str(refused(path, ReadOptions(rate=1.25 * RATE)))


@pytest.mark.parametrize("header", ["t,x,z", "t [samples],x,z", "t [counts],x,z"])
def test_a_count_of_rows_contradicts_no_rate(tmp_path, header):
    path = written(tmp_path, ROWS.astype(float), header)
    assert read(path, ReadOptions(rate=RATE)).rate_hz == pytest.approx(RATE, rel=1e-9)


def test_a_count_of_something_else_does(tmp_path):
    assert "one rate" in str(refused(written(tmp_path, 7.0 * ROWS), ReadOptions(rate=RATE)))


@pytest.mark.parametrize(("header", "factor", "unit"), [("t [mrad],x,z", 1.0, "s"), ("t [mrad],x,z", 1e3, "ms")])
def test_a_unit_of_no_time_is_refused_with_text_that_can_be_pasted(tmp_path, header, factor, unit):
    path = written(tmp_path, factor * EVEN, header)
    why = str(refused(path, ReadOptions()))
    assert "--rate HZ" in why
    assert f"--unit t={unit}" in why
    assert read(path, ReadOptions(units={"t": unit})).rate_hz == pytest.approx(RATE, rel=1e-9)
    assert read(path, ReadOptions(rate=RATE)).rate_hz == pytest.approx(RATE, rel=1e-9)


@pytest.mark.parametrize("t", [BURSTS, REPEATED], ids=["bursts", "repeated"])
@pytest.mark.parametrize(("header", "factor"), [("t,x,z", 1e3), ("t [ms],x,z", 1.0), ("t [ms],x,z", 1e3), ("t,x,z", 1.0)])
def test_what_is_offered_for_packets_leads_to_the_rate_of_the_samples(tmp_path, t, header, factor):
    """The unit comes before the rate, which is a thousand times off where the unit is."""
    path, options = written(tmp_path, factor * t, header), ReadOptions()
    for _ in range(2):
        try:
            record = read(path, options)
            break
        except BadInput as why:
            options = applied(options, why.remedy)
    else:
        record = read(path, options)
    assert record.rate_hz == pytest.approx(RATE, rel=1e-9)


def test_lost_rows_are_said_though_the_times_are_not_used(tmp_path):
    path = written(tmp_path, np.delete(np.arange(3010) / RATE, slice(1000, 1010)))
    with pytest.warns(UserWarning, match="a gap of 0.022 s between rows 1000 and 1001: where rows were lost"):
        read(path, ReadOptions(rate=RATE))
    for t in (EVEN, BURSTS, REPEATED, np.round(ROWS / RATE, 2), np.floor(1e3 * ROWS / 800.0) / 1e3):
        with pytest.warns(UserWarning, match="not used") as said:
            read(written(tmp_path, t), ReadOptions(rate=800.0 if t[-1] < 4.0 else RATE))
        assert not any("gap" in str(one.message) for one in said)


def test_a_second_clock_keeps_the_unit_that_it_states(tmp_path):
    path = tmp_path / "two.csv"
    x, z = 0.1 * np.sin(9.0 * EVEN), 0.02 * np.cos(17.0 * EVEN)
    table = np.column_stack([EVEN, x, 1e3 * EVEN, z + 1e-5 * np.random.default_rng(0).standard_normal(EVEN.size)])
    np.savetxt(path, table, delimiter=",", header="Time,x,Time [ms],z", comments="")
    options = ReadOptions(columns={"t": "#1"}, units={"t": "s"})
    assert read(path, options).rate_hz == pytest.approx(RATE, rel=1e-9)
    # One that states none is in the unit that is said of t.
    np.savetxt(path, table * [1e3, 1.0, 1.0, 1.0], delimiter=",", header="Time,x,Time,z", comments="")
    both = dataclasses.replace(options, units={"t": "ms"})
    assert read(path, both).rate_hz == pytest.approx(RATE, rel=1e-9)


@pytest.mark.parametrize("t", [np.full(80, np.nan), np.array([0.0]), np.array([0.0, np.nan, 2.0])], ids=["none", "one", "three"])
def test_a_unit_of_no_time_over_hardly_any_times_is_refused_too(tmp_path, t):
    assert "--rate HZ" in str(refused(written(tmp_path, t, "t [mrad],x,z"), ReadOptions()))


@pytest.mark.parametrize("t", [REPEATED, np.where(ROWS == 900, EVEN[899], EVEN), np.where(ROWS == 900, EVEN[890], EVEN)])
def test_missing_cells_over_times_that_do_not_go_on_are_no_crash(tmp_path, t):
    path = written(tmp_path, t)
    lines = path.read_text().splitlines()
    lines[500] = lines[500].rpartition(",")[0] + ",nan"
    path.write_text("\n".join(lines) + "\n")
    why = refused(path, ReadOptions(resample=True))
    assert "column t" in str(why)
    assert "--rate 500" in str(why)
    record = read(path, ReadOptions(resample=True, rate=RATE))
    assert np.isfinite(record.channels["z"]).all()
