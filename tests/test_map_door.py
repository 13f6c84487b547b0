"""``jaxbacklash map`` as a person meets it."""

import json

import numpy as np
import pytest

from .test_cli import call as call
from .test_cli import sentence

xarray = pytest.importorskip("xarray")
pytest.importorskip("zarr")
pytest.importorskip("h5netcdf")

SMALL = ("--inverse-alpha", "1:5:6", "--zeta", "0.01:0.03:4", "--periods", "30", "--skip", "5", "--samples", "4")


def test_a_map_is_written_told_and_drawn(call, tmp_path):
    code, out, err = call("map", *SMALL, "--out", "case1.nc")
    assert code == 0, err
    assert "24 cells" in out
    assert sorted(path.name for path in tmp_path.iterdir() if path.name != "cache") == ["case1.html", "case1.nc", "case1.png"]
    with xarray.open_dataset("case1.nc", engine="h5netcdf") as map_:
        assert map_.lyapunov.shape == (6, 4)
        np.testing.assert_allclose(map_.inverse_alpha, np.linspace(1.0, 5.0, 6))
        assert "units" in map_.attrs
        assert np.isfinite(map_.lyapunov).all()
    page = (tmp_path / "case1.html").read_text()
    assert page.count("<svg") == 2
    assert "<pre>jaxbacklash map --inverse-alpha 1:5:6 " in page
    code, out, _ = call("map", *SMALL, "--out", "again.nc", "--json")
    told = json.loads(out)
    assert code == 0
    assert told["cells"] == 24
    assert told["periods"] == 30
    assert set(told["wall_s"]) == {"start_up", "compile", "run"}
    assert told["solver"] == "exact linear pieces"


@pytest.mark.parametrize("name", ["mine.html", "mine.png"])
def test_a_page_or_picture_of_the_users_own_is_not_overwritten(call, tmp_path, name):
    (tmp_path / name).write_bytes(b"<html><title>My notes</title></html>")
    code, _, err = call("map", *SMALL, "--out", "mine.nc")
    assert code == 2
    assert name in sentence(err)
    assert (tmp_path / name).read_bytes() == b"<html><title>My notes</title></html>"
    assert not (tmp_path / "mine.nc").exists()


def test_a_map_is_made_again_in_place_of_its_own_files(call, tmp_path):
    assert call("map", *SMALL, "--out", "m.nc")[0] == 0
    (tmp_path / "m.nc").unlink()
    assert call("map", *SMALL, "--out", "m.nc")[0] == 0
    (tmp_path / "m.html").unlink()  # the picture by itself is known too
    assert call("map", *SMALL, "--out", "m.nc")[0] == 0


def test_a_map_over_drive_frequency(call):
    code, _, err = call("map", "--case", "2", "--omega", "0.2:0.3:5", "--periods", "30", "--skip", "5", "--out", "omega.nc")
    assert code == 0, err
    with xarray.open_dataset("omega.nc", engine="h5netcdf") as map_:
        assert map_.lyapunov.dims == ("Omega",)
        assert map_.attrs["zeta"] == pytest.approx(4.0 / 31000.0**0.5)
        assert map_.attrs["two_zeta"] == pytest.approx(8.0 / 31000.0**0.5)


@pytest.mark.parametrize(
    ("words", "fragment"),
    [
        (("--case", "3"), "wanted 1 or 2"),
        (("--inverse-alpha", "1:5"), "FROM:TO:COUNT"),
        (("--inverse-alpha", "0:5:9"), "above 0"),
        (("--zeta", "0.02"), "wanted a range"),
        (("--zeta", "0.01:0.02:3", "--start", "1"), "two numbers"),
        (("--zeta", "0.01:0.02:3", "--periods", "10"), "at least 20 periods"),
        (("--zeta", "0.01:0.02:3", "--out", "map.csv"), "wanted .nc"),
        (("--zeta", "0.01:0.02:99999999"), "at most"),
    ],
)
def test_mistakes_end_with_one_sentence(call, words, fragment):
    code, _, err = call("map", *words)
    assert code == 2
    assert fragment in sentence(err)
