"""MATLAB files: version 5 through SciPy, version 7.3 (which is HDF5) through h5py."""

from collections.abc import Collection
from pathlib import Path

import numpy as np

from jaxbacklash.errors import BadInput

from .arrays import as_columns
from .checks import wrong

HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
MATLAB_HEADER_BYTES = 512


def read_mat(path: Path, wanted: Collection[str]) -> dict[str, np.ndarray]:
    """The columns of a MATLAB file.

    Parameters
    ----------
    path : Path
    wanted : collection of str
        Columns that must hold numbers.

    Returns
    -------
    dict of arrays of shape (N,), float64
        See `arrays.as_columns`. The fields of a struct count as columns, under "struct.field" where the plain name
        occurs twice.

    Raises
    ------
    BadInput
        When the file is damaged or no MATLAB file, or when it is of version 7.3 and h5py is not installed.
    """
    with open(path, "rb") as file:
        head = file.read(MATLAB_HEADER_BYTES + len(HDF5_SIGNATURE))
    # MATLAB puts its own text before the HDF5 part; other programs often do not.
    newer = head.startswith(HDF5_SIGNATURE) or head.endswith(HDF5_SIGNATURE)
    try:
        plain, structs = _read_hdf5(path) if newer else _read_v5(path)
    except (BadInput, MemoryError):
        raise
    except Exception as why:  # The libraries raise whatever the damage happens to trip.
        wanted_file = "a .mat file of version 5 or 7.3"
        raise wrong(str(path), "a file that is damaged or no MATLAB file", wanted_file) from why
    return as_columns(_with_fields(plain, structs), wanted, str(path))


def _read_v5(path: Path) -> tuple[dict[str, np.ndarray], dict[str, dict[str, np.ndarray]]]:
    """Arrays by name, and the fields of each struct by the struct's name."""
    plain, structs = {}, {}
    from scipy import io  # a tenth of a second to import, and few records need it

    for name, values in io.loadmat(path).items():
        if name.startswith("__") or not isinstance(values, np.ndarray):
            continue
        if values.dtype.names and values.size == 1:
            fields = values.ravel()[0]
            structs[name] = {field: np.asarray(fields[field]) for field in values.dtype.names}
        elif not values.dtype.names:
            plain[name] = values
    return plain, structs


def _read_hdf5(path: Path) -> tuple[dict[str, np.ndarray], dict[str, dict[str, np.ndarray]]]:
    """Arrays by name, and the arrays in each group by the group's name."""
    try:
        import h5py
    except ImportError:
        way_out = 'h5py to read it: pip install "jaxbacklash[io]", or save the file again with -v7'
        raise wrong(str(path), "a MATLAB 7.3 file", way_out) from None
    plain, structs = {}, {}
    with h5py.File(path, "r") as file:
        for name, item in file.items():
            # "#refs#" and the like are MATLAB's own bookkeeping.
            if isinstance(item, h5py.Dataset):
                plain[name] = item
            elif not name.startswith("#"):
                structs[name] = {field: each for field, each in item.items() if isinstance(each, h5py.Dataset)}
        return _numeric(plain), {name: _numeric(fields) for name, fields in structs.items()}


def _numeric(datasets: dict) -> dict[str, np.ndarray]:
    """The data sets that hold numbers, read; text is stored as character codes and told by its attribute."""
    return {
        name: np.asarray(each)
        for name, each in datasets.items()
        if each.dtype.kind in "fiub" and each.attrs.get("MATLAB_class", b"") not in (b"char", "char")
    }


def _with_fields(plain: dict[str, np.ndarray], structs: dict[str, dict[str, np.ndarray]]) -> dict[str, np.ndarray]:
    """One level: struct fields stand beside the plain arrays."""
    every = [*plain, *(field for fields in structs.values() for field in fields)]
    arrays = dict(plain)
    for struct, fields in structs.items():
        for field, values in fields.items():
            arrays[field if every.count(field) == 1 else f"{struct}.{field}"] = values
    return arrays
