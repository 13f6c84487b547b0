"""Every number of the command line has a range, and what cannot be read or written is told before anything is computed."""

import inspect
import os
import subprocess
import sys
import time

import pytest
import typer

from jaxbacklash import cli
from jaxbacklash.cli import app
from jaxbacklash.commands import doors
from jaxbacklash.commands.ranges import RANGES
from jaxbacklash.errors import BadInput

from .hostile import MODEL, ROOT, one_sentence, write_record_csv
from .test_cli import call as call

HUGE = "99999999999999999999"


def numeric_options():
    """(command, parameter) of every option that takes a number."""
    group = typer.main.get_command(app)
    for name, command in group.commands.items():
        types = {
            told.name: eval(told.annotation, vars(cli)) if isinstance(told.annotation, str) else told.annotation
            for told in inspect.signature(command.callback).parameters.values()
        }
        for parameter in command.params:
            kind = types.get(parameter.name)
            if getattr(kind, "__origin__", kind) in (int, float, int | None, float | None):
                yield name, parameter


def test_every_number_has_a_range():
    without = [
        f"{name} {parameter.name}" for name, parameter in numeric_options()
        if f"{name}.{parameter.name}" not in RANGES and parameter.name not in RANGES
    ]  # fmt: skip
    assert without == []
    assert len(list(numeric_options())) > 60


@pytest.fixture
def files(tmp_path):
    write_record_csv(tmp_path / "r.csv")
    (tmp_path / "m.toml").write_text(MODEL)
    return tmp_path


WORDS = {
    "fit": ["r.csv"], "compare": ["m.toml", "r.csv"], "diagnose": ["r.csv"], "refine": ["r.csv"], "skeleton": ["r.csv"],
    "chaos": ["r.csv"], "look": ["r.csv"], "lost-motion": ["r.csv"], "simulate": ["m.toml", "--out", "s.csv"],
}  # fmt: skip


@pytest.mark.parametrize("value", ["nan", "inf", "-1e300", "-" + HUGE, HUGE * 20])
def test_no_number_beyond_its_range_gets_through(call, files, value):
    for name, parameter in numeric_options():
        option = max(parameter.opts, key=len)
        code, out, err = call(name, *WORDS.get(name, []), f"{option}={value}")
        assert (code, out) == (2, ""), (name, option)
        assert option in one_sentence(err)


@pytest.mark.parametrize(("words", "fragments"), [
    (["fit", "r.csv", "--starts", "1000000"], ["--starts 1000000", "1 to 100"]),
    (["fit", "r.csv", "--seed", "-1"], ["--seed -1", "0 to"]),
    (["fit", "r.csv", "--resample-rate", "0"], ["--resample-rate 0", "Hz"]),
    (["fit", "r.csv", "--window", "0"], ["--window 0", "0.02 to 10"]),
    (["fit", "r.csv", "--inertia", "0"], ["--inertia 0", "kg m^2"]),
    (["simulate", "m.toml", "--out", "s.csv", "--noise", "nan"], ["--noise nan"]),
    (["simulate", "m.toml", "--out", "s.csv", "--y0", "1e300"], ["--y0 1e+300"]),
    (["map", "--periods", "100000000"], ["--periods 100000000", "1 to 100000"]),
    (["chaos", "r.csv", "--surrogate-count", "0"], ["--surrogate-count 0", "1 to 999"]),
])  # fmt: skip
def test_the_sentence_gives_the_range(call, files, words, fragments):
    code, out, err = call(*words)
    assert (code, out) == (2, "")
    for fragment in fragments:
        assert fragment in one_sentence(err)


@pytest.mark.parametrize("words", [
    ["simulate", "m.toml", "--excitation", "r.csv", "--out", "r.csv"],
    ["simulate", "m.toml", "--excitation", "r.csv", "--out", "link.csv"],
    ["simulate", "m.toml", "--excitation", "r.csv", "--out", "hard.csv"],
    ["compare", "o/model.toml", "r.csv", "--out", "o"],
    ["fit", "r.csv", "--model", "o/model.toml", "--out", "o"],
])  # fmt: skip
def test_nothing_that_is_read_is_overwritten(call, files, words):
    (files / "o").mkdir()
    (files / "o" / "model.toml").write_text(MODEL)
    (files / "link.csv").symlink_to("r.csv")
    os.link(files / "r.csv", files / "hard.csv")
    before = {path.name: path.read_bytes() for path in (files / "r.csv", files / "o" / "model.toml")}
    code, out, err = call(*words)
    assert (code, out) == (2, "")
    assert "would overwrite" in one_sentence(err)
    assert {path.name: path.read_bytes() for path in (files / "r.csv", files / "o" / "model.toml")} == before


@pytest.mark.parametrize("name", ["report.html", "result.json", "model.toml"])
def test_a_folder_where_a_result_goes_is_told_at_once(call, files, name):
    (files / "o" / name).mkdir(parents=True)
    begun = time.monotonic()
    code, _, err = call("fit", "r.csv", "--inertia", "2", "--out", "o")
    assert code == 2
    assert f"o/{name} is a folder" in one_sentence(err)
    assert time.monotonic() - begun < 1.0


@pytest.mark.parametrize("name", ["a" * 300 + ".csv", "a\0b.csv"])
def test_names_that_no_file_can_have(call, files, name):
    for words in (["fit", name], ["fit", "r.csv", "--out", name], ["simulate", "m.toml", "--out", name]):
        code, _, err = call(*words)
        assert code == 2
        assert len(one_sentence(err)) < 200
        assert ("cannot be used as the name of a file" if len(name) > 200 else "null byte") in err


@pytest.mark.slow
@pytest.mark.parametrize("name", [b"two\nlines.csv", b"\xff\xfe.csv", "ünï ☂.csv".encode(), b"--out.csv"])
def test_odd_names_are_names(files, name):
    """Written, read, and written about."""
    os.link(files / "r.csv", os.path.join(os.fsencode(files), name))
    words = ["compare", "m.toml", os.path.join(b".", name), "--out", "o", "--json"]
    run = subprocess.run(
        [sys.executable, "-m", "jaxbacklash.cli", *words], cwd=files, capture_output=True, timeout=120,
        env={**os.environ, "PYTHONPATH": str(ROOT), "LC_ALL": "C"},
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    assert sorted(os.listdir(files / "o")) == ["model.toml", "report.html", "result.json"]


def test_a_read_only_folder_is_told_before_anything_is_computed(files, monkeypatch):
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # as for a user who is not root
    with pytest.raises(BadInput, match="cannot be written to"):
        doors.check("fit", {"out": files / "o"}, {})


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="this system has no /dev/full")
def test_a_full_disk_behind_stdout_is_told(files):
    with open("/dev/full", "w") as full:
        run = subprocess.run(
            [sys.executable, "-m", "jaxbacklash.cli", "--help"], stdout=full, stderr=subprocess.PIPE, text=True,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
        )  # fmt: skip
    assert run.returncode == 1
    assert "No space left" in one_sentence(run.stderr)
