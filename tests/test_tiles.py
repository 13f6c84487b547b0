"""A map that is killed goes on where it stopped and gives the same bits; a damaged tile is found; a dead worker loses nothing."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("zarr")
pytest.importorskip("xarray")

from jaxbacklash.dynamics.family import PaperCase
from jaxbacklash.dynamics.maps import labelled_map, run_map
from jaxbacklash.dynamics.netcdf import write_netcdf
from jaxbacklash.dynamics.request import request
from jaxbacklash.dynamics.tiles import TileStore
from jaxbacklash.errors import BadInput

ROOT = Path(__file__).resolve().parents[1]
AXES = {"inverse_alpha": np.linspace(1.5, 4.5, 10), "zeta": np.linspace(0.01, 0.03, 6)}


def small(**changes):
    options = {"periods": 30, "skip": 5, "samples": 4, "lanes": 12} | changes
    return request(PaperCase(1), options.pop("axes", AXES), **options)


def same(a, b):
    return all(np.array_equal(a[name].values, b[name].values, equal_nan=True) for name in a)


@pytest.fixture(scope="module")
def whole():
    return run_map(small())


def test_tiles_cover_the_map_once():
    wanted = small(lanes=8)  # 6 by 1, and its sides do not divide the map
    counted = np.zeros(wanted.shape, dtype=int)
    for box in wanted.tiles():
        counted[box] += 1
    assert np.all(counted == 1)
    assert small(lanes=4).tile == (1, 4)


def test_a_store_holds_the_bits_of_the_map_in_memory(whole, tmp_path):
    assert same(whole, run_map(small(), store=tmp_path / "store"))


@pytest.mark.parametrize("room", [1, 30, 100, 10_000])
def test_a_store_goes_into_its_file_some_chunks_at_a_time(tmp_path, monkeypatch, room):
    import xarray

    from jaxbacklash.dynamics import labels, netcdf

    pytest.importorskip("h5netcdf")
    for module in (labels, netcdf):
        monkeypatch.setattr(module, "ROOM", room)
    stored = run_map(small(lanes=8), store=tmp_path / "store")
    assert (stored.poincare.chunks is not None) == (room < stored.poincare.size)  # small arrays are read at once
    write_netcdf(stored, tmp_path / "map.nc")
    with xarray.open_dataset(tmp_path / "map.nc", engine="h5netcdf") as found:
        assert same(stored, found)
    bare = labelled_map(small(lanes=8), store=tmp_path / "store")  # as the command does, without xarray
    write_netcdf(bare, tmp_path / "bare.nc")
    with xarray.open_dataset(tmp_path / "bare.nc", engine="h5netcdf") as found:
        assert same(stored, found)
        assert found.attrs.keys() == stored.attrs.keys()
        assert found.zeta.attrs == stored.zeta.attrs
    np.testing.assert_array_equal(bare.loaded().values("lyapunov", {"zeta": 1}), stored.lyapunov[:, 1])
    np.testing.assert_array_equal(bare.values("poincare", {"inverse_alpha": 0}), stored.poincare[:, 0])


def test_tiles_do_not_depend_on_their_size_beyond_rounding(whole):
    other = run_map(small(lanes=7))
    np.testing.assert_allclose(other.lyapunov.values, whole.lyapunov.values, atol=0.05)
    settled = (whole.period.values > 0) & (other.period.values > 0)
    np.testing.assert_allclose(other.poincare.values[:, settled], whole.poincare.values[:, settled], atol=1e-4)


def test_only_what_is_missing_or_damaged_is_computed_again(whole, tmp_path):
    store = tmp_path / "store"
    run_map(small(), store=store)
    kept = TileStore(store, small())
    assert all(kept.has(k) for k in range(len(small().tiles())))
    chunk = sorted(path for path in (store / "arrays.zarr" / "lyapunov").rglob("*") if path.is_file() and path.name[0] != "z")[2]
    raw = bytearray(chunk.read_bytes())
    raw[len(raw) // 2] ^= 0xFF
    chunk.write_bytes(bytes(raw))
    (store / "records" / "000000.json").unlink()
    kept = TileStore(store, small())
    broken = [k for k in range(len(small().tiles())) if not kept.has(k)]
    assert len(broken) == 2
    assert 0 in broken
    told = []
    assert same(whole, run_map(small(), store=store, progress=lambda words, share: told.append(share)))
    assert len(told) == 2
    assert told[-1] == 1.0


def test_a_store_of_another_map_is_refused(tmp_path):
    run_map(small(), store=tmp_path / "store")
    with pytest.raises(BadInput, match="another map"):
        run_map(small(start=(0.1, 0.0)), store=tmp_path / "store")
    (tmp_path / "file").write_text("x")
    with pytest.raises(BadInput, match="store of tiles"):
        run_map(small(), store=tmp_path / "file")


RUN = """
import sys
from jaxbacklash import enable_double_precision
enable_double_precision()
import numpy as np
from tests.test_tiles import small
from jaxbacklash.dynamics.netcdf import write_netcdf
from jaxbacklash.dynamics.maps import run_map
tell = lambda words, share: (print(words, flush=True), sys.stdin.readline())  # nobody outruns who is to be killed
write_netcdf(run_map(small(lanes=2), store=sys.argv[1], workers=1, progress=tell), sys.argv[2])
"""


def begun(store, out):
    environment = os.environ | {"PYTHONPATH": str(ROOT), "JAX_PLATFORMS": "cpu"}
    return subprocess.Popen(
        [sys.executable, "-c", RUN, str(store), str(out)], cwd=ROOT, env=environment, stdin=subprocess.PIPE,
        stdout=subprocess.PIPE, text=True, bufsize=1,
    )  # fmt: skip


@pytest.mark.slow
def test_killed_three_times_it_ends_with_the_same_bits(tmp_path):
    pytest.importorskip("h5netcdf")
    rng = np.random.default_rng(5)
    store, out = tmp_path / "store", tmp_path / "killed.nc"
    for _ in range(3):
        run = begun(store, out)
        for _ in range(int(rng.integers(2, 8))):  # so many tiles, and then some time into the next
            assert run.stdout.readline()
            run.stdin.write("go on\n")
        time.sleep(float(rng.uniform(0.0, 0.05)))
        run.send_signal(signal.SIGKILL)
        assert run.wait() == -signal.SIGKILL
        assert not out.exists()
    records = len(list((store / "records").glob("*.json")))
    assert 6 <= records < len(small(lanes=2).tiles())
    run = begun(store, out)
    told = run.communicate()[0].splitlines()
    assert run.returncode == 0
    assert len(told) <= len(small(lanes=2).tiles()) - records
    fresh = begun(tmp_path / "fresh", tmp_path / "fresh.nc")
    fresh.communicate()
    assert out.read_bytes() == (tmp_path / "fresh.nc").read_bytes()


@pytest.mark.slow
def test_a_worker_killed_mid_run_loses_nothing(whole, tmp_path):
    distributed = pytest.importorskip("dask.distributed")
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        client.wait_for_workers(2)
        killed = []

        def kill_one(words, share):
            if not killed:
                victim = next(iter(cluster.workers.values())).pid
                killed.append(victim)
                os.kill(victim, signal.SIGKILL)

        found = run_map(small(lanes=4), store=tmp_path / "store", client=client, progress=kill_one)
    assert killed
    np.testing.assert_array_equal(found.lyapunov.values, run_map(small(lanes=4)).lyapunov.values)


def test_the_file_is_read_back_with_units(whole, tmp_path):
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("h5netcdf")
    write_netcdf(whole, tmp_path / "map.nc")
    with xarray.open_dataset(tmp_path / "map.nc", engine="h5netcdf") as found:
        assert found.lyapunov.dims == ("inverse_alpha", "zeta")
        assert found.lyapunov.dtype == np.float64
        assert found.lyapunov.attrs["units"] == "1/tau"
        assert found.poincare.dims == ("sample", "inverse_alpha", "zeta")
        assert found.attrs["Omega"] == 0.2
        assert "version" in found.attrs
        assert same(whole, found)
