"""Labels at the edge: arrays of a map become an xarray Dataset with coordinates, units and constants."""

from __future__ import annotations

import os
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import BadInput
from .maps import KEPT, VARIABLES, Request, package_version
from .periodicity import CHAOTIC, UNRESOLVED
from .tiles import MemoryTiles, TileStore, shape_of

ROOM = 2**20
"""Numbers that are read from a store at once: asking costs as much as reading a few chunks."""
ABOUT = {
    "lyapunov": ("largest Lyapunov exponent", "1/{time}"),
    "lyapunov_stderr": ("standard error of the exponent, from batch means", "1/{time}"),
    "period": (f"periods of the drive in one period of the motion; {CHAOTIC}: chaotic, {UNRESOLVED}: unresolved", "1"),
    "unresolved": ("1 where the solver met the edges too often to go on", "1"),
    "poincare": ("position at whole periods of the drive", "{length}"),
}


def need_xarray() -> Any:
    """The xarray library, or one sentence about how to get it."""
    try:
        import xarray
    except ImportError:
        raise BadInput('maps need xarray, which is not installed: pip install "jaxbacklash[sweep]"') from None
    return xarray


def need_h5netcdf() -> Any:
    """The library that writes netCDF, or one sentence about how to get it."""
    try:
        import h5netcdf
    except ImportError:
        raise BadInput('writing netCDF needs h5netcdf, which is not installed: pip install "jaxbacklash[sweep]"') from None
    return h5netcdf


def need_dask_array() -> Any:
    """The library that reads a store piece by piece, or one sentence about how to get it."""
    try:
        import dask.array
    except ImportError:
        raise BadInput('reading a store needs dask, which is not installed: pip install "jaxbacklash[sweep]"') from None
    return dask.array


def dataset(wanted: Request, kept: MemoryTiles) -> Any:
    """A map in memory as a Dataset."""
    return _labelled(wanted, kept.arrays, kept.solvers)


def dataset_from_store(wanted: Request, kept: TileStore) -> Any:
    """A map in a store as a Dataset; arrays of more than `ROOM` numbers are read from the tiles when they are needed."""
    if not is_large(wanted):
        return _labelled(wanted, {name: part[...] for name, part in kept.arrays.items()}, kept.solvers)
    da = need_dask_array()
    # Names of our own: dask's would depend on the folder, and with them the order in which a file is written.
    # Told what it will find, dask need not read the store to learn it.
    lazy = {
        name: da.from_array(part, chunks=part.chunks, name=f"map-{name}", meta=np.empty((0,) * part.ndim, part.dtype))
        for name, part in kept.arrays.items()
    }
    return _labelled(wanted, lazy, kept.solvers)


def is_large(wanted: Request) -> bool:
    """Whether a variable of the map has more than `ROOM` numbers."""
    return max(int(np.prod(shape_of(wanted, name))) for name in VARIABLES) > ROOM


def _labelled(wanted: Request, arrays: dict[str, Any], solvers: set[str]) -> Any:
    xarray = need_xarray()
    family, plan = wanted.family, wanted.plan
    length = "half play" if family.time_unit == "1/omega_0" else "rad"
    variables = {}
    for name, values in arrays.items():
        words, unit = ABOUT[name]
        unit = unit.format(time="tau" if family.time_unit == "1/omega_0" else "s", length=length)
        dims = ["sample", *wanted.names] if name in KEPT else wanted.names
        variables[name] = (dims, values, {"long_name": words, "units": unit})
    coordinates = {
        name: (name, np.array(values), {"units": family.unit(name), "long_name": family.long_name(name)})
        for name, values in wanted.axes
    }
    constants = family.constants(wanted.names)
    if "zeta" in constants:
        constants["two_zeta"] = 2.0 * constants["zeta"]
    attributes: dict[str, Any] = {
        "title": "Lyapunov exponent, period and stroboscopic samples",
        "units": "lengths in half plays, time tau in 1/omega_0" if length == "half play" else "SI",
        "periods": plan.periods, "skip": plan.skip, "start": np.array(wanted.start), "solver": ", ".join(sorted(solvers)),
        "package": "jaxbacklash", "version": package_version(), **constants,
    }  # fmt: skip
    if length == "half play":
        attributes["zeta_is"] = "c / (2 m omega_0); the paper's figures quote 2 zeta"
    return xarray.Dataset(variables, coordinates, attributes)


def write_netcdf(map_: Any, path: str | os.PathLike[str]) -> None:
    """Write a map whole or not at all, and the same map always as the same bytes.

    A map from a store goes over in order, some chunks at a time, so that no more than `ROOM` numbers are in memory.

    Raises
    ------
    BadInput
        h5netcdf is missing or the file cannot be written.
    """
    h5netcdf = need_h5netcdf()
    target = Path(path)
    part = target.with_name(target.name + ".part")
    try:
        with h5netcdf.File(part, "w") as file:
            file.dimensions = {str(name): int(size) for name, size in map_.sizes.items()}
            for key, value in map_.attrs.items():
                file.attrs[key] = value
            for name, variable in map_.variables.items():
                _write_variable(file, str(name), variable)
        part.replace(target)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise BadInput(f"--out {target}: cannot be written ({error.strerror or error})") from None


def _write_variable(file: Any, name: str, variable: Any) -> None:
    chunks = getattr(variable.data, "chunks", None)
    shape = tuple(parts[0] for parts in chunks) if chunks else None
    written = file.create_variable(name, variable.dims, dtype=variable.dtype, chunks=shape)
    for key, value in variable.attrs.items():
        written.attrs[key] = value
    if not chunks:
        written[...] = variable.values
        return
    edges = [np.concatenate([[0], np.cumsum(parts)]) for parts in chunks]
    # Every so many edges, and the last one.
    stops = [[*e[:-1:step], e[-1]] for e, step in zip(edges, _together(chunks))]
    for box in product(*(pairwise(e) for e in stops)):
        where = tuple(slice(int(begin), int(end)) for begin, end in box)
        written[where] = np.asarray(variable.data[where])


def _together(chunks: tuple[tuple[int, ...], ...]) -> list[int]:
    """How many chunks along each dimension are read at once: whole rows of chunks, as far as `ROOM` goes."""
    room = max(1, ROOM // int(np.prod([parts[0] for parts in chunks])))
    steps: list[int] = []
    for parts in reversed(chunks):
        steps.insert(0, min(len(parts), room))
        room = max(1, room // steps[0])
    return steps
