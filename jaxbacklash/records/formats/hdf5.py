"""HDF5 files (.h5, .hdf5): data sets in groups with units and rates among their attributes, through h5py."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ..checks import MIN_SAMPLES
from ..table import Table
from .arrays import MAX_CHANNELS, Columns, named_matrix, tidy
from .guard import Budget, guarded, library, room

MAX_DEPTH = 32
MAX_ATTRIBUTE_BYTES = 1 << 20
MAX_SETS = 4096
"""Data sets looked at; a file with more is no record."""
UNITS = ("unit", "units", "unit_string", "Unit", "Units", "UNIT", "UNITS")
NAMES = ("columns", "column_names", "names", "channels", "channel_names", "labels", "header")


def read(path: Path) -> Table:
    """The columns of an HDF5 file.

    Parameters
    ----------
    path : Path

    Returns
    -------
    Table
        A column for each data set of one dimension and for each column of a matrix, called "group/name"; units from the
        attributes "unit" or "units", the rate from "sample_rate", "fs", "dt" and the like, at a data set, a group or the file.
        Links to other files are named and not followed.

    Raises
    ------
    BadInput
        h5py is missing, or the file is damaged or too large.
    """
    h5py = library("h5py", "h5py", path, "an HDF5 file")
    columns = Columns()
    with (
        guarded(path, "a file that is damaged or no HDF5 file", "a complete .h5 file; copy it again"),
        h5py.File(path, "r") as file,
    ):
        found: dict[str, tuple[Any, np.ndarray]] = {}
        budget = Budget(str(path))
        _take_attributes(file, columns)
        for name, item in _items(file, h5py, "", set(), columns):
            _take_attributes(item, columns)
            if isinstance(item, h5py.Group):
                continue
            why = _unread(item, h5py)
            if why:
                columns.left_out[name] = why
                continue
            budget.take(item.size * item.dtype.itemsize, f"data set {name}")
            found[name] = (item, _values(item, h5py))
            if len(found) > MAX_SETS:
                raise ValueError("too many data sets")
        _add(found, columns, str(path))
    return columns.table("hdf5")


def _items(group: Any, h5py: Any, prefix: str, seen: set, columns: Columns, depth: int = 0) -> Iterator[tuple[str, Any]]:
    """Everything below a group, each object once though links may lead in a circle."""
    for name in group:
        full = tidy(f"{prefix}{name}")
        link = group.get(name, getlink=True)
        if isinstance(link, h5py.ExternalLink):
            columns.left_out[full] = "a link to another file, which is not followed"
            continue
        if isinstance(link, h5py.SoftLink):
            columns.left_out[full] = f"a link to {tidy(str(link.path))}"
            continue
        item = group[name]
        key = h5py.h5o.get_info(item.id).addr
        if key in seen:
            columns.left_out[full] = "a second name of another item"
            continue
        seen.add(key)
        if isinstance(item, h5py.Dataset):
            yield full, item
        elif isinstance(item, h5py.Group) and depth < MAX_DEPTH:
            yield full, item
            yield from _items(item, h5py, f"{full}/", seen, columns, depth + 1)


def _unread(item: Any, h5py: Any) -> str:
    """Why a data set is not read; empty where it is."""
    if item.shape is None:
        return "an empty data set"
    if elsewhere(item):
        return "a view of another file, which is not read"
    text = h5py.check_string_dtype(item.dtype) is not None
    if not (item.dtype.kind in "fiubcS" or item.dtype.names or text):
        return "no numbers"
    long = [length for length in item.shape if length > 1]
    if len(long) > 2 or (len(long) == 2 and (min(long) > MAX_CHANNELS or max(long) < MIN_SAMPLES)):
        return f"an array of shape {item.shape}"
    return ""


def attribute(item: Any, name: str) -> Any:
    """The value of an attribute; None where there is none, or one that claims to be as long as no name or number is."""
    if name not in item.attrs:
        return None
    found = item.attrs.get_id(name)
    if found.dtype.itemsize * math.prod(found.shape) > MAX_ATTRIBUTE_BYTES:
        return None
    if found.dtype.kind != "O":
        return item.attrs[name]
    with room():  # the length of a text stands in the file beside its place, and HDF5 believes it
        return item.attrs[name]


def elsewhere(item: Any) -> bool:
    """Whether the values of a data set stand in another file, which may be any file of the user."""
    return bool(item.external) or (item.is_virtual and any(source.file_name != "." for source in item.virtual_sources()))


def _values(item: Any, h5py: Any) -> np.ndarray:
    if h5py.check_string_dtype(item.dtype) is not None:
        with room():
            return np.asarray(item.asstr(errors="replace")[()]).astype(str)
    return np.asarray(item[()])


def _add(found: dict[str, tuple[Any, np.ndarray]], columns: Columns, where: str) -> None:
    """Data sets to columns; a matrix takes the names that stand in its attributes or in a data set `columns`."""
    arrays = named_matrix({name: values for name, (_, values) in found.items()}, where)
    for name, (item, values) in found.items():
        if name not in arrays:
            continue
        arrays.pop(name)
        unit = _attribute(item, UNITS)
        names = _attribute_names(item) or _names_beside(name, found)
        if values.ndim == 2 and len(names) in values.shape and len(names) > 1 and len(set(names)) == len(names):
            rows = values.T if values.shape[1] == len(names) else values
            group = name.rpartition("/")[0]
            for each, row in zip(names, rows, strict=True):
                columns.add(f"{group}/{each}" if group else each, row, unit, aliases=(f"{name}/{each}",))
        else:
            columns.add(name, values, unit)
    for name, values in arrays.items():
        columns.add(name, values)


def _take_attributes(item: Any, columns: Columns) -> None:
    """The rate, where an attribute states it."""
    for name in item.attrs:
        value = attribute(item, name)
        values = np.asarray(value) if isinstance(value, np.ndarray | np.number) else np.empty(0)
        if values.size == 1 and values.dtype.kind in "fiu":
            columns.take_rate(tidy(name), float(values.ravel()[0]))


def _attribute(item: Any, names: tuple[str, ...]) -> str:
    for name in names:
        value = attribute(item, name)
        if isinstance(value, bytes):
            value = value.decode("utf-8", "replace")
        if isinstance(value, str):
            return tidy(value)
    return ""


def _attribute_names(item: Any) -> list[str]:
    """Names of a matrix's columns among its attributes."""
    for name in NAMES:
        value = attribute(item, name)
        if isinstance(value, np.ndarray) and value.ndim == 1 and value.dtype.kind in "OSU":
            return [tidy(one.decode("utf-8", "replace") if isinstance(one, bytes) else str(one)) for one in value]
        if isinstance(value, str) and "," in value:
            return [tidy(one) for one in value.split(",")]
    return []


def _names_beside(name: str, found: dict[str, tuple[Any, np.ndarray]]) -> list[str]:
    """Names of a matrix's columns in a data set of text beside it; pandas calls it block0_items beside block0_values."""
    group, _, own = name.rpartition("/")
    for each in (*NAMES, own.replace("_values", "_items")):
        values = found.get(f"{group}/{each}" if group else each, (None, np.empty(0)))[1]
        if values.ndim == 1 and values.dtype.kind in "SU" and each != own:
            return [tidy(one.decode("utf-8", "replace") if isinstance(one, bytes) else str(one)) for one in values]
    return []
