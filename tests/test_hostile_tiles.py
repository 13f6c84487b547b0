"""A map writes into its own folder only, one process at a time, and goes on from whatever a damaged one still holds."""

import json
import os
import subprocess
import sys
import threading

import numpy as np
import pytest

pytest.importorskip("zarr")
pytest.importorskip("h5netcdf")

from jaxbacklash.dynamics import tile_folder
from jaxbacklash.dynamics.family import PaperCase
from jaxbacklash.dynamics.maps import labelled_map
from jaxbacklash.dynamics.request import request
from jaxbacklash.dynamics.tiles import TileStore, place
from jaxbacklash.errors import BadInput, NoAnswer

from .hostile import ROOT, one_sentence
from .test_cli import call as call

AXES = {"inverse_alpha": np.linspace(1.5, 4.5, 4), "zeta": np.linspace(0.01, 0.03, 3)}
WORDS = ("map", "--inverse-alpha", "1:5:4", "--zeta", "0.01:0.03:3", "--periods", "30", "--skip", "5", "--samples", "4")


def small():
    return request(PaperCase(1), AXES, periods=30, skip=5, samples=4, lanes=6)


@pytest.fixture(scope="module")
def whole():
    return labelled_map(small())


def same(a, b):
    return all(np.array_equal(a.values(name), b.values(name), equal_nan=True) for name in a.variables)


def with_file(store, name="mine.txt"):
    (store / name).parent.mkdir(parents=True)
    (store / name).write_text("mine")


def own_arrays(store):
    (store / "arrays.zarr").mkdir(parents=True)
    (store / "arrays.zarr" / "mine").write_text("mine")


def link(store):
    elsewhere = store.with_name("elsewhere")
    elsewhere.mkdir()
    (elsewhere / "mine.txt").write_text("mine")
    store.symlink_to(elsewhere)


def foreign_mark(store):
    with_file(store, "request.json")


def old_mark(store):
    store.mkdir()
    (store / "request.json").write_text(json.dumps({"fingerprint": "0" * 64}))


def plain_file(store):
    store.write_text("mine")


def everything(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.mark.parametrize("before", [with_file, own_arrays, link, foreign_mark, old_mark, plain_file])
def test_what_is_not_its_own_stays_as_it_is(call, tmp_path, before):
    before(tmp_path / "m.nc.tiles")
    held = everything(tmp_path)
    code, out, err = call(*WORDS, "--out", "m.nc")
    assert (code, out) == (2, "")
    assert "m.nc.tiles" in one_sentence(err)
    now = {name: text for name, text in everything(tmp_path).items() if not name.startswith("cache")}
    assert now == held


def test_what_somebody_put_beside_the_tiles_stays(call, tmp_path):
    store = tmp_path / "m.nc.tiles"
    tile_folder.reserve(store, "0" * 64)
    (store / "notes.txt").write_text("mine")
    (store / "sub").mkdir()
    assert tile_folder.remove(store) == ["notes.txt", "sub"]
    assert (store / "notes.txt").read_text() == "mine"


def test_a_store_is_removed_with_all_that_is_its_own(tmp_path):
    labelled_map(small(), store=tmp_path / "store")
    assert tile_folder.remove(tmp_path / "store") == []
    assert not (tmp_path / "store").exists()


DAMAGE = {
    "no solver": lambda store: (store / "records" / "000000.json").write_text('{"sha256": "0"}'),
    "solver is a number": lambda store: [
        record.write_text(json.dumps(json.loads(record.read_text()) | {"solver": 3})) for record in store.glob("records/*.json")
    ],
    "no json": lambda store: (store / "records" / "000001.json").write_text("{"),
    "a list": lambda store: (store / "records" / "000001.json").write_text("[]"),
    "other records": lambda store: (store / "records" / "999999.json").write_text("{}"),
    "broken zarr.json": lambda store: (store / "arrays.zarr" / "zarr.json").write_text("{no"),
    "empty zarr.json of a variable": lambda store: (store / "arrays.zarr" / "period" / "zarr.json").write_text(""),
    "another shape": lambda store: (store / "arrays.zarr" / "period" / "zarr.json").write_text(
        (store / "arrays.zarr" / "lyapunov_stderr" / "zarr.json").read_text()
    ),
    "no arrays": lambda store: os.rename(store / "arrays.zarr", store.with_name("gone")),
    "no records": lambda store: os.rename(store / "records", store.with_name("gone")),
    "a half-written mark": lambda store: (store / ".request.json.1.2.part").write_text("{"),
}


@pytest.mark.parametrize("damage", DAMAGE.values(), ids=DAMAGE)
def test_a_damaged_store_gives_the_same_map(whole, tmp_path, damage):
    store = tmp_path / "store"
    labelled_map(small(), store=store)
    damage(store)
    again = labelled_map(small(), store=store)
    assert same(whole, again)
    assert again.attrs["solver"] == whole.attrs["solver"]


def test_parts_that_are_links_are_refused(tmp_path):
    for part in ("arrays.zarr", "records"):
        store = tmp_path / part / "store"
        labelled_map(small(), store=store)
        elsewhere = tmp_path / part / "elsewhere"
        os.rename(store / part, elsewhere)
        (store / part).symlink_to(elsewhere)
        before = everything(elsewhere)
        with pytest.raises(BadInput, match="is not a folder"):
            labelled_map(small(), store=store)
        assert everything(elsewhere) == before


def test_a_full_disk_keeps_the_tiles_before(tmp_path, monkeypatch):
    store = TileStore(tmp_path / "store", small())

    def full(*args, **options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("jaxbacklash.dynamics.tiles.write_whole", full)
    numbers = {name: np.asarray(array[place(small().tiles()[0], name)]) for name, array in store.arrays.items()}
    with pytest.raises(NoAnswer, match="No space left on device"):
        store.put(0, numbers, "exact")
    assert not store.has(0)


def test_two_maps_into_one_file(tmp_path):
    store = tmp_path / "store"
    tile_folder.reserve(store, "0" * 64)
    code = (
        "import sys, time\nfrom pathlib import Path\nfrom jaxbacklash.dynamics.tile_folder import used_alone\n"
        "with used_alone(Path(sys.argv[1])):\n    print('in', flush=True)\n    time.sleep(60)\n"
    )
    other = subprocess.Popen(
        [sys.executable, "-c", code, str(store)], stdout=subprocess.PIPE, text=True, env={**os.environ, "PYTHONPATH": str(ROOT)}
    )
    try:
        assert other.stdout.readline() == "in\n"
        with pytest.raises(BadInput, match=f"process {other.pid} is computing"), tile_folder.used_alone(store):
            pass
    finally:
        other.kill()
        other.wait()
    with tile_folder.used_alone(store):  # its lock went with it
        assert (store / "lock").read_text().strip() == str(os.getpid())


def test_a_lock_that_is_a_link_to_a_device_does_not_hold(tmp_path):
    store = tmp_path / "store"
    tile_folder.reserve(store, "0" * 64)
    (store / "lock").symlink_to("/dev/zero")
    done = []

    def enter():
        with pytest.raises(BadInput, match="cannot be used"), tile_folder.used_alone(store):
            pass
        done.append(True)

    thread = threading.Thread(target=enter, daemon=True)
    thread.start()
    thread.join(20)
    assert done
