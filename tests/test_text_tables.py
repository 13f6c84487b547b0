"""Text tables are read as loggers, scopes, spreadsheets and controllers write them, or refused with the line and the way out."""

import gzip
import re
import shlex
import subprocess
import time
import zlib

import numpy as np
import pytest

from jaxbacklash.errors import BadInput
from jaxbacklash.records.text import opening, read_text
from tests.good_table import ROWS, T, X, Z, assert_good, cells, read, text

# ---- Bytes ----

ENCODINGS = ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32", "latin-1", "cp1252"]


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_every_usual_encoding(tmp_path, encoding, packed):
    data = text("\t", names=("t", "x [µm]", "z")).encode(encoding)
    table = read(tmp_path, gzip.compress(data) if packed else data, "rec.csv.gz" if packed else "rec.txt")
    assert_good(table, ("t", "x [µm]", "z"))
    assert table.columns[1].unit == "µm"
    assert ("packed" in table.details) == packed


def test_latin_letters_outside_the_bytes_looked_at_first_hinder_nothing(tmp_path):
    comment = "# " + "rig " * 40000 + "\n"
    assert_good(read(tmp_path, ("# a\n" + comment).encode() + "# 20 °C\n".encode("latin-1") + text().encode()))


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_every_line_end(tmp_path, end):
    table = read(tmp_path, text(end=end))
    assert_good(table)
    assert table.place(7) == "row 8 (line 9)"


def test_mixed_line_ends(tmp_path):
    lines = text().splitlines()
    mixed = "".join(line + end for line, end in zip(lines, ["\n", "\r\n", "\r"] * len(lines), strict=False))
    assert_good(read(tmp_path, mixed))


@pytest.mark.parametrize(
    ("data", "fragment"),
    [
        (b"", "an empty file"),
        (b" \n\n", "an empty file"),
        (b"\0" * 500, "NUL bytes"),
        (bytes(range(256)) * 20, "binary data"),
        (b"PK\x03\x04" + bytes(300), "binary data, packed as zip"),
        (b"\xfd7zXZ\0" + bytes(300), "packed by xz"),
        (text().encode()[:900] + b"\0" * 300, "NUL bytes from line"),
        (text().encode() * 60 + b"\0\0\0\0", "NUL bytes"),
        (gzip.compress(text().encode())[:-20], "ends in the middle"),
        (gzip.compress(text().encode())[:40] + b"abc" + gzip.compress(text().encode())[43:], "damaged gzip"),
        (gzip.compress(bytes(10**7)), "NUL bytes"),
        (b"t,x,z\n" + b"1" * 3_000_000 + b"\n0,1,2\n", "a line of more than 1048576 characters"),
    ],
)
def test_what_is_no_text_is_refused(tmp_path, data, fragment):
    with pytest.raises(BadInput, match=re.escape(fragment)):
        read(tmp_path, data)


def test_a_packed_file_without_end_is_refused_in_little_memory(tmp_path, monkeypatch):
    monkeypatch.setattr(opening, "MOST_UNPACKED", 2**20)
    path = tmp_path / "a file.csv.gz"
    pack = zlib.compressobj(9, zlib.DEFLATED, 31)
    path.write_bytes(pack.compress(b"t,x\n" + b"0.1,0.2\n" * 400_000) + pack.flush())
    with pytest.raises(BadInput, match="more than 1 MB of text") as caught:
        read_text(path)
    assert f"gunzip -k {shlex.quote(str(path))}" in str(caught.value)


# ---- Separators, quotes and decimal marks ----


@pytest.mark.parametrize("end", ["\n", "\r\n"])
@pytest.mark.parametrize("mark", [".", ","])
@pytest.mark.parametrize("separator", [",", ";", "\t", "|", " ", "   ", ", ", " ; ", "\t "])
@pytest.mark.parametrize("quote", ["", '"'])
def test_every_separator_with_points_and_commas(tmp_path, separator, mark, quote, end):
    if mark == "," and "," in separator and not quote:
        pytest.skip("commas between decimal commas: refused, see below")
    table = read(tmp_path, text(separator, mark, quote=quote, end=end))
    assert_good(table)
    assert table.details["decimal mark"] == {".": "point", ",": "comma"}[mark]


def test_commas_between_decimal_commas_are_refused(tmp_path):
    rows = [",".join(f"{value:.3f}".replace(".", ",") for value in row) for row in zip(T, X, Z, strict=True)]
    with pytest.raises(BadInput, match=r"line 2: found 6 values, wanted 3 .*decimal commas in a file separated by commas"):
        read(tmp_path, "\n".join(["t,x,z", *rows]))


@pytest.mark.parametrize("line", ["sep=;", "SEP=;", '"sep=;"', "\ufeffsep=;"])
def test_excels_first_line(tmp_path, line):
    table = read(tmp_path, line + "\r\n" + text(";", end="\r\n"))
    assert_good(table)
    assert table.details["header line"] == "2"


def test_one_column_of_decimal_commas(tmp_path):
    table = read(tmp_path, "z\n" + "\n".join(f"{value:.5f}".replace(".", ",") for value in X) + "\n")
    np.testing.assert_allclose(table.columns[0].values, np.round(X, 5), rtol=1e-15)
    assert len(table.columns) == 1


COUNTS = [500, 1234, -4139, 12, 1006, 4000, -2, 999, 1200, 3141] * 12


@pytest.mark.parametrize("separator", ["\t", ";", "|", " "])
def test_a_comma_that_can_mark_thousands_or_decimals_is_refused(tmp_path, separator):
    rows = [separator.join([f"{t:.3f}", f"{count:,}"]) for t, count in zip(T, COUNTS, strict=True)]
    content = "\n".join([separator.join(["t", "x"]), *rows]) + "\n"
    with pytest.raises(BadInput) as caught:
        read(tmp_path, content)
    message = str(caught.value)
    assert 'line 3, column x: found "1,234", which can be 1234 or 1.234' in message
    assert "--decimal . if it is 1234" in message
    assert "--decimal , if it is 1.234" in message
    np.testing.assert_array_equal(read(tmp_path, content, decimal=".").columns[1].values, COUNTS)
    small = [count / 1000 if abs(count) > 999 else count for count in COUNTS]
    np.testing.assert_array_equal(read(tmp_path, content, decimal=",").columns[1].values, small)
    # The times are written with points, whatever commas are.
    np.testing.assert_array_equal(read(tmp_path, content, decimal=",").columns[0].values, T)


@pytest.mark.parametrize("counts", [COUNTS, [*range(0, 595, 5), 1234]])
def test_counts_with_points_for_thousands_are_refused_without_a_comma_too(tmp_path, counts):
    rows = [f"{2 * row};" + f"{count:,}".replace(",", ".") for row, count in enumerate(counts)]
    content = "\n".join(["t;x", *rows]) + "\n"
    with pytest.raises(BadInput, match=r'column x: found "1\.234", which can be 1234 or 1\.234.*--decimal , if it is 1234'):
        read(tmp_path, content)
    np.testing.assert_array_equal(read(tmp_path, content, decimal=",").columns[1].values, counts)
    assert read(tmp_path, content, decimal=".").columns[1].values.max() < 1000
    # Between commas they are decimal points.
    assert read(tmp_path, content.replace(";", ",")).columns[1].values.max() < 1000


def test_three_decimals_throughout_are_decimals(tmp_path):
    rows = [f"{t + 1:.3f}\t{100 * x + 200:.3f}" for t, x in zip(T, X, strict=True)]
    table = read(tmp_path, "\n".join(["t\tx", *rows]) + "\n")
    np.testing.assert_array_equal(table.columns[0].values, np.round(T + 1, 3))


@pytest.mark.parametrize(
    "write",
    [
        lambda v: f"{v:,.2f}",
        lambda v: f"{v:,.2f}".replace(",", " "),
        lambda v: f"{v:,.2f}".replace(",", "'"),
        lambda v: f"{v:,.2f}".replace(",", "\u202f"),
        lambda v: f"{v:,.2f}".replace(",", "_").replace(".", ",").replace("_", "."),
        lambda v: f"{v:,.2f}".replace(",", "\u00a0").replace(".", ","),
        lambda v: f"{v:,.2f}".replace(",", "'").replace(".", ","),
    ],
)
def test_thousands_marks_that_can_be_read_in_one_way(tmp_path, write):
    counts = np.array(COUNTS) * 1000.25
    rows = [f"{t:.3f};{write(count)}" for t, count in zip(T, counts, strict=True)]
    table = read(tmp_path, "\n".join(["t;x", *rows]) + "\n")
    np.testing.assert_allclose(table.columns[1].values, np.round(counts, 2), rtol=1e-12)
    np.testing.assert_array_equal(table.columns[0].values, T)


def test_points_that_mark_thousands_beside_decimal_commas(tmp_path):
    rows = [f"{t:.3f}".replace(".", ",") + ";" + f"{count:,}".replace(",", ".") for t, count in zip(T, COUNTS, strict=True)]
    content = "\n".join(["t;x", *rows]) + "\n"
    with pytest.raises(BadInput, match=r'line 3, column x: found "1\.234", which can be 1234 or 1\.234'):
        read(tmp_path, content)
    np.testing.assert_array_equal(read(tmp_path, content, decimal=",").columns[1].values, COUNTS)
    proved = content + "0,240;1.234.567\n"
    np.testing.assert_array_equal(read(tmp_path, proved).columns[1].values, [*COUNTS, 1234567])


# ---- Names and units ----


@pytest.mark.parametrize(
    ("rows", "names", "units"),
    [
        (["t,x,z", "s,deg,deg"], ("t", "x", "z"), ("s", "deg", "deg")),
        (["t,x,z", "[s],[deg],[mrad]"], ("t", "x", "z"), ("s", "deg", "mrad")),
        (["t,x,z", "(ms),(°),(°)"], ("t", "x", "z"), ("ms", "°", "°")),
        (["t,x,z", "s,-,"], ("t", "x", "z"), ("s", "", "")),
        (["s,deg,deg", "t,x,z"], ("t", "x", "z"), ("s", "deg", "deg")),
        (["# t,x,z", "# s,deg,deg"], ("t", "x", "z"), ("s", "deg", "deg")),
        (["# columns: t, x, z", "# units: s, deg, mrad"], ("t", "x", "z"), ("s", "deg", "mrad")),
        (["t,x,z", "# s, deg, deg"], ("t", "x", "z"), ("s", "deg", "deg")),
        (["t,x,z", "# noon, windy, cold"], ("t", "x", "z"), ("", "", "")),
        (["Time [s],x (deg),z/rad"], ("Time [s]", "x (deg)", "z/rad"), ("s", "deg", "rad")),
        (['"Time, s","Base, deg","Rel, deg"'], ("Time, s", "Base, deg", "Rel, deg"), ("s", "deg", "deg")),
        (["t,x,x"], ("t", "x", "x"), ("", "", "")),
        (["Clock,Base,Base", "Time,Pos,Pos"], ("Time", "Pos", "Pos"), ("", "", "")),
        ([",Enc 1,Enc 2", "Time,Pos,Pos"], ("Time", "Enc 1/Pos", "Enc 2/Pos"), ("", "", "")),
        (["Base,,Link", "Pos,Vel,Pos"], ("Base/Pos", "Base/Vel", "Link/Pos"), ("", "", "")),
        ([",x,z"], ("column 1", "x", "z"), ("", "", "")),
    ],
)
def test_names_units_and_groups(tmp_path, rows, names, units):
    table = read(tmp_path, "\n".join(rows) + "\n" + text(names=()))
    if rows[0].startswith("Clock"):
        names = ("Clock/Time", "Base/Pos", "Base/Pos")
    assert_good(table, names)
    assert tuple(column.unit for column in table.columns) == units


def test_the_numbers_that_r_puts_before_rows(tmp_path):
    lines = text().splitlines()
    numbered = [lines[0], *(f'"{number}",{line}' for number, line in enumerate(lines[1:], 1))]
    assert_good(read(tmp_path, "\n".join(numbered) + "\n"), places=(1, 2, 3))


def test_fewer_names_than_values_are_refused(tmp_path):
    with pytest.raises(BadInput, match=r"line 2: found 3 values, wanted 2 \(t, x\), as many as line 1 has names"):
        read(tmp_path, text(names=("t", "x")))


# ---- Cells ----


@pytest.mark.parametrize("word", ["", "NaN", "nan", "-", "--", "NULL", "#N/A", "N/A", "OVERFLOW", "null", "1.#QNAN", " "])
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_cells_without_a_number_are_not_a_number(tmp_path, word, separator):
    rows = cells()
    for row in (20, 21, 90):
        rows[row][1] = word
    table = read(tmp_path, "\n".join(separator.join(row) for row in [["t", "x", "z"], *rows]) + "\n")
    expected = X.copy()
    expected[[20, 21, 90]] = np.nan
    np.testing.assert_array_equal(table.columns[1].values, expected)
    np.testing.assert_array_equal(table.columns[2].values, Z)
    assert any("line 22 and in 2 more rows" in note for note in table.notes) == (word.strip().lower() not in ("", "nan"))


@pytest.mark.parametrize(
    ("write", "unit"),
    [
        (lambda v: f"{v:.9E}", ""),
        (lambda v: f"{v:.9E}".replace("E", "D"), ""),
        (lambda v: f"{v:+.9f}", ""),
        (lambda v: f" {v:.9f} ", ""),
        (lambda v: f"'{v:.9f}'", ""),
        (lambda v: f'="{v:.9f}"', ""),
        (lambda v: f"{v:.9f}".replace("-", "\u2212"), ""),
        (lambda v: f"{v:.9f} rad", "rad"),
        (lambda v: f"{v:.9f}mm", "mm"),
        (lambda v: f"{v:.9f}°", "°"),
        (lambda v: f"{v:.9f}".replace("0.", "."), ""),
    ],
)
def test_numbers_as_programs_write_them(tmp_path, write, unit):
    rows = ["t;x;z", *(f"{t:.3f};{write(x)};{z:.12g}" for t, x, z in zip(T, X, Z, strict=True))]
    table = read(tmp_path, "\n".join(rows) + "\n")
    assert_good(table)
    assert table.columns[1].unit == unit


def test_infinity_truths_and_words(tmp_path):
    rows = [f"{t:.3f},{'Infinity' if row == 5 else '1.5'},{('TRUE', 'FALSE')[row % 2]},{('run', 'stop')[row > 9]},{x}"
            for row, (t, x) in enumerate(zip(T, X, strict=True))]  # fmt: skip
    table = read(tmp_path, "\n".join(["t,limit,on,state,x", *rows]) + "\n")
    assert table.columns[1].values[5] == np.inf
    np.testing.assert_array_equal(table.columns[2].values[:4], [1, 0, 1, 0])
    assert list(table.columns[3].values[8:12]) == ["run", "run", "stop", "stop"]
    np.testing.assert_array_equal(table.columns[4].values, X)


def test_units_that_change_from_cell_to_cell_are_no_numbers(tmp_path):
    rows = [f"{t:.3f},{(f'{1e3 * x:.3f} mrad', f'{x:.6f} rad')[row % 2]}" for row, (t, x) in enumerate(zip(T, X, strict=True))]
    assert read(tmp_path, "\n".join(["t,x", *rows])).columns[1].values.dtype.kind == "U"


@pytest.mark.parametrize("rows", [(3, 90), (0, 1, 2)])
def test_a_word_among_numbers_makes_a_column_of_text_and_costs_no_row(tmp_path, rows):
    lines = [f"{t:.3f},{'ERR' if row in rows else x}" for row, (t, x) in enumerate(zip(T, X, strict=True))]
    table = read(tmp_path, "\n".join(["t,x", *lines]) + "\n")
    assert table.names == ["t", "x"]
    assert np.flatnonzero(table.columns[1].values == "ERR").tolist() == list(rows)


def test_pythons_log_stamps_are_refused_with_the_way_to_mend_them(tmp_path):
    lines = [f"2025-11-12 10:03:{29 + t:06.3f},{x}".replace(".", ",", 1) for t, x in zip(T, X, strict=True)]
    with pytest.raises(BadInput) as caught:
        read(tmp_path, "\n".join(["asctime,x", *lines]) + "\n", "a log.csv")
    command = re.search(r"sed .*? > mended\.csv", str(caught.value))
    assert command is not None
    subprocess.run(["bash", "-c", command[0]], cwd=tmp_path, check=True)
    np.testing.assert_array_equal(read_text(tmp_path / "mended.csv").columns[1].values, X)


@pytest.mark.parametrize("names", [("t [s]", "x", "z"), None])
def test_a_table_that_lies_on_its_side(tmp_path, names):
    lines = [",".join([*([names[row]] if names else []), *map(repr, values.tolist())]) for row, values in enumerate((T, X, Z))]
    table = read(tmp_path, "\n".join(lines) + "\n")
    assert_good(table, names or ("column 1", "column 2", "column 3"))
    assert table.columns[0].unit == ("s" if names else "")
    assert any("each line is taken for a channel" in note for note in table.notes)


def test_underscores_are_no_digits(tmp_path):
    rows = [f"{t:.3f},1_000" for t in T]
    assert read(tmp_path, "\n".join(["t,x", *rows]) + "\n").columns[1].values.dtype.kind == "U"


def test_stamps_of_time_stay_text(tmp_path):
    rows = [f"2025-11-12 10:03:{29 + t:06.3f},{x},{z}" for t, x, z in zip(T, X, Z, strict=True)]
    table = read(tmp_path, "\n".join(["stamp,x,z", *rows]) + "\n")
    assert table.columns[0].values[1] == "2025-11-12 10:03:29.002"
    np.testing.assert_array_equal(table.columns[1].values, X)
    blanks = read(tmp_path, "\n".join(["date time x z", *(row.replace(",", " ") for row in rows)]) + "\n")
    assert blanks.names == ["date", "time", "x", "z"]
    np.testing.assert_array_equal(blanks.columns[3].values, Z)


def test_long_counts_keep_every_digit(tmp_path):
    stamps = 1762941809000000000 + np.arange(ROWS) * 20003
    table = read(tmp_path, "\n".join(["stamp,x", *(f"{stamp},{x}" for stamp, x in zip(stamps, X, strict=True))]) + "\n")
    assert list(table.columns[0].values.astype(np.int64)) == list(stamps)


# ---- Rates stated beside the samples ----


@pytest.mark.parametrize(
    ("line", "rate"),
    [
        ("# Sample rate: 500 Hz", 500.0),
        ("Sample Interval,0.002,,", 500.0),
        ("Delta_X\t0.002\t0.002", 500.0),
        ("# fs = 1000", 1000.0),
        ("% Fs: 2 kHz", 2000.0),
        ("Sampling Rate;1,5;kHz", 1500.0),
        ("Sample Rate (kHz): 1", 1000.0),
        ("Sampling period: 2 ms", 500.0),
        ("dt=1e-3", 1000.0),
        ("Abtastrate: 500 Hz", 500.0),
        ("Sample time: 500 us", 2000.0),
        ("sample rate [S/s]: 250", 250.0),
        ("Excitation frequency: 3 Hz", None),
        ("Date: 2025-11-12", None),
        ("Sample rate: unknown", None),
        ("Sample rate: 0 Hz", None),
        ("Sampling: 2 ms", 500.0),
        ("Rate of turn: 5", None),
    ],
)
def test_rates_stated_beside_the_samples(tmp_path, line, rate):
    table = read(tmp_path, f"{line}\nx,z,y\n" + text(names=()))
    assert table.rate_hz == (None if rate is None else pytest.approx(rate))


def test_two_rates_that_contradict_each_other_are_not_used(tmp_path):
    table = read(tmp_path, "# Sample rate: 500 Hz\n# dt = 0.001\n" + text())
    assert table.rate_hz is None
    assert any("two rates are stated" in note for note in table.notes)


@pytest.mark.parametrize(
    "content",
    [
        "This is a letter.\nIt holds no table, and on 3 May 2025 it was written.\n" * 20,
        "Read me\n\nThe scripts estimate a model (from position,\nvelocity 1, 2).\nIt was\nmade\nby us\nand them\nall\n",
        "<html><body>\n<p>no</p>\n</body></html>\n",
        '[{"t": 0, "x": 1},\n{"t": 1, "x": 2}]\n',
    ],
)
def test_prose_is_no_table(tmp_path, content):
    with pytest.raises(BadInput, match=r"no table of numbers|no values below it"):
        read(tmp_path, content)


def test_a_table_of_very_many_columns_is_seen_quickly(tmp_path):
    values = np.round(np.random.default_rng(0).normal(size=(90, 10_000)), 3)
    lines = [",".join(f"c{column}" for column in range(values.shape[1])), *(",".join(map(str, row)) for row in values.tolist())]
    start = time.process_time()
    table = read(tmp_path, "\n".join(lines) + "\n")
    assert time.process_time() - start < 20.0
    np.testing.assert_array_equal(table.columns[-1].values, values[:, -1])
