"""How long a fit takes: against scipy and numba on the same record, by record length, in memory, and from the shell.

    python -m benchmarks.fit_speed [--tiny]

The record is 30 s at 500 Hz with noise of 3e-5 rad on x and on z, made by a program that shares nothing with the
package; everyone starts from a stiffness 80 % and a play 50 % too large and half the damping. Runs are interleaved, so
that what else the machine does hits all alike; a first run compiles and is left out of the medians. It needs numba.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # its threads only wait for one another, most of all in LSMR

import numpy as np

import jaxbacklash as jb
from benchmarks.peers import numba_errors_in_x, numba_shooting
from jaxbacklash.fitting.fit import prepare
from jaxbacklash.fitting.search import search
from jaxbacklash.parameters import values
from jaxbacklash.records import Record, write_record
from tests.independent.generator import make_excitation, measure, simulate_truth
from tests.independent.rigs import Rig

RIG = Rig(inertia=2.9, backlash=0.0245, stiffness=11800.0, damping=10.5)
NAMES = ("backlash", "stiffness", "damping")
RATE, SIGMA = 500.0, 3e-5  # Hz, rad on both channels
LENGTHS = (10.0, 30.0, 120.0, 600.0)
JAX_FIT, JAX_ONE, JAX_SEARCH = "jaxbacklash, whole fit", "jaxbacklash, whole fit, one start", "jaxbacklash, search"
PEERS = {name: f"least_squares + numba, {name}" for name in ("grouped", "explicit", "operator")}
SMALL, SMALL_SCHUR = "least_squares + numba", "hand-written LM + numba"
NOTES = """\
Our search includes cutting the record (its noise, knots and splines), which the peers are given for nothing. The whole
fit adds the estimate it starts from and the score, and takes four starts where the peers take one. They tie loosely: our last,
tightest tie moves no parameter by 0.03 standard errors. Ours on the smaller problem is not to be had: a measured base
motion always brings its spline. numba's compiled code may come from its disk cache."""


def make_record(duration: float, seed: int = 11) -> Record:
    """A multisine record of the rig, with the measured channels x and z."""
    rng = np.random.default_rng(seed)
    truth = simulate_truth(RIG, {}, make_excitation(rng, "multisine", duration), RATE, duration)
    seen = measure(truth, rng, SIGMA, SIGMA)
    return Record(seen["t"], {"x": seen["x"], "z": seen["z"]})


def wild_start() -> dict[str, float]:
    """Where every search begins."""
    return {"backlash": 1.5 * RIG.backlash, "stiffness": 1.8 * RIG.stiffness, "damping": 0.5 * RIG.damping}


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    """Seconds, and what the work returned; a peer that times itself is believed."""
    begin = time.perf_counter()
    answer = work()
    spent = time.perf_counter() - begin
    return (answer["seconds"] if isinstance(answer, dict) else spent), answer


def contestants(record: Record) -> dict[str, Callable[[], Any]]:
    """By name, the fits to be timed, the last two of the smaller problem."""
    start = wild_start()
    system = jb.base_motion_joint(RIG.inertia, **start)
    windows, layout, _ = prepare(system, [record], 0.2)
    plain = record.t, record.channels["x"], record.channels["z"], RIG.inertia, start
    known: dict[str, Any] = {
        "sigma_z": layout.noise[0], "sigma_x": layout.input_noise[0], "intervals": windows.intervals,
        "window": layout.length * layout.dt, "longest": float(windows.panel),
    }  # fmt: skip

    def ours() -> Any:
        return search(system, prepare(system, [record], 0.2)[0], NAMES, starts=1, seed=0)

    def peer(form: str) -> Callable[[], Any]:
        return lambda: numba_errors_in_x.fit(*plain, **known, jacobian=form)

    return {
        JAX_SEARCH: ours,
        JAX_ONE: lambda: jb.fit(record, inertia=RIG.inertia, starts=1),
        JAX_FIT: lambda: jb.fit(record, inertia=RIG.inertia),
        **{label: peer(form) for form, label in PEERS.items()},
        SMALL: lambda: numba_shooting.fit(*plain),
        SMALL_SCHUR: lambda: numba_shooting.fit_schur(*plain),
    }


def reading(answer: Any) -> tuple[np.ndarray, float, int]:
    """Parameters in the order of NAMES, cost in units of the noise (NaN for the smaller problem), and steps taken."""
    if isinstance(answer, dict):
        cost = answer["cost"] if "rms" not in answer else np.nan
        return np.array([answer[name] for name in NAMES]), cost, answer["nfev"]
    if isinstance(answer, jb.Fit):
        found = values(answer.system)
    else:
        problem = answer.problem
        found = dict(zip(values(problem.system), np.asarray(problem.parameters(answer.unknowns.theta))))
    return np.array([found[name] for name in NAMES]), answer.cost, answer.steps


def against_peers(record: Record, rounds: int) -> None:
    """The table of medians, ratios and answers."""
    fits = contestants(record)
    first, later, answers = {}, {name: [] for name in fits}, {}
    for name, work in fits.items():
        begin = time.perf_counter()
        answers[name] = work()
        first[name] = time.perf_counter() - begin
    for _ in range(rounds):
        for name, work in fits.items():
            spent, answers[name] = timed(work)
            later[name].append(spent)
    ours = answers[JAX_SEARCH]
    reference, cost, _ = reading(ours)
    errors = np.sqrt(np.diag(ours.covariance))
    middle = {name: float(np.median(spent)) for name, spent in later.items()}
    print(f"\n{record.samples} samples, median of {rounds} interleaved runs; ratio: our search / this one")
    head = f"{'':36}{'ms':>8}{'ratio':>8}{'compile s':>11}{'steps':>7}{'cost - ours':>13}"
    print(f"{head}   parameters - ours, std errors")
    for name in fits:
        found, its_cost, steps = reading(answers[name])
        away = "  ".join(f"{d:+7.3f}" for d in (found - reference) / errors)
        spent = middle[name]
        gap = "-" if np.isnan(its_cost) else f"{its_cost - cost:+.2f}"
        if name == SMALL:
            print("the smaller problem: x taken as exact, windows not tied, intervals that lie")
        compile_s = first[name] - spent
        ratio = middle[JAX_SEARCH] / spent
        print(f"  {name:<34}{spent * 1e3:8.1f}{ratio:8.3f}{compile_s:11.1f}{steps:7d}{gap:>13}   {away}")
    print(NOTES)


def by_length(lengths: tuple[float, ...], rounds: int) -> None:
    """Cost of `fit(..., starts=1)` against the length of the record."""
    records = {length: make_record(length) for length in lengths}
    spent: dict[float, list[float]] = {length: [] for length in lengths}
    for turn in range(rounds + 1):
        for length, record in records.items():
            seconds, found = timed(lambda record=record: jb.fit(record, inertia=RIG.inertia, starts=1))
            assert found.tied
            if turn:
                spent[length].append(seconds)
    print(f"\nRecord length, jaxbacklash.fit(starts=1) from its own estimate, median of {rounds} interleaved runs")
    print("   length s      ms   ms per s of record")
    for length in lengths:
        middle = float(np.median(spent[length])) * 1e3
        print(f"  {length:9.0f}{middle:8.0f}{middle / length:12.2f}")


def peak_memory(length: float, folder: Path, tiny: bool) -> None:
    """Peak memory of a fresh process that fits one record."""
    path = folder / "long.npz"
    write_record(make_record(length), path)
    words = [sys.executable, "-m", "benchmarks.fit_speed", "--memory", str(path), *(["--tiny"] if tiny else [])]
    ran = subprocess.run(words, check=True, capture_output=True, text=True)
    print(f"\nPeak memory, a fresh process that fits {length:.0f} s: {ran.stdout.strip()}")


def report_memory(path: str, tiny: bool) -> None:
    """The fresh process: its peak before and after the fit."""
    jb.start(cache=tiny, brief=tiny)
    record = jb.read_record(path)
    before = _peak()
    jb.fit(record, inertia=RIG.inertia, starts=1)
    print(f"{_peak():.0f} MB, of which {before:.0f} MB before the fit")


def _peak() -> float:
    # Linux hands the parent's ru_maxrss on to its child; the kernel's own high-water mark begins anew.
    status = Path("/proc/self/status")
    if status.exists():
        line = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        return float(line.split()[1]) / 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def from_the_shell(lengths: tuple[float, ...], folder: Path, tiny: bool) -> None:
    """Wall time of `jaxbacklash fit`, the first call with nothing compiled; the others with other records. A tiny run takes the
    programs that are kept."""
    print("\nCommand line, wall time of a fresh process")
    for out in (True,) if tiny else (False, True):
        kept = {} if tiny else {"JAXBACKLASH_CACHE": str(folder / f"cache_{out}")}
        for k, length in enumerate(lengths):
            path = folder / f"record_{k}.csv"
            if not path.exists():
                write_record(make_record(length, seed=20 + k), path)
            words = [sys.executable, "-m", "jaxbacklash.cli", "fit", str(path), "--inertia", str(RIG.inertia)]
            words += ["--out", str(folder / f"out_{k}")] if out else []
            begin = time.perf_counter()
            ran = subprocess.run(words, env=os.environ | kept, capture_output=True, text=True)
            spent = time.perf_counter() - begin
            if ran.returncode:
                print(f"  jaxbacklash fit failed with code {ran.returncode}: {ran.stderr.strip()[-300:]}")
                return
            state = "empty cache" if k == 0 else "warm cache"
            print(f"  {length:5.0f} s record, {state:<11} {'with' if out else 'without'} --out: {spent:6.1f} s")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tiny", action="store_true", help="a short record, few runs, programs that are kept already")
    parser.add_argument("--memory", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.memory:
        return report_memory(given.memory, given.tiny)
    jb.start(cache=given.tiny, brief=given.tiny)
    against_peers(make_record(6.0 if given.tiny else 30.0), 2 if given.tiny else 9)
    by_length(LENGTHS[:1] if given.tiny else LENGTHS, 1 if given.tiny else 3)
    with tempfile.TemporaryDirectory() as folder:
        peak_memory(10.0 if given.tiny else 600.0, Path(folder), given.tiny)
        # The second record falls into the first one's compiled sizes, the third does not.
        from_the_shell((6.0, 5.0) if given.tiny else (30.0, 33.0, 26.0), Path(folder), given.tiny)


if __name__ == "__main__":
    main()
