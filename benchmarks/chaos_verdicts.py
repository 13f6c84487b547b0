"""How often is a series called chaotic that is not, and how often is chaos missed?

    python -m benchmarks.chaos_verdicts [--tiny] [--realisations 200] [--samples 5000] [--only NAME ...] [--keep FILE]

First the signals the verdict's rules were made with, then others that were held back and never looked at while they were
made. Chaotic series carry 2 % noise. With 200 realisations a rate of 2 % has a standard deviation of 1 %. The whole table takes
hours: with ``--keep`` each verdict is written down as it is found, all rows advance together, the table of what is there is
printed after each block, and the same command goes on where it was stopped.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jaxbacklash import chaos
from tests.independent.chaotic import HELD_BACK, KNOWN, NOT_CHAOTIC, NOT_CHAOTIC_HELD_BACK, case_1, with_noise

WORDS = ("chaotic", "regular", "stochastic", "undecided")
BLOCK = 10  # realisations of a row before the next row has its turn


@dataclass(frozen=True)
class Row:
    """A line of the table: ``title`` of its group, ``name``, and ``make(samples, realisations)`` of its series."""

    title: str
    name: str
    make: Callable[[int, int], np.ndarray]


def rows() -> list[Row]:
    """All lines, in the order of the table."""
    quiet = "not chaotic"
    found = [Row(quiet, name, lambda n, r, make=make: make(n, r, 3)) for name, make in NOT_CHAOTIC.items()]
    noisy = "chaotic, 2 % noise"
    for title, systems in ((noisy, [*KNOWN, case_1(2.0)]), (noisy + ", held back", HELD_BACK)):
        found += [Row(title, s.name, lambda n, r, s=s: with_noise(s.series(n, r, 4), 0.02, 4)) for s in systems]
    held = NOT_CHAOTIC_HELD_BACK.items()
    return found + [Row(quiet + ", held back", name, lambda n, r, make=make: make(n, r, 3)) for name, make in held]


def word(series: np.ndarray, number: int) -> str:
    """The verdict; noise reduction is left out, since no verdict rests on it."""
    return chaos(series, clean=False, seed=number).verdict.word


def table(lines: list[Row], found: dict[tuple[str, int], str]) -> None:
    """Print what was found so far, with the number of realisations it rests on."""
    title = ""
    for line in lines:
        counted = Counter(one for (name, _), one in found.items() if name == line.name)
        total = sum(counted.values())
        if not total:
            continue
        if line.title != title:
            title = line.title
            print(title)
        print(f"  {line.name:<32}{total:5d}" + "".join(f"{100.0 * counted[one] / total:11.1f}" for one in WORDS), flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tiny", action="store_true", help="one realisation of few signals")
    parser.add_argument("--realisations", type=int, default=200)
    parser.add_argument("--samples", type=int, default=5000)
    parser.add_argument("--only", nargs="+", default=[""], help="rows whose name contains one of these")
    parser.add_argument("--keep", type=Path, help="verdicts are written here one by one, and not found again")
    asked = parser.parse_args()
    realisations, samples = (1, 1500) if asked.tiny else (asked.realisations, asked.samples)
    lines = [line for line in rows() if any(part in line.name for part in asked.only)]
    lines = [lines[0], lines[3]] if asked.tiny else lines
    found: dict[tuple[str, int], str] = {}
    if asked.keep and asked.keep.exists():
        kept = [json.loads(text) for text in asked.keep.read_text().splitlines()]
        found = {(one["name"], one["number"]): one["word"] for one in kept if one["samples"] == samples}
    print(f"{samples} samples a series; verdicts in per cent\n{'':<34}{'n':>5}" + "".join(f"{one:>11}" for one in WORDS))
    made: dict[str, np.ndarray] = {}
    for first in range(0, realisations, BLOCK):
        for line in lines:
            for number in range(first, min(first + BLOCK, realisations)):
                if (line.name, number) in found:
                    continue
                if line.name not in made:
                    made[line.name] = line.make(samples, realisations)
                found[line.name, number] = said = word(made[line.name][number], number)
                if asked.keep:
                    one = {"name": line.name, "number": number, "samples": samples, "word": said}
                    with asked.keep.open("a") as file:
                        file.write(json.dumps(one) + "\n")
        if asked.keep and first + BLOCK < realisations:
            print(f"after {first + BLOCK}:")
            table(lines, found)
    table(lines, found)


if __name__ == "__main__":
    main()
