"""Every kind of bad input that a person is likely to bring, and the sentence each must get.

`CASES` holds (name, write, fragments): `write(folder)` puts the file there and returns the words of a command line,
`fragments` are texts that the sentence must contain.
"""

import itertools
import os
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy import io

from jaxbacklash.errors import BadInput
from jaxbacklash.records import parse_columns, parse_scales, parse_units, read_record

N, RATE = 1000, 500.0


def good() -> dict[str, np.ndarray]:
    """A base-motion record that nothing is wrong with."""
    t = np.arange(N) / RATE
    noise = np.random.default_rng(0).normal(scale=3e-5, size=(2, N))
    return {"t": t, "x": 0.1 * np.sin(13 * t) + noise[0], "z": 0.05 * np.sin(29 * t + 0.4) + noise[1]}


def write_text(path: Path, table: dict) -> None:
    rows = zip(*(np.asarray(values).tolist() for values in table.values()), strict=True)
    path.write_text("\n".join([",".join(table), *(",".join(map(str, row)) for row in rows)]) + "\n")


def write_hdf5(path: Path, table: dict) -> None:
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in table.items():
            file[name] = np.atleast_2d(values)


WRITE = {".csv": write_text, ".npz": lambda path, table: np.savez(path, **table), ".mat": io.savemat}


def table(change, *options, file="rec.csv"):
    """A case whose file holds `change(good())`."""

    def write(folder: Path) -> list[str]:
        path = folder / file
        WRITE[path.suffix](path, change(good()))
        return ["fit", str(path), *options]

    return write


def lines(change, *options, file="rec.csv"):
    """A case whose text file holds the lines `change(lines of good())`."""

    def write(folder: Path) -> list[str]:
        path = folder / file
        write_text(path, good())
        path.write_bytes("".join(change(path.read_text().splitlines(keepends=True))).encode())
        return ["fit", str(path), *options]

    return write


def content(data: bytes, file="rec.csv"):
    """A case whose file holds these bytes."""

    def write(folder: Path) -> list[str]:
        (folder / file).write_bytes(data)
        return ["fit", str(folder / file)]

    return write


def cell(row: int, column: str, value):
    """A change of one value; row counted from 1."""

    def change(table: dict) -> dict:
        values = table[column].astype(object)
        values[row - 1] = value
        return table | {column: values}

    return change


def line(number: int, text: str):
    """A change of one line of the file, counted from 1."""
    return lambda old: [*old[: number - 1], text, *old[number:]]


def cut(path_to: str):
    """A case with an archive that was not copied to its end."""

    def write(folder: Path) -> list[str]:
        path = folder / path_to
        WRITE[path.suffix](path, good())
        path.write_bytes(path.read_bytes()[:9000])
        return ["fit", str(path)]

    return write


def folder_case(folder: Path) -> list[str]:
    (folder / "rec.csv").mkdir()
    return ["fit", str(folder / "rec.csv")]


def without(*names):
    return lambda table: {name: values for name, values in table.items() if name not in names}


def every_row_but(*rows):
    return lambda table: {name: np.delete(values, [row - 1 for row in rows]) for name, values in table.items()}


def named(**names):
    """A change of column names: old name = new name."""
    return lambda table: {names.get(name, name): values for name, values in table.items()}


def with_values(**changes):
    """A change of columns by functions of their values."""
    return lambda table: table | {name: change(table[name]) for name, change in changes.items()}


def jittered(t):
    return t + np.random.default_rng(1).uniform(-2e-5, 2e-5, t.size)


def sixth(value):
    """A change of the sixth value of a column."""
    return lambda values: np.where(np.arange(values.size) == 5, value, values)


def npy_as_npz(folder: Path) -> list[str]:
    with open(folder / "rec.npz", "wb") as file:
        np.save(file, good()["z"])
    return ["fit", str(folder / "rec.npz")]


def packed(names):
    """One matrix with an array of names."""
    return lambda table: {"data": np.column_stack(list(table.values())), "columns": np.array(names)}


CASES = [
    # The file as a whole.
    ("no such file", lambda folder: ["fit", str(folder / "rec.csv")], ["no such file"]),
    ("a folder", folder_case, ["a folder", "wanted a file"]),
    ("no workbook", content(b"t,x,z\n", "rec.xlsx"), ["no Excel workbook"]),
    ("no suffix", content(b"t,x,z\n", "rec"), ["a header line and no values"]),
    ("empty csv", content(b""), ["empty file"]),
    ("empty npz", content(b"", "rec.npz"), ["empty file"]),
    ("blank csv", content(b"\n \n"), ["empty file"]),
    ("only comments", content(b"# rig 4\n# noon\n"), ["only blank lines or comments"]),
    ("only a header", content(b"t,x,z\n"), ["a header line and no values"]),
    ("binary csv", content(bytes(range(256)) * 20), ["binary data", "wanted text"]),
    ("no header", lines(lambda old: old[1:]), ["column 1, column 2, column 3", "--columns"]),
    ("npz of zeros", content(bytes(500), "rec.npz"), ["damaged or no NumPy archive"]),
    ("half an npz", cut("rec.npz"), ["damaged", "NumPy archive"]),
    ("npy called npz", npy_as_npz, ["a single NumPy array"]),
    ("text called mat", content(b"t,x,z\n0,0,0\n" * 40, "rec.mat"), ["damaged or no MATLAB file"]),
    ("half a mat", cut("rec.mat"), ["damaged or no MATLAB file"]),
    ("broken mat 7.3", content(b"MATLAB 7.3".ljust(512) + b"\x89HDF\r\n\x1a\n" + bytes(90), "rec.mat"), ["damaged"]),
    # Lines and cells.
    ("a word", lines(line(17, "0.03,0.1,abc\n")), ["line 17", "column z", '"abc"', "wanted a number"]),
    ("an empty cell", lines(line(17, "0.03,,0.1\n")), ["line 17", "column x", "no number", "--resample"]),
    ("a short line", lines(line(17, "0.03,0.1\n")), ["line 17", "2 values", "wanted 3"]),
    ("a long line", lines(line(17, "0.03,0.1,0.2,0.3\n")), ["line 17", "4 values", "wanted 3"]),
    ("half a last line", lines(lambda old: [*old[:-1], "1.998,0.0"]), ["line 1001", "half-written"]),
    ("a name twice", lines(line(1, "t,x,x\n")), ["t, x, x", "--columns 'x=#2,z=#3'"]),
    ("nan in csv", table(cell(40, "x", "nan")), ["line 41", "column x", "no number", "a finite number"]),
    ("overflow in csv", table(cell(40, "z", "1e999")), ["line 41", "column z", "inf", "a finite number"]),
    ("nan time", table(cell(9, "t", "nan")), ["line 10", "column t", "no number"]),
    # Columns.
    ("only time", table(without("x", "z")), ["the columns t", "wanted x with z or y"]),
    ("no time", table(named(t="zeit")), ["zeit, x, z", "--columns t=zeit"]),
    ("unknown names", table(named(x="enc1", z="enc2")), ["t, enc1, enc2", "--columns x=enc1,z=enc2"]),
    ("input alone", table(without("z")), ["the columns t, x", "wanted x with z or y"]),
    ("output not named", table(named(z="enc2")), ["the columns t, x, enc2", "--columns z=enc2"]),
    ("force alone", table(lambda good: without("x", "z")(good | {"F": good["x"]})), ["the columns t, F"]),
    ("mapped column missing", table(named(z="enc2"), "--columns", "z=enc3"), ['"enc3"', "did you mean enc2"]),
    ("mapping without =", table(without(), "--columns", "enc2"), ["--columns", '"enc2"', "x=NAME_OF_A_COLUMN"]),
    ("mapping of nothing", table(without(), "--columns", "z="), ["--columns", '"z="']),
    ("mapping twice", table(without(), "--columns", "z=a,z=b"), ["--columns", "the channel z twice"]),
    ("one column for two", table(without(), "--columns", "x=z,z=z"), ['"z" for x and for z', "one channel for it"]),
    ("mapping of no channel", table(without(), "--columns", "q=enc2"), ["--columns", '"q"', "t, x, z, y, F, T"]),
    # Units and scales.
    ("unknown unit", table(without(), "--unit", "x=furlong"), ["--unit", '"furlong"', "rad", "deg", "arcsec"]),
    ("unit of another kind", table(without(), "--unit", "t=deg"), ["--unit", '"deg" for t', "ms"]),
    ("unit of an absent channel", table(without(), "--unit", "y=deg"), ["no channel y", "--unit", "t, x, z"]),
    ("angles and lengths", table(without(), "--unit", "x=deg,z=mm"), ["x in deg and z in mm"]),
    ("scale no number", table(without(), "--scale", "z=two"), ["--scale", '"two"', "a number"]),
    ("scale nought", table(without(), "--scale", "z=0"), ["--scale", '"0"', "other than 0"]),
    ("degrees", table(with_values(x=np.rad2deg, z=np.rad2deg)), ["column z", "radians", "--unit x=deg,z=deg"]),
    ("degrees of y", table(lambda old: without("z")(old | {"y": 50 * old["z"]})), ["column y", "--unit x=deg,y=deg"]),
    ("degrees of x", table(with_values(x=lambda x: 200 * x)), ["column x", "radians", "x=deg", "x=rad"]),
    # Time.
    ("milliseconds", table(with_values(t=lambda t: 1000 * t)), ["column t", "looks like milliseconds", "--unit t=ms"]),
    ("microseconds", table(with_values(t=lambda t: 1e6 * t)), ["looks like microseconds", "--unit t=us"]),
    ("time twice", table(with_values(t=lambda t: np.where(t == t[50], t[49], t))), ["row 51", "--rate 500"]),
    ("time back", table(with_values(t=lambda t: np.r_[t[:60], t[:-60]])), ["row 60", "goes back from 0.118", "row 61"]),
    ("constant time", table(with_values(t=lambda t: 0 * t)), ["column t"]),
    ("a lost row", table(every_row_but(501)), ["column t", "gap of 0.004 s", "rows 500 and 501", "--resample"]),
    ("lost rows", table(every_row_but(501, 701)), ["gap of 0.004 s", "1 more like it", "--resample"]),
    ("uneven time", table(with_values(t=jittered)), ["column t", "uneven", "--resample"]),
    ("uneven time, printed", table(with_values(t=lambda t: np.round(jittered(t), 6))), ["uneven", "--resample"]),
    ("one shift", table(with_values(t=lambda t: t + 6e-4 * (t > 1))), ["column t", "uneven", "--resample"]),
    ("gap too long", table(every_row_but(*range(501, 520)), "--resample"), ["gap of 0.04 s", "even with --resample"]),
    # Size and motion.
    ("few samples", table(every_row_but(*range(51, 1001))), ["50 samples", "at least 64"]),
    ("short", table(every_row_but(*range(101, 1001))), ["a record of 0.2 s", "at least 0.5 s"]),
    ("constant input", table(with_values(x=lambda x: 0 * x + 0.2)), ["column x", "constant 0.2", "free decay"]),
    ("constant output", table(with_values(z=lambda z: 0 * z + 0.2)), ["column z", "constant 0.2", "to change"]),
    ("zero output", table(with_values(z=lambda z: 0 * z)), ["column z", "0 in every row"]),
    ("zero force", table(lambda old: old | {"F": 0 * old.pop("x")}), ["column F", "0 in every row", "input"]),
    # Arrays.
    ("nan in npz", table(with_values(z=sixth(np.nan)), file="rec.npz"), ["column z", "no number at row 6"]),
    ("inf in mat", table(with_values(x=sixth(np.inf)), file="rec.mat"), ["column x", "inf at row 6"]),
    ("complex", table(with_values(z=lambda z: z + 0j), file="rec.npz"), ["column z", "complex"]),
    ("text array", table(with_values(z=lambda z: np.full(z.size, "low")), file="rec.npz"), ["column z", '"low"']),
    ("pickled objects", table(with_values(z=lambda z: z.astype(object)), file="rec.npz"), ["z", "pickled objects"]),
    ("matrix for a column", table(with_values(z=lambda z: z.reshape(2, -1)), file="rec.mat"), ["z/row 1"]),
    ("lengths differ", table(with_values(z=lambda z: z[1:]), file="rec.npz"), ["z", "999 values", "wanted 1000"]),
    ("a single number", table(with_values(z=lambda z: z[0]), file="rec.npz"), ["column z", "a single value"]),
    ("too few names", table(packed(["t", "x"]), file="rec.npz"), ["2 names", "data (1000, 3)"]),
    ("a name twice in npz", table(packed(["t", "x", "x"]), file="rec.npz"), ["columns", '"x" more than once']),
    ("names that are numbers", table(packed([1, 2, 3]), file="rec.npz"), ["columns", "something other than names"]),
]


def sentence_of(error: BadInput) -> str:
    """The text of an error, which must be one sentence on one line."""
    text = str(error)
    assert text.endswith(".")
    assert len(text.splitlines()) == 1
    assert "Traceback" not in text
    return text


# ---- Through read_record ----

OPTIONS = {
    "--columns": ("columns", parse_columns),
    "--unit": ("units", parse_units),
    "--scale": ("scales", parse_scales),
}


def read_as_told(words: list[str]):
    """`read_record` called as the words of a command line say."""
    _, path, *rest = words
    arguments = {"resample": True} if "--resample" in rest else {}
    for option, value in itertools.pairwise(rest):
        if option in OPTIONS:
            name, parse = OPTIONS[option]
            arguments[name] = parse(value)
    return read_record(path, **arguments)


@pytest.mark.parametrize(("write", "fragments"), [case[1:] for case in CASES], ids=[case[0] for case in CASES])
def test_a_bad_record_gets_one_clear_sentence(tmp_path, write, fragments):
    words = write(tmp_path)
    with pytest.raises(BadInput) as caught:
        read_as_told(words)
    text = sentence_of(caught.value)
    assert words[1] in text or text.startswith("--")
    for fragment in fragments:
        assert fragment in text


def test_the_table_starts_from_a_good_record(tmp_path):
    record = read_as_told(table(without())(tmp_path))
    assert record.samples == N


def test_a_file_without_permission_gets_a_sentence(tmp_path):
    words = table(without())(tmp_path)
    os.chmod(words[1], 0)
    if os.access(words[1], os.R_OK):
        pytest.skip("this user may read everything")
    with pytest.raises(BadInput, match="cannot be read"):
        read_as_told(words)


def test_mat_7_3_without_h5py_says_what_to_install(tmp_path, monkeypatch):
    write_hdf5(tmp_path / "rec.mat", good())
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(BadInput) as caught:
        read_record(tmp_path / "rec.mat")
    assert 'pip install "jaxbacklash[io]"' in sentence_of(caught.value)
