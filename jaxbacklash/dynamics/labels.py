"""Labels at the edge: arrays of a map become an xarray Dataset with coordinates, units and constants."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ..frames import needed
from .periodicity import CHAOTIC, UNRESOLVED
from .request import KEPT, VARIABLES, Request, package_version
from .tiles import MemoryTiles, TileStore, shape_of

ROOM = 2**20
"""Numbers of a map that are held in memory at once: asking a store costs as much as reading a few chunks."""
ABOUT = {
    "lyapunov": ("largest Lyapunov exponent", "1/{time}"),
    "lyapunov_stderr": ("standard error of the exponent, from batch means", "1/{time}"),
    "period": (f"periods of the drive in one period of the motion; {CHAOTIC}: chaotic, {UNRESOLVED}: unresolved", "1"),
    "unresolved": ("1 where the solver met the edges too often to go on", "1"),
    "poincare": ("position at whole periods of the drive", "{length}"),
}


def need_xarray() -> Any:
    """The xarray library, or one sentence about how to get it."""
    return needed("xarray", "a map", "sweep")


def need_dask_array() -> Any:
    """The library that reads a store piece by piece, or one sentence about how to get it."""
    return needed("dask.array", "reading a store", "sweep")


class Variable(NamedTuple):
    """Numbers with the names of their dimensions, in memory or in a store's array, which is read where it is indexed."""

    dims: tuple[str, ...]
    data: Any
    attrs: dict[str, Any]


class Labelled(NamedTuple):
    """A map with its labels, of which `dataset` makes xarray's: that library, with those it loads, takes a second to come."""

    variables: dict[str, Variable]
    coordinates: dict[str, Variable]
    attrs: dict[str, Any]

    @property
    def sizes(self) -> dict[str, int]:
        """Dimensions in order of their appearance."""
        return {dim: n for part in self.variables.values() for dim, n in zip(part.dims, part.data.shape)}

    def values(self, name: str, at: Mapping[str, int] | None = None) -> np.ndarray:
        """Numbers of a variable, read where others are not: ``at`` gives some dimensions' index, the rest keep their order."""
        part = self.variables[name]
        return np.asarray(part.data[tuple((at or {}).get(dim, slice(None)) for dim in part.dims)])

    def loaded(self) -> Labelled:
        """The same with all but the kept samples in memory: of a large map these would not fit."""
        here = {name: v if name in KEPT else v._replace(data=self.values(name)) for name, v in self.variables.items()}
        return self._replace(variables=here)


def dataset(map_: Labelled) -> Any:
    """A map as xarray's Dataset; what lies in a store is read from its tiles when it is needed."""
    xarray = need_xarray()
    stored = {name: part for name, part in map_.variables.items() if not isinstance(part.data, np.ndarray)}
    lazy = {name: part._replace(data=_lazy(name, part.data)) for name, part in stored.items()}
    return xarray.Dataset(map_.variables | lazy, map_.coordinates, map_.attrs)


def _lazy(name: str, part: Any) -> Any:
    # A name of our own: dask's would depend on the folder, and with it the order in which a file is written.
    # Told what it will find, dask need not read the store to learn it.
    meta = np.empty((0,) * part.ndim, part.dtype)
    return need_dask_array().from_array(part, chunks=part.chunks, name=f"map-{name}", meta=meta)


def is_large(wanted: Request) -> bool:
    """Whether a variable of the map has more than `ROOM` numbers."""
    return max(int(np.prod(shape_of(wanted, name))) for name in VARIABLES) > ROOM


def labelled(wanted: Request, kept: MemoryTiles | TileStore) -> Labelled:
    """Computed tiles with names and units; from a store they are read at once unless the map is large, see `is_large`."""
    family, plan = wanted.family, wanted.plan
    length = "half play" if family.time_unit == "1/omega_0" else "rad"
    variables = {}
    for name, values in kept.arrays.items():
        words, unit = ABOUT[name]
        unit = unit.format(time="tau" if family.time_unit == "1/omega_0" else "s", length=length)
        dims = ("sample", *wanted.names) if name in KEPT else tuple(wanted.names)
        variables[name] = Variable(dims, values if is_large(wanted) else values[...], {"long_name": words, "units": unit})
    coordinates = {
        name: Variable((name,), np.array(values), {"units": family.unit(name), "long_name": family.long_name(name)})
        for name, values in wanted.axes
    }
    constants = family.constants(wanted.names)
    if "zeta" in constants:
        constants["two_zeta"] = 2.0 * constants["zeta"]
    attributes: dict[str, Any] = {
        "title": "Lyapunov exponent, period and stroboscopic samples",
        "units": "lengths in half plays, time tau in 1/omega_0" if length == "half play" else "SI",
        "periods": plan.periods, "skip": plan.skip, "start": np.array(wanted.start), "solver": ", ".join(sorted(kept.solvers)),
        "package": "jaxbacklash", "version": package_version(), **constants,
    }  # fmt: skip
    if length == "half play":
        attributes["zeta_is"] = "c / (2 m omega_0); the paper's figures quote 2 zeta"
    return Labelled(variables, coordinates, attributes)
