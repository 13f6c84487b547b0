"""Where the tiles of a map are kept: in memory, or in a zarr store that survives being killed at any moment.

A store is one zarr group with an array per variable, cut into chunks that are the tiles, and beside it a small record per tile,
written after the tile and only then: its checksum and the solver's name. A tile counts as done when its record is there and
its chunks still have that checksum; everything else is computed anew. Since a tile's numbers depend on nothing but the
request, a run that was stopped ends with the same bits as one that was not.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import BadInput, NoAnswer
from ..whole_file import write_whole
from .request import KEPT, VARIABLES, Request
from .tile_folder import ARRAYS, RECORDS, reserve


class MemoryTiles:
    """Tiles of a map that fits in memory."""

    def __init__(self, wanted: Request) -> None:
        self._boxes = wanted.tiles()
        self.arrays = {name: np.empty(shape_of(wanted, name), dtype=kind) for name, kind in VARIABLES.items()}
        self.solvers: set[str] = set()

    def has(self, k: int) -> bool:
        return False

    def put(self, k: int, numbers: dict[str, np.ndarray], solver: str) -> None:
        for name, values in numbers.items():
            self.arrays[name][place(self._boxes[k], name)] = values
        self.solvers.add(solver)


class TileStore:
    """Tiles of a map in a folder.

    Raises
    ------
    BadInput
        zarr is not installed, or the folder cannot be written, is not a store of tiles, or holds another map.
    """

    def __init__(self, path: Path, wanted: Request) -> None:
        zarr = need_zarr()
        self.path, self._boxes = path, wanted.tiles()
        self._solvers: dict[int, str] = {}
        reserve(path, wanted.fingerprint())
        try:
            self.arrays = self._open(zarr, wanted)
        except Exception:  # missing, damaged or of another shape: made anew, and with it the tiles
            try:
                self._create(zarr, wanted)
                self.arrays = self._open(zarr, wanted)
            except OSError as error:
                raise BadInput(f"{path}: cannot be used as a store of tiles ({error.strerror or error})") from None

    def _open(self, zarr: Any, wanted: Request) -> dict[str, Any]:
        group = zarr.open_group(self.path / ARRAYS, mode="r+")
        arrays = {name: group[name] for name in VARIABLES}
        for name, kind in VARIABLES.items():
            found = arrays[name]
            if (found.shape, found.chunks, found.dtype) != (*self._layout(wanted, name), np.dtype(kind)):
                raise ValueError(f"{name}: not the array of this map")
        return arrays

    def _create(self, zarr: Any, wanted: Request) -> None:
        group = zarr.open_group(self.path / ARRAYS, mode="w")
        for name, kind in VARIABLES.items():
            shape, chunks = self._layout(wanted, name)
            group.create_array(name, shape=shape, chunks=chunks, dtype=kind, overwrite=True)

    def _layout(self, wanted: Request, name: str) -> tuple[tuple[int, ...], tuple[int, ...]]:
        lead = (wanted.plan.samples,) if name in KEPT else ()
        return shape_of(wanted, name), (*lead, *wanted.tile)

    def has(self, k: int) -> bool:
        """True when the tile is there and sound."""
        try:
            record = json.loads(self._record(k).read_text(encoding="utf-8"))
            solver = record["solver"]
            sound = record["sha256"] == _checksum({name: self.arrays[name][place(self._boxes[k], name)] for name in VARIABLES})
        except Exception:  # whatever is wrong with a half-written or damaged tile, the cure is to compute it again
            return False
        if not sound or not isinstance(solver, str):
            return False
        self._solvers[k] = solver
        return True

    def put(self, k: int, numbers: dict[str, np.ndarray], solver: str) -> None:
        """Keep a tile.

        Raises
        ------
        NoAnswer
            It cannot be written; those before it are kept.
        """
        try:
            if self._record(k).is_dir():
                raise IsADirectoryError(21, f"{self._record(k).name} is a folder")
            self._record(k).unlink(missing_ok=True)
            for name, values in numbers.items():
                self.arrays[name][place(self._boxes[k], name)] = values
            write_whole(self._record(k), json.dumps({"sha256": _checksum(numbers), "solver": solver}), lasting=True)
        except OSError as error:
            raise NoAnswer(
                f"{self.path}: a tile cannot be written ({error.strerror or error}); the tiles written so far are kept, the same "
                "command goes on from there"
            ) from None
        self._solvers[k] = solver

    @property
    def solvers(self) -> set[str]:
        return set(self._solvers.values())

    def _record(self, k: int) -> Path:
        return self.path / RECORDS / f"{k:06d}.json"


def need_zarr() -> Any:
    """The zarr library, or one sentence about how to get it."""
    try:
        import zarr
    except ImportError:
        raise BadInput('a store of tiles needs zarr, which is not installed: pip install "jaxbacklash[sweep]"') from None
    return zarr


def shape_of(wanted: Request, name: str) -> tuple[int, ...]:
    """The whole map's shape of one variable."""
    return (wanted.plan.samples, *wanted.shape) if name in KEPT else wanted.shape


def place(box: tuple[slice, ...], name: str) -> tuple[slice, ...]:
    """Where a tile stands in one variable."""
    return (slice(None), *box) if name in KEPT else box


def _checksum(numbers: dict[str, Any]) -> str:
    total = hashlib.sha256()
    for name in VARIABLES:
        total.update(np.ascontiguousarray(numbers[name]).tobytes())
    return total.hexdigest()
