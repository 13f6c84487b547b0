"""Thousands of records, each fitted by itself: records a second beside a loop of single fits, and beside scipy with numba.

    python -m benchmarks.many_records [--tiny] [--records N]

Records of 5 s at 200 Hz with noise of 3e-5 rad on x and on z, of joints whose play, stiffness and damping differ by a few
percent, made by a program that shares nothing with the package; one in a hundred is broken. `fit_each` reads and fits all of
them, on all cores. The loop reads and fits some of them with `read_record` and `fit` in one process. scipy's `least_squares`
with numba's multiple shooting, on all cores, is given the arrays, the noise and a start 80 % and 50 % off for nothing; what it
solves is smaller, see `benchmarks.peers.numba_shooting`. Runs of a part of the records are interleaved, so that what else the
machine does hits all alike. The run over all is killed on its way and begun again; its table is compared with that of an
undisturbed run of the same records.
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from numba import njit

import jaxbacklash as jb
from benchmarks.peers import numba_shooting
from jaxbacklash.commands.reading import Reading
from jaxbacklash.many.kept import NAME
from jaxbacklash.program import cores

DURATION, RATE, SIGMA, INERTIA = 5.0, 200.0, 3e-5, 2.9
PLAY, STIFFNESS, DAMPING = 0.0245, 11800.0, 10.5
BROKEN = 100
"""One record in so many is broken."""
FINE = 20
"""Steps of the generator between two samples."""


@njit(cache=True)
def follow(times, amplitude, omega, phase, inertia, play, stiffness, damping, fine):
    """Base and link of a joint driven by a multisine, by RK4 steps so short that the corners of the contact do not matter."""
    x, y = np.zeros(times.size), np.zeros(times.size)
    dt = (times[1] - times[0]) / fine
    place, speed = 0.0, 0.0

    def base(t):
        s, v = 0.0, 0.0
        for a, w, p in zip(amplitude, omega, phase):
            s += a * np.sin(w * t + p)
            v += a * w * np.cos(w * t + p)
        return s, v

    def rate(t, q, v):
        s, ds = base(t)
        z = q - s
        pressed = z - min(max(z, -0.5 * play), 0.5 * play)
        return -(stiffness * pressed + damping * (v - ds)) / inertia

    place, speed = base(0.0)
    for k in range(times.size):
        x[k] = base(times[k])[0]
        y[k] = place
        for j in range(fine):
            t = times[k] + j * dt
            a1 = rate(t, place, speed)
            a2 = rate(t + dt / 2, place + dt / 2 * speed, speed + dt / 2 * a1)
            a3 = rate(t + dt / 2, place + dt / 2 * (speed + dt / 2 * a1), speed + dt / 2 * a2)
            a4 = rate(t + dt, place + dt * (speed + dt / 2 * a2), speed + dt * a3)
            place += dt * (speed + dt / 6 * (a1 + a2 + a3))
            speed += dt / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    return x, y


def one_record(number: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, dict[str, float]]:
    """Times, x, z and the truth of one record."""
    rng = np.random.default_rng([17, number])
    omega = 2.0 * np.pi * rng.uniform(0.5, 8.0, 6)
    amplitude = 0.3 * rng.uniform(0.5, 1.0, 6) / omega
    times = np.arange(round(DURATION * RATE)) / RATE
    truth = {
        "backlash": PLAY * rng.uniform(0.95, 1.05), "stiffness": STIFFNESS * rng.uniform(0.95, 1.05),
        "damping": DAMPING * rng.uniform(0.95, 1.05),
    }  # fmt: skip
    x, y = follow(times, amplitude, omega, rng.uniform(0.0, 6.28, 6), INERTIA, *truth.values(), FINE)
    noise = SIGMA * rng.standard_normal((2, times.size))
    return times, x + noise[0], y - x + noise[1], truth


def make(folder: Path, first: int, last: int) -> None:
    """Write records, one in a hundred with a word among the numbers."""
    for number in range(first, last):
        times, x, z, _ = one_record(number)
        rows = [f"{a:.6g},{b:.9g},{c:.9g}" for a, b, c in zip(times, x, z)]
        if number % BROKEN == BROKEN - 1:
            rows[500] = "2.5,lost,0"
        (folder / f"record{number:06d}.csv").write_text("t,x,z\n" + "\n".join(rows) + "\n")


def peer(number: int) -> None:
    """scipy and numba on one record."""
    times, x, z, truth = one_record(number)
    start = {"backlash": 1.5 * truth["backlash"], "stiffness": 1.8 * truth["stiffness"], "damping": 0.5 * truth["damping"]}
    numba_shooting.fit(times, x, z, INERTIA, start)


def timed(work: Callable[[], object]) -> float:
    """Seconds of some work."""
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def against_others(paths: list[Path], part: int, alone: int, rounds: int) -> None:
    """Records a second of all contestants on a part of the records, interleaved."""
    read = Reading().record
    sound = [path for k, path in enumerate(paths[:part]) if k % BROKEN != BROKEN - 1]
    for path in sound[:2]:
        jb.fit(read(path), inertia=INERTIA)
    jb.fit_each(sound[: 2 * cores()], inertia=INERTIA, read=read)
    spent: dict[str, list[float]] = {"fit_each": [], "loop of fit": [], "scipy + numba": []}
    with ProcessPoolExecutor(cores(), mp_context=get_context("spawn")) as pool:
        list(pool.map(peer, range(4)))
        for _ in range(rounds):
            spent["fit_each"].append(timed(lambda: jb.fit_each(sound, inertia=INERTIA, read=read)) / len(sound))
            spent["loop of fit"].append(timed(lambda: [jb.fit(read(path), inertia=INERTIA) for path in sound[:alone]]) / alone)
            spent["scipy + numba"].append(timed(lambda: list(pool.map(peer, range(alone)))) / alone)
    ours = float(np.median(spent["fit_each"]))
    print(f"\n{len(sound)} records by fit_each (its processes begun anew each time), {alone} by the others; median of {rounds}")
    print(f"  {'':<16}{'records/s':>11}{'ms a record':>13}{'ours is quicker by':>20}")
    for name, each in spent.items():
        middle = float(np.median(each))
        print(f"  {name:<16}{1.0 / middle:11.2f}{middle * 1e3:13.1f}{middle / ours:20.2f}")


def command(folder: Path, out: Path) -> list[str]:
    """The command over all records."""
    words = ["fit", str(folder), "--each", "--inertia", str(INERTIA), "--out", str(out)]
    return [sys.executable, "-m", "jaxbacklash.cli", *words]


def all_of_them(folder: Path, count: int, again: int, out: Path) -> None:
    """The whole command: killed on the way and begun again, then its rate, memory, broken records and the truth."""
    begin = time.perf_counter()
    run = subprocess.Popen(command(folder, out), stdout=subprocess.DEVNULL)
    rows, peak = out / NAME, 0.0
    while run.poll() is None and (not rows.exists() or rows.read_bytes().count(b"\n") < count // 3):
        peak = max(peak, memory(run.pid))
        time.sleep(0.2)
    killed = time.perf_counter() - begin
    run.send_signal(signal.SIGKILL)
    run.wait()
    done = rows.read_bytes().count(b"\n") - 1
    begin = time.perf_counter()
    run = subprocess.Popen(command(folder, out), stdout=subprocess.PIPE, text=True)
    while run.poll() is None:
        peak = max(peak, memory(run.pid))
        time.sleep(0.2)
    spent = time.perf_counter() - begin
    assert run.stdout is not None
    print(f"\n{count} records by the command: killed after {killed:.0f} s with {done} rows, the rest in {spent:.0f} s")
    print(f"  {(count - done) / spent:.1f} records/s; at most {peak:.0f} MB in all processes")
    print("  " + run.stdout.read().strip().replace("\n", "\n  "))
    table = (out / "table.csv").read_text().splitlines()
    heads = table[0].split(",")
    fresh = jb.fit_each(sorted(folder.glob("*.csv"))[:again], inertia=INERTIA, read=Reading().record)
    fresh.write(out / "fresh.csv")
    equal = (out / "fresh.csv").read_text().splitlines()[1:] == [_under(heads, row, fresh) for row in table[1 : again + 1]]
    print(f"  the first {again} rows against a run that nothing stopped: {'equal' if equal else 'not equal'}")
    truths = [one_record(k)[3] for k in range(again)]
    for name in ("backlash", "stiffness", "damping"):
        true = np.array([truth[name] for truth in truths])
        off = (fresh.numbers(name) - true) / fresh.numbers(name, "stderr")
        inside = np.mean(np.abs(off[np.isfinite(off)]) < 1.96)
        print(f"  {name}: {100 * inside:.1f} % of the 95 % intervals hold the truth")


def _under(heads: list[str], row: str, fresh: jb.Each) -> str:
    """A row with the columns that the shorter table has."""
    assert heads == list(fresh.columns())
    return row


def memory(pid: int) -> float:
    """Resident memory [MB] of a process and its children."""
    total = 0.0
    try:
        children = [int(word) for path in Path(f"/proc/{pid}/task").glob("*/children") for word in path.read_text().split()]
        for one in [pid, *children]:
            status = Path(f"/proc/{one}/status").read_text()
            total += next(float(line.split()[1]) for line in status.splitlines() if line.startswith("VmRSS")) / 1024
    except (OSError, StopIteration):
        pass
    return total


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tiny", action="store_true", help="few records")
    parser.add_argument("--records", type=int, default=10_000, help="how many there are")
    given = parser.parse_args()
    count, part, alone, rounds = (40, 24, 4, 1) if given.tiny else (given.records, 400, 30, 3)
    jb.start(brief=given.tiny)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "records"
        folder.mkdir()
        spent = timed(lambda: make(folder, 0, count))
        print(f"{count} records of {DURATION:g} s at {RATE:g} Hz made in {spent:.0f} s, {cores()} cores")
        against_others(sorted(folder.glob("*.csv")), part, alone, rounds)
        all_of_them(folder, count, min(200, count), Path(place) / "out")


if __name__ == "__main__":
    main()
