"""How long `jaxbacklash refine` takes from the shell: with an empty cache of compiled programs, and with a filled one.

    python -m benchmarks.refine_speed [--effects gravity cubic_stiffness coulomb_joint] [--runs 5] [--draw 0] [--tiny]

Each record is 30 s at 500 Hz with noise of 3e-5 rad on x and on z, and hides one effect; it is made by a program that
shares nothing with the package. Every run is a process of its own, so that all that a user waits for counts: libraries
to load, compiling, searching, scoring, the other methods and the report. Warm runs with and without a report alternate.
It needs numba.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from jaxbacklash.records import Record, write_record
from tests.independent.generator import make_effects, make_excitation, make_rig, measure, simulate_truth

RATE, SIGMA, DURATION = 500.0, 3e-5, 30.0  # Hz, rad, s
EFFECTS = ("gravity", "cubic_stiffness", "coulomb_joint", "coulomb_ground", "sensor_delay", "dahl")


def write_case(folder: Path, draw: int, effect: str, duration: float) -> tuple[Path, float]:
    """A record that hides one effect, and its rig's inertia; ``draw`` tells one such record from another."""
    number = EFFECTS.index(effect) if effect in EFFECTS else len(EFFECTS)
    rng = np.random.default_rng(8100 + number + 100 * draw)
    rig, values = make_rig(rng), make_effects(rng, effect)
    truth = simulate_truth(rig, values, make_excitation(rng, "chirp", duration), RATE, duration)
    seen = measure(truth, rng, SIGMA, SIGMA)
    path = folder / f"{effect}.csv"
    write_record(Record(seen["t"], {"x": seen["x"], "z": seen["z"]}), path)
    return path, float(rig.inertia)


def seconds(record: Path, inertia: float, cache: Path | None, out: Path | None) -> tuple[float, list[str]]:
    """How long one process takes, and the effects it names."""
    code = "from jaxbacklash.cli import main; main()"
    words = [sys.executable, "-c", code, "refine", str(record), "--inertia", f"{inertia:.9g}", "--json"]
    words += [] if out is None else ["--out", str(out)]
    begun = time.perf_counter()
    kept = {} if cache is None else {"JAXBACKLASH_CACHE": str(cache)}
    done = subprocess.run(words, capture_output=True, text=True, env={**os.environ, **kept})
    took = time.perf_counter() - begun
    if done.returncode:
        raise SystemExit(done.stderr)
    return took, json.loads(done.stdout)["effects"]


def measure_case(folder: Path, draw: int, effect: str, duration: float, runs: int, empty: bool) -> None:
    """One line of the table; the cold run has an ``empty`` cache of its own, or else whatever the user's holds."""
    record, inertia = write_case(folder, draw, effect, duration)
    cache, out = folder / f"cache-{effect}" if empty else None, folder / f"out-{effect}"
    cold, found = seconds(record, inertia, cache, None)
    warm: dict[str, list[float]] = {"warm": [], "with report": []}
    for _ in range(runs):
        for name, place in (("warm", None), ("with report", out)):
            warm[name].append(seconds(record, inertia, cache, place)[0])
    told = ", ".join(f"{n} {statistics.median(t):.1f} ({min(t):.1f} to {max(t):.1f})" for n, t in warm.items())
    print(f"{effect:20s} found {'+'.join(found) or 'nothing':28s} cold {cold:.1f} s, {told} s", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--effects", nargs="+", default=list(EFFECTS))
    parser.add_argument("--runs", type=int, default=5, help="warm runs, of which median and range are shown")
    parser.add_argument("--draw", type=int, default=0, help="another joint and strength for each effect")
    parser.add_argument("--duration", type=float, default=DURATION, help="of each record [s]")
    parser.add_argument("--tiny", action="store_true", help="one short record, one warm run, the cache that is there")
    options = parser.parse_args()
    effects, runs, duration = (["gravity"], 1, 8.0) if options.tiny else (options.effects, options.runs, options.duration)
    with tempfile.TemporaryDirectory() as folder:
        for effect in effects:
            measure_case(Path(folder), options.draw, effect, duration, runs, empty=not options.tiny)


if __name__ == "__main__":
    main()
