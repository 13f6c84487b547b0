"""What stands above, between and below the rows of a text table is passed over, used, or refused with its line."""

import re

import numpy as np
import pytest

from jaxbacklash.errors import BadInput
from jaxbacklash.records.text import read_text
from tests.good_table import ROWS, T, X, Z, assert_good, put, read, text

TEK = """Model,DPO2014
Firmware Version,1.44

Point Format,Y,
Horizontal Units,s,
Horizontal Scale,0.4,
Sample Interval,0.002,
Record Length,120,
Vertical Units,V,V
,,
Label,base,rel
"""
LECROY = (
    "LECROYWR62Xi,62431,Waveform\nSegments,1,SegmentSize,120\nSegment,TrigTime,TimeSinceSegment1\n#1,12-Nov-2025 10:03:29,0\n"
)
KUKA = "; KUKA trace\n;channels: A1 A2\n\nName;Trace_7\nCycleTime [ms];2\n\n"
LVM_TOP = (
    "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\nMulti_Headings\tYes\n"
    "X_Columns\tOne\nTime_Pref\tRelative\nOperator\tlab\nDate\t2025/11/12\nTime\t10:03:29.5\n***End_of_Header***\t\n\t\n"
)
LVM_SEGMENT = (
    "Channels\t2\t\t\nSamples\t120\t120\t\nDate\t2025/11/12\t2025/11/12\t\nTime\t10:03:29.5\t10:03:29.5\t\n"
    "Y_Unit_Label\trad\trad\t\nX_Dimension\tTime\tTime\t\nX0\t0.0\t0.0\t\nDelta_X\t0.002\t0.002\t\n***End_of_Header***\t\t\t\n"
    "X_Value\tA\tB\tComment\n"
)


@pytest.mark.parametrize(
    ("above", "separator", "names", "rate"),
    [
        (TEK + "TIME,CH1,CH2\n", ",", ("TIME", "CH1", "CH2"), 500.0),
        (LECROY + "Time,Ampl1,Ampl2\n", ",", ("Time", "Ampl1", "Ampl2"), None),
        ("Rigol\nt,CH1,CH2\n", ",", ("t", "CH1", "CH2"), None),
        (KUKA + "Time_s;A1.ActPos;A2.ActPos\n", ";", ("Time_s", "A1.ActPos", "A2.ActPos"), 500.0),
        (LVM_TOP + LVM_SEGMENT, "\t", ("X_Value", "A", "B"), 500.0),
        ("Operator: M. Smith, lab 3\nSample rate: 500 Hz\nRig: no. 4\n\nt,x,z\n", ",", ("t", "x", "z"), 500.0),
        ("% rig 4\n% t x z\n", " ", ("t", "x", "z"), None),
        ("# t,x,z\n", ",", ("t", "x", "z"), None),
        ("#t x z\n", " ", ("t", "x", "z"), None),
        ("# rig\n#\n# t\tx\tz\n", "\t", ("t", "x", "z"), None),
        ("// exported\n// t; x; z\n", ";", ("t", "x", "z"), None),
        ("; exported\n; t, x, z\n", ",", ("t", "x", "z"), None),
        ("# t,x,z\n", " ", ("t", "x", "z"), None),
        ("Time (s)  Base (deg)  Rel (deg)\n", "\t", ("Time (s)", "Base (deg)", "Rel (deg)"), None),
        ("t, x, z\n", " ", ("t", "x", "z"), None),
        ("fs = 500\n[Data]\nt,x,z\n", ",", ("t", "x", "z"), 500.0),
        ("t,x,z\n[Data]\n", ",", ("t", "x", "z"), None),
        ("mass,stiffness,damping\n1.5,200,0.1\n\nt,x,z\n", ",", ("t", "x", "z"), None),
        ("\n\n\nt,x,z\n", ",", ("t", "x", "z"), None),
        ("x in mm is not used\nwhere the rig stood, and when\nt,x,z\n", ",", ("t", "x", "z"), None),
    ],
)
def test_what_stands_above_a_table(tmp_path, above, separator, names, rate):
    table = read(tmp_path, above + text(separator, names=()))
    assert_good(table, names)
    assert table.rate_hz == rate
    assert table.first_line == above.count("\n") + 1
    assert table.place(3) == f"row 4 (line {above.count(chr(10)) + 4})"


@pytest.mark.parametrize(
    ("above", "separator", "names", "units"),
    [
        ("Time,Channel A,Channel B\n(ms),(mV),(mV)\n\n", ",", ("Time", "Channel A", "Channel B"), ("ms", "mV", "mV")),
        ("in s,C1 in V,C2 in V\n", ",", ("in s", "C1 in V", "C2 in V"), ("s", "V", "V")),
        ("x-axis,1,2\nsecond,Volt,Volt\n", ",", ("x-axis", "1", "2"), ("second", "Volt", "Volt")),
        ("Model,SDS1104,,\nSource,CH1,CH2\nSecond,Volt,Volt\n", ",", ("Source", "CH1", "CH2"), ("Second", "Volt", "Volt")),
        ("Time (s) Run #1,Pos (rad) Run #1,z\n", ",", ("Time (s) Run #1", "Pos (rad) Run #1", "z"), ("s", "rad", "")),
        ('"Time\n[s]","x\n[deg]",z\n', ",", ("Time [s]", "x [deg]", "z"), ("s", "deg", "")),
        ('Rig 5" arm\nt,x,z\n', ",", ("t", "x", "z"), ("", "", "")),
        ("% Created by MATLAB\n% time\n% base\n% rel\n", " ", ("time", "base", "rel"), ("", "", "")),
        ("# Created by Octave 8.4\n# name: data\n# columns: 3\n", " ", ("column 1", "column 2", "column 3"), ("", "", "")),
        ("| t | x | z |\n|---|---|---|\n", "|", ("t", "x", "z"), ("", "", "")),
        ("Time (s) Base angle (deg) z (rad)\n", " ", ("Time (s)", "Base angle (deg)", "z (rad)"), ("s", "deg", "rad")),
        ("".join(f"Key {row}: value {row}\n" for row in range(1500)) + "t,x,z\n", ",", ("t", "x", "z"), ("", "", "")),
        ("".join(f"# line {row}, 1, 2\n" for row in range(400)) + "t,x,z\n", ",", ("t", "x", "z"), ("", "", "")),
        ("\n".join(f"ch{row},{row},{2 * row}" for row in range(60)) + "\n\nt,x,z\n", ",", ("t", "x", "z"), ("", "", "")),
        ("t,x,z,\n", ",", ("t", "x", "z"), ("", "", "")),
        ("t\tx\tz\n", ",", ("t", "x", "z"), ("", "", "")),
    ],
)
def test_headers_of_many_instruments(tmp_path, above, separator, names, units):
    table = read(tmp_path, above + text(separator, names=()))
    assert_good(table, names)
    assert tuple(column.unit for column in table.columns) == units


def test_rigols_increment_stands_behind_the_names(tmp_path):
    lines = ["X,CH1,CH2,Start,Increment,", "Sequence,Volt,Volt,-6.0e-2,2.0e-3,"]
    lines += [f"{row},{x:.9g},{z:.9g},,," for row, (x, z) in enumerate(zip(X, Z, strict=True))]
    table = read(tmp_path, "\n".join(lines) + "\n")
    assert table.names == ["X", "CH1", "CH2"]
    assert [column.unit for column in table.columns] == ["", "Volt", "Volt"]
    assert table.rate_hz == pytest.approx(500.0)
    np.testing.assert_allclose(table.columns[1].values, X)


def test_a_labview_file_of_two_segments(tmp_path):
    rows = text("\t", names=())
    table = read(tmp_path, LVM_TOP + LVM_SEGMENT + rows + "\n" + LVM_SEGMENT + rows, "rec.lvm")
    assert table.names == ["X_Value", "A", "B"]
    np.testing.assert_array_equal(table.columns[0].values, [*T, *T])
    assert any("comes again at line" in note for note in table.notes)


def test_a_labview_file_without_times(tmp_path):
    rows = "".join(f"\t{x}\t{z}\t\n" for x, z in zip(X, Z, strict=True))
    table = read(tmp_path, LVM_TOP.replace("One", "No") + LVM_SEGMENT + rows, "rec.lvm")
    np.testing.assert_allclose(table.columns[0].values, T, rtol=1e-12)
    np.testing.assert_array_equal(table.columns[2].values, Z)


def test_numbers_without_names_go_by_number(tmp_path):
    table = read(tmp_path, text(names=()))
    assert_good(table, ("column 1", "column 2", "column 3"))
    assert table.details["header line"] == "none"
    assert any("no line of names" in note for note in table.notes)


@pytest.mark.parametrize("mark", ["#", "%", "//", ";"])
def test_comments_and_blank_lines_between_rows(tmp_path, mark):
    lines = text().splitlines()
    lines = put(60, "")(put(40, f"{mark} noon, 12, 3")(lines))
    table = read(tmp_path, "\n".join(lines) + "\n")
    assert_good(table)
    assert table.place(0) == "row 1 (line 2)"
    assert table.place(ROWS - 1) == f"row {ROWS} (line {ROWS + 3})"


@pytest.mark.parametrize(
    "footer",
    [
        "End of data",
        "\nSamples: 120",
        "# end",
        "\n\n\n",
        "Total rows,120",
        "Total,,12.5",
        ",,\n,,\n",
        "\nMean,0.1,0.2\nStd,0.1,0.2\n",
    ],
)
def test_a_footer_is_passed_over(tmp_path, footer):
    assert_good(read(tmp_path, text() + footer))
    assert_good(read(tmp_path, text() + footer + "\n"))


def test_a_header_that_comes_again_is_passed_over_and_said(tmp_path):
    lines = text().splitlines()
    table = read(tmp_path, "\n".join(put(51, lines[0])(lines)) + "\n")
    assert_good(table)
    assert any("comes again at line 51" in note for note in table.notes)


@pytest.mark.parametrize("names", [("t", "x", "z", ""), ("t", "x", "z")])
def test_separators_at_the_end_of_every_line(tmp_path, names):
    body = text(names=()).replace("\n", ",\n")
    assert_good(read(tmp_path, ",".join(names) + "\n" + body))
    assert_good(read(tmp_path, ",".join(names) + "\n" + body.replace(",\n", ",,,\n")))


@pytest.mark.parametrize(
    ("number", "line", "fragment"),
    [
        (17, "0.03,0.1", "line 17: found 2 values, wanted 3 (t, x, z)"),
        (17, "0.03,0.1,0.2,0.3", "line 17: found 4 values, wanted 3"),
        (17, "logger restarted", "line 17: found 1 value"),
        (100, "*** overrun ***", "line 100: found 1 value"),
        (50, '0.1,"0.2,0.3', "line 50: found a quotation mark without an end"),
    ],
)
def test_a_line_that_breaks_the_table_is_named(tmp_path, number, line, fragment):
    with pytest.raises(BadInput, match=re.escape(fragment)):
        read(tmp_path, "\n".join(put(number, line)(text().splitlines())) + "\n")


def test_half_a_last_line_is_refused(tmp_path):
    with pytest.raises(BadInput, match="line 122: found 2 of 3 values and then the end of the file, which looks half-written"):
        read(tmp_path, text() + "0.240,0.1")


def test_two_tables_are_refused(tmp_path):
    with pytest.raises(BadInput, match="line 42: found a second table") as caught:
        read(tmp_path, "\n".join([*text().splitlines()[:41], "a,b,c", *text(names=()).splitlines()]) + "\n")
    assert "--skip 41" in str(caught.value)
    assert_good(read_text(tmp_path / "rec.csv", skip=41), ("a", "b", "c"))


def test_skip_passes_lines_over(tmp_path):
    table = read(tmp_path, "gain,offset,serial\n1.02,0.5,17\n0.98,0.1,18\n" + text(), skip=3)
    assert_good(table)
    assert table.place(0) == "row 1 (line 5)"
    with pytest.raises(BadInput, match="after the 500 lines that --skip passes over"):
        read(tmp_path, text(), skip=500)


def test_the_file_says_how_it_was_read(tmp_path):
    table = read(tmp_path, TEK + text(";", mark=",", names=("TIME", "CH1", "CH2")))
    assert table.details == {
        "encoding": "utf-8",
        "separator": "semicolon",
        "decimal mark": "comma",
        "header line": "12",
        "first line of values": "13",
        "lines passed over": "1 to 11",
    }
    assert any("lines 1 to 11 above the table are passed over" in note for note in table.notes)
