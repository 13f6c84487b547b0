"""MATLAB files of version 7.3, which are HDF5 files with MATLAB's own attributes, through h5py."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .guard import Budget, library
from .hdf5 import attribute, elsewhere
from .mat_tree import MAX_DEPTH, Instance, Tree, Unread

MAX_CELLS = 4096
"""More cells than this are not followed: each is a reference of its own, and a record is no heap of single values."""


def read_tree(path: Path) -> Tree:
    """The variables of the file; raises whatever h5py does on a damaged one."""
    h5py = library("h5py", "h5py", path, "a MATLAB 7.3 file", ", or save the file again with -v7")
    with h5py.File(path, "r") as file:
        # "#refs#" and the like are MATLAB's own bookkeeping.
        budget = Budget(str(path))
        return {name: _value(file, name, h5py, 0, budget) for name in file if not name.startswith("#")}


def _value(parent: Any, name: str, h5py: Any, depth: int, budget: Budget) -> Any:
    """What stands under a name: MATLAB writes no links to other files, so none is followed."""
    link = parent.get(name, getlink=True)
    if not isinstance(link, h5py.HardLink):
        return Unread("a link to another place")
    return _item(parent[name], h5py, depth, budget)


def _item(item: Any, h5py: Any, depth: int, budget: Budget) -> Any:
    """A group is a struct; a data set is an array, text, an array of references (cells, arrays of structs) or an object."""
    if depth > MAX_DEPTH:
        return Unread("values nested deeper than any record is")
    kind = attribute(item, "MATLAB_class") or b""
    kind = kind.decode("latin-1") if isinstance(kind, bytes) else str(kind)
    if "MATLAB_object_decode" in item.attrs and kind not in ("", "function_handle"):
        return Instance(kind)
    if isinstance(item, h5py.Group):
        if "MATLAB_sparse" in item.attrs:
            return _sparse(item, budget)
        fields = {name: _value(item, name, h5py, depth + 1, budget) for name in item}
        return _struct_array(fields) if fields else Unread("a struct without fields")
    if not isinstance(item, h5py.Dataset):
        return Unread("a kind of data that has no values")
    if elsewhere(item):
        return Unread("a view of another file, which is not read")
    if attribute(item, "MATLAB_empty"):
        return np.empty(0)
    if item.dtype.kind == "O" and h5py.check_ref_dtype(item.dtype) is h5py.Reference:
        return _cells(item, h5py, depth, budget)
    if item.dtype.kind not in "fiub" and not item.dtype.names:
        return Unread("text" if h5py.check_string_dtype(item.dtype) else "objects, not numbers")
    budget.take(item.size * item.dtype.itemsize, f"array {item.name}")
    values = np.asarray(item)
    if kind == "char":
        # A row of character codes for each text, turned as HDF5 stores MATLAB's columns.
        lines = ["".join(map(chr, row)).rstrip() for row in np.atleast_2d(values.T if values.ndim > 1 else values)]
        return lines[0] if len(lines) == 1 else np.array(lines)
    if values.dtype.names == ("real", "imag"):
        return values["real"] + 1j * values["imag"]
    # Rows and columns of a matrix come turned; one column is the same either way.
    return values.T if kind and values.ndim > 1 else values


def _cells(item: Any, h5py: Any, depth: int, budget: Budget) -> Any:
    """The values that an array of references points to."""
    if item.size > MAX_CELLS:
        return Unread(f"an array of {item.size} structs or cells")
    cells = [_item(item.file[one], h5py, depth + 1, budget) for one in np.asarray(item).T.ravel() if one]
    if len(cells) > 1 and all(isinstance(cell, np.ndarray) and cell.size == 1 for cell in cells):
        return np.array([cell.ravel()[0] for cell in cells])
    return np.array(cells) if len(cells) > 1 and all(isinstance(cell, str) for cell in cells) else cells


def _struct_array(fields: dict[str, Any]) -> Any:
    """MATLAB writes an array of structs as a struct of arrays of references; the k-th of each belong together."""
    lengths = {len(value) if isinstance(value, list | np.ndarray) else 0 for value in fields.values()}
    if not any(isinstance(value, list) for value in fields.values()) or len(lengths) != 1 or lengths == {0}:
        return fields
    if not all(isinstance(value, list) or (isinstance(value, np.ndarray) and value.ndim == 1) for value in fields.values()):
        return fields
    return [{name: value[number] for name, value in fields.items()} for number in range(lengths.pop())]


def _sparse(item: Any, budget: Budget) -> Any:
    """A sparse matrix: its rows are an attribute of the group, its values and their places data sets in it."""
    from scipy.sparse import csc_matrix

    rows, columns = int(item.attrs["MATLAB_sparse"]), item["jc"].size - 1
    for name in ("jc", "ir", "data"):
        if name in item:
            budget.take(item[name].size * 8, f"array {item.name}")
    budget.take(rows * columns * 8, f"array {item.name}")
    if "data" not in item:  # all zeros
        return np.zeros((rows, columns))
    matrix = csc_matrix((item["data"][()], item["ir"][()], item["jc"][()]), shape=(rows, columns))
    matrix.check_format(full_check=True)  # places out of range would be written to
    return matrix.toarray()


def refers_elsewhere(path: Path) -> bool:
    """Whether anything in the file stands in another file: mat-io would read it."""
    h5py = library("h5py", "h5py", path, "a MATLAB 7.3 file")
    with h5py.File(path, "r") as file:
        if any(isinstance(file.get(name, getlink=True), h5py.ExternalLink) for name in file):
            return True
        return bool(file.visititems(lambda _, item: True if isinstance(item, h5py.Dataset) and elsewhere(item) else None))
