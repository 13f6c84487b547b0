"""A command that is told to stop ends at once, with one line, the shells' exit code and nothing half written."""

import os
import signal
import time
from pathlib import Path

import pytest

from .hostile import MODEL, jaxbacklash, write_record_csv

WITHIN = 2.0
"""Seconds from the signal to the end of the process."""
COMMANDS = {
    "fit": ["fit", "r.csv", "--inertia", "2", "--starts", "50", "--out", "o"],
    "refine": ["refine", "r.csv", "--inertia", "2", "--out", "o"],
    "chaos": ["chaos", "r.csv", "--out", "o"],
    "map": ["map", "--inverse-alpha", "1:5:600", "--zeta", "0.005:0.03:300", "--out", "m.nc"],
    "simulate": ["simulate", "m.toml", "--duration", "380", "--rate", "5000", "--out", "s.csv"],
}


def stopped(folder, name, after, *signals):
    """What is left when a command gets signals: exit code, seconds, stderr."""
    write_record_csv(folder / "r.csv", seconds=8.0)
    (folder / "m.toml").write_text(MODEL)
    run = jaxbacklash(*COMMANDS[name], cwd=folder)
    begun(run)
    time.sleep(after)
    if run.poll() is not None:
        pytest.skip(f"{name} was over before")
    told = time.monotonic()
    for number in signals:
        run.send_signal(number)
    _, err = run.communicate(timeout=60)
    return run.returncode, time.monotonic() - told, err.decode()


def begun(run):
    """Wait until the command takes signals: on a busy machine Python itself takes seconds to start."""
    state, until = Path(f"/proc/{run.pid}/status"), time.monotonic() + 30.0
    while state.exists() and run.poll() is None and time.monotonic() < until:
        taken = next((line.split()[1] for line in state.read_text().splitlines() if line.startswith("SigCgt")), "0")
        if int(taken, 16) >> (signal.SIGTERM - 1) & 1:
            return
        time.sleep(0.02)


def half_written(folder):
    return [name for _, _, names in os.walk(folder) for name in names if "part" in name]


def test_ctrl_c_ends_a_simulation(tmp_path):
    assert stopped(tmp_path, "simulate", 1.0, signal.SIGINT)[::2] == (130, "stopped\n")


def test_a_command_that_ends_by_itself_leaves_nothing_open(tmp_path):
    write_record_csv(tmp_path / "r.csv", seconds=4.0)
    run = jaxbacklash("look", "r.csv", cwd=tmp_path, PYTHONWARNINGS="always::ResourceWarning")
    _, err = run.communicate(timeout=60)
    assert run.returncode == 0
    assert b"unclosed" not in err


@pytest.mark.slow
@pytest.mark.parametrize("after", [0.5, 1.5, 4.0])
@pytest.mark.parametrize("name", COMMANDS)
def test_ctrl_c_ends_every_command_soon(tmp_path, name, after):
    code, seconds, err = stopped(tmp_path, name, after, signal.SIGINT)
    assert code == 130
    assert err.endswith("stopped\n")
    assert "Traceback" not in err
    assert seconds < WITHIN
    assert half_written(tmp_path) == []


@pytest.mark.slow
@pytest.mark.parametrize(("signals", "expected"), [
    ((signal.SIGTERM,), 143), ((signal.SIGHUP,), 129), ((signal.SIGINT, signal.SIGINT, signal.SIGINT), 130),
])  # fmt: skip
def test_other_signals_and_several_of_them(tmp_path, signals, expected):
    code, seconds, err = stopped(tmp_path, "refine", 3.0, *signals)
    assert (code, err.splitlines()[-1]) == (expected, "stopped")
    assert seconds < WITHIN


@pytest.mark.slow
def test_a_map_that_was_stopped_goes_on(tmp_path):
    words = ["map", "--inverse-alpha", "1:5:120", "--zeta", "0.005:0.03:60", "--periods", "120", "--out", "m.nc"]
    run = jaxbacklash(*words, cwd=tmp_path)
    records = tmp_path / "m.nc.tiles" / "records"
    until = time.monotonic() + 60.0
    while len(list(records.glob("*.json"))) < 2 and time.monotonic() < until and run.poll() is None:
        time.sleep(0.01)
    run.send_signal(signal.SIGINT)
    run.communicate(timeout=60)
    assert run.returncode == 130
    assert list(records.glob("*.json"))
    again = jaxbacklash(*words, cwd=tmp_path)
    again.communicate(timeout=120)
    assert again.returncode == 0
    assert (tmp_path / "m.nc").exists()
    assert not records.parent.exists()


def test_a_signal_that_is_ignored_stays_ignored(tmp_path):
    (tmp_path / "m.toml").write_text(MODEL)
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)  # as under nohup
    try:
        run = jaxbacklash("simulate", "m.toml", "--duration", "3", "--rate", "100", "--out", "s.csv", cwd=tmp_path)
    finally:
        signal.signal(signal.SIGHUP, before)
    begun(run)
    run.send_signal(signal.SIGHUP)
    run.communicate(timeout=60)
    assert run.returncode == 0
