"""Text tables that NumPy opens itself: the same values, lines and refusals as where it is handed line by line."""

import gzip

import numpy as np
import pytest

from jaxbacklash.records.text import plain
from jaxbacklash.records.text.layout import find_layout
from jaxbacklash.records.text.opening import open_text

ROWS = 300
BAD = [
    "2x", "1_0", "1.5d3", "0x10", "2024-11-02", "1.2.3", "--1", "1e", "e5", "1e5e3", "1e-.5", ".", "-", "1/2", "inf", "nan",
    "+-1", "12:30", "\u0665", "1\u00a0", "\u00b0", '"1"', "", "1 2", " 1", "#", "1#2", "1\t",
]  # fmt: skip


@pytest.fixture
def laid(tmp_path):
    """The layout of a file with these bytes."""

    def layout(data: bytes, name: str = "rec.csv"):
        path = tmp_path / name
        path.write_bytes(data)
        return find_layout(open_text(path), 0)

    return layout


def cells(style: str) -> list[list[str]]:
    """A table of three columns, its second and third with signs."""
    rng = np.random.default_rng(5)
    table = np.stack([np.arange(ROWS) * 0.01, rng.normal(size=ROWS) * 1e-3, rng.normal(size=ROWS) * 40], axis=1)
    return [[style % value for value in row] for row in table]


def written(rows: list[list[str]], separator: str = ",", end: str = "\n", above: str = "t,x,y\n", below: str = "") -> bytes:
    """The bytes of a file."""
    lines = above.replace(",", separator).replace("\n", end)
    return (lines + end.join(separator.join(row) for row in rows) + below.replace("\n", end)).encode()


def same(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether two arrays are equal to the last bit, the sign of a zero included."""
    return a.shape == b.shape and a.tobytes() == b.tobytes()


@pytest.mark.parametrize("style", ["%.18e", "%.6f", "%.9g", "%+.3E", "%d"])
@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("below", ["", "\n", "\n\n\n", "\n# end\n"])
def test_values_and_lines_are_those_of_reading_by_lines(laid, style, separator, end, below):
    layout = laid(written(cells(style), separator, end, "Rig 4\n\nnoon \u00b0\nt,x,y\n", below))
    values, last = plain._at_once(layout)
    expected, line = plain._by_lines(layout, False)
    assert same(values, expected)
    assert last == line
    assert same(values, np.array([[float(cell) for cell in row] for row in cells(style)]))


@pytest.mark.parametrize("bad", BAD)
def test_an_odd_cell_is_read_as_by_lines_or_handed_on(laid, bad, monkeypatch):
    """Whatever one cell holds far below the first lines, both ways give one result, or none."""
    rows = cells("%.6f")
    rows[ROWS - 20][1] = bad
    layout = laid(written(rows))
    found = plain.read_plain(layout, None)
    monkeypatch.setattr(plain, "_at_once", lambda layout: None)
    expected = plain.read_plain(layout, None)
    assert (found is None) == (expected is None)
    if found is not None:
        assert same(found[0], expected[0])
        assert found[1:] == expected[1:]


@pytest.mark.parametrize("every", [2, 3, ROWS - 1])
def test_lines_that_end_another_way_than_most_are_not_cut_off(laid, every):
    lines = written(cells("%.6f")).split(b"\n")
    ends = [b"\r" if number % every == 0 else b"\n" for number in range(1, len(lines))]
    layout = laid(b"".join(line + end for line, end in zip(lines, [b"\n", *ends], strict=True)))
    values, _ = plain._at_once(layout)
    assert same(values, plain._by_lines(layout, False)[0])
    assert len(values) == ROWS


def test_blank_lines_are_not_told_of(laid, recwarn):
    rows = cells("%.6f")
    rows[150:150] = [[""], [""]]
    assert len(plain._at_once(laid(written(rows)))[0]) == ROWS
    assert not recwarn.list


def test_rows_between_blanks_and_comments_keep_their_lines(laid):
    rows = cells("%.6f")
    rows[100:100] = [[""], ["# a remark"]]
    layout = laid(written(rows, below="\n"))
    assert plain._at_once(layout) is not None
    values, _, lines = plain.read_plain(layout, None)
    assert len(values) == ROWS
    assert [lines[99], lines[100]] == [101, 104]


def test_a_byte_that_is_no_character_hinders_no_numbers(laid):
    # So far down that the encoding is judged without it.
    above = f"# {'-' * 70000}\nt,x,y\n"
    layout = laid(written(cells("%.6f"), above=above, below="\n# 20 ") + b"\x81C\n")
    assert layout.source.encoding == "utf-8-sig"
    assert plain._at_once(layout) is None
    assert len(plain.read_plain(layout, None)[0]) == ROWS


def test_packed_files_and_those_called_so_are_read_by_lines(laid):
    data = written(cells("%.6f"))
    for name, held in (("rec.csv", gzip.compress(data)), ("rec.csv.gz", data), ("rec.xz", data)):
        layout = laid(held, name)
        assert plain._at_once(layout) is None
        assert len(plain.read_plain(layout, None)[0]) == ROWS
