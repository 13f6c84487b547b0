"""MATLAB files of version 5 (saved with -v6 or -v7, or without an option) through SciPy."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .guard import MAX_BYTES
from .mat5_tags import checked
from .mat_tree import Instance, Tree, Unread

OPAQUE_NAME = "None"
"""What SciPy calls a variable that holds a value of a class."""


def read_tree(path: Path) -> Tree:
    """The variables of the file; raises whatever SciPy does on a damaged one."""
    from scipy import io  # a tenth of a second to import, and few records need it

    source = checked(path)
    variables = io.loadmat(source)
    return {name: plain(value) for name, value in variables.items() if not name.startswith("__")}


def plain(value: Any) -> Any:
    """SciPy's own kinds as structs, lists and arrays."""
    if hasattr(value, "toarray"):  # a sparse matrix; of 1e9 by 1e9 with one number it would fill the memory
        if value.shape[0] * value.shape[1] * 8 > MAX_BYTES:
            return Unread(f"a sparse matrix of shape {value.shape}")
        if hasattr(value, "check_format"):
            value.check_format(full_check=True)  # places out of range would be written to
        return value.toarray()
    if not isinstance(value, np.ndarray):
        return value
    kind = type(value).__name__
    if kind == "MatlabOpaque":
        return Instance(_text(value.ravel()[0]["s2"]))
    if kind == "MatlabFunction":
        return Unread("a function")
    if value.dtype.names:
        structs = [{field: plain(one[field]) for field in value.dtype.names} for one in value.ravel()]
        return structs[0] if len(structs) == 1 else structs
    if value.dtype.kind == "O":
        cells = [plain(one) for one in value.ravel()]
        # A column of single values or of words is one column, not as many cells.
        if cells and all(isinstance(cell, np.ndarray) and cell.size == 1 and cell.dtype.kind in "fiubU" for cell in cells):
            kinds = {cell.dtype.kind == "U" for cell in cells}
            if len(kinds) == 1:
                return np.array([cell.ravel()[0] for cell in cells])
        return [cells[0]] if len(cells) == 1 else cells
    if value.dtype.kind == "U" and value.size == 1:
        return str(value.ravel()[0])
    return value


def _text(name: Any) -> str:
    return name.decode("latin-1") if isinstance(name, bytes) else str(name)
