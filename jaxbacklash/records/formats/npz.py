"""NumPy archives: one array per column, or one matrix beside an array `columns` of names."""

from __future__ import annotations

import zipfile
import zlib
from pathlib import Path
from typing import IO

import numpy as np

from ..checks import listed, wrong
from ..table import Table
from .arrays import Columns, named_matrix, tidy
from .guard import bounded, guarded

WANTED = "a .npz file as numpy.savez writes it"


def read(path: Path) -> Table:
    """The columns of a NumPy archive.

    Parameters
    ----------
    path : Path

    Returns
    -------
    Table

    Raises
    ------
    BadInput
        When the file is damaged or no archive, a member is encrypted, packed in an unknown way or claims more than it holds.
        What is pickled is never read: a pickle runs whatever code its author chose.
    """
    with guarded(path, "a file that is damaged or no NumPy archive", WANTED):
        with open(path, "rb") as file:
            if file.read(6) == b"\x93NUMPY":
                raise wrong(str(path), "a single NumPy array", "a .npz archive with one array per column, or the suffix .npy")
        with zipfile.ZipFile(path) as archive:
            members = [each for each in archive.infolist() if not each.is_dir()]
            bounded(sum(each.file_size for each in members), str(path), "arrays")
            arrays: list[tuple[str, np.ndarray | str]] = []
            for each in members:
                name = tidy(each.filename.removesuffix(".npy"))
                if each.filename.endswith(".npy"):
                    arrays.append((name, _member(archive, each, f"{path}, array {name}")))
    if not arrays:
        raise wrong(str(path), f"a zip archive with {listed(each.filename for each in members)}, no NumPy array", WANTED)
    names = [name for name, _ in arrays]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise wrong(str(path), f'two arrays of the name "{twice}"', "each name once")
    columns = Columns()
    plain = {name: values for name, values in arrays if isinstance(values, np.ndarray)}
    columns.left_out |= {name: found for name, found in arrays if isinstance(found, str)}
    if "columns" in columns.left_out:
        raise wrong(f"{path}, array columns", columns.left_out["columns"], "an array of names")
    for name, values in named_matrix(plain, str(path)).items():
        columns.add(name, values)
    return columns.table("npz")


def _member(archive: zipfile.ZipFile, info: zipfile.ZipInfo, where: str) -> np.ndarray | str:
    """One array, or what is there instead of one that can be read."""
    try:
        with archive.open(info) as file:
            claimed = declared_size(file)
        if claimed is None:
            return "pickled objects, which are never read"
        if claimed <= info.file_size:
            with archive.open(info) as file:
                return np.lib.format.read_array(file, allow_pickle=False)
    except NotImplementedError as why:
        raise wrong(where, "data packed in a way that Python does not know", "an archive as numpy.savez writes it") from why
    except RuntimeError as why:
        if isinstance(why, RecursionError):
            raise
        raise wrong(where, "encrypted data", "an archive without a password") from why
    except (ValueError, zipfile.BadZipFile, zlib.error, EOFError, OSError) as why:
        raise wrong(where, "damaged data", "a complete file; copy it again") from why
    found = f"an array that claims {claimed} bytes in a member of {info.file_size}"
    raise wrong(where, found, "a complete file; copy it again")


def declared_size(file: IO[bytes]) -> int | None:
    """Bytes of the array whose .npy header comes next in ``file``, by what the header says; None for pickled objects."""
    version = np.lib.format.read_magic(file)
    read_header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, _, dtype = read_header(file)
    if dtype.hasobject:
        return None
    count = 1
    for length in shape:
        count *= int(length)
    return count * dtype.itemsize
