"""How a command ends where the surroundings fail it: streams, disk, memory, and errors that nobody foresaw."""

import errno
import math
import os
import subprocess
import sys

import numpy as np
import pytest

from jaxbacklash.commands import outcome
from jaxbacklash.errors import BadInput, NoAnswer
from jaxbacklash.whole_file import remove_unfinished, whole_file, write_whole

from .hostile import MODEL, ROOT, ended, one_sentence


@pytest.mark.parametrize(("error", "code", "fragment"), [
    (BadInput("r.csv: found that"), 2, "error: r.csv: found that"),
    (NoAnswer("nothing"), 1, "no answer: nothing"),
    (MemoryError(), 1, "not enough memory"),
    (RuntimeError("RESOURCE_EXHAUSTED: Out of memory allocating 9 bytes"), 1, "not enough memory"),
    (OSError(errno.ENOSPC, "No space left on device", "o/x"), 1, "o/x: cannot be written (No space left on device)"),
    (RuntimeError("can't start new thread"), 1, "ulimit -u"),
    (ZeroDivisionError("float division by zero"), 1, "range of double precision"),
    (np.linalg.LinAlgError("SVD did not converge"), 1, "range of double precision"),
    (KeyboardInterrupt(), 130, "stopped"),
    (BrokenPipeError(), 1, ""),
    (TypeError("a\nb" * 1000), 1, "internal error: TypeError: a ba ba"),
    (KeyError(), 1, "internal error: KeyError: no message"),
    (RecursionError("maximum recursion depth exceeded"), 1, "internal error: RecursionError"),
])  # fmt: skip
def test_every_error_has_a_sentence_and_a_code(error, code, fragment):
    sentence, found = outcome.told(error)
    assert found == code
    assert fragment in sentence
    assert len(sentence) < 500


def test_the_traceback_is_shown_to_whom_it_helps(monkeypatch, capsys):
    monkeypatch.setenv(outcome.DEBUG, "1")
    outcome.told(TypeError("odd"))
    assert "TypeError: odd" in capsys.readouterr().err


def fail_within(path):
    with whole_file(path) as part:
        part.write_text("half")
        raise ZeroDivisionError


def end_within(path):
    with whole_file(path) as part:
        part.write_text("half")
        remove_unfinished()
        assert os.listdir(path.parent) == []


@pytest.mark.parametrize("kind", [str, bytes])
def test_a_file_is_whole_or_as_it_was(tmp_path, kind):
    path = tmp_path / "a.txt"
    write_whole(path, kind(b"old", "ascii") if kind is str else b"old")
    with pytest.raises(ZeroDivisionError):
        fail_within(path)
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_names_of_every_length_and_half_characters(tmp_path):
    name = os.fsdecode(b"\xff" * 3 + "ü".encode() * 126)
    write_whole(tmp_path / name, "\udcff half")
    assert (tmp_path / name).read_text() == "\\udcff half"
    with pytest.raises(IsADirectoryError):
        write_whole(tmp_path, "x")


def test_what_is_being_written_is_removed_when_the_process_is_told_to_end(tmp_path):
    with pytest.raises(FileNotFoundError):
        end_within(tmp_path / "a.txt")


def within(shell, *words, cwd):
    """The command under what a shell does before: limits, closed streams."""
    run = ["/bin/sh", "-c", f'{shell}; exec "$@"', "sh", sys.executable, "-m", "jaxbacklash.cli", *words]
    return subprocess.run(run, cwd=cwd, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": str(ROOT)}, timeout=120)


@pytest.mark.slow
@pytest.mark.parametrize("out", ["s.csv", "s.npz", "s.mat"])
def test_a_disk_without_room_leaves_nothing_half_written(tmp_path, out):
    (tmp_path / "m.toml").write_text(MODEL)
    (tmp_path / out).write_text("old")
    run = within("ulimit -f 40", "simulate", "m.toml", "--duration", "8", "--out", out, cwd=tmp_path)
    assert run.returncode in (1, 2)
    assert "cannot be written (File too large)" in one_sentence(run.stderr)
    assert (tmp_path / out).read_text() == "old"
    assert sorted(os.listdir(tmp_path)) == sorted(["m.toml", out])


@pytest.mark.parametrize("closed", ["exec >&-", "exec 2>&-", "exec <&- >&- 2>&-"])
def test_streams_that_are_closed_before_it_begins(tmp_path, closed):
    (tmp_path / "m.toml").write_text("[model]\n")
    run = within(closed, "look", "m.toml", cwd=tmp_path)
    assert run.returncode == 2
    assert (tmp_path / "m.toml").read_text() == "[model]\n"


def test_an_answer_that_nobody_can_read_is_no_error(tmp_path):
    (tmp_path / "r.csv").write_text("t,z\n" + "".join(f"{0.01 * i},{math.sin(0.3 * i)}\n" for i in range(200)))
    run = within("exec >&-", "look", "r.csv", "--json", cwd=tmp_path)
    assert (run.returncode, run.stderr) == (0, "")


@pytest.mark.slow
def test_a_reader_that_goes_away_is_no_error(tmp_path):
    code, _, err = ended("--help", cwd=tmp_path)
    assert (code, err) == (0, "")
    words = f"'{sys.executable}' -m jaxbacklash.cli fit --help | head -c 1"
    run = subprocess.run(
        words, shell=True, cwd=tmp_path, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": str(ROOT)}
    )
    assert "Traceback" not in run.stderr
    assert "internal error" not in run.stderr
