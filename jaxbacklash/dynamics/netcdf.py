"""A map as a netCDF file: by h5netcdf where that is installed, else by scipy.

h5netcdf writes netCDF-4 and takes a map from a store of tiles piece by piece. scipy comes with the package and writes netCDF-3
from memory, with at most 2 GB a variable. xarray, MATLAB and the netCDF tools read both.
"""

from __future__ import annotations

import importlib.util
import os
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import BadInput
from ..whole_file import whole_file
from .labels import ROOM, Labelled

LARGEST = 2**31 - 1
"""Bytes in a variable of a netCDF-3 file as scipy writes it, at most."""


def can_keep_tiles() -> bool:
    """Whether the libraries of the extra ``sweep`` are there that keep a map's tiles on disk and copy them into a file."""
    return all(importlib.util.find_spec(library) is not None for library in ("zarr", "h5netcdf"))


def write_netcdf(map_: Any, path: str | os.PathLike[str]) -> None:
    """Write a map whole or not at all, and the same map with the same library always as the same bytes.

    A map from a store goes over in order, some chunks at a time, so that no more than `ROOM` numbers are in memory.
    ``map_`` is a Dataset or a `Labelled`. Without h5netcdf the file is netCDF-3.

    Raises
    ------
    BadInput
        The file cannot be written, or h5netcdf is missing and a variable has more than 2 GB.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import mkdtemp
    >>> found = jb.dynamics.paper_map(1, {"inverse_alpha": [1.5, 2.0, 3.0], "zeta": [0.02, 0.03]}, periods=60, skip=20)
    >>> file = Path(mkdtemp()) / "case1.nc"
    >>> jb.dynamics.write_netcdf(found, file)
    >>> file.stat().st_size > 1000
    True
    """
    target = Path(path)
    write = _by_h5netcdf if importlib.util.find_spec("h5netcdf") is not None else _by_scipy
    try:
        with whole_file(target) as part:
            write(map_, part)
    except OSError as error:
        raise BadInput(f"--out {target}: cannot be written ({error.strerror or error})") from None


def _variables(map_: Any) -> dict[str, Any]:
    """Coordinates first; a Dataset's are among its variables."""
    return {**(map_.coordinates if isinstance(map_, Labelled) else {}), **map_.variables}


def _by_scipy(map_: Any, part: Path) -> None:
    from scipy.io import netcdf_file

    with netcdf_file(part, "w", version=2) as file:
        for name, size in map_.sizes.items():
            file.createDimension(str(name), int(size))
        for key, value in map_.attrs.items():
            setattr(file, key, _attribute(value))
        for name, variable in _variables(map_).items():
            data = np.asarray(variable.data)
            if data.nbytes > LARGEST:
                raise BadInput(f'{name} has {data.nbytes} bytes, more than netCDF-3 takes: pip install "jaxbacklash[sweep]"')
            written = file.createVariable(str(name), data.dtype, tuple(variable.dims))
            for key, value in variable.attrs.items():
                setattr(written, key, _attribute(value))
            written[...] = data


def _attribute(value: Any) -> Any:
    """What netCDF-3 knows: text, 32 bit integers and floats; numbers that do not fit in 32 bits go as floats."""
    if isinstance(value, str):
        return value
    numbers = np.asarray(value)
    if numbers.dtype.kind in "biu" and np.all(np.abs(numbers.astype(float)) < 2.0**31):
        return numbers.astype(np.int32)
    return numbers.astype(float)


def _by_h5netcdf(map_: Any, part: Path) -> None:
    import h5netcdf

    with h5netcdf.File(part, "w") as file:
        file.dimensions = {str(name): int(size) for name, size in map_.sizes.items()}
        for key, value in map_.attrs.items():
            file.attrs[key] = value
        for name, variable in _variables(map_).items():
            _write_variable(file, str(name), variable)


def _write_variable(file: Any, name: str, variable: Any) -> None:
    data = variable.data
    chunks = _chunks(data)
    shape = tuple(parts[0] for parts in chunks) if chunks else None
    written = file.create_variable(name, tuple(variable.dims), dtype=data.dtype, chunks=shape)
    for key, value in variable.attrs.items():
        written.attrs[key] = value
    if not chunks:
        written[...] = np.asarray(data)
        return
    edges = [np.concatenate([[0], np.cumsum(parts)]) for parts in chunks]
    # Every so many edges, and the last one.
    stops = [[*e[:-1:step], e[-1]] for e, step in zip(edges, _together(chunks))]
    for box in product(*(pairwise(e) for e in stops)):
        where = tuple(slice(int(begin), int(end)) for begin, end in box)
        written[where] = np.asarray(data[where])


def _chunks(data: Any) -> tuple[tuple[int, ...], ...] | None:
    """The lengths of an array's chunks along each dimension, as dask tells them; zarr tells the length of a whole one."""
    chunks = getattr(data, "chunks", None)
    if not chunks or not isinstance(chunks[0], int):
        return chunks
    return tuple(tuple(min(step, size - i) for i in range(0, size, step)) for step, size in zip(chunks, data.shape))


def _together(chunks: tuple[tuple[int, ...], ...]) -> list[int]:
    """How many chunks along each dimension are read at once: whole rows of chunks, as far as `ROOM` goes."""
    room = max(1, ROOM // int(np.prod([parts[0] for parts in chunks])))
    steps: list[int] = []
    for parts in reversed(chunks):
        steps.insert(0, min(len(parts), room))
        room = max(1, room // steps[0])
    return steps
