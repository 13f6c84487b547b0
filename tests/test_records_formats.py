"""Records survive each file format, and text tables are read as people and programs write them."""

import dataclasses
import time

import h5py
import numpy as np
import pytest
from scipy import io

from jaxbacklash.errors import BadInput
from jaxbacklash.records import Record, read_record, write_record

from .test_records import assert_same, motion, record_of, write_table


@pytest.mark.parametrize("suffix", [".csv", ".npz", ".mat"])
def test_what_is_written_reads_back_to_the_last_digit(tmp_path, suffix):
    table = motion()
    record = Record(table["t"], {"x": table["x"], "z": table["z"]}, extras={"speed m/s": np.gradient(table["x"])})
    write_record(record, tmp_path / f"rec{suffix}")
    again = read_record(tmp_path / f"rec{suffix}")
    assert_same(again, record)
    np.testing.assert_array_equal(again.extras["speed m/s"], record.extras["speed m/s"])
    assert [path.name for path in tmp_path.iterdir()] == [f"rec{suffix}"]


@pytest.mark.parametrize("shape", [(-1,), (-1, 1), (1, -1)])
@pytest.mark.parametrize("kind", ["npz", "mat5", "mat7.3", "struct5", "struct7.3"])
def test_arrays_may_be_rows_columns_or_fields_of_a_struct(tmp_path, kind, shape):
    table = {name: values.reshape(shape) for name, values in motion().items()}
    path = tmp_path / ("rec.npz" if kind == "npz" else "rec.mat")
    if kind == "npz":
        np.savez(path, **table)
    elif kind.endswith("5"):
        io.savemat(path, {"data": table, "gain": 3.0} if kind == "struct5" else table)
    else:
        with h5py.File(path, "w", userblock_size=512) as file:
            group = file.create_group("data") if kind == "struct7.3" else file
            for name, values in table.items():
                group[name] = values
    assert_same(read_record(path), record_of())


@pytest.mark.parametrize("transposed", [False, True])
def test_one_matrix_with_its_names_beside_it(tmp_path, transposed):
    data = np.column_stack(list(motion().values()))
    names = ["t_s", "x", "z_rad"]
    np.savez(tmp_path / "rec.npz", data=data.T if transposed else data, columns=np.array(names), rig=4)
    io.savemat(tmp_path / "rec.mat", {"data": data, "columns": np.array(names, dtype=object)})
    for name in ("rec.npz", "rec.mat"):
        assert_same(read_record(tmp_path / name, columns={"t": "t_s", "z": "z_rad"}), record_of())


@pytest.mark.parametrize("suffix", [".csv", ".txt", ".dat", ".tsv", ".CSV"])
@pytest.mark.parametrize("separator", [",", ";", "\t", " ", "   ", ", "])
def test_any_usual_separator(tmp_path, separator, suffix):
    assert_same(read_record(write_table(tmp_path / f"rec{suffix}", motion(), separator=separator)), record_of())


@pytest.mark.parametrize(
    "change",
    [
        lambda text: "\ufeff" + text,
        lambda text: text + "\n\n  \n",
        lambda text: text.rstrip("\n"),
        lambda text: "# rig 4\n\n" + text.replace("\n", "\n# noon\n", 1),
        lambda text: text.replace("\n", "\r\n"),
        lambda text: text.replace("\n", ",\n"),
        lambda text: text.replace("\n", ",\n").replace(",\n", "\n", 1),
        lambda text: text.replace("t,x,z", '"t","x","z"').replace("\n0.002,", '\n"0.002",'),
        lambda text: "# " + text,
        lambda text: text.replace(",", ";").replace(".", ","),
        lambda text: text.replace("0.002,", "0.002 ,"),
    ],
)
def test_tables_as_people_and_programs_write_them(tmp_path, change):
    path = write_table(tmp_path / "rec.csv", motion())
    path.write_bytes(change(path.read_text()).encode())
    assert_same(read_record(path), record_of())


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_the_encodings_of_spreadsheets(tmp_path, encoding):
    path = write_table(tmp_path / "rec.csv", motion() | {"µm": motion()["x"]})
    path.write_bytes(path.read_text().encode(encoding))
    assert read_record(path).extras.keys() == {"µm"}


def test_columns_nobody_asked_for_are_kept_whatever_they_hold(tmp_path):
    table = motion()
    state = ["run"] * 999 + ["stop"]
    path = write_table(tmp_path / "rec.csv", table | {"state": state, "temp": ["", *["21.5"] * 999], "empty": [""] * 1000})
    record = read_record(path)
    assert_same(record, record_of())
    assert record.extras.keys() == {"state", "temp"}
    assert list(record.extras["state"]) == state
    np.testing.assert_array_equal(record.extras["temp"], [np.nan, *[21.5] * 999])
    write_record(record, tmp_path / "again.csv")
    assert list(read_record(tmp_path / "again.csv").extras["state"]) == state


def test_a_failed_write_leaves_nothing_behind(tmp_path):
    record = dataclasses.replace(record_of(), extras={"boxed": np.array([None] * 1000)})
    with pytest.raises(ValueError, match="Object arrays"):
        write_record(record, tmp_path / "rec.npz")
    with pytest.raises(BadInput, match="cannot be written"):
        write_record(record_of(), tmp_path / "absent" / "rec.csv")
    with pytest.raises(BadInput, match=r"wanted one of \.csv"):
        write_record(record_of(), tmp_path / "rec.xlsx")
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_ten_minutes_at_5_khz_take_seconds(tmp_path):
    table = motion(3_000_000, 5000.0)
    write_record(Record(table.pop("t"), table), tmp_path / "rec.csv")
    start = time.perf_counter()
    read_record(tmp_path / "rec.csv")
    assert time.perf_counter() - start < 10
