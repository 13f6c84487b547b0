"""Time and memory of a whole analysis over the length of the series.

    python -m benchmarks.chaos_length [--tiny]

Lorenz with 2 % noise; a fresh process for each length, so that the memory is that length's own. Seconds depend on the machine;
the growth with the length does not.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import time

from jaxbacklash import chaos
from tests.independent.chaotic import LORENZ, with_noise


def one(samples: int) -> None:
    """Analyse one series and print its line."""
    series = with_noise(LORENZ.series(samples, 1, 1)[0], 0.02)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    wall, cpu = time.perf_counter(), time.process_time()
    found = chaos(series, LORENZ.dt)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    value = "none" if found.lyapunov is None else f"{found.lyapunov:.3f}"
    print(f"{samples:>9}{wall:9.1f}{cpu:9.1f}{before:11.0f}{after:11.0f}{value:>10}  {found.verdict.word}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tiny", action="store_true", help="one short series")
    parser.add_argument("--one", type=int, help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.one:
        one(asked.one)
        return
    print(f"{'samples':>9}{'wall s':>9}{'cpu s':>9}{'MB before':>11}{'MB peak':>11}{'exponent':>10}  verdict", flush=True)
    for samples in (1000,) if asked.tiny else (5000, 20000, 50000, 200000, 500000):
        subprocess.run([sys.executable, "-m", "benchmarks.chaos_length", "--one", str(samples)], check=True)


if __name__ == "__main__":
    main()
