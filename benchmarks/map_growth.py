"""How time and memory of a map grow with its cells and periods, with a verdict.

    python -m benchmarks.map_growth [--tiny] [--largest 1024] [--rounds 4]

Every size runs in a fresh process with a store of tiles and a netCDF written from it, so that its peak memory is its own. The
time is that of the run and the file, after compiling, by the clock. All sizes run one after the other, ``--rounds`` times
over, and the shortest of each counts: a host that is slow for a minute slows one round of some sizes, not all rounds of one.
Straight growth: no size is more than 20 per cent off the straight line through all of them, whose constant is what a map costs
however small. A map of fewer tiles than cores leaves cores idle, which the table shows. Memory: twice the cells may cost no
more than twice the memory and 20 per cent, and the largest map stays below `MEMORY`, whatever its file holds. Two quiet cores
need five to eight minutes; the machine should do nothing else.
"""

from __future__ import annotations

import argparse
import gc
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROWS = (32, 64, 128, 256, 512, 1024)
PERIODS = (50, 100, 200, 400, 800, 1600)
FEW = 40
"""Periods of every map whose size is varied."""
MEMORY = 1200.0
"""Most memory [MB] for a map of 1024 x 1024 cells with 16 samples each: the file alone holds 159 MB; the libraries take 500."""
ROOM = 0.2
Size = tuple[int, int, int]
"""Rows, columns, periods."""


def one(rows: int, columns: int, periods: int, folder: str) -> None:
    """The fresh process: run and tell seconds, cores in use, and memory [MB] before the run and at its peak."""
    import jaxbacklash as jb
    from jaxbacklash import program

    jb.start()
    from jaxbacklash.dynamics.family import PaperCase
    from jaxbacklash.dynamics.follow import trace_exact
    from jaxbacklash.dynamics.maps import run_map
    from jaxbacklash.dynamics.netcdf import write_netcdf
    from jaxbacklash.dynamics.request import request

    axes = {"inverse_alpha": np.linspace(1.0, 5.0, rows), "zeta": np.linspace(0.005, 0.03, columns)}
    wanted = request(PaperCase(1), axes, periods=periods, skip=periods // 4, samples=16)
    # Two tiles of two cells first: what writes and reads the files is loaded when it is first asked for, and is no growth.
    few = request(PaperCase(1), {name: values[:2] for name, values in axes.items()}, periods=24, skip=2, samples=1, lanes=2)
    write_netcdf(run_map(few, store=f"{folder}/few"), f"{folder}/few.nc")
    trace_exact(int(np.prod(wanted.tile)), wanted.plan)()
    gc.freeze()  # like the command: to look through all the libraries' objects once takes as long as a small map
    before = memory("VmRSS")
    begun = time.perf_counter()
    write_netcdf(run_map(wanted, store=f"{folder}/tiles"), f"{folder}/map.nc")
    spent = time.perf_counter() - begun
    busy = min(program.cores(), len(wanted.tiles()))
    print(json.dumps({"s": spent, "cores": busy, "MB": memory("VmHWM"), "before": before}))


def memory(name: str) -> float:
    """``VmRSS`` now or ``VmHWM``, the most so far, of this process [MB]."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(float(line.split()[1]) / 1024 for line in lines if line.startswith(name))


def fresh(rows: int, columns: int, periods: int) -> dict[str, float]:
    """What a fresh process told."""
    with tempfile.TemporaryDirectory() as folder:
        words = [sys.executable, "-m", "benchmarks.map_growth", "--one", str(rows), str(columns), str(periods), folder]
        done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{rows} x {columns} cells, {periods} periods failed:\n{done.stderr}")
    return dict(json.loads(done.stdout.splitlines()[-1]))


def measured(sizes: list[Size], rounds: int) -> dict[Size, dict[str, float]]:
    """Of every size what its quickest process told, with the largest of the peaks."""
    told: dict[Size, list[dict[str, float]]] = {size: [] for size in sizes}
    for _ in range(rounds):
        for size in told:
            told[size].append(fresh(*size))
    return {
        size: min(runs, key=lambda one: one["s"])
        | {"MB": max(one["MB"] for one in runs), "slowest": max(one["s"] for one in runs)}
        for size, runs in told.items()
    }


def straight(size: np.ndarray, spent: np.ndarray) -> tuple[float, float, np.ndarray]:
    """Constant and slope of the line with the smallest relative misfit, neither below zero, and the misfit of each size."""
    from scipy.optimize import nnls

    (constant, slope), _ = nnls(np.stack([1.0 / spent, size / spent], axis=1), np.ones(spent.size))
    return float(constant), float(slope), (constant + slope * size) / spent - 1.0


def growth(memory: np.ndarray, size: np.ndarray) -> float:
    """Largest factor of memory from one size to the next, over that of the size: up to 1 is not faster than straight."""
    return float(np.max((memory[1:] / memory[:-1]) / (size[1:] / size[:-1]))) if size.size > 1 else 1.0


def table(head: str, sizes: list[Size], told: dict[Size, dict[str, float]]) -> None:
    """Time and memory of every size, and the verdict on how they grow."""
    print(f"\n{head}\n      cells  periods        s  slowest  cores   ns a cell and period     peak MB")
    rows = [told[size] | {"work": float(np.prod(size))} for size in sizes]
    for size, row in zip(sizes, rows):
        each = 1e9 * row["s"] / row["work"]
        seen = f"{row['s']:9.2f}{row['slowest']:9.2f}{row['cores']:7.0f}{each:23.0f}{row['MB']:12.0f}"
        print(f"  {size[0] * size[1]:9d}{size[2]:9d}{seen}")
    if len(rows) > 2:
        work, spent = (np.array([row[k] for row in rows]) for k in ("work", "s"))
        constant, slope, misfit = straight(work, spent)
        worst = float(np.abs(misfit).max())
        print(f"  seconds: {constant:.2f} s and {1e9 * slope:.0f} ns a cell and period; off it by {100 * worst:.0f} % "
              f"at most (wanted 20 %): {verdict(worst <= ROOM)}")  # fmt: skip
        faster = growth(np.array([row["MB"] for row in rows]), work)
        print(f"  memory grows {faster:.2f} times as fast as the size at most (wanted 1.2): {verdict(faster <= 1.0 + ROOM)}")


def verdict(met: bool) -> str:
    return "met" if met else "NOT MET"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tiny", action="store_true", help="a few small sizes")
    parser.add_argument("--largest", type=int, default=ROWS[-1], help="rows and columns of the largest map")
    parser.add_argument("--rounds", type=int, default=4, help="runs of every size; the shortest counts")
    parser.add_argument("--one", nargs=4, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.one:
        rows, columns, periods = map(int, given.one[:3])
        return one(rows, columns, periods, given.one[3])
    begun = time.perf_counter()
    side, rounds = (32, 1) if given.tiny else (64, given.rounds)
    wide = [(rows, rows, FEW) for rows in ROWS if rows <= (side if given.tiny else given.largest)]
    long = [(side, side, count) for count in (PERIODS[:1] if given.tiny else PERIODS)]
    told = measured([*wide, *long], rounds)
    table("against cells", wide, told)
    largest, side_by_side = told[wide[-1]], f"{wide[-1][0]} x {wide[-1][0]}"
    print(f"  {side_by_side} cells: peak {largest['MB']:.0f} MB, {largest['MB'] - largest['before']:.0f} MB of it for the map "
          f"(wanted below {MEMORY:.0f} MB in all): {verdict(largest['MB'] < MEMORY)}")  # fmt: skip
    table("against periods", long, told)
    print(f"\n{time.perf_counter() - begun:.0f} s in all")


if __name__ == "__main__":
    main()
