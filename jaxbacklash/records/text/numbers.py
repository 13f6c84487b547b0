"""Cells as numbers: decimal points and commas, marks of thousands, Fortran's exponents, units behind numbers, words for none.

What a comma or a point inside a number means is proved by a cell that can be read in one way only ("0,5", "1234,5",
"1.234,5"), in its own column or, for commas, in another. Where all cells can be read in two ways ("1,234") the column is
refused, never guessed. Points are decimal ones unless some of a column's numbers have three digits behind a point and all
others are whole and below 1000, as in columns of counts with marks of thousands.
"""

from __future__ import annotations

import dataclasses
import functools
import math
import re
from collections.abc import Callable, Sequence

import numpy as np

from ..checks import wrong
from .cells import ABSENT, number_and_unit

_PLAIN = r"[-+]?(?:\d+{0}?\d*|{0}\d+)(?:[eEdD][-+]?\d+)?"
_GROUPED = r"[-+]?[1-9]\d{{0,2}}(?P<mark>[{1}'\u2019 \u00a0\u2009\u202f])\d{{3}}(?:(?P=mark)\d{{3}})*(?:{0}\d*)?"


def _pattern(decimal: str, other: str) -> Callable[[str], re.Match | None]:
    infinite = r"|[-+]?(?:[iI][nN][fF](?:inity|INITY)?|1{0}#INF)"
    text = "|".join((_PLAIN, _GROUPED)).format(decimal, other)
    return re.compile(text + infinite.format(decimal)).fullmatch


_BY_POINT, _BY_COMMA = _pattern(r"\.", ","), _pattern(",", r"\.")
TWO_WAYS = re.compile(r"[-+]?[1-9]\d{0,2}(?:[.,]\d{3})+").fullmatch
_INFINITE = re.compile(r"([-+]?)1[.,]#INF", re.IGNORECASE)
_MARKS = {
    ".": str.maketrans("dD", "ee", ",'\u2019 \u00a0\u2009\u202f"),
    ",": str.maketrans("dD,", "ee.", ".'\u2019 \u00a0\u2009\u202f"),
}
_TRUTH = {"true": 1.0, "false": 0.0}
_NAN = "nan"
_OF_COMMAS = frozenset("0123456789+-eE,")

LONG = re.compile(r"\s*[-+]?\d{17,}\s*")
"""Whole numbers beyond what double precision holds exactly (2^53)."""

SAMPLE = 100
"""Cells of a column that are looked at before all of it is taken for numbers with units."""


@dataclasses.dataclass
class Cells:
    """The cells of one column, tidied: stripped of blanks and quotes, `_NAN` for none, and what its marks can mean.

    ``point`` and ``comma`` say whether all can be read with that decimal mark; ``doubtful`` is a row that can be read in two
    ways, ``proof`` the marks that some cell proves to be the decimal one, ``small`` whether cells without a mark are there and
    all below 1000.
    """

    texts: Sequence[str]
    unit: str = ""
    point: bool = False
    comma: bool = False
    doubtful: int | None = None
    proof: frozenset[str] = frozenset()
    small: bool = False

    def values(self, decimal: str) -> np.ndarray:
        """The numbers, read with a decimal mark."""
        table = _MARKS[decimal]
        return np.array([float(text.translate(table)) for text in self.texts])


def read_numbers(
    columns: Sequence[Sequence[str]],
    names: Sequence[str],
    decimal: str | None,
    place: Callable[[int], str],
    grouping: bool = True,
) -> tuple[list[np.ndarray], list[str], list[str], str]:
    """Columns of cells as numbers where they are numbers.

    Parameters
    ----------
    columns : sequence of sequences of str
        The cells of each column.
    names : sequence of str
        Their names, for messages.
    decimal : str or None
        "." or "," as the user said; decides only what can be read in two ways.
    place : callable
        Names a row (from 0) for messages: the file and the line.
    grouping : bool
        Whether a point may mark thousands: not where commas separate the cells.

    Returns
    -------
    values : list of arrays of shape (N,)
        float64 with NaN for none, or text.
    units : list of str
        Units that stand behind each number of a column, else empty.
    notes : list of str
    mark : str
        The decimal mark of most columns.

    Raises
    ------
    BadInput
        A cell can be read in two ways and nothing says which.
    """
    done: dict[int, np.ndarray] = {}
    cells: dict[int, Cells] = {}
    notes: list[str] = []
    for number, texts in enumerate(columns):
        direct = _direct(texts)
        if direct is not None:
            done[number] = direct
        if direct is None or any("." in text for text in texts):
            cells[number] = Cells(texts)
    if len(done) < len(columns):
        # What points mean in a column that NumPy can read may still be shown by the commas of another.
        commas = any("," in text for number, texts in enumerate(columns) if number not in done for text in texts)
    else:
        commas = False
    for number in [number for number in cells if number not in done or commas or (grouping and _may_group(columns[number]))]:
        cells[number] = judged(columns[number])
    proof = frozenset().union(*(column.proof for column in cells.values()))
    marks = []
    for number, column in cells.items():
        # Counts of nanoseconds since 1970 stay text, for `times.seconds`: double precision would round them to 256.
        if not (column.point or column.comma) or LONG.fullmatch(column.texts[0]):
            continue
        mark = _decide(column, proof, decimal, grouping, functools.partial(_place, place, names[number]))
        done[number] = column.values(mark) if number not in done or mark == "," else done[number]
        if any("." in text or "," in text for text in column.texts):
            marks.append(mark)
    units = [cells[number].unit if number in cells and number in done else "" for number in range(len(columns))]
    if len(set(marks)) == 2:
        notes.append("some columns are written with decimal points, others with decimal commas")
    values = [done[number] if number in done else _words(columns[number]) for number in range(len(columns))]
    for number in sorted(set(cells) & set(done)):
        notes += _absent(columns[number], values[number], names[number], place)
    return values, units, notes, max(set(marks), key=marks.count, default=".")


def _may_group(texts: Sequence[str]) -> bool:
    """Whether the first cells with points may all be marked by thousands."""
    pointed = [text for text in texts if "." in text]
    return all(TWO_WAYS(text.strip()) for text in pointed[:SAMPLE])


def _direct(texts: Sequence[str]) -> np.ndarray | None:
    """The numbers of a column that Python can read as it stands, None for any other, or where double precision loses digits."""
    if texts and LONG.fullmatch(texts[0]):
        return None
    try:
        values = np.array(list(map(float, texts)))
    except ValueError:
        return None
    # Python takes "1_000" for a number.
    return None if any("_" in text for text in texts) else values


def _tidy(text: str) -> str:
    """A cell without blanks and quotes around it, with a plain minus; `_NAN` where it stands for none."""
    text = text.strip(" \t'\"\u00a0\u2009\u202f\ufeff=").replace("\u2212", "-").replace("\u2013", "-")
    return _NAN if text.lower() in ABSENT else text


def _of_decimal_commas(texts: Sequence[str]) -> Cells | None:
    """A column of nothing but digits, signs and decimal commas, judged in a fraction of the time; None for any other."""
    if not set("".join(texts)) <= _OF_COMMAS:
        return None
    try:
        for text in texts:
            float(text.replace(",", "."))
    except ValueError:
        return None
    proved = any("," in text and not _BY_POINT(text) for text in texts)
    return Cells(texts, comma=True, proof=frozenset(",")) if proved else None


def judged(texts: Sequence[str]) -> Cells:
    """What the cells of a column can mean."""
    quick = _of_decimal_commas(texts)
    if quick is not None:
        return quick
    tidy = [_tidy(text) for text in texts]
    filled = [(row, text) for row, text in enumerate(tidy) if text != _NAN]
    column = Cells(tidy)
    point = all(_BY_POINT(text) for _, text in filled)
    comma = all(_BY_COMMA(text) for _, text in filled)
    if filled and not (point or comma):
        pairs = [pair for _, text in filled[:SAMPLE] if (pair := number_and_unit(text))]
        if len(pairs) < min(len(filled), SAMPLE):
            return column
        pairs += [pair for _, text in filled[SAMPLE:] if (pair := number_and_unit(text))]
        if len(pairs) == len(filled) and len({unit for _, unit in pairs}) == 1:
            again = judged([number for number, _ in pairs])
            for (row, _), (number, _) in zip(filled, pairs, strict=True):
                tidy[row] = number
            doubtful = None if again.doubtful is None else filled[again.doubtful][0]
            return dataclasses.replace(again, texts=tidy, unit=pairs[0][1], doubtful=doubtful)
        return column
    if not filled:
        return dataclasses.replace(column, point=True)
    tidy[:] = [_INFINITE.sub(r"\1inf", text) for text in tidy] if any("#" in text for _, text in filled) else tidy
    proof = set()
    doubtful = None
    whole = [len(text.lstrip("+-")) for _, text in filled if "," not in text and "." not in text]
    for row, text in filled:
        if "," not in text and "." not in text:
            continue
        by_point, by_comma = _BY_POINT(text), _BY_COMMA(text)
        if by_point and by_comma:
            doubtful = row if doubtful is None and TWO_WAYS(text) else doubtful
        elif by_comma:
            proof.add(",")
        elif by_point:
            proof.add(".")
    # Columns are judged one by one: a program may write times with a point and values with a comma.
    small = bool(whole) and max(whole) <= 3
    return Cells(tidy, point=point, comma=comma, doubtful=doubtful, proof=frozenset(proof), small=small)


def _decide(column: Cells, proof: frozenset[str], decimal: str | None, grouping: bool, place: Callable[[int], str]) -> str:
    """The decimal mark of a column, or the refusal of one that can be read in two ways."""
    if column.doubtful is None or not (column.point and column.comma):
        return "." if column.point else ","
    if decimal is not None:
        return decimal
    text = column.texts[column.doubtful]
    mark = "," if "," in text else "."
    grouped = "," if mark == "." else "."
    # A comma that is the decimal mark elsewhere is so here; a comma that marks thousands elsewhere likewise.
    if mark == "." and "," not in proof and not (column.small and grouping):
        return "."
    if mark == "," and "," in proof and "." not in proof:
        return ","
    whole, parts = text.replace(mark, ""), text.replace(mark, ".")
    found = f'"{text}", which can be {whole} or {parts}'
    name = "comma" if mark == "," else "point"
    wanted = f"--decimal {grouped} if it is {whole} (the {name} marks thousands), --decimal {mark} if it is {parts}"
    raise wrong(place(column.doubtful), found, wanted)


def _place(place: Callable[[int], str], name: str, row: int) -> str:
    return f"{place(row)}, column {name}"


def _words(texts: Sequence[str]) -> np.ndarray:
    """A column of words, or of truths as numbers."""
    lower = {text.strip().lower() for text in texts}
    if lower <= _TRUTH.keys() | {""} and lower & _TRUTH.keys():
        return np.array([_TRUTH.get(text.strip().lower(), math.nan) for text in texts])
    return np.array([text.strip() for text in texts])


def _absent(texts: Sequence[str], values: np.ndarray, name: str, place: Callable[[int], str]) -> list[str]:
    """A note on words that stand where a number is missing."""
    odd = [row for row in np.flatnonzero(np.isnan(values)).tolist() if texts[row].strip().lower() not in ("", _NAN)]
    if not odd:
        return []
    more = f" and in {len(odd) - 1} more rows" if len(odd) > 1 else ""
    where = place(odd[0]).rpartition(" line ")[2]
    return [f'column {name} holds no number but "{texts[odd[0]].strip()[:20]}" at line {where}{more}; read as not a number']
