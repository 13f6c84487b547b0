"""Text around and within the table: preambles, comments, units, separators, decimal and thousands marks, encodings."""

from __future__ import annotations

import codecs

import numpy as np

from tests.odd_files.draft import READ, REFUSED, Draft
from tests.odd_files.kinds import kind, pick

PER_RADIAN = {"deg": 180.0 / np.pi, "mrad": 1e3, "rad": 1.0, "°": 180.0 / np.pi}


@kind("head names container")
def scope_preamble(draft: Draft, rng) -> None:
    """A scope's lines above the table, their commas as many as they like."""
    step = draft.columns[0].values[1]
    draft.above = [f"Model,{pick(rng, 'DPO2024', 'SDS1104', 'RTB2004')}", f"Firmware Version,{rng.integers(1, 9)}.2"]
    draft.above += pick(rng, [""], ["Point Format,Y,", ""], [])
    draft.above += ["Waveform Type,ANALOG,,", "Horizontal Units,s,,", f"Sample Interval,{step:g},,"]
    draft.above += [f"Record Length,{draft.columns[0].values.size},,", "Probe Attenuation,1,1,", "Vertical Offset,0,0,"]
    draft.above += pick(rng, [""], ["Label,base,joint,"], [])
    draft.rename(t="TIME", x="CH1", z="CH2")


@kind("head names marks container")
def labview_preamble(draft: Draft, rng) -> None:
    """LabVIEW's measurement file as text."""
    draft.separator, draft.suffix = "\t", pick(rng, ".lvm", ".txt")
    comma = pick(rng, True, False)
    draft.mark = "," if comma else "."
    size, step = draft.columns[0].values.size, draft.columns[0].values[1]
    draft.above = ["LabVIEW Measurement\t", "Writer_Version\t2", "Reader_Version\t2", "Separator\tTab"]
    draft.above += [f"Decimal_Separator\t{draft.mark}", "Multi_Headings\tNo", "X_Columns\tOne", "Time_Pref\tRelative"]
    draft.above += ["Operator\tlab", "Date\t2024/03/05", "Time\t10:11:12.5", "***End_of_Header***\t", "\t"]
    draft.above += ["Channels\t2\t\t", f"Samples\t{size}\t{size}\t", "Date\t2024/03/05\t2024/03/05\t"]
    draft.above += ["Time\t10:11:12.5\t10:11:12.5\t", "Y_Unit_Label\trad\trad\t", "X_Dimension\tTime\tTime\t", "X0\t0\t0\t"]
    draft.above += [f"Delta_X\t{step:g}\t{step:g}\t".replace(".", draft.mark), "***End_of_Header***\t\t\t"]
    draft.rename(t="X_Value", x="Untitled", z="Untitled 1")
    draft.trailing = "\t"


@kind("head names marks container")
def controller_preamble(draft: Draft, rng) -> None:
    """A controller's trace export."""
    draft.separator = pick(rng, ";", "\t")
    sep = draft.separator
    draft.above = [f"Name{sep}Trace_{rng.integers(1, 99)}", f"File{sep}C:\\Traces\\axis{rng.integers(1, 7)}.tracex"]
    draft.above += [f"Starttime of export{sep}133532345678900000{sep}Tuesday, March 5, 2024{sep}10:11:12", ""]
    draft.above += [f"CycleTime [ms]{sep}{1e3 * draft.columns[0].values[1]:g}", f"Axes{sep}A1{sep}A2", *pick(rng, [""], [])]
    draft.rename(t="Time_s", x="A1.ActPos", z="A2.ActPos")


@kind("head container")
def key_value_preamble(draft: Draft, rng) -> None:
    """A few lines `Key: value` above the header."""
    draft.above = ["Operator: M. Smith, lab 3", f"Date: 2024-03-0{rng.integers(1, 9)}", "Sample rate: 500 Hz", "Rig: joint no. 4"]
    draft.above = draft.above[: int(rng.integers(1, 5))] + pick(rng, [""], [])


@kind("head container")
def comment_lines(draft: Draft, rng) -> None:
    """Comments of every mark, the header among them or not, and a comment at the end."""
    mark = pick(rng, "#", "%", ";", "//")
    draft.above = [f"{mark} exported by tool {rng.integers(1, 9)}", f"{mark} operator: lab, rig: 4"][: int(rng.integers(1, 3))]
    draft.header_prefix = pick(rng, "", f"{mark} ", mark)
    draft.footer = pick(rng, [], [f"{mark} end"])


@kind("head x z container units")
def unit_row(draft: Draft, rng) -> None:
    """A row of units under the header."""
    angle, time = pick(rng, "deg", "rad", "mrad"), pick(rng, "s", "ms")
    _in_units(draft, angle, time)
    left, right = pick(rng, ("", ""), ("[", "]"), ("(", ")"))
    units = (angle if column.channel in ("x", "z") else time for column in draft.columns)
    draft.below_header = [draft.separator.join(f"{left}{unit}{right}" for unit in units)]


@kind("names x z container units")
def units_in_header(draft: Draft, rng) -> None:
    """Units in the column names, in brackets, parentheses or after a slash."""
    angle, time = pick(rng, "deg", "rad", "mrad"), pick(rng, "s", "ms")
    _in_units(draft, angle, time)
    left, right = pick(rng, (" [", "]"), (" (", ")"), ("/", ""), (" / ", ""), ("[", "]"))
    words = pick(rng, ("Time", "Base", "Joint"), ("t", "x", "z"), ("time", "pos_1", "pos_2"))
    names = (f"{name}{left}{unit}{right}" for name, unit in zip(words, (time, angle, angle), strict=True))
    draft.rename(**dict(zip("txz", names, strict=True)))


@kind("names x z bytes container units")
def degree_sign(draft: Draft, rng) -> None:
    """A degree sign in the header, in one of the encodings that loggers use."""
    _in_units(draft, "°", "s")
    draft.encoding = pick(rng, "latin-1", "cp1252", "utf-8", "utf-16")
    draft.rename(t="Time [s]", x="Base [°]", z="Joint [°]")


def _in_units(draft: Draft, angle: str, time: str) -> None:
    for column in draft.columns if time == "ms" else ():
        if column.channel not in ("x", "z"):  # t, and the times that a channel has of its own
            column.values = 1e3 * column.values
    for channel in "xz":
        draft.column(channel).values = PER_RADIAN[angle] * draft.column(channel).values


@kind("head container")
def sep_line(draft: Draft, rng) -> None:
    """Excel's first line sep=;"""
    draft.separator = pick(rng, ";", ",", "\t", "|")
    draft.above = [pick(rng, "sep=", "SEP=", '"sep=') + draft.separator]
    if draft.above[0].startswith('"'):
        draft.above[0] += '"'


@kind("marks container")
def separators(draft: Draft, rng) -> None:
    """Anything that keeps columns apart."""
    draft.separator = pick(rng, "\t", ";", "|", "  ", ", ", " ; ", "\t ")
    draft.suffix = pick(rng, ".csv", ".txt", ".dat", ".tsv")


@kind("marks container")
def decimal_commas(draft: Draft, rng) -> None:
    """Decimal commas, unquoted between other separators."""
    draft.separator, draft.mark = pick(rng, ";", "\t", " ; "), ","


@kind("marks container")
def quoted_decimal_commas(draft: Draft, rng) -> None:
    """Decimal commas, quoted between commas."""
    draft.separator, draft.mark, draft.quoted = ",", ",", "all"


@kind("marks container")
def numbers_as_text(draft: Draft, rng) -> None:
    """All cells in quotes, perhaps with blanks inside."""
    draft.separator, draft.quoted = pick(rng, ",", ";", "\t"), "all"
    if pick(rng, True, False):
        for column in draft.columns:
            column.cells = [f" {cell} " for cell in column.texts()]


@kind("marks x z container")
def thousands_two_ways(draft: Draft, rng) -> None:
    """Counts with a mark that is a thousands mark or a decimal one: nobody can tell from the file."""
    count = 5e-6
    for channel in "xz":
        column = draft.column(channel)
        counts = np.round(column.values / count)
        column.cells = [f"{int(value):,}" for value in counts]
        draft.options += ["--scale", f"{channel}={count:g}"]
    draft.separator = "\t"
    draft.tolerance = count
    draft.expect(REFUSED, r"\d,\d{3}|thousand", r"row|line", remedy=r"decimal[ =]+'?\.")


@kind("marks x z container")
def thousands_one_way(draft: Draft, rng) -> None:
    """Numbers with thousands marks and decimals, which can be read in one way only."""
    for channel in "xz":
        column = draft.column(channel)
        # micro-radians with two decimals
        column.cells = [f"{value:,.2f}" for value in 1e6 * column.values]
        draft.options += ["--unit", f"{channel}=urad"]
    draft.separator = pick(rng, ";", "\t")
    draft.tolerance = 1e-7
    draft.expect(READ)


@kind("tail container")
def trailing_separators(draft: Draft, rng) -> None:
    """A separator too many at the end of every line."""
    draft.trailing = draft.separator


@kind("tail container")
def footer(draft: Draft, rng) -> None:
    """Something under the table."""
    size = draft.columns[0].values.size
    draft.footer = pick(rng, ["End of file"], ["", f"Samples: {size}"], ["# end of trace"], ["", "", ""], [f"Total rows,{size}"])
    draft.footer = list(draft.footer)


@kind("bytes container")
def utf16(draft: Draft, rng) -> None:
    """UTF-16 of both orders, with a mark and without."""
    little, marked = pick(rng, True, False), pick(rng, True, False)
    draft.encoding = "utf-16-le" if little else "utf-16-be"
    if marked:
        draft.byte_mark = codecs.BOM_UTF16_LE if little else codecs.BOM_UTF16_BE


@kind("bytes container")
def other_bytes(draft: Draft, rng) -> None:
    """A UTF-8 mark, lines that end as on Windows, a NUL at the end."""
    choice = int(rng.integers(3))
    if choice == 0:
        draft.byte_mark = codecs.BOM_UTF8
    draft.line_end = "\n" if choice == 0 else "\r\n"
    if choice == 2:
        draft.encoding = "utf-8-sig"


@kind("bytes container")
def gzipped(draft: Draft, rng) -> None:
    """A compressed text file."""
    draft.zipped, draft.suffix = True, pick(rng, ".csv", ".txt", ".dat")
