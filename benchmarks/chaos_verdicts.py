"""How often is a series called chaotic that is not, and how often is chaos missed?

    python -m benchmarks.chaos_verdicts [--tiny] [--realisations 200] [--samples 5000] [--only NAME]

First the signals the verdict's rules were made with, then others that were held back and never looked at while they were
made. Chaotic series carry 2 % noise. With 200 realisations a rate of 2 % has a standard deviation of 1 %.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter

import numpy as np

from jaxbacklash import chaos
from tests.independent.chaotic import HELD_BACK, KNOWN, NOT_CHAOTIC, NOT_CHAOTIC_HELD_BACK, case_1, with_noise

WORDS = ("chaotic", "regular", "stochastic", "undecided")


def count(series: np.ndarray) -> Counter[str]:
    """Verdicts over realisations (R, N); noise reduction is left out, since no verdict rests on it."""
    return Counter(chaos(one, clean=False, seed=number).verdict.word for number, one in enumerate(series))


def row(name: str, series: np.ndarray) -> Counter[str]:
    """Print one line of the table."""
    begun = time.perf_counter()
    found = count(series)
    shares = "".join(f"{100.0 * found[word] / len(series):11.1f}" for word in WORDS)
    print(f"{name:<34}{len(series):5d}{shares}{(time.perf_counter() - begun) / len(series):9.2f}", flush=True)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tiny", action="store_true", help="one realisation of few signals")
    parser.add_argument("--realisations", type=int, default=200)
    parser.add_argument("--samples", type=int, default=5000)
    parser.add_argument("--only", default="", help="rows whose name contains this")
    asked = parser.parse_args()
    realisations, samples = (1, 1500) if asked.tiny else (asked.realisations, asked.samples)
    print(f"{samples} samples a series; verdicts in per cent, seconds a series")
    print(f"{'':<34}{'n':>5}" + "".join(f"{word:>11}" for word in WORDS) + f"{'s':>9}")
    for title, signals in (("not chaotic", NOT_CHAOTIC), ("not chaotic, held back", NOT_CHAOTIC_HELD_BACK)):
        print(title)
        for name, make in list(signals.items())[: 1 if asked.tiny else None]:
            if asked.only in name:
                row("  " + name, make(samples, realisations, 3))
    print("chaotic, 2 % noise; those after CASE 1 were held back")
    for system in [*KNOWN, case_1(2.0), *HELD_BACK][: 1 if asked.tiny else None]:
        if asked.only in system.name:
            row("  " + system.name, with_noise(system.series(samples, realisations, 4), 0.02, 4))


if __name__ == "__main__":
    main()
