"""A real joint with play and dry friction: fitted to two slow tests, checked on all others with its parameters frozen.

    python -m benchmarks.real_joint [FOLDER] [--tiny] [--effects coulomb_ground cubic_stiffness]

FOLDER holds the sine tests of the full-scale rotary friction damper of Coble, Huggins, Cao, Ricles and Downey (2022) as .npz
files with the columns t_s, x_in and F_kip: prescribed motion in, force out, 1024 Hz. The two slowest are fitted. Without a
FOLDER, or with --tiny, tests of a made-up damper stand in, simulated by `tests.independent.held_link`, of which the model is
true.

For each test: the play read off its force loop without any model (travel over which less than a tenth of the sliding force is
carried), the same reading of the model's prediction, and the windowed prediction error, as a share of the sliding force and over
the noise. Tests that were fitted are marked.
"""

from __future__ import annotations

import argparse
import time
import warnings
from pathlib import Path

import numpy as np

import jaxbacklash as jb
from jaxbacklash.fitting.score import Score
from jaxbacklash.records import oriented, parse_columns, parse_units, read_record
from jaxbacklash.regression.force_loop import read_plateau, sliding_level
from tests.independent.held_link import HeldLink, measured

COLUMNS, UNITS = parse_columns("t=t_s,x=x_in,T=F_kip"), parse_units("x=in,T=kip")
TRIED = ("0.25Hz30lbtension0.5amplitude", "0.5Hz30lbtension0.5amplitude")
MADE_UP = HeldLink(inertia=200.0, backlash=3e-3, stiffness=2e6, damping=6000.0, friction=4000.0)


def of_folder(folder: Path) -> dict[str, jb.Record]:
    """The tests in a folder by name, force turned to that of the link on its base."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # all of them measure the actuator's force
        found = {p.stem.split("_char_")[-1]: oriented(read_record(p, columns=COLUMNS, units=UNITS)) for p in folder.glob("*.npz")}
    return dict(sorted(found.items()))


def made_up(duration: float = 6.0, rate: float = 256.0) -> dict[str, jb.Record]:
    """Three tests of a damper of which the model is true."""
    found = {}
    for seed, (name, amplitude) in enumerate({"10 mm": 0.010, "15 mm": 0.015, "20 mm": 0.020}.items()):
        table, rng = measured(MADE_UP, amplitude, 0.5, duration=duration, rate=rate), np.random.default_rng(seed)
        noisy = {n: table[n] + s * rng.standard_normal(table["t"].size) for n, s in (("x", 1e-6), ("T", 8.0))}
        found[name] = jb.Record(table["t"], noisy, name)
    return found


def line(name: str, record: jb.Record, score: Score, fitted: bool) -> str:
    """One test in the table."""
    x, force = record.channels["x"], record.channels["T"]
    widths = [read_plateau(x, f).median for f in (force, score.predicted)]
    told = [" " * 9 if w is None else f"{1e3 * w:9.2f}" for w in widths]
    error = 100.0 * float(np.sqrt(np.mean((score.measured - score.predicted) ** 2))) / sliding_level(force)
    return f"{name:<30} {told[0]} {told[1]} {error:8.1f} {score.median:10.3g} {score.rms:10.3g}  {'fitted' if fitted else ''}"


def main() -> None:
    words = argparse.ArgumentParser(description="A real joint with play and dry friction, tried on two tests, checked on others.")
    words.add_argument("folder", nargs="?", type=Path, help="folder with the measured tests")
    words.add_argument("--tiny", action="store_true", help="the made-up damper, one starting point")
    words.add_argument("--effects", nargs="+", default=["coulomb_ground"], help="effects in the model")
    given = words.parse_args()
    jb.start(brief=given.tiny)
    records = of_folder(given.folder) if given.folder and not given.tiny else made_up()
    tried = [name for name in records if name in TRIED] or list(records)[:2]
    begun = time.perf_counter()
    fit = jb.fit([records[name] for name in tried], effects=given.effects, translational=True, starts=1 if given.tiny else 2)
    print(f"fitted to {' and '.join(tried)} in {time.perf_counter() - begun:.0f} s")
    print("\n".join(str(fit).splitlines()[-3 - len(fit.parameters) :]))
    print(f"\n{'':30} {'play read off the':>19}    error, windows of 0.2 s")
    print(f"{'test':<30} {'loop, mm':>9} {'model, mm':>9} {'% of Tc':>8} {'med/noise':>10} {'rms/noise':>10}")
    for name, record in records.items():
        own = name in tried
        score = fit.scores[tried.index(name)] if own else jb.compare(fit.system, record, translational=True).score
        print(line(name, record, score, own), flush=True)


if __name__ == "__main__":
    main()
