"""The play from exponents at several drive levels, beside the direct fit: how wide, how honest, and when it is worth anything.

    python -m benchmarks.play_from_exponents [--tiny] [--rigs 10] [--experiments 400] [--out DIR]

First imagined experiments on the exponent map of a joint like the paper's (tests/drive_levels.py): half width and coverage of
the play's interval over sets of drive levels; with damping and gravity unknown; and with a map whose damping or gravity is
wrong. Then rigs of random play, simulated without the package and sin y in the weight: eight series with 1 % noise, each read
by `jaxbacklash.chaos` alone, with the rates of wrong verdicts and the error of the exponents against the map; and beside the
play so found the fit of one of the same records by simulation. The last rows scale the measured channel by a gain that nobody
knows. It needs numba.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np

import jaxbacklash as jb
from jaxbacklash.signature import ExponentMap, Level, expected_precision, exponent_map, play_from_exponents
from tests.drive_levels import AMPLITUDES, FREQUENCY, INERTIA, Twin

PLAYS = np.radians([1.2, 2.4])
"""Range of true plays, and of what is thought possible [rad]."""
NOISE = 0.01
RATE, SECONDS = 125.0, 60.0
GAIN = 1.05


def ladders() -> dict[str, np.ndarray]:
    """Sets of drive levels [rad], all over the paper's range."""
    low, high = AMPLITUDES[0], AMPLITUDES[-1]
    return {
        "the paper's 8": AMPLITUDES, "3 levels": np.geomspace(low, high, 3), "16 levels": np.geomspace(low, high, 16),
        "32 levels": np.geomspace(low, high, 32),
    }  # fmt: skip


def map_of(twin: Twin, tiny: bool, over: dict[str, list[float]] | None = None) -> ExponentMap:
    """The exponent map over what the levels and plays ask for."""
    ratios = (0.9 * AMPLITUDES[0] / PLAYS[1], 1.1 * AMPLITUDES[-1] / PLAYS[0], 40 if tiny else 451)
    size = {"periods": 60, "skip": 30, "starts": 2} if tiny else {"periods": 300, "skip": 150, "starts": 4}
    if over is not None:
        size = {"periods": 160, "skip": 80, "starts": 2}
    return exponent_map(twin.system(), FREQUENCY, ratios, over=over, **size)


def imagined(map_: ExponentMap, twin: Twin, options: argparse.Namespace) -> None:
    """What could be had if the observation model were true."""
    count = 10 if options.tiny else options.experiments
    plays = (float(PLAYS[0]), float(PLAYS[1]))
    print(f"{count} imagined experiments a row, plays {np.degrees(PLAYS[0]):.1f} to {np.degrees(PLAYS[1]):.1f} deg")
    found = {name: expected_precision(map_, levels, plays, experiments=count, seed=1) for name, levels in ladders().items()}
    for name, one in found.items():
        print(f"  {name:<40}{one}", flush=True)
    for words, error, drive in (("to 1 %, drive to 0.2 %", 0.01, 0.002), ("to 30 %", 0.3, 0.01)):
        given = {"stderr": error, "systematic": 0.2 * error, "drive_error": drive}
        one = expected_precision(map_, AMPLITUDES, plays, experiments=count, seed=1, **given)
        print(f"  {'8, exponents ' + words:<40}{one}", flush=True)
    rig = twin.rig
    if not options.tiny:
        over = {
            "damping": [f * rig.damping for f in (0.6, 1.0, 1.4)], "linear_gravity.G": [-110.0, -90.0, -70.0],
        }  # fmt: skip
        unknown = map_of(twin, options.tiny, over)
        one = expected_precision(unknown, AMPLITUDES, plays, experiments=count, seed=1, truth=map_)
        print(f"  {'damping +-40 %, weight +-22 % unknown':<40}{one}", flush=True)
        for words, index in (("damping taken 40 % too high", (2, 1)), ("weight taken 22 % too low", (1, 2))):
            wrong = replace(unknown, axes={}, exponent=unknown.exponent[:, *index], stderr=unknown.stderr[:, *index])
            one = expected_precision(wrong, AMPLITUDES, plays, experiments=count, seed=1, truth=map_)
            print(f"  {words:<40}{one}", flush=True)
    if options.out is not None:
        from jaxbacklash.plot.drawing import on_page

        options.out.mkdir(parents=True, exist_ok=True)
        shown = {name: found[name] for name in ("3 levels", "the paper's 8", "32 levels")}
        on_page(jb.plot.expected_precision, shown).savefig(options.out / "worth_over_play.png", dpi=150)


def measured(map_: ExponentMap, options: argparse.Namespace) -> None:
    """Plays from series alone, and from a fit, on rigs that the package did not simulate."""
    rng = np.random.default_rng(11)
    rigs, chosen = (1, AMPLITUDES[[2, 6]]) if options.tiny else (options.rigs, AMPLITUDES)
    seconds = 12.0 if options.tiny else SECONDS
    words: Counter[tuple[bool | None, str]] = Counter()
    ratio, rows, clock = [], [], Counter[str]()
    for number in range(rigs):
        play = float(np.exp(rng.uniform(*np.log(PLAYS))))
        twin = replace(Twin(), play=float(np.degrees(play)))
        levels, records = [], []
        for amplitude in chosen:
            record, truth = twin.series(amplitude, seconds=seconds, rate=RATE, noise=3e-5, rng=rng)
            z = truth + NOISE * truth.std() * rng.standard_normal(truth.size)
            record = replace(record, channels=record.channels | {"z": z})
            begun = time.perf_counter()
            level = Level.measured(float(amplitude), jb.chaos(z, 1.0 / RATE, clean=False), FREQUENCY)
            clock["series"] += time.perf_counter() - begun
            levels.append(level)
            records.append(record)
            at = int(np.rint(map_.place(amplitude, play)))
            share = map_.chaotic_share[at]
            words[True if share == 1.0 else False if share == 0.0 else None, level.word] += 1
            if share == 1.0 and level.exponent is not None:
                ratio.append(level.exponent / map_.exponent[:, at].mean())
        found = play_from_exponents(map_, levels, plays=(float(PLAYS[0]), float(PLAYS[1])))
        fit, spent, value, half = None, 0.0, np.nan, np.nan
        if number < options.fits:
            begun = time.perf_counter()
            fit = jb.fit(records[len(records) // 2], inertia=INERTIA, effects=["gravity"], starts=1).parameters["backlash"]
            spent = time.perf_counter() - begun
            if fit.value is not None:
                value, half = fit.value / play - 1.0, 1.96 * fit.stderr / play
        rows.append((play, found, value, half))
        low, high = 100.0 * (np.array(found.interval or (np.nan, np.nan)) / play - 1.0)
        inside = any(first <= play <= last for first, last in found.pieces)
        middle = np.nan if found.value is None else 100.0 * (found.value / play - 1.0)
        print(f"  play {np.degrees(play):.3f} deg: from exponents {middle:+6.2f} %, interval {low:+5.1f} to {high:+5.1f} %, in "
              f"{len(found.pieces)} pieces that {'hold' if inside else 'miss'} it"
              + (f"; fit {100 * value:+.4f} +- {100 * half:.4f} % ({spent:.1f} s)" if fit else ""), flush=True)  # fmt: skip
        if number == 0 and options.out is not None:
            draw(options.out, map_, found, play, fit)
    told = [found for _, found, _, _ in rows if found.interval is not None]
    held = [found.interval is None or found.interval[0] <= play <= found.interval[1] for play, found, _, _ in rows]
    print(f"  intervals hold the truth in {sum(held)} of {len(rows)}, a play came out of {len(told)}; verdicts where the map is: "
          + "; ".join(f"{name} {dict((w, n) for (kind, w), n in words.items() if kind is key)}"
                      for key, name in ((True, "chaotic"), (False, "regular"), (None, "either"))))  # fmt: skip
    if ratio:
        print(f"  measured exponent over the map's, {len(ratio)} levels: mean {np.mean(ratio):.3f}, scatter {np.std(ratio):.3f}")
    widths = [0.5 * (f.interval[1] - f.interval[0]) / p for p, f, *_ in rows if f.interval is not None]
    fits = [half for *_, half in rows if np.isfinite(half)]
    if widths and fits:
        print(
            f"  half width: exponents {100 * np.median(widths):.2g} %, fit {100 * np.median(fits):.2g} %: "
            f"{np.median(widths) / np.median(fits):.0f} times wider; {clock['series'] / (rigs * len(chosen)):.1f} s a series"
        )
    if options.fits:
        scaled = records[len(records) // 2]
        scaled = replace(scaled, channels=scaled.channels | {"z": GAIN * scaled.channels["z"]})
        fit = jb.fit(scaled, inertia=INERTIA, effects=["gravity"], starts=1)
        off = 100 * (fit.parameters["backlash"].value / play - 1.0)
        print(f"  z read {100 * (GAIN - 1):.0f} % too large: the fit's play is off by {off:+.2f} %, its rms over noise "
              f"{fit.score.rms:.1f}; the exponents do not change")  # fmt: skip


def draw(folder: Path, map_: ExponentMap, found: object, play: float, fit: object) -> None:
    """Levels on the map, and the likelihood of the play."""
    from jaxbacklash.plot.drawing import on_page

    folder.mkdir(parents=True, exist_ok=True)
    on_page(jb.plot.exponent_over_drive, map_, found).savefig(folder / "exponent_over_drive.png", dpi=150)
    ends = None if fit is None or fit.value is None else tuple(fit.ci95)
    on_page(jb.plot.play_likelihood, found, truth=play, fit=ends).savefig(folder / "play_likelihood.png", dpi=150)
    print(f"  written: {folder}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tiny", action="store_true", help="few imagined experiments, one rig of two short series")
    parser.add_argument("--rigs", type=int, default=10, help="rigs whose series are analysed")
    parser.add_argument("--fits", type=int, default=2, help="rigs that are also fitted")
    parser.add_argument("--experiments", type=int, default=400)
    parser.add_argument("--out", type=Path, help="folder for the figures")
    options = parser.parse_args()
    if options.tiny:
        options.fits = 0
    jb.start(brief=options.tiny)
    twin = Twin()
    begun = time.perf_counter()
    map_ = map_of(twin, options.tiny)
    print(f"{twin}: map of {map_.exponent.size} motions in {time.perf_counter() - begun:.1f} s")
    imagined(map_, twin, options)
    print(f"rigs simulated without the package, series of {SECONDS:.0f} s at {RATE:.0f} Hz, noise {100 * NOISE:.0f} %")
    measured(map_, options)


if __name__ == "__main__":
    main()
