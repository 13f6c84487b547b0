"""The first lines of a text table under each separator that it may have: where rows of values begin and how wide they are."""

from __future__ import annotations

import dataclasses
import functools
import itertools
import re
from typing import TextIO

from ..checks import wrong
from .cells import MISSING, NUMBER, STAMP, WORD, kinds, split
from .opening import LONGEST_LINE

WINDOWS = (100, 1200, 10000)
"""Lines looked at first, and as many more where rows of values do not fill the end of what was looked at."""

COMMENT = re.compile(r'\s*(?:"?(?:#(?!N/A|NV|VALUE|DIV|NUM|REF)|%|//)|!(?=\s|$))')
MOST_LOOKED_AT = 2**21
"""Characters looked at, however few lines they are."""

LINES_OF_A_CELL = 6
"""A quoted name may span as many lines; a quotation mark without an end within them is an inch."""

ENOUGH = 0.45
"""A separator that finds less than this share of the values of another is out of the question."""

SEPARATORS = ("\t", ";", ",", "|", None)
NAMES = {"\t": "tab", ";": "semicolon", ",": "comma", "|": "bar", None: "blanks", ":": "colon"}


@dataclasses.dataclass(frozen=True)
class Line:
    """One line of the head: its number in the file (from 1), its text, and whether it is blank or a comment."""

    number: int
    text: str
    comment: bool

    @property
    def blank(self) -> bool:
        """Whether nothing stands in the line."""
        return not self.text.strip()


@dataclasses.dataclass(frozen=True)
class Run:
    """Lines of equal make, one below the other.

    ``first`` and ``last`` are indices of lines in the head, ``width`` the cells of each, ``kinds`` what its cells are (a letter
    each, see `cells`), ``values`` how many cells of the run are numbers or stamps.
    """

    separator: str | None
    first: int
    last: int
    kinds: str
    values: int

    @property
    def width(self) -> int:
        """Cells in a line."""
        return len(self.kinds)

    @property
    def score(self) -> float:
        """How much it looks like a table: cells that are values, times the square of the share that they are."""
        filled = sum(kind != MISSING for kind in self.kinds)
        share = sum(kind in NUMBER + STAMP for kind in self.kinds) / max(filled, 1)
        return self.values * share**2


def read_lines(file: TextIO, first: int, count: int, where: str) -> list[Line]:
    """Up to ``count`` lines from line ``first`` on, fewer where they are long; refuses one too long for a line of a table."""
    lines: list[Line] = []
    left = MOST_LOOKED_AT
    for number in range(first, first + count):
        text = file.readline(LONGEST_LINE + 1) if left > 0 else ""
        left -= len(text)
        if not text:
            break
        if len(text) > LONGEST_LINE:
            wanted = "one line a sample, with a line end behind each"
            raise wrong(f"{where} line {number}", f"a line of more than {LONGEST_LINE} characters", wanted)
        lines.append(Line(number, text, COMMENT.match(text) is not None))
    return lines


def with_whole_cells(lines: list[Line]) -> list[Line]:
    """Lines of which those are joined that a quoted cell spans, as names in spreadsheets do ("Time" above "[s]")."""
    whole: list[Line] = []
    rest = iter(range(len(lines)))
    for index in rest:
        line = lines[index]
        if line.text.count('"') % 2 and not line.comment:
            end = next(
                (more for more in range(index + 1, min(index + LINES_OF_A_CELL, len(lines))) if lines[more].text.count('"') % 2),
                None,
            )
            if end is not None:
                parts = [each.text.strip("\r\n") for each in lines[index : end + 1]]
                line = Line(line.number, " ".join(parts) + "\n", False)
                for _ in range(end - index):
                    next(rest)
        whole.append(line)
    return whole


class Head:
    """The first lines of a file, cut and judged as far as anybody asks."""

    def __init__(self, lines: list[Line]):
        self.lines = lines
        self.cells = functools.cache(lambda index, separator: split(self.lines[index].text, separator))
        self.kinds = functools.cache(lambda index, separator: kinds(self.cells(index, separator)))

    def passed(self, index: int, separator: str | None) -> bool:
        """Whether a line holds no cells: blank, a comment, or the ";" that begins one in robot controllers."""
        line = self.lines[index]
        return line.blank or line.comment or (separator != ";" and line.text.lstrip().startswith(";"))

    def runs(self, separator: str | None) -> list[Run]:
        """All runs of lines with values, in order."""
        runs: list[Run] = []
        first = last = values = 0
        form = ""
        for index in range(len(self.lines)):
            if self.passed(index, separator):
                continue
            kinds = self.kinds(index, separator)
            valued = kinds.count(NUMBER) + kinds.count(STAMP)
            joined = _joined(form, kinds) if form and valued else None
            if joined is None:
                if form:
                    runs.append(Run(separator, first, last, form, values))
                first, values, form = index, 0, kinds if valued else ""
            else:
                form = joined
            last = index
            values += valued
        if form:
            runs.append(Run(separator, first, last, form, values))
        return runs

    def cells_at_most(self, separator: str | None) -> int:
        """Cells that are not empty in all lines, or somewhat more; none where the separator is in no line."""
        if separator is None:
            return sum(len(line.text.split()) for line in self.lines)
        marks = sum(line.text.count(separator) for line in self.lines)
        return marks + len(self.lines) if marks else 0

    def best(self, separators: tuple[str | None, ...]) -> Run | None:
        """The run that looks most like a table, and of equal ones that of the separator named first."""
        found: list[Run] = []
        most = 0.0
        for mark in separators:
            # As many cells cannot be enough, even if all were values: the lines are not cut for that.
            if self.cells_at_most(mark) < max(ENOUGH * most, 1):
                continue
            runs = self.runs(mark)
            if runs:
                found.append(max(runs, key=lambda run: run.score))
                most = max(most, found[-1].score)
        # "0,5" below "z" is one number: a run with a header of its own width is taken before one of twice the numbers.
        near = [run for run in found if run.score >= ENOUGH * most]
        return max(near, key=lambda run: (self.fits_above(run), round(run.score, 6)), default=None)

    def fits_above(self, run: Run) -> bool:
        """Whether the line above a run has as many cells, none of them a value."""
        above = next((i for i in reversed(range(run.first)) if not self.passed(i, run.separator)), None)
        if above is None:
            return False
        kinds = self.kinds(above, run.separator).rstrip(MISSING)
        return len(kinds) == len(run.kinds.rstrip(MISSING)) and set(kinds) <= {WORD, MISSING}


def _joined(form: str, kinds: str) -> str | None:
    """What two lines of one table are together; None where they cannot be of one."""
    if form == kinds:
        return form
    if len(form) != len(kinds):
        # A separator behind the last value may be there or not.
        short, long = sorted((form, kinds), key=len)
        if long[len(short) :].strip(MISSING):
            return None
    both = []
    for one, other in itertools.zip_longest(form, kinds, fillvalue=MISSING):
        if one == other or other == MISSING:
            both.append(one)
        elif one == MISSING:
            both.append(other)
        elif WORD not in (one, other):
            both.append(NUMBER)
        else:
            return None
    return "".join(both)
