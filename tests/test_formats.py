"""Files of arrays (.npz, .npy, .mat, .h5) give their columns by name, and whatever is no column is named too."""

import io as memory
import struct
import zipfile
from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy import io, sparse

from jaxbacklash.errors import BadInput
from jaxbacklash.records.formats import guard, reader_for
from jaxbacklash.records.table import Table

RNG = np.random.default_rng(5)
T = np.arange(400) / 200
X, Z = 0.1 * np.sin(9 * T), 0.02 * np.cos(9 * T) + 1e-4 * RNG.standard_normal(400)


def table_of(path: Path) -> Table:
    reader = reader_for(path)
    assert reader is not None
    return reader(path)


def refused(path: Path, *parts: str) -> None:
    with pytest.raises(BadInput) as why:
        table_of(path)
    sentence = str(why.value)
    assert "\n" not in sentence
    assert str(path) in sentence
    for part in parts:
        assert part in sentence


def holds(table: Table, **columns) -> None:
    for name, values in columns.items():
        (found,) = table.called(name)
        np.testing.assert_array_equal(found.values, values)
        assert found.values.dtype == np.float64


def test_npz_columns_constants_and_what_is_left_out(tmp_path):
    path = tmp_path / "rec.npz"
    np.savez(path, t=T, x=X[:, None], z=Z[None], fs=200, gains=np.eye(3), w=X + 0j, boxed=np.array([None] * 400), text="rig")
    table = table_of(path)
    holds(table, t=T, x=X, z=Z)
    assert table.names == ["t", "x", "z"]
    assert table.rate_hz == 200
    assert "complex" in table.left_out["w"]
    assert "pickled" in table.left_out["boxed"]
    assert "(3, 3)" in table.left_out["gains"]


def test_npz_of_dates_of_text_and_of_a_structured_array(tmp_path):
    path = tmp_path / "rec.npz"
    stamps = np.datetime64("2024-05-01T12:00:00") + (T * 1e9).astype("timedelta64[ns]")
    state = np.where(X > 0, "up", "down")
    np.savez(path, when=stamps, state=state, raw=np.rec.fromarrays([X, Z], names=["x", "z"]))
    table = table_of(path)
    np.testing.assert_allclose(table.called("when")[0].values, T, atol=1e-9)
    assert table.called("when")[0].unit == "s"
    assert "2024-05-01" in table.notes[0]
    assert list(table.called("state")[0].values) == list(state)
    np.testing.assert_array_equal(table.called("raw.z")[0].values, Z)


@pytest.mark.parametrize("suffix", [".npy", ".bin"])
@pytest.mark.parametrize("values", [np.column_stack([T, X, Z]), np.stack([T, X, Z]), np.rec.fromarrays([T, X, Z], names="t,x,z")])
def test_npy_matrix_or_structured_array(tmp_path, values, suffix):
    path = tmp_path / f"rec{suffix}"
    with open(path, "wb") as file:
        np.save(file, values)
    table = table_of(path)
    way = None if values.dtype.names else "row" if len(values) == 3 else "column"
    assert table.names == (["t", "x", "z"] if way is None else [f"{way} {number}" for number in (1, 2, 3)])
    for column, wanted in zip(table.columns, (T, X, Z), strict=True):
        np.testing.assert_array_equal(column.values, wanted)


def test_an_archive_that_claims_more_than_it_holds_is_refused_before_anything_is_allocated(tmp_path):
    for claimed in ((10**13,), (3, 10**13)):
        member = memory.BytesIO()
        np.lib.format.write_array_header_1_0(member, {"descr": "<f8", "fortran_order": False, "shape": claimed})
        with zipfile.ZipFile(tmp_path / "rec.npz", "w") as archive:
            archive.writestr("t.npy", member.getvalue() + bytes(800))
        refused(tmp_path / "rec.npz", "array t", "bytes in a member of 9")
        (tmp_path / "rec.npy").write_bytes(member.getvalue() + bytes(800))
        refused(tmp_path / "rec.npy", "GB", "shorter record")


def test_a_bomb_of_zeros_is_refused_by_the_size_it_unpacks_to(tmp_path):
    path = tmp_path / "rec.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("t.npy", bytes(1000))
    data = bytearray(path.read_bytes())
    # The directory at the end of the archive says what each member unpacks to: 4 GB here.
    place = data.rfind(b"PK\x01\x02")
    data[place + 24 : place + 28] = struct.pack("<I", 2**32 - 2)
    path.write_bytes(data)
    refused(path, "4.295 GB", "at most 2.1 GB")


def damaged_archives():
    def archive(**members):
        file = memory.BytesIO()
        with zipfile.ZipFile(file, "w") as out:
            for name, content in members.items():
                out.writestr(name, content)
        return bytearray(file.getvalue())

    good = memory.BytesIO()
    np.savez(good, t=T, x=X)
    whole = bytearray(good.getvalue())
    encrypted = bytearray(whole)
    for place in (whole.find(b"PK\x03\x04") + 6, whole.find(b"PK\x01\x02") + 8):
        encrypted[place] |= 1
    packed = bytearray(whole)
    for place in (whole.find(b"PK\x03\x04") + 8, whole.find(b"PK\x01\x02") + 10):
        packed[place] = 77
    flipped = bytearray(whole)
    flipped[900] ^= 255
    return {
        "no arrays": (archive(**{"notes.txt": b"rig 4"}), ["notes.txt", "no NumPy array"]),
        "empty archive": (archive(), ["nothing", "no NumPy array"]),
        "encrypted": (encrypted, ["encrypted"]),
        "unknown packing": (packed, ["packed in a way"]),
        "one bit": (flipped, ["array t", "damaged data"]),
        "half": (whole[: len(whole) // 2], ["damaged or no NumPy archive"]),
        "no header in a member": (archive(**{"t.npy": b"t,x,z"}), ["array t", "damaged data"]),
        "a header that is code": (
            archive(**{"t.npy": b"\x93NUMPY\x01\x00\x40\x00" + b"__import__('os').abort()".ljust(64)}),
            ["array t", "damaged data"],
        ),
        "two of one name": (twice(), ["two arrays", '"t"']),
    }


def twice() -> bytearray:
    member = memory.BytesIO()
    np.save(member, T)
    file = memory.BytesIO()
    with zipfile.ZipFile(file, "w") as out:
        out.writestr("t.npy", member.getvalue())
        with pytest.warns(UserWarning, match="Duplicate name"):
            out.writestr("t.npy", member.getvalue())
    return bytearray(file.getvalue())


@pytest.mark.parametrize("kind", damaged_archives())
def test_damaged_archives_end_in_a_sentence(tmp_path, kind):
    content, parts = damaged_archives()[kind]
    (tmp_path / "rec.npz").write_bytes(content)
    refused(tmp_path / "rec.npz", *parts)


def test_odd_names_of_members_are_shown_on_one_line(tmp_path):
    np.savez(tmp_path / "rec.npz", **{"a\nb": T, "\x1b[31mred": X, "../up": Z})
    assert table_of(tmp_path / "rec.npz").names == ["a b", "[31mred", "../up"]


def test_structs_within_structs_and_arrays_of_structs(tmp_path):
    runs = np.empty((1, 2), dtype=[("x", "O"), ("z", "O")])
    for number in range(2):
        runs[0, number] = (X[:, None] + number, Z[:, None] + number)
    nested = {"rig": {"base": {"x": X, "label": "left"}, "z": Z}, "t": T, "Fs": 200.0}
    io.savemat(tmp_path / "rec.mat", {"log": nested, "runs": runs, "note": "rig 4", "sp": sparse.csc_matrix(np.diag(X))})
    table = table_of(tmp_path / "rec.mat")
    holds(table, t=T, **{"rig.base.x": X, "log.rig.base.x": X, "rig.z": Z, "runs(2).z": Z + 1})
    assert table.rate_hz == 200
    assert table.left_out["note"] == "text"
    assert "(400, 400)" in table.left_out["sp"]


def test_simulink_structure_with_time(tmp_path):
    signals = np.empty((1, 2), dtype=[("values", "O"), ("dimensions", "O"), ("label", "O")])
    signals[0, 0] = (X[:, None], 1, "base")
    signals[0, 1] = (np.column_stack([Z, -Z]), 2, "")
    io.savemat(tmp_path / "rec.mat", {"simout": {"time": T[:, None], "signals": signals, "blockName": "m/To Workspace"}})
    table = table_of(tmp_path / "rec.mat")
    holds(table, time=T, base=X, **{"signals(1).values": X, "signals(2).values/column 2": -Z})
    assert "signals(2).values/column 1" in table.left_out["signals(2).values"]


def test_a_to_file_matrix_and_cells(tmp_path):
    io.savemat(tmp_path / "rec.mat", {"ans": np.stack([T, X, Z]), "held": np.array([X, Z, "w"], dtype=object), "on": X > 0})
    table = table_of(tmp_path / "rec.mat")
    holds(table, **{"ans/row 1": T, "ans/row 3": Z, "held(2)": Z, "on": X > 0})


@pytest.mark.parametrize("matlab", [True, False])
def test_mat_73_with_structs_cells_text_and_matrices(tmp_path, matlab):
    with h5py.File(tmp_path / "rec.mat", "w", userblock_size=512) as file:
        file["log/rig/x"] = X[None]
        file["log/t"] = T[None]
        file["ans"] = np.column_stack([T, X, Z])  # MATLAB's 3 by 400
        file["name"] = np.frombuffer("rig".encode("utf-16-le"), "<u2")[:, None]
        refs = file.create_group("#refs#")
        refs["a"], refs["b"] = X[None], Z[None]
        file["cells"] = np.array([[refs["a"].ref, refs["b"].ref]], dtype=h5py.ref_dtype)
        file["away"] = h5py.ExternalLink("/etc/passwd", "/x")
        file["log/again"] = file["log"]
        if matlab:
            for name in ("log/rig/x", "log/t", "ans"):
                file[name].attrs["MATLAB_class"] = np.bytes_("double")
            file["name"].attrs["MATLAB_class"] = np.bytes_("char")
    table = table_of(tmp_path / "rec.mat")
    holds(table, **{"rig.x": X, "ans/row 2" if matlab else "ans/column 2": X, "cells(2)": Z})
    assert "link" in table.left_out["away"]


@pytest.mark.parametrize("newer", [False, True])
def test_sparse_matrices(tmp_path, newer):
    x = np.where(np.abs(X) > 0.05, X, 0.0)
    if newer:
        columns = sparse.csc_matrix(x[:, None])
        with h5py.File(tmp_path / "rec.mat", "w", userblock_size=512) as file:
            group = file.create_group("x")
            group.attrs["MATLAB_class"], group.attrs["MATLAB_sparse"] = np.bytes_("double"), np.uint64(400)
            group["data"], group["ir"], group["jc"] = columns.data, columns.indices, columns.indptr
            claims = file.create_group("big")
            claims.attrs["MATLAB_class"], claims.attrs["MATLAB_sparse"] = np.bytes_("double"), np.uint64(4)
            claims["jc"] = np.zeros(3, dtype=np.uint64)
    else:
        big = sparse.csc_matrix(([1.0], ([0], [0])), shape=(10**6, 10**6))
        io.savemat(tmp_path / "rec.mat", {"x": sparse.csc_matrix(x[None]), "big": big})
    table = table_of(tmp_path / "rec.mat")
    holds(table, x=x)
    assert "(1000000, 1000000)" in table.left_out["big"] or newer


def test_a_variable_that_claims_terabytes_or_unpacks_to_too_much_is_refused(tmp_path, monkeypatch):
    path = tmp_path / "rec.mat"
    io.savemat(path, {"x": np.zeros((500, 1))})
    path.write_bytes(path.read_bytes().replace(struct.pack("<ii", 500, 1), struct.pack("<ii", 2**30, 5000)))
    refused(path, "damaged or no MATLAB file")
    io.savemat(path, {"t": T, "log": {"x": np.zeros(10**6)}}, do_compression=True)
    assert path.stat().st_size < 20_000
    assert table_of(path).names == ["t", "x"]
    monkeypatch.setattr(guard, "MAX_BYTES", 10**6)
    refused(path, "a packed array", "GB", "shorter record")


def test_variables_packed_and_not_packed_in_one_file(tmp_path):
    io.savemat(tmp_path / "plain.mat", {"t": T, "log": {"x": X}})
    io.savemat(tmp_path / "packed.mat", {"z": Z}, do_compression=True)
    plain, packed = ((tmp_path / name).read_bytes() for name in ("plain.mat", "packed.mat"))
    (tmp_path / "rec.mat").write_bytes(plain + packed[128:])
    holds(table_of(tmp_path / "rec.mat"), t=T, x=X, z=Z)
    (tmp_path / "rec.mat").write_bytes(packed + plain[128:])
    holds(table_of(tmp_path / "rec.mat"), t=T, x=X, z=Z)


@pytest.mark.parametrize("kind", [0, 8, 10, 11, 19, 20, 255, 8457, 14, 15])
def test_elements_of_a_kind_that_does_not_exist_never_reach_the_library(tmp_path, kind):
    """SciPy looks such a kind up in a table that ends before it, and the process with it."""
    io.savemat(tmp_path / "rec.mat", {"log": {"x": X[:, None]}})
    data = bytearray((tmp_path / "rec.mat").read_bytes())
    place = data.index(struct.pack("<II", 9, 3200))
    data[place : place + 4] = struct.pack("<I", kind)
    (tmp_path / "rec.mat").write_bytes(data)
    refused(tmp_path / "rec.mat", "damaged or no MATLAB file")


def test_a_matrix_that_lacks_what_it_announces_never_reaches_the_library(tmp_path):
    io.savemat(tmp_path / "rec.mat", {"log": {"x": X[:, None], "z": Z[:, None]}, "cells": np.array([T, X], dtype=object)})
    whole = (tmp_path / "rec.mat").read_bytes()
    place = whole.index(struct.pack("<IIII", 6, 8, 6, 0)) + 9
    (tmp_path / "rec.mat").write_bytes(whole[:place] + b"\x08" + whole[place + 1 :])  # complex, without imaginary parts
    refused(tmp_path / "rec.mat", "damaged or no MATLAB file")
    place = whole.rindex(struct.pack("<IIII", 6, 8, 1, 0)) + 24
    (tmp_path / "rec.mat").write_bytes(whole[:place] + struct.pack("<ii", 30000, 30000) + whole[place + 8 :])
    refused(tmp_path / "rec.mat", "damaged or no MATLAB file")


def test_places_out_of_range_in_a_sparse_matrix_are_refused(tmp_path):
    io.savemat(tmp_path / "rec.mat", {"x": sparse.csc_matrix(X[:, None])})
    data = bytearray((tmp_path / "rec.mat").read_bytes())
    place = data.index(struct.pack("<iii", 1, 2, 3))
    data[place : place + 12] = struct.pack("<iii", 2**30, 5, -7)
    (tmp_path / "rec.mat").write_bytes(data)
    refused(tmp_path / "rec.mat", "damaged or no MATLAB file")


def test_half_a_file_of_every_kind(tmp_path):
    np.save(tmp_path / "rec.npy", np.column_stack([T, X]))
    io.savemat(tmp_path / "rec.mat", {"t": T, "x": {"y": X}})
    with h5py.File(tmp_path / "new.mat", "w", userblock_size=512) as file:
        file["t"] = T
    for path in list(tmp_path.iterdir()):
        whole = path.read_bytes()
        for size in (20, 130, len(whole) // 2, len(whole) - 7):
            path.write_bytes(whole[:size])
            refused(path, "found", "wanted")
