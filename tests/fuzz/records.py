"""Broken text records and files that are no records at all."""

from __future__ import annotations

import gzip
import os
from pathlib import Path

import numpy as np

from tests.fuzz.case import Case, csv_text, good_columns, good_model, good_record, kind, pick, reading_command

EXTREMES = (1e300, -1e300, 1e-300, 5e-324, 1e308, 1e155, 1e30, -1e9)


def _case(rng, folder: Path, data: str | bytes, name: str = "r.csv", accepts: bool = True) -> Case:
    good_model(folder)
    (folder / name).write_bytes(data if isinstance(data, bytes) else data.encode())
    return Case(reading_command(rng, name), accepts=accepts)


@kind("records", 3)
def numbers_at_the_end_of_their_range(rng, folder: Path) -> Case:
    columns = {name: values.copy() for name, values in good_columns().items()}
    value, name = float(pick(rng, *EXTREMES)), str(pick(rng, "t", "x", "z"))
    if pick(rng, True, False):
        columns[name] = columns[name] * value
    else:
        columns[name][rng.integers(20, 900, int(rng.integers(1, 20)))] = value
    case = _case(rng, folder, csv_text(columns))
    if case.words[0] == "fit" and pick(rng, True, False):
        case.words += ["--unit", "x=rad,z=rad"]
    return case


@kind("records", 2)
def cells_that_are_no_numbers(rng, folder: Path) -> Case:
    lines = csv_text(good_columns()).splitlines()
    for _ in range(int(rng.integers(1, 5))):
        at = int(rng.integers(1, len(lines)))
        cells = lines[at].split(",")
        cells[int(rng.integers(3))] = pick(
            rng, "inf", "-Infinity", "1e999", "0x1f", "1_000", "abc", "--", "=A1+B1", "1;2", "\u0661\u0662", "1+2j", "true"
        )
        lines[at] = ",".join(cells)
    return _case(rng, folder, "\n".join(lines), accepts=False)


@kind("records", 2)
def lines_cut_or_joined(rng, folder: Path) -> Case:
    lines = csv_text(good_columns()).splitlines()
    at = int(rng.integers(1, len(lines) - 1))
    lines[at] = pick(
        rng,
        lines[at][: len(lines[at]) // 2].rstrip(","),
        lines[at] + "," + lines[at + 1],
        lines[at] * 1000,
        "x" * 200000,
        ",,,,,",
    )
    return _case(rng, folder, "\n".join(lines))


@kind("records", 3)
def damaged_bytes(rng, folder: Path) -> Case:
    data = bytearray(csv_text(good_columns()).encode())
    for at in rng.integers(0, len(data), int(pick(rng, 1, 5, 300))):
        data[at] = int(rng.integers(256))
    return _case(rng, folder, bytes(data))


@kind("records", 2)
def rubbish(rng, folder: Path) -> Case:
    size = int(pick(rng, 1, 3, 100, 5000))
    text = csv_text(good_columns())
    data = pick(
        rng, rng.bytes(size), b"\0" * size, b"", b"\n" * size, b",", b"t,x,z", b"t,x,z\n", b"\xff\xfe", b"\xef\xbb\xbf",
        b"sep=;\n",
        b"# only\n# comments\n", b'"' * size, b"t,x,z\n0,0,0\n", ("a,b,c\n" * size).encode(), b"<html><body>404</body></html>",
        ("{" * size).encode(), text[: len(text) // 3].encode("utf-16")[:-1], b"\x1f\x8b" + rng.bytes(size),
    )  # fmt: skip
    return _case(rng, folder, data, accepts=False)


@kind("records", 2)
def times_that_are_none(rng, folder: Path) -> Case:
    columns = dict(good_columns())
    t = columns["t"]
    columns["t"] = pick(
        rng, t[::-1], 0 * t, rng.permutation(t), t * 0 + 5, np.r_[t[:500], t[:501]], -t, rng.uniform(0, 1, t.size).cumsum(),
        np.where(np.arange(t.size) == 400, 1e9, t), t**3 * 100, np.round(t, 1),
    )  # fmt: skip
    return _case(rng, folder, csv_text(columns), accepts=False)


@kind("records", 2)
def channels_misnamed(rng, folder: Path) -> Case:
    old, new = good_columns(), {}
    names = pick(
        rng,
        "t,base,z",
        "t,z,base",
        "x,t,z",
        "t,F,y",
        "t,x,T",
        "time,a,b",
        "t,T,z",
        "t,y,x",
        "t,x,x",
        ",,",
        "t,F,z",
        "T,X,Z",
        "t,x,z,y,F,T",
    )
    for name, values in zip(names.split(","), [*old.values(), *[old["x"]] * 3], strict=False):
        new[name if name not in new else f"{name} "] = values
    return _case(rng, folder, csv_text(new))


@kind("records", 1)
def output_alone_of_a_driven_record(rng, folder: Path) -> Case:
    columns = good_columns()
    return _case(rng, folder, csv_text({"t": columns["t"], pick(rng, "z", "y"): columns["z"]}))


@kind("records", 2)
def channels_that_tell_nothing(rng, folder: Path) -> Case:
    columns = dict(good_columns())
    noise = 1e-5 * rng.standard_normal(1001)
    name = str(pick(rng, "x", "z"))
    columns[name] = pick(
        rng, 0.0 * noise, noise, 0.3 + 0.0 * noise, columns["t"], np.sign(noise), np.arange(1001) % 2.0, 1e-9 * noise
    )
    return _case(rng, folder, csv_text(columns))


@kind("records", 1)
def too_short_or_slow(rng, folder: Path) -> Case:
    rows = int(pick(rng, 0, 1, 2, 3, 10, 63, 64, 65, 130))
    columns = {name: values[:rows] for name, values in good_columns().items()}
    columns["t"] = columns["t"] * float(pick(rng, 1, 1, 1000, 1e6, 1e-6))
    return _case(rng, folder, csv_text(columns))


@kind("records", 1)
def slow_triangles(rng, folder: Path) -> Case:
    t = np.arange(400) * 2.0
    x = np.abs((t / 80.0) % 2.0 - 1.0) - 0.5
    z = 0.01 * np.sign(np.gradient(x)) + 1e-4 * rng.standard_normal(t.size)
    return _case(rng, folder, csv_text({"t": t, "x": x, pick(rng, "z", "y"): z + (x if pick(rng, True, False) else 0.0)}))


@kind("records", 2)
def odd_file_names(rng, folder: Path) -> Case:
    name = pick(
        rng, "a" * 250 + ".csv", "a" * 300 + ".csv", "-r.csv", "r\n.csv", 'r".csv', "r'.csv", "r\\.csv", "\u00e9\u4e2d.csv",
        "r;rm -rf x.csv", "$(touch x).csv",
        " .csv", "r.CSV", "..csv", "r.csv.", "r", "\x1b[31mr.csv", "%s%n.csv", "r\udcff.csv", "<b>r.csv",
    )  # fmt: skip
    good_model(folder)
    if len(name) < 256:
        good_record(folder, name)
    words = reading_command(rng, name if not name.startswith("-") else f"./{name}")
    return Case(words)


@kind("records", 2, alone=True)
def paths_that_are_no_files(rng, folder: Path) -> Case:
    good_model(folder)
    choice = int(rng.integers(7))
    path = folder / "r.csv"
    if choice == 0:
        path.mkdir()
    elif choice == 1:
        os.mkfifo(path)
    elif choice in (2, 3, 4):
        path.symlink_to(("nowhere.csv", "/dev/zero", "r.csv")[choice - 2])
    elif choice == 5:
        path.symlink_to("/dev/urandom")
    return Case(reading_command(rng, "r.csv" if choice < 6 else "/dev/null"), accepts=False, alone=True)


@kind("records", 1)
def compressed_wrongly(rng, folder: Path) -> Case:
    packed = gzip.compress(csv_text(good_columns()).encode())
    data = pick(rng, packed[: len(packed) // 2], packed[:-4] + b"abcd", csv_text(good_columns()).encode(), b"",
        gzip.compress(rng.bytes(3000)),
                gzip.compress(b"0" * 50_000_000))  # fmt: skip
    return _case(rng, folder, data, "r.csv.gz")


@kind("records", 1)
def a_matrix_of_many_columns(rng, folder: Path) -> Case:
    count = int(pick(rng, 200, 5000))
    rows = "\n".join(",".join(["1.5"] * count) for _ in range(70))
    header = ",".join(f"c{i}" for i in range(count))
    return _case(rng, folder, f"{header}\n{rows}\n", accepts=False)


@kind("records", 1)
def another_kind_of_record_held_out(rng, folder: Path) -> Case:
    good_record(folder)
    columns = good_columns(1)
    other = pick(rng, {"t": columns["t"], "F": columns["x"], "y": columns["z"]}, {"t": columns["t"], "z": columns["z"]})
    (folder / "h.csv").write_text(csv_text(other))
    return Case(["fit", "r.csv", "--heldout", pick(rng, "h.csv", "h.csv", ".", "no.csv"), "--inertia", "2.94"], accepts=False)
