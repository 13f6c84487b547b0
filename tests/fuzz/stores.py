"""What stands where a map wants to write: tiles of another, folders that are not its own, links, damage; and two maps at once."""

from __future__ import annotations

import json
from pathlib import Path

from tests.fuzz.case import Case, kind, pick

MAP = ["map", "--inverse-alpha", "1:5:6", "--zeta", "0.01:0.03:3", "--periods", "40", "--skip", "10", "--out", "m.nc"]


def mine_is_there(folder: Path) -> str:
    """A complaint when a user's own file is gone."""
    for path in ("m.nc.tiles/mine.txt", "elsewhere/mine.txt"):
        if (folder / "expected" / path).exists() and not (folder / path).exists():
            return f"{path} is gone"
    return ""


def _mine(folder: Path, path: str) -> None:
    for place in (folder / path, folder / "expected" / path):
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text("mine\n")


@kind("stores", 3)
def a_folder_that_is_not_its_own(rng, folder: Path) -> Case:
    _mine(folder, "m.nc.tiles/mine.txt")
    extra = int(rng.integers(4))
    if extra == 1:
        (folder / "m.nc.tiles" / "request.json").write_text("{}")
    if extra == 2:
        (folder / "m.nc.tiles" / "arrays.zarr").mkdir()
        (folder / "m.nc.tiles" / "arrays.zarr" / "zarr.json").write_text("{broken")
    if extra == 3:
        (folder / "m.nc.tiles" / "records").write_text("a file")
    return Case(MAP, check=mine_is_there)


@kind("stores", 2)
def a_link_for_a_folder(rng, folder: Path) -> Case:
    _mine(folder, "elsewhere/mine.txt")
    target = pick(rng, "elsewhere", "nowhere", "m.nc.tiles", "/dev/null")
    (folder / "m.nc.tiles").symlink_to(target)
    return Case(MAP, check=mine_is_there)


@kind("stores", 2)
def something_at_the_output(rng, folder: Path) -> Case:
    name = pick(rng, "m.nc", "m.html", "m.png", "m.nc.tiles")
    (folder / name).mkdir() if name != "m.nc.tiles" else (folder / name).write_text("a file")
    return Case(MAP)


@kind("stores", 3, alone=True)
def damaged_tiles(rng, folder: Path) -> Case:
    """A store as an interrupted map leaves it, then damaged: the map is computed anew or refused, never wrong."""
    store = folder / "m.nc.tiles"
    (store / "records").mkdir(parents=True)
    (store / "request.json").write_text(pick(rng, json.dumps({"fingerprint": "other"}), "", "{", "[]", "null", "\0" * 20))
    for place in range(int(rng.integers(0, 4))):
        record = pick(rng, "{}", "", "null", json.dumps({"sha256": "0" * 64}), json.dumps({"sha256": 5, "solver": None}))
        (store / "records" / f"{place:06d}.json").write_text(record)
    return Case(MAP, alone=True, lost=("m.nc.tiles/",))


@kind("stores", 1, alone=True)
def two_maps_at_once(rng, folder: Path) -> Case:
    return Case(MAP, alone=True, twice=True)
