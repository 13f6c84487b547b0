"""How long does it take to read a good text file, and how much of that is NumPy's own reader of numbers?

    python -m benchmarks.read_speed [--tiny]

Records t,x,z of a moved base, with the noise of an encoder, in files of 15,001 and of a million rows: with 6 and 8 decimals, as
loggers write them, and with the 18 digits of `numpy.savetxt`. The least of several readings counts, by the wall and by the
processor, which two cores share in long records; beside it stands `numpy.loadtxt` alone on the same file, and how many times as
long the whole takes: encoding, layout, units, clock and every check of `records.findings` come on top.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

import jaxbacklash as jb

STYLES = {"6 decimals": "%.6f", "8 decimals": "%.8f", "18 digits": "%.18e"}
RATE = 500.0
"""Samples per second."""


def write(path: Path, rows: int, style: str) -> None:
    """A base that swings at two frequencies and a link that lags behind it, in rad."""
    t, rng = np.arange(rows) / RATE, np.random.default_rng(rows)
    x = 0.05 * np.sin(2 * np.pi * 1.7 * t) + 0.02 * np.sin(2 * np.pi * 4.1 * t)
    z = 0.017 * np.sin(2 * np.pi * 1.7 * t - 0.4) + 0.012 * np.sin(2 * np.pi * 4.1 * t - 1.0)
    columns = [t, *(values + rng.normal(scale=1e-5, size=rows) for values in (x, z))]
    np.savetxt(path, np.stack(columns, axis=1), fmt=style, delimiter=",", header="t,x,z", comments="")


def least(work: Callable[[], object], times: int) -> tuple[float, float]:
    """The shortest of several runs [s], by the wall and by the processor."""
    wall = busy = np.inf
    for _ in range(times):
        from_, worked = time.perf_counter(), time.process_time()
        work()
        wall, busy = min(wall, time.perf_counter() - from_), min(busy, time.process_time() - worked)
    return float(wall), float(busy)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tiny", action="store_true", help="up to 50,000 rows, fewer readings")
    sizes = (2_001, 50_000) if parser.parse_args().tiny else (15_001, 1_000_000)
    print(f"{'rows':>9}  {'written with':<12} {'wall':>9} {'processor':>10} {'loadtxt alone':>14} {'times that':>11}")
    with tempfile.TemporaryDirectory() as folder:
        for rows in sizes:
            times = max(3, min(50, 1_000_000 // rows))
            for name, style in STYLES.items():
                path = Path(folder) / "run.csv"
                write(path, rows, style)
                record = jb.read_record(path)
                assert record.samples == rows
                assert not record.findings
                wall, busy = least(partial(jb.read_record, path), times)
                _, bare = least(partial(np.loadtxt, path, delimiter=",", skiprows=1), times)
                print(f"{rows:9d}  {name:<12} {wall:7.4f} s {busy:8.4f} s {bare:12.4f} s {busy / bare:11.2f}", flush=True)


if __name__ == "__main__":
    main()
