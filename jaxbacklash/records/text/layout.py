"""Where the table in a text file begins, what separates its cells, and the names and units of its columns."""

from __future__ import annotations

import dataclasses
import re

from jaxbacklash.errors import BadInput

from ..checks import wrong
from .cells import MISSING, NUMBER, STAMP, WORD
from .head import NAMES, SEPARATORS, WINDOWS, Head, Line, Run, read_lines, with_whole_cells
from .header import find_names
from .opening import Source
from .statements import stated_rate

ENCODINGS = {
    "utf-8-sig": "utf-8",
    "cp1252": "Windows-1252 (Latin-1)",
    "utf-16-le": "utf-16 (little end first)",
    "utf-16-be": "utf-16 (big end first)",
}
"""Encodings by Python's names, where those are not what people say."""

STATED_SEPARATOR = re.compile(r'\ufeff?\s*"?sep=(.)"?\s*', re.IGNORECASE)
"""The first line by which Excel is told the separator."""


@dataclasses.dataclass(frozen=True)
class Layout:
    """How a text table is laid out: what its first lines tell.

    Parameters
    ----------
    source : Source
    separator : str or None
        None for any run of blanks.
    names, units : tuple of str
        For each column; units are empty where none is stated.
    header_line : int or None
        Line (from 1) of the names; None where the file has none.
    first_line : int
        Line of the first values.
    kinds : str
        What the first cells of each column are, a letter each; see `cells`.
    width : int
        Cells in a line as written: more than there are names where every line ends with separators.
    quoted : bool
        Whether cells stand in quotes.
    sample : tuple of str
        The lines of values that were looked at.
    repeated : tuple of str
        Lines of the header and the units, which may come again where logs were joined.
    passed : str
        Numbers of the lines above the table that are passed over; empty where there are none.
    notes : tuple of str
        As in `Table`.
    rate_hz : float or None
        Samples per second, where a line states it.
    whole : bool
        Whether the lines that were looked at are all there are.
    """

    source: Source
    separator: str | None
    names: tuple[str, ...]
    units: tuple[str, ...]
    header_line: int | None
    first_line: int
    kinds: str
    width: int
    quoted: bool
    sample: tuple[str, ...]
    repeated: tuple[str, ...]
    passed: str
    notes: tuple[str, ...]
    rate_hz: float | None
    whole: bool

    def details(self, mark: str, skip: int) -> dict[str, str]:
        """How the file is read, for a person; ``mark`` is the decimal mark, ``skip`` the lines passed over unseen."""
        details = {"encoding": ENCODINGS.get(self.source.encoding, self.source.encoding)}
        if self.source.gzip:
            details["packed"] = "gzip"
        details["separator"] = NAMES.get(self.separator, str(self.separator))
        details["decimal mark"] = {".": "point", ",": "comma"}[mark]
        details["header line"] = "none" if self.header_line is None else str(self.header_line)
        details["first line of values"] = str(self.first_line)
        if self.passed:
            details["lines passed over"] = self.passed
        if skip:
            details["lines skipped"] = str(skip)
        return details


def find_layout(source: Source, skip: int) -> Layout:
    """Look at the first lines of a file.

    Parameters
    ----------
    source : Source
    skip : int
        Lines to pass over unseen.

    Raises
    ------
    BadInput
        Where there is no table: only blank lines, comments, words, or a header and nothing below it.
    """
    where = str(source.path)
    head, run, whole = _look(source, skip)
    if run is None or _is_prose(head, run):
        raise _no_table(head, where, skip)
    first = _beginning(head, run, where)
    run = dataclasses.replace(run, first=first)
    names = find_names(head, run, where)
    top = names.first if names.first is not None else first
    notes = list(names.notes)
    above = [line for line in head.lines[:top] if not line.blank and not STATED_SEPARATOR.fullmatch(line.text)]
    passed = ""
    if above:
        start, stop = above[0].number, above[-1].number
        passed = f"{start} to {stop}" if stop > start else f"{start}"
        if not all(line.comment for line in above):
            lines = f"lines {passed}" if stop > start else f"line {passed}"
            notes.insert(0, f"{lines} above the table {'are' if stop > start else 'is'} passed over")
    rate, said = stated_rate(line.text for line in [*head.lines[:first], *_comments(head, first)])
    rate = rate or names.rate_hz
    if rate is None and said:
        notes.append(said)
    sample = [
        line.text for index, line in enumerate(head.lines[first : run.last + 1], first) if not head.passed(index, run.separator)
    ]
    return Layout(
        source=source,
        separator=run.separator,
        names=names.names,
        units=names.units,
        header_line=names.line,
        first_line=head.lines[first].number,
        kinds=run.kinds[: len(names.names)].ljust(len(names.names), MISSING),
        width=run.width,
        quoted=any('"' in line for line in sample),
        sample=tuple(sample),
        repeated=names.texts,
        passed=passed,
        notes=tuple(notes),
        rate_hz=rate,
        whole=whole,
    )


def _look(source: Source, skip: int) -> tuple[Head, Run | None, bool]:
    """As many lines as are needed to see the table, its first rows, and whether these are all lines of the file."""
    where = str(source.path)
    lines: list[Line] = []
    with source.lines(skip) as file:
        for window in WINDOWS:
            wanted = window - len(lines)
            more = read_lines(file, skip + len(lines) + 1, wanted, where)
            lines += more
            stated = STATED_SEPARATOR.fullmatch(lines[0].text) if lines else None
            head = Head(with_whole_cells(lines[1:] if stated else lines))
            run = (head.best((_mark(stated[1]),)) if stated else None) or head.best(SEPARATORS)
            ended = len(more) < wanted
            if ended or (
                run
                and 2 * sum(kind in NUMBER + STAMP for kind in run.kinds) > run.width
                and run.last - run.first >= 8
                and all(head.passed(i, run.separator) for i in range(run.last + 1, len(head.lines)))
            ):
                break
        whole = not file.read(1)
    return head, run, whole


def _mark(separator: str) -> str | None:
    return None if separator == " " else separator


FEWEST_ROWS, LEAST_SHARE = 10, 0.1
"""Fewer rows than this, and less than this share of all lines, are numbers in a text, such as its date or its chapters."""


def _is_prose(head: Head, run: Run) -> bool:
    """Whether lines with numbers are lost among others that are no preamble of theirs."""
    lines = [index for index in range(len(head.lines)) if not head.passed(index, run.separator)]
    rows = sum(run.first <= index <= run.last for index in lines)
    below = sum(index > run.last for index in lines)
    return rows < FEWEST_ROWS and (rows < LEAST_SHARE * len(lines) or below > max(3, rows))


def _no_table(head: Head, where: str, skip: int) -> BadInput:
    """The refusal of a file in which no line holds a value."""
    kept = [line for line in head.lines if not line.blank]
    after = f" after the {skip} lines that --skip passes over" if skip else ""
    if not kept and skip:
        return wrong(where, f"nothing{after}", "a header line and numbers")
    if all(line.comment for line in kept):
        return wrong(where, f"only blank lines or comments{after}", "a header line and numbers")
    if len(kept) == 1:
        return wrong(where, f"a header line and no values below it{after}", "one line of numbers per sample")
    shown = " ".join(kept[-1].text.split())[:60]
    return wrong(
        where,
        f'no table of numbers{after} in the first {len(head.lines)} lines, the last of which is "{shown}"',
        "one line of numbers per sample",
    )


def _beginning(head: Head, run: Run, where: str) -> int:
    """Index of the first line of values.

    Above the best run there may be more of the table: a row with a word for a number parts it, a line of another width (which
    is refused later, by its number), or a header that comes again.

    Raises
    ------
    BadInput
        Where another table stands above: all its rows would be lost.
    """
    values = [place for place, kind in enumerate(run.kinds) if kind in (NUMBER, STAMP)]
    first, rows = run.first, 0
    words: list[int] = []
    for index in reversed(range(run.first)):
        if head.passed(index, run.separator):
            continue
        kinds = head.kinds(index, run.separator).rstrip(MISSING)
        whole = len(kinds) > values[-1] and all(kinds[place] in (NUMBER, STAMP) for place in values)
        # A word may stand where a number is missing, but not for the first value: lines above a table begin with words.
        begun = kinds[values[0] : values[0] + 1] == run.kinds[values[0]] and len(head.kinds(index, run.separator)) == run.width
        if len(kinds) > run.width or not (whole or begun):
            words += [index] * (set(kinds) <= {WORD, MISSING} and len(kinds) > 1)
            continue
        rows += 1
        if not words:
            first = index
    if rows and words:
        texts = {head.lines[index].text.strip() for index in words}
        # The same header above both parts: one log behind another.
        if len(texts) == 1 and len(words) > 1:
            return _first_below(head, run, words[-1])
        if first == run.first and rows > PARAMETERS:
            raise _second_table(head, words[0], where)
    return first


PARAMETERS = 20
"""A table of more rows than this above another is no list of parameters: which of the two is meant must be said."""


def _first_below(head: Head, run: Run, header: int) -> int:
    """Index of the first line of values below a header."""
    rows = (index for index in range(header + 1, run.first) if not head.passed(index, run.separator))
    return next((index for index in rows if set(head.kinds(index, run.separator)) & {NUMBER, STAMP}), run.first)


def _second_table(head: Head, index: int, where: str) -> BadInput:
    """The refusal of a file with two tables."""
    line = head.lines[index]
    shown = " ".join(line.text.split())[:40]
    wanted = f"one table; --skip {line.number - 1} passes over what is above this one"
    return wrong(f"{where} line {line.number}", f'a second table ("{shown}")', wanted)


def _comments(head: Head, first: int) -> list[Line]:
    """Comments between the first rows of values."""
    return [line for line in head.lines[first:] if line.comment]
