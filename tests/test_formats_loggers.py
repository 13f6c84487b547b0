"""Files of loggers, spreadsheets and robots, each written by its own library, give the record that went in."""

import builtins
import importlib
import importlib.util
import shlex
import subprocess
import warnings
from pathlib import Path

import numpy as np
import pytest

from jaxbacklash.errors import BadInput
from jaxbacklash.records.formats import reader_for
from jaxbacklash.records.formats.guard import quiet
from jaxbacklash.records.formats.messages import Topics
from jaxbacklash.records.table import Table

from .logger_files import NAMED, RADIANS, RATE, UNITLESS, WRITERS, course, write_mdf, write_tdms, write_uff
from .test_formats import refused, table_of

APART = ("rec.mf4", "rec.mdf")
"""Read in a process of their own, a second each."""
QUICK = [pytest.param(name, marks=pytest.mark.slow) if name in APART else name for name in WRITERS]


def attempt(path: Path) -> Table | str | None:
    """The table of a file, the sentence that refuses it, or None where it would be read as text."""
    try:
        reader = reader_for(path)
        return None if reader is None else reader(path)
    except BadInput as why:
        return str(why)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """One good file of each kind."""
    folder = tmp_path_factory.mktemp("files")
    with quiet():
        for name, write in WRITERS.items():
            write(folder / name, course())
    return folder


@pytest.mark.parametrize("name", WRITERS)
def test_each_format_gives_times_motions_and_units(files, name, capfd):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        table = table_of(files / name)
    captured = capfd.readouterr()
    assert not captured.out
    assert not captured.err
    wanted = course()
    (t,) = table.called("t [s]" if name == "rec.xlsx" else "t")
    np.testing.assert_allclose(t.values, wanted["t"], rtol=0, atol=1e-9)
    assert t.unit in ("s", "")
    for channel, called in zip(("x", "z"), NAMED.get(name, ("x", "z")), strict=True):
        (column,) = table.called(called)
        degrees = np.degrees(column.values) if name in RADIANS else column.values
        np.testing.assert_allclose(degrees, wanted[channel], rtol=1e-12, atol=1e-12)
        assert column.unit == ("" if name in UNITLESS else "deg")
    assert table.rate_hz is None or table.rate_hz == pytest.approx(RATE, rel=1e-9)


@pytest.mark.parametrize("name", QUICK)
def test_a_file_is_known_by_its_content_too(files, name, tmp_path):
    path = tmp_path / "record.bin"
    path.write_bytes((files / name).read_bytes())
    assert table_of(path).names == table_of(files / name).names


@pytest.mark.parametrize("name", WRITERS)
def test_a_file_cut_off_anywhere_ends_in_a_sentence_or_in_what_is_there(files, name, tmp_path, capfd):
    whole = (files / name).read_bytes()
    for part in (0.6,) if name in APART else (0.02, 0.3, 0.6, 0.97):
        path = tmp_path / name
        path.write_bytes(whole[: int(part * len(whole))])
        found = attempt(path)
        if isinstance(found, str):
            assert str(path) in found
            assert "found" in found
            assert "wanted" in found
        else:
            # TDMS keeps what was written before a program stopped, and says so.
            assert name == "rec.tdms"
            assert any("ends before" in note for note in found.notes)
    assert not capfd.readouterr().err


@pytest.mark.parametrize("name", QUICK)
def test_bytes_turned_at_random_never_end_in_a_traceback(files, name, tmp_path):
    rng = np.random.default_rng(3)
    whole = np.frombuffer((files / name).read_bytes(), dtype=np.uint8)
    path = tmp_path / name
    for _ in range(2 if name in APART else 12):
        changed = whole.copy()
        # Half of them near the beginning, where formats keep what they say of themselves.
        places = rng.integers(0, min(whole.size, rng.choice([400, whole.size])), size=4)
        changed[places] = rng.integers(0, 256, size=4)
        path.write_bytes(changed.tobytes())
        found = attempt(path)
        assert not isinstance(found, str) or "\n" not in found


@pytest.mark.parametrize(
    ("name", "module", "package"),
    [
        ("rec.tdms", "nptdms", "nptdms"),
        ("rec.mf4", "asammdf", "asammdf"),
        ("rec.uff", "pyuff", "pyuff"),
        ("rec.xlsx", "openpyxl", "openpyxl"),
        ("rec.h5", "h5py", "h5py"),
        ("rec.bag", "rosbags", "rosbags"),
        ("json.mcap", "mcap", "mcap"),
    ],
)
def test_a_missing_library_is_named_with_the_command_that_installs_it(files, name, module, package, monkeypatch):
    real = importlib.import_module

    def without(wanted, *rest):
        if wanted.split(".")[0] == module:
            raise ImportError(wanted)
        return real(wanted, *rest)

    found = importlib.util.find_spec
    monkeypatch.setattr(importlib, "import_module", without)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name, *rest: None if name == module else found(name, *rest))
    refused(files / name, package, 'pip install "jaxbacklash[io]"')


def test_a_library_that_ends_its_process_ends_in_a_sentence(files, tmp_path, monkeypatch):
    package = tmp_path / "asammdf"
    package.mkdir()
    (package / "__init__.py").write_text("import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)\n")
    monkeypatch.syspath_prepend(tmp_path)
    refused(files / "rec.mf4", "damaged or no MDF file")


def test_a_missing_library_for_tables_of_matlab_is_named(tmp_path, monkeypatch):
    matio = importlib.import_module("matio")
    import pandas

    with quiet():
        matio.save_to_mat(str(tmp_path / "rec.mat"), {"T": pandas.DataFrame(course())}, version="v7")
    real = builtins.__import__

    def without(wanted, *rest, **more):
        if wanted == "matio":
            raise ImportError(wanted)
        return real(wanted, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", without)
    refused(tmp_path / "rec.mat", "class table", 'pip install "jaxbacklash[io]"')


@pytest.mark.parametrize("version", ["v7", "v7.3"])
def test_tables_and_timetables_of_matlab(tmp_path, version):
    import matio
    import pandas

    wanted = course()
    table = pandas.DataFrame({name: wanted[name] for name in ("x", "z")})
    timed = table.set_index(pandas.to_timedelta(wanted["t"], unit="s"))
    with quiet():
        matio.save_to_mat(str(tmp_path / "rec.mat"), {"TT": timed, "rig": {"T": table}, "fs": 200.0}, version=version)
    found = table_of(tmp_path / "rec.mat")
    np.testing.assert_allclose(found.called("TT.Time")[0].values, wanted["t"], atol=1e-9)
    np.testing.assert_array_equal(found.called("TT.x")[0].values, wanted["x"])
    np.testing.assert_array_equal(found.called("rig.T.z")[0].values, wanted["z"])
    assert found.rate_hz == 200


def test_channels_of_different_rates_keep_a_clock_each(tmp_path):
    from asammdf import MDF, Signal
    from nptdms import ChannelObject, TdmsWriter

    wanted = course()
    start = np.datetime64("2024-05-01T10:00:00")
    with TdmsWriter(tmp_path / "rec.tdms") as file:
        slow = {"wf_increment": 0.01, "wf_start_time": start + np.timedelta64(3, "ms")}
        fast = ChannelObject("Fast", "x", wanted["x"], {"wf_increment": 0.005, "wf_start_time": start})
        file.write_segment([fast, ChannelObject("Slow", "z", wanted["z"][::2], slow)])
    with MDF(version="4.10") as file:
        file.append([Signal(wanted["x"], wanted["t"], name="x")])
        file.append([Signal(wanted["z"][::2], wanted["t"][::2] + 0.003, name="z")])
        file.save(tmp_path / "rec.mf4")
    for name in ("rec.tdms", "rec.mf4"):
        table = table_of(tmp_path / name)
        (x,), (z,) = table.called("x"), table.called("z")
        assert x.clock is not None
        assert z.clock is not None
        np.testing.assert_allclose(x.clock, wanted["t"], atol=1e-9)
        np.testing.assert_allclose(z.clock, wanted["t"][::2] + 0.003, atol=1e-9)
        assert not table.called("t")


def test_a_time_channel_in_the_file_is_the_time(tmp_path):
    from nptdms import ChannelObject, TdmsWriter

    wanted = course()
    with TdmsWriter(tmp_path / "rec.tdms") as file:
        # LabVIEW writes an increment of 1 where nobody set one.
        channels = {"Time": wanted["t"], "x": wanted["x"]}
        file.write_segment([ChannelObject("Log", name, values, {"wf_increment": 1.0}) for name, values in channels.items()])
    table = table_of(tmp_path / "rec.tdms")
    assert table.names == ["Log/Time", "Log/x"]
    assert table.rate_hz is None


def test_a_rate_that_a_group_states(tmp_path):
    from nptdms import ChannelObject, GroupObject, TdmsWriter

    with TdmsWriter(tmp_path / "rec.tdms") as file:
        group = GroupObject("Log", {"Sample Rate": 200.0, "rig": 4})
        file.write_segment([group, ChannelObject("Log", "x", course()["x"]), ChannelObject("Log", "angle (deg)", course()["z"])])
    table = table_of(tmp_path / "rec.tdms")
    assert table.rate_hz == 200
    assert [column.unit for column in table.columns] == ["", "deg"]
    assert all(column.clock is None for column in table.columns)


def test_a_folder_that_ros_2_recorded(files):
    folder = files / "folder of rec.db3"
    (files / "rec.db3").replace(folder / f"{folder.name}.db3")
    table = table_of(folder)
    (folder / f"{folder.name}.db3").replace(files / "rec.db3")
    np.testing.assert_allclose(np.degrees(table.called("x/position")[0].values), course()["x"], atol=1e-12)


def test_topics_stamped_by_a_simulator_keep_their_digits_beside_those_of_the_wall_clock():
    topics = Topics()
    for row in range(100):
        topics.add("/real", {"x": row}, 1_700_000_000_000_000_000 + row * 1_000_000)
        stamp = {"sec": 3, "nanosec": row * 1_000_000}
        topics.add("/simulated", {"header": {"stamp": stamp}, "x": row, "camera": [0] * 1000}, 5)
    table = topics.table("mcap", {})
    for column in table.columns:
        np.testing.assert_allclose(column.clock, np.arange(100) / 1000, rtol=0, atol=1e-12)
    assert "1000 elements" in table.left_out["simulated/camera"]
    assert "simulated: as stamped" in table.details["times"]
    assert "the times of real are more than a day from the others" in table.notes[0]


def test_universal_files_uneven_single_spectra_and_cut(tmp_path):
    wanted = course()
    wanted["t"] = wanted["t"] ** 1.01
    write_uff(tmp_path / "uneven.uff", wanted, even=0)
    np.testing.assert_allclose(table_of(tmp_path / "uneven.uff").called("t")[0].values, wanted["t"], rtol=1e-5)
    write_uff(tmp_path / "spectra.uff", course(), function=2)
    refused(tmp_path / "spectra.uff", "no data set 58 with a time response")
    write_uff(tmp_path / "whole.uff", course())
    text = (tmp_path / "whole.uff").read_text()
    (tmp_path / "claims.uff").write_text(text.replace("         4       400", "         4999999999"))
    refused(tmp_path / "claims.uff", "GB")
    (tmp_path / "more.uff").write_text(text.replace("         4       400", "         4       500"))
    refused(tmp_path / "more.uff", "400 of 500 values")


def test_what_cannot_be_read_says_how_to_convert_it(tmp_path):
    import zipfile

    cases = {
        "old.xls": (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600), "saved as .xlsx"),
        "a b.parquet": (b"PAR1" + bytes(60), "pandas.read_parquet"),
        "rec.pkl": (b"\x80\x04\x95" + bytes(60), "runs code"),
        "unknown.rec": (b"\x80\x04\x95" + bytes(60), "runs code"),
    }
    for name, (content, part) in cases.items():
        (tmp_path / name).write_bytes(content)
        refused(tmp_path / name, part)
    with zipfile.ZipFile(tmp_path / "my run.zip", "w") as archive:
        archive.writestr("rec.csv", "t,x,z\n0,0,0\n")
    with pytest.raises(BadInput) as why:
        table_of(tmp_path / "my run.zip")
    command = str(why.value).split("the file in it: ")[1].removesuffix(".")
    assert "rec.csv" in str(why.value)
    assert shlex.split(command) == ["unzip", str(tmp_path / "my run.zip")]
    with pytest.raises(BadInput) as why:
        table_of(tmp_path / "a b.parquet")
    command = str(why.value).split("a .csv file: ")[1].removesuffix(".")
    # A shell takes it apart into one piece of Python and two names.
    words = subprocess.run(["bash", "-c", f"printf '%s\\n' {command}"], capture_output=True, text=True, check=True).stdout
    assert words.splitlines()[3:] == [str(tmp_path / "a b.parquet"), str(tmp_path / "a b.csv")]
    compile(words.splitlines()[2], "command", "exec")


@pytest.mark.parametrize("suffix", [".csv", ".txt", ".dat", ".lvm", ".log", ".xls", ".unknown"])
def test_text_is_left_to_the_reader_of_text(tmp_path, suffix):
    path = tmp_path / f"rec{suffix}"
    path.write_text("[Header]\nrig,4\nt,x,z\n" + "0,0,0\n" * 40)
    assert reader_for(path) is None


def test_a_dat_file_may_be_a_measurement_data_file(tmp_path):
    write_mdf(tmp_path / "rec.mdf", course())
    path = (tmp_path / "rec.mdf").rename(tmp_path / "rec.dat")
    assert table_of(path).format == "mdf"


def test_dates_as_a_channel_are_counted_from_the_first(tmp_path):
    from nptdms import ChannelObject, TdmsWriter

    wanted = course()
    stamps = np.datetime64("2024-05-01T10:00:00") + np.round(1e6 * wanted["t"]).astype("timedelta64[us]")
    with TdmsWriter(tmp_path / "rec.tdms") as file:
        file.write_segment([ChannelObject("Log", "Time", stamps), ChannelObject("Log", "x", wanted["x"])])
    table = table_of(tmp_path / "rec.tdms")
    np.testing.assert_allclose(table.called("Time")[0].values, wanted["t"], atol=1e-9)
    assert table.called("Time")[0].unit == "s"
    assert "2024-05-01" in table.notes[0]
    write_tdms(tmp_path / "rec.tdms", wanted)
    assert not table_of(tmp_path / "rec.tdms").notes
