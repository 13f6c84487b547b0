"""A single NumPy array: a structured array with a field per column, a matrix, or one channel."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..checks import wrong
from ..table import Table
from .arrays import Columns
from .guard import bounded, guarded
from .npz import declared_size

WANTED = "a .npy file of plain numbers as numpy.save writes it"


def read(path: Path) -> Table:
    """The columns of a .npy file; those of a matrix are called "column 1" and so on. Raises `BadInput`."""
    with guarded(path, "a file that is damaged or no NumPy array", WANTED), open(path, "rb") as file:
        claimed = declared_size(file)
        if claimed is None:
            raise wrong(str(path), "pickled objects, which are never read", WANTED)
        bounded(claimed, str(path), "an array")
        if claimed > path.stat().st_size:
            found = f"an array that claims {claimed} bytes in a file of {path.stat().st_size}"
            raise wrong(str(path), found, "a complete file; copy it again")
        file.seek(0)
        values = np.lib.format.read_array(file, allow_pickle=False)
    columns = Columns()
    columns.add("", values)
    return columns.table("npy", {"shape": str(values.shape)})
