"""Friction that gives before it slips: is it named, alone, on rigs, strengths, rates and noise drawn anew?

    python -m benchmarks.hysteresis_recovery [--seed 1] [--only 0 3 7] [--duration 20] [--tiny] [--out FILE.json]

Twelve records a seed, four each of Dahl, LuGre and Bouc-Wen, any of which counts for the others, from a sixth of a usual strength
to twice. One hides gravity as well, one an asymmetric gap; two have ten times the noise; rates are 250, 500 and 1000 Hz. The
simulation is the non-smooth one of `tests.independent`. It needs numba.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.effect_recovery import EXCITATIONS, SIGMA, Case, judge, table
from jaxbacklash.criticism.refine import refine
from jaxbacklash.program import start
from jaxbacklash.records import Record
from tests.independent.generator import make_effects, make_excitation, make_rig, measure, simulate_truth

FAMILY = ("dahl", "lugre", "bouc_wen")
TORQUES = ("sigma", "Fc", "sigma0", "sigma1", "Fs")
BESIDE = {4: ("gravity",), 6: ("asymmetric_gap",)}
NOISY = (5, 9)
RATES = (500.0, 250.0, 500.0, 1000.0)  # Hz
RECORDS = 12


def make_record(seed: int, number: int, duration: float, share: float = 1.0) -> Case:
    """Record ``number`` of a seed: the law in turn, the strength ``share`` of one between a sixth of the usual and twice that."""
    rng = np.random.default_rng((9000, seed, number))
    law = FAMILY[number % len(FAMILY)]
    rig, values = make_rig(rng), make_effects(rng, law, *BESIDE.get(number, ()))
    strength = share * float(np.exp(rng.uniform(np.log(1.0 / 6.0), np.log(2.0))))
    values[law] = {n: v * strength if n in TORQUES else v for n, v in values[law].items()}
    kind = EXCITATIONS[int(rng.integers(len(EXCITATIONS)))]
    truth = simulate_truth(rig, values, make_excitation(rng, kind, duration), RATES[number % len(RATES)], duration)
    sigma = SIGMA * (10.0 if number in NOISY else 1.0)
    seen = measure(truth, rng, sigma, sigma, 3.0 * sigma if number % 4 == 3 else None)
    return Case(number, tuple(values), rig, values, Record(seen["t"], {"x": seen["x"], "z": seen["z"]}), kind)


def main() -> None:
    """Run, print, and keep what was found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--duration", type=float, default=20.0)
    parser.add_argument("--only", type=int, nargs="*", default=None)
    parser.add_argument("--tiny", action="store_true", help="one short record, of friction too weak to be seen")
    parser.add_argument("--out", type=Path, default=None)
    options = parser.parse_args()
    start(brief=options.tiny)
    rows: list[dict[str, Any]] = []
    # Where the search tries laws with memory, each compiles a program of its own; of the tiny record only the true one does, and
    # its other programs are those of `benchmarks.effect_recovery --tiny`.
    duration, share = (8.0, 1e-3) if options.tiny else (options.duration, 1.0)
    for number in [2] if options.tiny else options.only or range(RECORDS):
        case = make_record(options.seed, number, duration, share)
        begin = time.perf_counter()
        found = refine(case.record, inertia=case.rig.inertia)
        rows.append(judge(case, found, time.perf_counter() - begin))
        level = case.values[FAMILY[number % len(FAMILY)]]["Fc"]
        words = f"{number} {'+'.join(case.hidden)} ({level:.2g} N m, {case.kind}) -> {'+'.join(found.effects) or 'nothing'}"
        print(words, found.verdict.word, f"{rows[-1]['seconds']:.1f} s", flush=True)
    print(f"\nseed {options.seed}, {options.duration:g} s\n{table(rows)}")
    if options.out is not None:
        options.out.write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
