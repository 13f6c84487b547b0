"""NumPy archives: one array per column, or one matrix beside an array `columns` of names."""

import zipfile
import zlib
from collections.abc import Collection
from pathlib import Path

import numpy as np

from .arrays import as_columns
from .checks import wrong


def read_npz(path: Path, wanted: Collection[str]) -> dict[str, np.ndarray]:
    """The columns of a NumPy archive.

    Parameters
    ----------
    path : Path
    wanted : collection of str
        Columns that must hold numbers.

    Returns
    -------
    dict of arrays of shape (N,), float64
        See `arrays.as_columns`.

    Raises
    ------
    BadInput
        When the file is damaged or no archive, or holds pickled objects where a column is wanted.
    """
    try:
        # A pickle runs whatever code its author chose; a record is no reason to trust one.
        archive = np.load(path, allow_pickle=False)
    except (ValueError, EOFError, zipfile.BadZipFile) as why:
        wanted_file = "a .npz file as numpy.savez writes it"
        raise wrong(str(path), "a file that is damaged or no NumPy archive", wanted_file) from why
    if not isinstance(archive, np.lib.npyio.NpzFile):
        raise wrong(str(path), "a single NumPy array", "a .npz archive with one array per column")
    arrays = {}
    with archive:
        for name in archive.files:
            try:
                arrays[name] = archive[name]
            except (zipfile.BadZipFile, zlib.error, EOFError) as why:
                raise wrong(f"{path}, array {name}", "damaged data", "a complete file; copy it again") from why
            except ValueError as why:
                if name in wanted or name == "columns":
                    found = "pickled objects or damaged data"
                    raise wrong(f"{path}, array {name}", found, "an array of plain numbers or names") from why
    return as_columns(arrays, wanted, str(path))
