"""How long do the skeletons take, and how much memory the wavelet transform of a long record?

    python -m benchmarks.skeleton_speed [--tiny]

A 30 s record at 500 Hz: both methods, then the page with all its pictures, cold and warm; the cross-check beside a fit takes the
first of these. A 10-minute record at 5 kHz (3 million samples), with encoder noise: time, and how much larger the process was at
its largest than with the signals alone (resident memory), for the scalogram of all samples and for both methods. Memory stays
bounded since samples are averaged down to 100 a cycle of the fastest motion above the noise, and each atom of the wavelet sees
means that leave it 32 to 64 samples a cycle.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import jaxbacklash as jb
from jaxbacklash.signals import frequency_grid, scalogram
from jaxbacklash.skeletons.describing_function import dead_zone


def sweep(seconds: float, rate: float, top: float = 12.0) -> jb.Record:
    """A joint under a chirp, stepped by a plain semi-implicit rule: good enough to be timed."""
    t = np.arange(0.0, seconds, 1.0 / rate)
    f = top * t / seconds
    x = 0.045 / (1.0 + (f / 2.8) ** 2) * np.sin(np.pi * f * t) * np.minimum(t, 1.0)
    k, c, half, dt = 4777.0, 6.9, 0.0131, 1.0 / rate
    y, v = np.zeros(t.size), 0.0
    dx = np.gradient(x, dt)
    for n in range(t.size - 1):
        z = y[n] - x[n]
        v += dt * (-k * (z - min(max(z, -half), half)) - c * (v - dx[n]))
        y[n + 1] = y[n] + dt * v
    return jb.Record(t, {"x": x, "z": y - x})


def long_record(what: str, seconds: float) -> None:
    """In a process of its own: make the signals, then report what the method adds in time and memory."""
    rate, rng = 5000.0, np.random.default_rng(1)
    t = np.arange(round(seconds * rate)) / rate
    f = 12.0 * t / seconds
    x = 0.03 * np.sin(np.pi * f * t)
    z = 0.02 * np.sin(np.pi * f * t - 1.0) * (1.0 + 0.5 * t / seconds)
    z = z + 0.1 * dead_zone(z, 0.013)
    record = jb.Record(t, {name: values + 3e-5 * rng.standard_normal(t.size) for name, values in (("x", x), ("z", z))})
    jb.skeleton(jb.Record(t[: t.size // 60], {name: values[: t.size // 60] for name, values in record.channels.items()}))
    before, begin = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.perf_counter()
    if what == "scalogram":
        scalogram(t, record.channels["z"], frequency_grid(0.05, 60.0, 12))
    else:
        jb.skeleton(record)
    more = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    print(f"{what:<10} {t.size} samples: {time.perf_counter() - begin:.1f} s, {more:.0f} MB more than with the signals alone")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tiny", action="store_true", help="10 s, and a 1-minute long record")
    parser.add_argument("--long", choices=("scalogram", "skeleton"), help=argparse.SUPPRESS)
    parser.add_argument("--seconds", type=float, default=600.0, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.long:
        long_record(options.long, options.seconds)
        return
    from jaxbacklash.report.skeleton_report import skeleton_report
    from jaxbacklash.report.skeleton_result import skeletons_json

    record = sweep(10.0 if options.tiny else 30.0, 500.0)
    with tempfile.TemporaryDirectory() as folder:
        for name in ("cold", "warm", "warm"):
            marks = [(time.perf_counter(), time.process_time())]
            found = jb.skeleton(record)
            marks.append((time.perf_counter(), time.process_time()))
            skeleton_report(found, skeletons_json(found), Path(folder) / "report.html")
            marks.append((time.perf_counter(), time.process_time()))
            wall, busy = (np.diff([mark[k] for mark in marks]) for k in (0, 1))
            print(
                f"{name}: both methods {wall[0]:.2f} s, page {wall[1]:.2f} s, together {wall.sum():.2f} s "
                f"(processor {busy.sum():.2f} s)"
            )
    for what in ("scalogram", "skeleton"):
        command = [sys.executable, "-m", "benchmarks.skeleton_speed", "--long", what]
        subprocess.run([*command, "--seconds", "60" if options.tiny else "600"], check=True)


if __name__ == "__main__":
    main()
