"""Workbooks, JSON and HDF5 as people and programs fill them, with titles, several sheets, dates and formulas; hostile ones."""

import datetime
import json
import struct
import zipfile

import h5py
import numpy as np
import pytest
from openpyxl import Workbook

from .logger_files import course, write_xlsx
from .test_formats import refused, table_of

ROWS = [[float(value) for value in row] for row in zip(*course(120).values(), strict=True)]
T, X, Z = np.array(ROWS).T


def workbook(path, **sheets):
    """A workbook of sheets, each a list of rows."""
    book = Workbook()
    book.remove(book.active)
    for title, rows in sheets.items():
        sheet = book.create_sheet(title)
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


def test_a_header_below_a_title_with_units_in_a_row_of_their_own_and_a_sheet_of_notes(tmp_path):
    data = [["Test 4"], [], ["Time", "Base", "Rel"], ["s", "deg", "deg"], *ROWS, [], ["mean", 0.0, 1.0]]
    table = table_of(workbook(tmp_path / "rec.xlsx", Notes=[["Rig", 4], ["Operator", "me"]], Data=data))
    assert table.names == ["Time", "Base", "Rel"]
    assert [column.unit for column in table.columns] == ["s", "deg", "deg"]
    np.testing.assert_array_equal(table.called("Rel")[0].values, Z)
    assert table.place(0) == "row 1 (line 5)"
    assert "Notes" in table.left_out
    assert any("row 1 above the table" in note for note in table.notes)
    assert not any("line" in note for note in table.notes)


def test_two_sheets_with_tables_give_groups(tmp_path):
    first, second = [["t", "x"], *[row[:2] for row in ROWS]], [["t", "z"], *[[row[0], row[2]] for row in ROWS]]
    table = table_of(workbook(tmp_path / "rec.xlsx", **{"run A": first, "B": second}))
    assert table.names == ["run A/t", "run A/x", "B/t", "B/z"]
    np.testing.assert_array_equal(table.called("z")[0].values, Z)


def test_dates_times_of_day_numbers_as_text_errors_and_gaps(tmp_path):
    begin = datetime.datetime(2024, 5, 1, 12)
    columns = ["when", "day", "x", "z"]
    rows = []
    for number, (t, x, z) in enumerate(ROWS):
        moment = begin + datetime.timedelta(seconds=t)
        rows.append([moment, moment.time(), f"{x:.6f}".replace(".", ","), "#N/A" if number == 5 else None if number == 7 else z])
    table = table_of(workbook(tmp_path / "rec.xlsx", S=[columns, *rows]))
    when, day, x, z = (column.values for column in table.columns)
    assert when[3].startswith("2024-05-01T12:00:00.015")
    assert day[3].startswith("12:00:00.015")
    np.testing.assert_allclose(x, X, atol=1e-12)
    assert list(np.flatnonzero(np.isnan(z))) == [5, 7]
    np.testing.assert_array_equal(z[8:], Z[8:])


def test_a_number_as_text_that_can_be_read_in_two_ways_is_refused(tmp_path):
    rows = [[t, f"1,{100 + number}", z] for number, (t, _, z) in enumerate(ROWS)]
    path = workbook(tmp_path / "rec.xlsx", S=[["t", "x", "z"], *rows])
    refused(path, "sheet S, row 2, column x", '"1,100"', "--decimal")
    from jaxbacklash.records.formats import reader_for

    np.testing.assert_allclose(reader_for(path)(path, decimal=",").called("x")[0].values, 1.1 + np.arange(120) / 1000)
    np.testing.assert_allclose(reader_for(path)(path, decimal=".").called("x")[0].values, 1100.0 + np.arange(120))


@pytest.mark.parametrize("both", [True, False])
def test_formulas_without_results_are_named_by_their_cell(tmp_path, both):
    rows = [[t, f"=A{number}*2", f"=A{number}*3" if both else z] for number, (t, _, z) in enumerate(ROWS, start=2)]
    refused(workbook(tmp_path / "rec.xlsx", S=[["t", "x", "z"], *rows]), "sheet S", "=A2*2", "cell B2", "save it again")


def test_a_workbook_with_macros_and_an_empty_one(tmp_path):
    write_xlsx(tmp_path / "rec.xlsx", course())
    path = (tmp_path / "rec.xlsx").rename(tmp_path / "rec.xlsm")
    assert table_of(path).names == ["t [s]", "x [deg]", "z [deg]"]
    refused(workbook(tmp_path / "empty.xlsx", S=[[]]), "empty sheets")


def test_hostile_workbooks(tmp_path):
    write_xlsx(tmp_path / "good.xlsx", course(70))
    with zipfile.ZipFile(tmp_path / "good.xlsx") as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    sheet = next(name for name in members if name.endswith("sheet1.xml"))
    lol = b"<!DOCTYPE b [<!ENTITY a0 'ha'>" + b"".join(
        b"<!ENTITY a%d '%s'>" % (level, b"&a%d;" % (level - 1) * 10) for level in range(1, 10)
    )
    bomb = members[sheet].replace(b"<worksheet", lol + b"]><worksheet", 1).replace(b"<v>0</v>", b"<v>&a9;</v>")
    far = members[sheet].replace(b'r="A3"', b'r="XFD1048576"')
    for name, content in {"bomb": bomb, "far": far, "text": b"t,x,z", "half": members[sheet][:900]}.items():
        with zipfile.ZipFile(tmp_path / f"{name}.xlsx", "w", zipfile.ZIP_DEFLATED) as archive:
            for member, data in members.items():
                archive.writestr(member, content if member == sheet else data)
    refused(tmp_path / "bomb.xlsx", "found", "wanted")
    refused(tmp_path / "text.xlsx", "damaged")
    refused(tmp_path / "half.xlsx", "damaged")
    # A cell that stands far out leaves its own place empty, and nothing else is lost.
    assert list(np.flatnonzero(np.isnan(table_of(tmp_path / "far.xlsx").columns[0].values))) == [1]
    data = bytearray((tmp_path / "good.xlsx").read_bytes())
    place = data.rfind(b"PK\x01\x02")
    data[place + 24 : place + 28] = struct.pack("<I", 2**31)
    (tmp_path / "good.xlsx").write_bytes(data)
    refused(tmp_path / "good.xlsx", "2.148 GB", "once unpacked")


JSON_FORMS = {
    "arrays by name": {"t": T.tolist(), "x": X.tolist(), "z": Z.tolist(), "rig": 4},
    "objects": [{"t": t, "x": x, "z": z} for t, x, z in ROWS],
    "objects below a name": {"samples": [{"t": t, "x": x, "z": z} for t, x, z in ROWS], "fs": 200},
    "groups": {"run": {"t": T.tolist(), "rig": {"x": X.tolist(), "z": Z.tolist()}}},
    "split": {"columns": ["t", "x", "z"], "index": list(range(120)), "data": ROWS},
    "split by name": {"names": ["t", "x", "z"], "values": [T.tolist(), X.tolist(), Z.tolist()]},
    "by row number": {name: {str(row): value for row, value in enumerate(values)} for name, values in zip("txz", (T, X, Z))},
    "rows below names": [["t", "x", "z"], *ROWS],
    "channels": {"channels": [{"name": name, "values": values.tolist()} for name, values in zip("txz", (T, X, Z))]},
    "series": {"results": [{"series": [{"name": "rig", "columns": ["t", "x", "z"], "values": ROWS}]}]},
    "with units": {name: {"unit": "deg", "data": values.tolist()} for name, values in zip("txz", (T, X, Z))},
    "numbers as text": {"t": [str(value) for value in T], "x": X.tolist(), "z": Z.tolist()},
}


@pytest.mark.parametrize("form", JSON_FORMS)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_json_in_every_usual_form(tmp_path, form, encoding):
    path = tmp_path / "rec.json"
    path.write_text(json.dumps(JSON_FORMS[form]), encoding=encoding)
    table = table_of(path)
    for name, values in zip("txz", (T, X, Z), strict=True):
        (column,) = table.called(name)
        np.testing.assert_array_equal(column.values, values)
        assert column.unit == ("deg" if form == "with units" else "")
    assert table.rate_hz == (200 if form == "objects below a name" else None)


@pytest.mark.parametrize("suffix", [".jsonl", ".ndjson", ".json"])
def test_json_a_line_a_sample_with_a_list_and_null(tmp_path, suffix):
    lines = [{"t": t, "imu": {"gyro": [x, z]}, "w": None if row == 3 else z} for row, (t, x, z) in enumerate(ROWS)]
    del lines[6]["w"]
    path = tmp_path / f"rec{suffix}"
    path.write_text("\n".join(map(json.dumps, lines)) + "\n")
    table = table_of(path)
    assert table.names == ["t", "imu/gyro/1", "imu/gyro/2", "w"]
    assert list(np.flatnonzero(np.isnan(table.called("w")[0].values))) == [3, 6]
    assert any("row 7" in note for note in table.notes)
    path.write_text(path.read_text() + '{"t": 1, ')
    refused(path, "line 121", "no JSON")


def test_a_matrix_without_names_is_listed_by_number(tmp_path):
    (tmp_path / "rec.json").write_text(json.dumps({"data": ROWS}))
    table = table_of(tmp_path / "rec.json")
    assert table.names == ["data/column 1", "data/column 2", "data/column 3"]
    assert "(120, 3)" in table.left_out["data"]


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("[" * 100_000, ["nested deeper"]),
        ('{"a":' * 100_000 + "1" + "}" * 100_000, ["nested deeper"]),
        ('{"t": [1, 2, 1' + "0" * 400 + "]}", ["column t, row 3", "beyond 1e308"]),
        ('{"t": [1, 2, 1' + "0" * 5000 + "]}", ["found", "wanted"]),
        ('{"t": [1, 2,', ["line 1 column 13", "no JSON"]),
        ('{"data": [[0, 1], [2, 3], [4]]}', ["row 3", "1 value,"]),
        ('{"columns": ["a", "b"], "data": [[0, 1], [2, 3], [4, 5, 6]]}', ["row 3", "3 values", "names"]),
        ("3", ["without a list of numbers"]),
        ("{}", ["without a list of numbers"]),
        ('{"t": "\\u0000"}', ["without a list of numbers"]),
        ("[[[[1, 2], [3, 4]]]]", ["found"]),
    ],
)
def test_json_that_is_damaged_or_no_record(tmp_path, text, parts):
    (tmp_path / "rec.json").write_text(text)
    refused(tmp_path / "rec.json", *parts)


def test_json_with_nan_and_infinity_keeps_them_for_the_checks(tmp_path):
    (tmp_path / "rec.json").write_text('{"t": [0, 1, 2], "x": [NaN, Infinity, -Infinity]}')
    np.testing.assert_array_equal(table_of(tmp_path / "rec.json").called("x")[0].values, [np.nan, np.inf, -np.inf])


def test_hdf5_with_units_rates_names_and_links_in_circles(tmp_path):
    with h5py.File(tmp_path / "rec.h5", "w") as file:
        file["run/x"], file["run/z"] = X, Z[:, None]
        file["run/x"].attrs["units"] = np.bytes_("deg")
        file["run"].attrs["sample_rate"] = 200
        file["m"] = np.column_stack([T, X, Z])
        file["m"].attrs["columns"] = ["t", "base", "rel"]
        file["run/loop"], file["soft"] = file["run"], h5py.SoftLink("/run/x")
        file["away"] = h5py.ExternalLink("/etc/passwd", "/x")
        file["state"] = ["on"] * 120
        file["raw"] = np.rec.fromarrays([X, Z], names="a,b")
        file["picture"] = np.zeros((300, 300))
        file["frame/block0_values"], file["frame/block0_items"] = np.column_stack([X, Z]), [b"left", b"right"]
    table = table_of(tmp_path / "rec.h5")
    others = {"frame/left", "frame/right", "frame/block0_items"}
    assert set(table.names) == {"run/x", "run/z", "t", "base", "rel", "state", "raw.a", "raw.b"} | others
    assert table.called("x")[0].unit == "deg"
    assert table.rate_hz == 200
    np.testing.assert_array_equal(table.called("m/rel")[0].values, Z)
    for name, part in {"run/loop": "second name", "soft": "/run/x", "away": "another file", "picture": "(300, 300)"}.items():
        assert part in table.left_out[name]


def test_hdf5_never_reads_other_files_nor_what_claims_terabytes(tmp_path):
    secret = tmp_path / "secret.txt"
    secret.write_bytes(bytes(range(100)))
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = X
    with h5py.File(tmp_path / "rec.h5", "w") as file:
        layout = h5py.VirtualLayout(shape=(120,), dtype="f8")
        layout[:] = h5py.VirtualSource(tmp_path / "other.h5", "x", shape=(120,))
        file.create_virtual_dataset("view", layout)
        file.create_dataset("stolen", shape=(100,), dtype="u1", external=[(str(secret), 0, 100)])
    refused(tmp_path / "rec.h5", "view (a view of another file", "stolen (a view of another file")
    (tmp_path / "rec.h5").rename(tmp_path / "rec.mat")
    refused(tmp_path / "rec.mat", "view (a view of another file", "stolen (a view of another file")
    with h5py.File(tmp_path / "huge.h5", "w") as file:
        file.create_dataset("x", shape=(10**13,), dtype="f8", chunks=(1000,))
    refused(tmp_path / "huge.h5", "data set x", "8e+04 GB", "shorter record")
    with h5py.File(tmp_path / "long.h5", "w", libver="latest") as file:
        file["x"] = X
        file["x"].attrs["units"] = np.bytes_("d" * 40_000 + "eg")
    data = (tmp_path / "long.h5").read_bytes()
    assert table_of(tmp_path / "long.h5").names == ["x"]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("jaxbacklash.records.formats.hdf5.MAX_ATTRIBUTE_BYTES", 1000)
        assert table_of(tmp_path / "long.h5").columns[0].unit == ""
    assert len(data) > 40_000
    with h5py.File(tmp_path / "huge.mat", "w", userblock_size=512) as file:
        file.create_dataset("x", shape=(1, 10**13), dtype="f8", chunks=(1, 1000))
    refused(tmp_path / "huge.mat", "array /x", "8e+04 GB")


@pytest.mark.parametrize("kind", ["timeseries", "Simulink.SimulationData.Dataset", "my.Own"])
def test_values_of_classes_that_no_library_reads_come_with_the_line_that_exports_them(tmp_path, kind):
    with h5py.File(tmp_path / "run 1.mat", "w", userblock_size=512) as file:
        file["logsout"] = np.array([[0xDD000000, 2, 1, 1, 1, 1]], dtype="u4")
        file["logsout"].attrs["MATLAB_class"] = np.bytes_(kind)
        file["logsout"].attrs["MATLAB_object_decode"] = np.int32(3)
    line = {
        "timeseries": "writematrix([logsout.Time, squeeze(logsout.Data)], 'run 1.csv')",
        "Simulink.SimulationData.Dataset": "writetimetable(extractTimetable(logsout), 'run 1.csv')",
        "my.Own": "save('run 1_plain.mat', '-struct', 's', '-v7')",
    }[kind]
    refused(tmp_path / "run 1.mat", f"class {kind}", line)
