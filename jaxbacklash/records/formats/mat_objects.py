"""Values of MATLAB's classes (tables, timetables, strings, dates) through mat-io, where a file holds any."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .arrays import tidy
from .mat5 import plain
from .mat73 import refers_elsewhere
from .mat_tree import Instance, Measured, Tree, has_instances

UNITS = ("VariableUnits", "varUnits")


def with_objects(tree: Tree, path: Path, newer: bool) -> tuple[Tree, bool]:
    """The tree of a file with its tables as structs of columns.

    Parameters
    ----------
    tree : dict
        As `mat5.read_tree` or `mat73.read_tree` returns it.
    path : Path
    newer : bool
        Whether the file is of version 7.3.

    Returns
    -------
    tree : dict
        The same one where it holds no values of classes, or where mat-io cannot read them.
    missing : bool
        Whether mat-io would be needed and is not installed.
    """
    if not has_instances(tree) or (newer and refers_elsewhere(path)):
        return tree, False
    try:
        import matio
    except ImportError:
        return tree, True
    try:
        variables = matio.load_from_mat(str(path), add_table_attrs=True)
    except Exception:  # a class that it does not know ends it in many ways; what is plain has been read already
        return tree, False
    return {str(name): _value(value) for name, value in variables.items() if not str(name).startswith("__")}, False


def _value(value: Any) -> Any:
    """mat-io's kinds: those of SciPy, data frames for tables and objects with the name of their class."""
    if hasattr(value, "classname"):
        return Instance(str(value.classname))
    if hasattr(value, "columns") and hasattr(value, "index"):
        return _frame(value)
    if isinstance(value, np.ndarray) and value.dtype.names:
        structs = [{field: _value(one[field]) for field in value.dtype.names} for one in value.ravel()]
        return structs[0] if len(structs) == 1 else structs
    if isinstance(value, np.ndarray) and value.dtype.kind == "O":
        cells = value.ravel()
        if any(hasattr(one, "columns") or hasattr(one, "classname") or _is_cell(one) for one in cells):
            return _value(cells[0]) if cells.size == 1 else [_value(one) for one in cells]
    return plain(value)


def _is_cell(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.dtype.kind == "O"


def _frame(frame: Any) -> Tree:
    """Columns of a table by name, the times of a timetable first."""
    columns: Tree = {}
    index = frame.index.to_numpy()
    if index.dtype.kind in "mM":
        columns[str(frame.index.name or "Time")] = index
    units = next((frame.attrs[key] for key in UNITS if len(frame.attrs.get(key, ())) == frame.shape[1]), [""] * frame.shape[1])
    for name, unit in zip(frame.columns, units, strict=True):
        values = frame[name].to_numpy()
        if values.dtype.kind == "O":
            values = np.array([str(one) for one in values])
        columns[str(name)] = Measured(values, tidy(str(unit)))
    return columns
