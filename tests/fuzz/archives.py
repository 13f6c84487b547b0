"""Broken files of other formats: NumPy's, MATLAB's, JSON, workbooks, and the binary ones of measuring programs."""

from __future__ import annotations

import io as bytes_io
import json
import struct
import zipfile
from pathlib import Path

import numpy as np
from scipy import io, sparse

from tests.fuzz.case import Case, good_columns, good_model, kind, pick, reading_command


def _case(rng, folder: Path, name: str, accepts: bool = False) -> Case:
    good_model(folder)
    return Case(reading_command(rng, name), accepts=accepts)


@kind("records", 4)
def numpy_archive(rng, folder: Path) -> Case:
    path = folder / "r.npz"
    columns = good_columns()
    choice = int(rng.integers(9))
    if choice == 0:
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("notes.txt", "no arrays")
    elif choice in (1, 2):
        np.savez(path, **columns)
        data = bytearray(path.read_bytes())
        at = data.find(b"PK\x01\x02") + (8 if choice == 1 else 10)
        data[at : at + 2] = b"\x01\x00" if choice == 1 else b"\x63\x00"
        if choice == 2:
            data[8:10] = b"\x63\x00"
        path.write_bytes(bytes(data))
    elif choice == 3:  # claims far more samples than it holds
        header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (10000000000000,), }"
        header += b" " * (63 - (10 + len(header)) % 64) + b"\n"
        with zipfile.ZipFile(path, "w") as archive:
            for name in columns:
                archive.writestr(f"{name}.npy", b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + b"\0" * 80)
    elif choice == 4:
        np.savez(path, **columns)
        data = path.read_bytes()
        path.write_bytes(data[: int(rng.integers(1, len(data)))])
    elif choice == 5:
        np.savez(path, **(columns | {"z": np.array([{"a": 1}] * 1001, dtype=object)}))
    elif choice == 6:
        strange = columns["z"].astype(pick(rng, "datetime64[s]", "S5", "U5", "c16"))
        np.savez(path, **(columns | {"z": strange}))
    elif choice == 7:
        np.savez(
            path,
            **(columns | {"z": pick(rng, columns["z"][:-1], columns["z"].reshape(7, 11, 13), np.float64(3.0), columns["z"][:0])}),
        )
    else:
        np.savez_compressed(path, **{name: np.zeros(20_000_000) for name in columns})  # small on disk, large in memory
    return _case(rng, folder, "r.npz")


@kind("records", 3)
def matlab_file(rng, folder: Path) -> Case:
    path, columns = folder / "r.mat", good_columns()
    choice = int(rng.integers(8))
    if choice == 0:
        io.savemat(path, {name: sparse.csc_matrix(values) for name, values in columns.items()})
    elif choice == 1:
        io.savemat(path, columns)
        data = path.read_bytes()
        path.write_bytes(data[: int(rng.integers(1, len(data)))])
    elif choice == 2:
        io.savemat(path, columns)
        data = bytearray(path.read_bytes())
        for at in rng.integers(120, len(data), 30):
            data[at] = int(rng.integers(256))
        path.write_bytes(bytes(data))
        return _case(rng, folder, "r.mat", accepts=True)
    elif choice == 3:
        cells = np.empty(3, dtype=object)
        cells[:] = list(columns.values())
        io.savemat(path, {"c": cells})
    elif choice == 4:
        io.savemat(path, {"t": "abc", "x": "def", "z": np.zeros((0, 0))})
    elif choice == 5:
        path.write_bytes(b"MATLAB 7.3 MAT-file".ljust(512) + b"\x89HDF\r\n\x1a\n" + rng.bytes(2000))
    elif choice == 6:
        io.savemat(path, {"s": {"a": {"b": {"c": columns["x"]}}}})
    else:
        io.savemat(path, columns | {"z": columns["z"] + 1j})
    return _case(rng, folder, "r.mat")


@kind("records", 2)
def json_file(rng, folder: Path) -> Case:
    lists = {name: values.tolist() for name, values in good_columns().items()}
    text = pick(
        rng, "", "null", "[]", "{}", "5", '"text"', "[" * 100_000, '{"t": [1, 2', json.dumps(lists | {"z": lists["z"][:-3]}),
        json.dumps(lists | {"z": [None] * 1001}), json.dumps(lists | {"z": ["a"] * 1001}), json.dumps({"a": {"b": {"c": lists}}}),
        json.dumps([[1], [2, 3]]), "NaN", json.dumps(lists).replace("0.0,", "NaN,"), json.dumps({"t": lists}), '{"t": 1, "t": 2}',
    )  # fmt: skip
    (folder / "r.json").write_text(text)
    return _case(rng, folder, "r.json", accepts="b" in text and len(text) > 1000)


@kind("records", 2)
def binary_of_a_measuring_program(rng, folder: Path) -> Case:
    suffix, head = pick(rng, (".tdms", b"TDSm"), (".mf4", b"MDF     4.10    "), (".uff", b"    -1\n    58\n"), (".h5",
        b"\x89HDF\r\n\x1a\n"),
                        (".xlsx", b"PK\x03\x04"), (".npy", b"\x93NUMPY"), (".mcap", b"\x89MCAP0\r\n"), (".bag",
                        b"#ROSBAG V2.0\n"),
                        (".lvm", b"LabVIEW Measurement\n"), (".unv", b"    -1\n   58b     1     2\n"))  # fmt: skip
    body = pick(rng, b"", rng.bytes(40), rng.bytes(4000), b"\0" * 4000)
    (folder / f"r{suffix}").write_bytes(pick(rng, head, head, b"") + body)
    return _case(rng, folder, f"r{suffix}")


@kind("records", 2)
def numpy_array_file(rng, folder: Path) -> Case:
    columns = good_columns()
    matrix = np.column_stack(list(columns.values()))
    stream = bytes_io.BytesIO()
    np.save(stream, pick(rng, matrix[:, :1], matrix[0], matrix.astype(complex), matrix.astype("U8"), np.zeros((3, 3, 3)),
        np.float64(1),
                         matrix.T, np.zeros((0, 3)), matrix * np.nan))  # fmt: skip
    data = stream.getvalue()
    (folder / "r.npy").write_bytes(pick(rng, data, data, data[: len(data) // 2], data[:20]))
    case = _case(rng, folder, "r.npy", accepts=True)
    if case.words[0] in ("fit", "refine", "diagnose"):
        case.words += ["--columns", "t=#1,x=#2,z=#3"]
    return case


@kind("records", 1)
def a_file_under_another_suffix(rng, folder: Path) -> Case:
    source = folder / "source.npz"
    np.savez(source, **good_columns())
    data = source.read_bytes()
    source.unlink()
    name = "r" + pick(
        rng, ".csv", ".mat", ".json", ".xlsx", ".npy", ".txt", ".gz", ".h5", ".tdms", ".xyz", "", ".py", ".toml", ".csv.gz"
    )
    (folder / name).write_bytes(data)
    return _case(rng, folder, name, accepts=True)
