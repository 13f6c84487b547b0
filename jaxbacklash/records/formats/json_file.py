"""JSON: arrays by name, lists of objects, tables as pandas and spreadsheets' scripts write them, and a line for each sample.

The shapes understood, each one level within a group if need be:

    {"t": [...], "x": [...]}                          arrays by name
    {"x": {"unit": "deg", "data": [...]}}             with what is known of each
    [{"t": 0.0, "x": 0.1}, ...]                       an object for each sample, also one a line (.jsonl)
    {"columns": ["t", "x"], "data": [[0.0, 0.1], ...]}   rows and their names
    [["t", "x"], [0.0, 0.1], ...]                     rows below their names
    {"x": {"0": 0.1, "1": 0.2}}                       columns by row number
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from ..checks import wrong
from ..table import Table
from .arrays import Columns
from .guard import guarded

MAX_FILE_BYTES = 256 << 20
"""Python's numbers and lists take some ten times the text's size in memory."""
NAMES_KEYS = ("columns", "names", "header", "headers", "fields", "channels", "labels")
DATA_KEYS = ("data", "values", "rows", "samples", "value", "y")
UNIT_KEYS = ("unit", "units")
CALLED_KEYS = ("name", "channel", "label", "id", "topic")
MAX_PLACES = 16
"""A longer list within the object of one sample is no vector of that sample."""
MAX_DEPTH = 8
WANTED = 'arrays by name such as {"t": [0, 0.002], "x": [0, 0.1], "z": [0, 0.01]}'


def read(path: Path) -> Table:
    """The columns of a JSON file.

    Parameters
    ----------
    path : Path

    Returns
    -------
    Table
        Columns by the names of the file, "group/channel" for arrays within an object; null becomes NaN.

    Raises
    ------
    BadInput
        When the file is damaged or too large, or holds no columns.
    """
    size = path.stat().st_size
    if size > MAX_FILE_BYTES:
        found = f"{size / 1e6:.4g} MB of JSON"
        raise wrong(str(path), found, f"at most {MAX_FILE_BYTES / 1e6:.4g} MB; save the record as .csv or .npz")
    columns = Columns()
    with guarded(path, "a file that is damaged or no JSON", f"a JSON file with {WANTED}"):
        value = _load(path)
        _take("", value, columns, str(path), 0)
    if not columns.columns:
        raise wrong(str(path), "JSON without a list of numbers", WANTED)
    return columns.table("json")


def _load(path: Path) -> Any:
    """The value of the file, or a list of the values of its lines."""
    data = path.read_bytes()
    text = data.decode(json.detect_encoding(data)).lstrip("\ufeff")
    try:
        return json.loads(text)
    except json.JSONDecodeError as why:
        lines = [(number, line) for number, line in enumerate(text.splitlines(), start=1) if line.strip()]
        values = []
        for number, line in lines:
            try:
                values.append(json.loads(line))
            except json.JSONDecodeError as bad:
                if len(values) < 2:
                    found = f"no JSON: {why.msg[:1].lower()}{why.msg[1:]}"
                    raise wrong(f"{path} line {why.lineno} column {why.colno}", found, f"a JSON file with {WANTED}") from why
                raise wrong(f"{path} line {number}", f"no JSON: {bad.msg}", "an object a line, as in the lines above") from bad
        return values


def _take(name: str, value: Any, columns: Columns, where: str, depth: int, unit: str = "") -> None:
    """Add what a value holds to the columns; ``name`` is the path to it."""
    if depth > MAX_DEPTH:
        columns.left_out[name] = "values nested deeper than any record is"
    elif isinstance(value, dict):
        _take_object(name, value, columns, where, depth)
    elif isinstance(value, list) and value and all(isinstance(one, dict) for one in value):
        if any(_is_long(each) for one in value for each in one.values()):
            _take_channels(name, value, columns, where, depth)
        else:
            _take_records(name, value, columns, where)
    elif isinstance(value, list) and value and all(isinstance(one, list) for one in value):
        _take_rows(name, value, None, columns, where)
    elif isinstance(value, list):
        columns.add(name, _column(value, f"{where}, column {name or 1}"), unit)
    else:
        columns.add(name, np.array(value if isinstance(value, float | int | bool | str) else np.nan))


def _take_channels(name: str, value: list[dict], columns: Columns, where: str, depth: int) -> None:
    """A list of objects with a list of values each: channels, or tables, that say what they are called."""
    for number, one in enumerate(value, start=1):
        called = next((one[key] for key in CALLED_KEYS if isinstance(one.get(key), str)), str(number))
        rest = {key: each for key, each in one.items() if each is not called}
        _take(f"{name}/{called}" if name else called, rest, columns, where, depth + 1)


def _take_object(name: str, value: dict, columns: Columns, where: str, depth: int) -> None:
    """An object: a table with its names beside it, a channel with its unit, rows by number, or a group."""
    names = next((value[key] for key in NAMES_KEYS if _is_names(value.get(key))), None)
    rows = next((key for key in DATA_KEYS if isinstance(value.get(key), list)), None)
    if rows is not None and names and value[rows] and all(isinstance(one, list) for one in value[rows]):
        _take_rows(name, value[rows], names, columns, where)
        return
    unit = next((value[key] for key in UNIT_KEYS if isinstance(value.get(key), str)), None)
    lists = [key for key, one in value.items() if isinstance(one, list | dict)]
    if name and rows is not None and lists == [rows]:
        _take(name, value[rows], columns, where, depth + 1, unit or "")
        return
    if value and all(key.isdecimal() for key in value):
        _take(name, list(value.values()), columns, where, depth + 1)
        return
    units: dict = next((value[key] for key in UNIT_KEYS if isinstance(value.get(key), dict)), {})
    for key, one in value.items():
        if one is not units:
            stated = units.get(key)
            _take(f"{name}/{key}" if name else key, one, columns, where, depth + 1, stated if isinstance(stated, str) else "")


def _is_long(value: Any) -> bool:
    """Whether a value holds a course in time rather than what belongs to one sample."""
    if isinstance(value, dict):
        return any(map(_is_long, value.values()))
    return isinstance(value, list) and (len(value) > MAX_PLACES or any(map(_is_long, value)))


def _is_names(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(one, str) for one in value)


def _take_records(name: str, records: list[dict], columns: Columns, where: str) -> None:
    """An object for each sample; objects within it are groups, a list within it a column for each place."""
    flat = [_flat(record) for record in records]
    keys: dict[str, None] = {}
    for one in flat:
        keys.update(dict.fromkeys(one))
    for key in keys:
        full = f"{name}/{key}" if name else key
        absent = next((row for row, one in enumerate(flat) if key not in one), None)
        if absent is not None:
            columns.notes.append(f"column {full} is missing in row {absent + 1} and perhaps others, taken as NaN")
        columns.add(full, _column([one.get(key) for one in flat], f"{where}, column {full}"))


def _flat(record: dict, prefix: str = "", depth: int = 0) -> dict[str, Any]:
    """An object's values by "group/name"."""
    flat: dict[str, Any] = {}
    for key, one in record.items():
        if isinstance(one, list) and len(one) <= MAX_PLACES:
            one = {str(place): each for place, each in enumerate(one, start=1)}
        if isinstance(one, dict) and depth < MAX_DEPTH:
            flat |= _flat(one, f"{prefix}{key}/", depth + 1)
        else:
            flat[prefix + key] = one
    return flat


def _take_rows(name: str, rows: list[list], names: list[str] | None, columns: Columns, where: str) -> None:
    """Rows of values, below their names if these stand nowhere else."""
    if names is None and len(rows) > 1 and _is_names(rows[0]) and not _is_names(rows[1]):
        names, rows = rows[0], rows[1:]
    width = len(names) if names is not None else len(rows[0])
    odd = next((number for number, row in enumerate(rows, start=1) if len(row) != width), None)
    if odd is not None and names is not None and len(rows) == width:
        rows = [list(row) for row in zip(*rows, strict=True)]  # a list for each name, not for each sample
        odd = None
    if odd is not None:
        what = "as many as there are names" if names is not None else "as many as in row 1"
        raise wrong(f"{where}, row {odd}", f"{len(rows[odd - 1])} value{'s' * (len(rows[odd - 1]) != 1)}", f"{width}, {what}")
    cells = [_column(list(each), f"{where}, column {number}") for number, each in enumerate(zip(*rows, strict=True), start=1)]
    if names is None and all(each.dtype.kind == "f" for each in cells):
        columns.add(name, np.column_stack(cells))
        return
    for number, each in enumerate(cells, start=1):
        column = names[number - 1] if names is not None else f"column {number}"
        columns.add(f"{name}/{column}" if name else column, each)


def _column(values: list, where: str) -> np.ndarray:
    """One column: numbers with NaN for null, or text."""
    try:
        if not all(one is None or isinstance(one, float | int) for one in values):
            return _texts(values)
        return np.array([np.nan if one is None else one for one in values], dtype=np.float64)
    except OverflowError as why:
        row = next(row for row, one in enumerate(values, start=1) if isinstance(one, int) and abs(one) > 2**1023)
        raise wrong(f"{where}, row {row}", "a number beyond 1e308", "one that a computer can hold") from why


def _texts(values: list) -> np.ndarray:
    """Text, or numbers written as text; whatever else is no column."""
    if any(isinstance(one, list | dict) for one in values):
        return np.array([None] * len(values), dtype=object)
    words = ["" if one is None else str(one) for one in values]
    try:
        return np.array([np.nan if word == "" else float(word) for word in words])
    except ValueError:
        return np.array(words)
