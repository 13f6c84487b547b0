"""``jaxbacklash map`` without the extra ``sweep``: no zarr, dask, xarray or h5netcdf, a file by scipy."""

import sys

import numpy as np
import pytest
from scipy.io import netcdf_file

from jaxbacklash.dynamics import PaperCase, request, write_netcdf
from jaxbacklash.dynamics.maps import labelled_map

from .test_cli import call as call
from .test_cli import sentence

WORDS = ("map", "--inverse-alpha", "1:5:6", "--zeta", "0.01:0.03:4", "--periods", "30", "--skip", "5", "--samples", "4")


@pytest.fixture(autouse=True)
def plain(monkeypatch):
    """As after ``pip install .``: the libraries of the extra cannot be imported."""
    for library in ("zarr", "dask", "xarray", "h5netcdf", "h5py"):
        monkeypatch.setitem(sys.modules, library, None)


def same_request():
    axes = {"inverse_alpha": np.linspace(1.0, 5.0, 6), "zeta": np.linspace(0.01, 0.03, 4)}
    return request(PaperCase(1), axes, periods=30, skip=5, samples=4)


def test_a_map_is_written_and_drawn(call, tmp_path):
    code, out, err = call(*WORDS, "--out", "case1.nc")
    assert code == 0, err
    assert "24 cells" in out
    assert sorted(path.name for path in tmp_path.iterdir() if path.name != "cache") == ["case1.html", "case1.nc", "case1.png"]
    known = labelled_map(same_request())
    with netcdf_file("case1.nc", mmap=False) as file:
        assert file.dimensions == {"sample": 4, "inverse_alpha": 6, "zeta": 4}
        for name, variable in {**known.variables, **known.coordinates}.items():
            np.testing.assert_array_equal(file.variables[name][...], np.asarray(variable.data))
            assert file.variables[name].dimensions == variable.dims
            assert file.variables[name].units == variable.attrs["units"].encode()
        assert file.periods == 30
        assert file.solver == b"exact linear pieces"
        np.testing.assert_array_equal(file.start, [0.0, 0.0])


def test_the_same_map_is_the_same_bytes(tmp_path):
    map_ = labelled_map(same_request())
    for name in ("one.nc", "two.nc"):
        write_netcdf(map_, tmp_path / name)
    assert (tmp_path / "one.nc").read_bytes() == (tmp_path / "two.nc").read_bytes()


def test_a_map_too_large_for_memory_asks_for_the_extra(call):
    code, _, err = call("map", "--inverse-alpha", "1:5:9000000", "--periods", "132", "--out", "large.nc")
    assert code == 2
    assert 'pip install "jaxbacklash[sweep]"' in sentence(err)
