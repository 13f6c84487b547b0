"""How time and memory of a map grow with its cells and periods.

    python -m benchmarks.map_growth [--tiny]

Every size runs in a fresh process with a store of tiles, so that its peak memory is its own. The time is that of the run
alone, after compiling; straight growth keeps it over cells and periods constant within 20 per cent.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CELLS = ((32, 32), (64, 64), (128, 128), (256, 256), (512, 512), (1024, 1024))
PERIODS = (50, 100, 200, 400, 800, 1600)


def one(rows: int, columns: int, periods: int, folder: str) -> None:
    """The fresh process: run and tell seconds and peak memory [MB]."""
    import numpy as np

    import jaxbacklash as jb
    from jaxbacklash import program

    program.prepare_for_maps()
    jb.start()
    from jaxbacklash.dynamics.family import PaperCase
    from jaxbacklash.dynamics.follow import compile_exact
    from jaxbacklash.dynamics.maps import request, run_map

    axes = {"inverse_alpha": np.linspace(1.0, 5.0, rows), "zeta": np.linspace(0.005, 0.03, columns)}
    wanted = request(PaperCase(1), axes, periods=periods, skip=periods // 4, samples=16)
    compile_exact(int(np.prod(wanted.tile)), wanted.plan)
    begun = time.perf_counter()
    run_map(wanted, store=folder)
    spent = time.perf_counter() - begun
    status = Path("/proc/self/status").read_text()
    peak = next(float(line.split()[1]) / 1024 for line in status.splitlines() if line.startswith("VmHWM"))
    print(json.dumps({"s": spent, "MB": peak}))


def fresh(rows: int, columns: int, periods: int) -> dict[str, float]:
    """Seconds and peak memory of one size."""
    with tempfile.TemporaryDirectory() as folder:
        words = [sys.executable, "-m", "benchmarks.map_growth", "--one", str(rows), str(columns), str(periods), folder]
        done = subprocess.run(words, check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def table(head: str, sizes: list[tuple[int, int, int]]) -> None:
    """Time over cells and periods, relative to the middle size, and peak memory."""
    print(f"\n{head}\n      cells  periods        s   ns a cell and period     peak MB")
    for rows, columns, periods in sizes:
        found = fresh(rows, columns, periods)
        each = 1e9 * found["s"] / (rows * columns * periods)
        print(f"  {rows * columns:9d}{periods:9d}{found['s']:9.2f}{each:23.0f}{found['MB']:12.0f}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tiny", action="store_true", help="two small sizes")
    parser.add_argument("--one", nargs=4, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.one:
        rows, columns, periods = map(int, given.one[:3])
        return one(rows, columns, periods, given.one[3])
    cells, periods = (CELLS[:1], PERIODS[:1]) if given.tiny else (CELLS, PERIODS)
    table("against cells", [(*shape, 50 if given.tiny else 100) for shape in cells])
    table("against periods", [(32 if given.tiny else 64, 32 if given.tiny else 64, count) for count in periods])


if __name__ == "__main__":
    main()
