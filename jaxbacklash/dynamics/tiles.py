"""Where the tiles of a map are kept: in memory, or in a zarr store that survives being killed at any moment.

A store is one zarr group with an array per variable, cut into chunks that are the tiles, and beside it a small record per tile,
written after the tile and only then: its checksum and the solver's name. A tile counts as done when its record is there and
its chunks still have that checksum; everything else is computed anew. Since a tile's numbers depend on nothing but the
request, a run that was stopped ends with the same bits as one that was not.
"""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import BadInput
from .maps import KEPT, VARIABLES, Request

ARRAYS, RECORDS = "arrays.zarr", "records"


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
        zarr is not installed, the folder cannot be written, or holds another map.
    """

    def __init__(self, path: Path, wanted: Request) -> None:
        zarr = need_zarr()
        self.path, self._boxes = path, wanted.tiles()
        mark = path / "request.json"
        told = json.dumps({"fingerprint": wanted.fingerprint()})
        try:
            (path / RECORDS).mkdir(parents=True, exist_ok=True)
            if not mark.exists():
                self._create(zarr, wanted)
                _write_whole(mark, told)
        except OSError as error:
            raise BadInput(f"{path}: cannot be used as a store of tiles ({error.strerror or error})") from None
        if mark.read_text(encoding="utf-8") != told:
            raise BadInput(
                f"{path} holds tiles of another map (other axes, periods, start or version): remove it or name another output"
            )
        self._group = zarr.open_group(path / ARRAYS, mode="r+")
        self.arrays = {name: self._group[name] for name in VARIABLES}

    def _create(self, zarr: Any, wanted: Request) -> None:
        group = zarr.open_group(self.path / ARRAYS, mode="w")
        for name, kind in VARIABLES.items():
            lead = (wanted.plan.samples,) if name in KEPT else ()
            group.create_array(name, shape=shape_of(wanted, name), chunks=(*lead, *wanted.tile), dtype=kind, overwrite=True)

    def has(self, k: int) -> bool:
        """True when the tile is there and sound."""
        try:
            record = json.loads(self._record(k).read_text(encoding="utf-8"))
            return record["sha256"] == _checksum({name: self.arrays[name][place(self._boxes[k], name)] for name in VARIABLES})
        except Exception:  # whatever is wrong with a half-written or damaged tile, the cure is to compute it again
            return False

    def put(self, k: int, numbers: dict[str, np.ndarray], solver: str) -> None:
        self._record(k).unlink(missing_ok=True)
        for name, values in numbers.items():
            self.arrays[name][place(self._boxes[k], name)] = values
        _write_whole(self._record(k), json.dumps({"sha256": _checksum(numbers), "solver": solver}))

    @property
    def solvers(self) -> set[str]:
        return {json.loads(file.read_text(encoding="utf-8"))["solver"] for file in (self.path / RECORDS).glob("*.json")}

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


def _write_whole(path: Path, text: str) -> None:
    part = path.with_name(path.name + ".part")
    with part.open("w", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    part.replace(path)
