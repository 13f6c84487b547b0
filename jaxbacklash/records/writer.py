"""Write a record to a file that `read_record` gives back."""

import csv
import zipfile
from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import BinaryIO

import numpy as np

from ..whole_file import whole_file
from .checks import listed, wrong
from .record import Record


def write_record(record: Record, path: str | PathLike[str]) -> None:
    """Write a record, in SI units and radians, in the format that the suffix names.

    The file appears whole or not at all: it is written beside its place and then put there. Numbers are
    written with all the digits they have.

    Parameters
    ----------
    record : Record
    path : str or path
        A .csv, .npz or .mat (version 5) file; one that is there already is replaced.

    Raises
    ------
    BadInput
        When the suffix is another one, or the file cannot be written.
    """
    path = Path(path)
    write = WRITERS.get(path.suffix.lower())
    if write is None:
        raise wrong(str(path), f'the suffix "{path.suffix}" for a record to write', f"one of {listed(WRITERS)}")
    columns = {"t": record.t, **record.channels}
    columns |= {name: values for name, values in record.extras.items() if name not in columns}
    try:
        with whole_file(path) as unfinished, open(unfinished, "wb") as file:
            write(file, columns)
    except OSError as why:
        raise wrong(str(path), f"that it cannot be written ({why.strerror or why})", "a place that can") from why


def _write_csv(file: BinaryIO, columns: dict[str, np.ndarray]) -> None:
    # csv writes floats as repr does: the shortest text that reads back as the same number.
    lines = _Encoded(file)
    writer = csv.writer(lines, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(values.tolist() for values in columns.values()), strict=True))


class _Encoded:
    """Takes text, writes bytes; a TextIOWrapper would close the file under its owner."""

    def __init__(self, file: BinaryIO):
        self.file = file

    def write(self, text: str) -> int:
        return self.file.write(text.encode())


def _write_npz(file: BinaryIO, columns: dict[str, np.ndarray]) -> None:
    # Not numpy.savez: it takes the names as keywords, and a column may be called "file".
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, values in columns.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, values, allow_pickle=False)


def _write_mat(file: BinaryIO, columns: dict[str, np.ndarray]) -> None:
    from scipy import io  # a tenth of a second to import, and few records need it

    io.savemat(file, columns, oned_as="column", do_compression=True)


WRITERS: dict[str, Callable[[BinaryIO, dict[str, np.ndarray]], None]] = {
    ".csv": _write_csv,
    ".npz": _write_npz,
    ".mat": _write_mat,
}
