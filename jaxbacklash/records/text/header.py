"""Names and units of the columns of a text table: rows of names, of units and of groups above the first line of values."""

from __future__ import annotations

import dataclasses
import re

from ..checks import listed
from ..header_units import is_unit, split_unit
from .cells import MISSING, NUMBER, STAMP, WORD, kind, number_and_unit, split, spread
from .head import SEPARATORS, Head, Run
from .names import bare_comment, fit_names

MARKER = re.compile(
    r"\W*(?:end[ _]?of[ _]?header|(?:begin[ _]|start[ _]?(?:of[ _])?)?(?:data|values|samples|measurements?)|header|table)\W*",
    re.IGNORECASE,
)
"""Lines such as "[Data]" that stand between names and values."""


LABEL = re.compile(r"^\s*(?:units?|einheit(?:en)?|names?|columns?|fields?|channels?|variables?|header)\s*[:=]\s*", re.IGNORECASE)
"""How a comment with names or units may begin: "# columns: t, x, z"."""

Row = tuple[int, list[str]]
"""A row of words: the index of its line in the head, and its cells."""


@dataclasses.dataclass(frozen=True)
class Names:
    """Names and units of the columns.

    ``first`` is the index in the head of the uppermost line that belongs to them and ``line`` the line (from 1) of the names,
    both None where there are none; ``texts`` the lines themselves; ``rate_hz`` what a header of a scope states besides.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    first: int | None = None
    line: int | None = None
    texts: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    rate_hz: float | None = None


def find_names(head: Head, run: Run, where: str) -> Names:
    """The names and units above a run of values.

    Parameters
    ----------
    head : Head
    run : Run
        ``run.first`` is the first line of values.
    where : str
        The file, for sentences.

    Raises
    ------
    BadInput
        Where there are more or fewer names than values.
    """
    filled = len(run.kinds.rstrip(MISSING))
    rows = _chosen(_rows_above(head, run), _commented(head, run), filled, run.width)
    if not rows:
        return _unnamed(head, run)
    titled, units, place = _with_units(rows, filled)
    index, cells = titled
    rate = _increment(cells, units[1], filled) if units and place == "under" else None
    cells = cells[:filled] if rate else fit_names(cells, head, index, run, where)
    used, notes = [titled], []
    behind = [""] * len(cells)
    if units:
        used.append(units)
        behind = [_bare(cell) for cell in spread(units[1], len(cells))[: len(cells)]]
        notes.append(f"the row of units {place} the header ({listed(each or '-' for each in behind)}) is used")
    group = next((row for row in rows if row[0] < min(each[0] for each in used)), None)
    named = [cell for cell in cells if cell]
    if group and len(set(named)) < len(named) and _groups(group[1], len(cells)):
        groups = _filled(spread(group[1], len(cells)))
        cells = [f"{above}/{name}" if above else name for above, name in zip(groups, cells, strict=True)]
        notes.append(f"the row above the header names groups, so columns are called {next(filter(None, cells))} and so on")
        used.append(group)
    names = tuple(name or f"column {number}" for number, name in enumerate(cells, 1))
    return Names(
        names=names,
        units=tuple(unit or split_unit(name)[1] for unit, name in zip(behind, names, strict=True)),
        first=min(row for row, _ in used),
        line=head.lines[index].number,
        texts=tuple(head.lines[row].text.strip(" \t\r\n\ufeff") for row, _ in used),
        notes=tuple(notes),
        rate_hz=rate,
    )


def _chosen(rows: list[Row], commented: list[Row], filled: int, width: int) -> list[Row]:
    """Rows of words or those in comments: words further up that do not fit the values are a preamble."""
    if commented and not (rows and filled <= len(_trimmed(rows[0][1])) <= width):
        return commented
    if commented and len(rows) == 1 and _all_units(commented[0][1], filled) and commented[0][0] > rows[0][0]:
        return [commented[0], *rows]
    return rows


def _with_units(rows: list[Row], filled: int) -> tuple[Row, Row | None, str]:
    """The row of names, the row of units if there is one, and whether that stands "under" the names or "above" them."""
    if len(rows) > 1 and _all_units(rows[0][1], filled):
        return rows[1], rows[0], "under"
    if len(rows) > 1 and _all_units(rows[1][1], filled):
        return rows[0], rows[1], "above"
    return rows[0], None, ""


def _trimmed(cells: list[str]) -> list[str]:
    """Cells without empty ones at the end."""
    return cells if not cells or cells[-1] else _trimmed(cells[:-1])


def _rows_above(head: Head, run: Run) -> list[Row]:
    """Up to three rows of words right above the values, the nearest first."""
    rows: list[Row] = []
    for index in reversed(range(run.first)):
        line = head.lines[index]
        if head.passed(index, run.separator) or MARKER.fullmatch(line.text.strip()) or not line.text.strip("-=+|: \t\r\n"):
            if rows and line.blank:
                break
            continue
        cells = _row_of_words(line.text, run)
        if cells is None and len(rows) == 1 and _numbered_names(split(line.text, run.separator), rows[0][1]):
            cells = split(line.text, run.separator)
        if cells is None:
            break
        rows.append((index, cells))
        if len(rows) == 3:
            break
    return rows


def _numbered_names(cells: list[str], units: list[str]) -> bool:
    """Whether a row above units calls columns by number, as some scopes do: x-axis,1,2 above second,Volt,Volt."""
    numbered = len(cells) > 1 and cells[1:] == [str(number) for number in range(1, len(cells))]
    return numbered and len(cells) == len(units) and kind(cells[0]) == WORD and _all_units(units, len(units))


def _row_of_words(text: str, run: Run) -> list[str] | None:
    """The cells of a line that may hold names or units; None where it holds numbers."""
    cells = split(text, run.separator)
    words = cells[: len(run.kinds.rstrip(MISSING))]
    if any(kind(cell) in (NUMBER, STAMP) and not is_unit(cell) for cell in words) or not any(words) or text.startswith("@"):
        return None
    return cells


def _commented(head: Head, run: Run) -> list[Row]:
    """Rows of names and units that stand in comments, as numpy.savetxt and MATLAB write them; the nearest first.

    They are the last comments above the values: others, of as many words by chance, are prose.
    """
    rows: list[Row] = []
    for index in reversed(range(run.first)):
        if head.lines[index].blank or not bare_comment(head.lines[index].text).strip("-=* \t"):
            continue
        cells = _commented_cells(head, index, run)
        if cells is None or len(rows) == 2:
            break
        rows.append((index, cells))
    if rows:
        # A second row is of units, or above units.
        filled = len(run.kinds.rstrip(MISSING))
        return rows if len(rows) == 2 and (_all_units(rows[0][1], filled) or _all_units(rows[1][1], filled)) else rows[:1]
    return _name_by_name(head, run)


def _commented_cells(head: Head, index: int, run: Run) -> list[str] | None:
    """The cells of a comment that has one word for each column; None where it has not."""
    text = head.lines[index].text
    if not head.passed(index, run.separator):
        return None
    bare = LABEL.sub("", bare_comment(text))
    for separator in (run.separator, *SEPARATORS):
        cells = split(bare.strip(" ") if separator else bare, separator)
        if (
            len(run.kinds.rstrip(MISSING)) <= len(cells) <= run.width
            and all(kind(cell) in (WORD, MISSING) for cell in cells)
            and any(cells)
        ):
            return cells
    return None


def _name_by_name(head: Head, run: Run) -> list[Row]:
    """Names that stand in as many comments right above the values, one in each."""
    lines = range(run.first - run.width, run.first)
    if run.width < 2 or lines[0] < 0 or not all(head.lines[index].comment for index in lines):
        return []
    names = [bare_comment(head.lines[index].text).strip() for index in lines]
    single = all(name and kind(name) == WORD and len(name.split()) <= 3 and ":" not in name for name in names)
    return [(lines[-1], names)] if single else []


def _all_units(cells: list[str], width: int) -> bool:
    """Whether a row holds units and nothing else: "s,deg,deg", "[s];[deg]", "(ms)", with "-" or nothing for none."""
    named = [
        cell for cell in cells[:width] if kind(cell) != MISSING and cell not in ("1", "[-]", "(-)", "[]", "()", "[1]", "(1)")
    ]
    return bool(named) and all(_is_bracketed(cell) or is_unit(cell) or cell.lower() == "sequence" for cell in named)


def _is_bracketed(cell: str) -> bool:
    return re.fullmatch(r"\[[^\[\]]{1,20}\]|\([^()]{1,20}\)", cell) is not None


def _bare(cell: str) -> str:
    """A unit without its brackets; nothing for none."""
    cell = cell.strip("[]() ")
    return "" if kind(cell) == MISSING or cell == "1" or cell.lower() == "sequence" else cell


def _increment(names: list[str], values: list[str], width: int) -> float | None:
    """The rate [Hz] that a scope writes behind the names: X,CH1,Start,Increment over Sequence,Volt,-0.06,0.001."""
    for name, value in zip(names[width:], values[width:], strict=False):
        if re.fullmatch(r"(?:x\s*)?incr?(?:ement)?|delta\s*[xt]?|dt", name, re.IGNORECASE):
            try:
                step = float(value)
            except ValueError:
                continue
            return 1.0 / step if step > 0 else None
    return None


def _groups(cells: list[str], width: int) -> bool:
    """Whether a row names groups of columns: words, at least two of them, and no more than there are columns."""
    words = [cell for cell in cells if cell]
    return len(words) >= 2 and len(cells) <= width + 1 and not any(kind(cell) in (NUMBER, STAMP) for cell in words)


def _filled(cells: list[str]) -> list[str]:
    """Names of groups, each standing for the empty cells to its right as well."""
    filled: list[str] = []
    for cell in cells:
        filled.append(cell or (filled[-1] if filled else ""))
    return filled


def _unnamed(head: Head, run: Run) -> Names:
    """Names by number where the file has none."""
    width = len(run.kinds.rstrip(MISSING))
    cells = head.cells(run.first, run.separator)
    units = tuple((number_and_unit(cell) or ("", ""))[1] for cell in spread(cells, width))
    note = f"no line of names stands above the values of line {head.lines[run.first].number}; columns go by number"
    return Names(tuple(f"column {place}" for place in range(1, width + 1)), units, notes=(note,))
