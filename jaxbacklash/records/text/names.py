"""A row of names brought to one name for each column of values, or refused."""

from __future__ import annotations

import re
import shlex

from ..checks import listed, wrong
from .cells import MISSING, NUMBER, STAMP, split
from .head import COMMENT, SEPARATORS, Head, Run


def bare_comment(text: str) -> str:
    """A comment without its mark."""
    return re.sub(r"^\s*\"?(?:#+|%+|//+|;+|!+)", "", text.rstrip("\r\n"))


def fit_names(cells: list[str], head: Head, index: int, run: Run, where: str) -> list[str]:
    """The names, one for each column of values.

    Parameters
    ----------
    cells : list of str
        Line ``index`` of the head cut as values are.
    where : str
        The file, for the sentence.

    Raises
    ------
    BadInput
        There are more or fewer names than values, however the line is cut.
    """
    width = run.width
    # Every line may end with a separator, and then the last column is none; LabVIEW writes a name for comments.
    filled = len(run.kinds.rstrip(MISSING))
    while len(cells) > width and (not cells[-1] or cells[-1].lower() == "comment"):
        cells = cells[:-1]
    if len(cells) == width:
        while width > filled and not cells[-1]:
            cells, width = cells[:-1], width - 1
        # "t, x, z" above values between blanks is cut at blanks too, and keeps its commas.
        if run.separator is None and any(cell.endswith((",", ";")) for cell in cells[:-1]):
            return [cell.strip(",;") for cell in cells]
        return cells
    if filled <= len(cells) < width:
        return cells
    text = head.lines[index].text.strip("\r\n")
    for other in _other_ways(bare_comment(text) if COMMENT.match(text) else text):
        if filled <= len(other) <= width:
            return other
    if len(cells) == width - 1 and _counts_rows(head, run):
        return ["", *cells]
    line = head.lines[run.first].number
    found = f"{width} value{'s' * (width != 1)}"
    names = f"{len(cells)} ({listed(cells)})"
    raise wrong(
        f"{where} line {line}",
        found,
        f"{names}, as many as line {head.lines[index].number} has names{_hint(cells, head, run, where)}",
    )


def _counts_rows(head: Head, run: Run) -> bool:
    """Whether values begin with the number of the row, as R writes them, without a name."""
    rows = [row for row in range(run.first, min(run.last, run.first + 5) + 1) if not head.passed(row, run.separator)]
    first = [head.cells(row, run.separator)[0] for row in rows]
    return any(first == [str(start + place) for place in range(len(first))] for start in (0, 1))


def _hint(cells: list[str], head: Head, run: Run, where: str) -> str:
    """The end of the refusal where it is a decimal comma that makes too many values."""
    if run.separator != ",":
        return ""
    if run.width == 2 * len(cells):
        return "; decimal commas in a file separated by commas need quotes, or semicolons as separators"
    if run.width == len(cells) + 1 and run.kinds.startswith(STAMP + NUMBER):
        path = shlex.quote(where)
        return f"; where the comma before milliseconds is one too many: sed -E 's/(:[0-9]{{2}}),/\\1./' {path} > mended.csv"
    return ""


def _other_ways(text: str) -> list[list[str]]:
    """A header cut otherwise than its values: by another separator, by two blanks or more, behind each unit, at each blank."""
    ways = [split(text, mark) for mark in SEPARATORS if mark and mark in text]
    ways.append([cell for cell in re.split(r"\t+|\s{2,}", text.strip()) if cell])
    united = re.sub(r"\s+([\[(][^\])]*[\])])", "\u00a0\\1", text)
    ways.append(united.split(" "))
    ways.append(re.findall(r"[^\[\]()]+[\[(][^\])]*[\])]", text))
    return [[cell.replace("\u00a0", " ").strip() for cell in way if cell.strip()] for way in ways]
