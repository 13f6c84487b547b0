"""Which effects are found on joints unlike the laboratory's: any size, rate, noise and encoder, strengths from barely visible.

    python -m benchmarks.effect_strangers [--records 72] [--noise 1 10 30] [--seed 1] [--set rigs] [--only 3 8] [--work DIR]

A twelfth of the records hides something outside the catalogue, a sixth nothing, the rest one effect, two or three, drawn at
random; see `tests.independent.strangers`. The simulation is non-smooth and shares nothing with the package. As in
`benchmarks.effect_recovery` a set is identifiable when every effect in it is more than 6 standard errors strong in a fit of the
true model, and a second record of each joint, under another excitation, is only predicted. Every answer is a JSON file in
--work, so that a killed run goes on where it was. It needs numba.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import tempfile
import time
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.effect_recovery import EXCITATIONS, RIG_SINGLES, SINGLES, TODAY, Case, judge, named_today, table
from jaxbacklash.criticism.refine import refine
from jaxbacklash.program import start
from jaxbacklash.records import Record
from tests.independent.rigs import OUTSIDE_CATALOGUE
from tests.independent.strangers import RUBBING, make_stranger

# Of twelve records: how many effects each hides, None for one outside the catalogue.
HIDES = (1, 2, 0, 1, 3, 1, 2, 0, 1, None, 2, 1)


# What is drawn from, and which of it every record of that set has at least one of.
DRAWN: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "laboratory": (SINGLES, SINGLES), "rigs": (SINGLES + RIG_SINGLES, RIG_SINGLES),
}  # fmt: skip
BEGIN = {"laboratory": 41, "rigs": 59}
USUAL = 2071
"""A record of 10 s at 500 Hz that hides nothing: its programs are those of the laboratory's records."""


def hidden_set(rng, count: int | None, alone: int, of: str = "laboratory") -> tuple[str, ...]:
    """Names of what a record hides; single effects go through the catalogue by turns, only one law of friction in the joint.

    No two that are one by definition: a preload beside a spring in the gap only moves the place where that spring rests.
    """
    if count is None:
        return (str(rng.choice([n for n in OUTSIDE_CATALOGUE if of == "laboratory" or n not in TODAY])),)
    drawn, wanted = DRAWN[of]
    if count == 1:
        return (wanted[alone % len(wanted)],)
    while True:
        names = tuple(str(n) for n in rng.choice(drawn, count, replace=False))
        laws = {n.partition(":")[0] for n in names}
        one_of_each = len(laws) == len(names) and not {"gap_spring", "preload"} <= laws
        if sum(n in RUBBING for n in names) <= 1 and one_of_each and (not count or set(names) & set(wanted)):
            return names


def make_case(number: int, noise: float, seed: int, of: str = "laboratory") -> Case:
    """Record ``number`` of a set: the same joint and motion at every noise."""
    rng = np.random.default_rng([seed, BEGIN[of], number])
    count = HIDES[number % len(HIDES)]
    alone = sum(h == 1 for h in HIDES) * (number // len(HIDES)) + sum(h == 1 for h in HIDES[: number % len(HIDES)])
    hidden = hidden_set(rng, count, alone + 4 * seed, of)
    which = int(rng.integers(len(EXCITATIONS)))
    made = make_stranger(rng, hidden, (EXCITATIONS[which], EXCITATIONS[(which + 1) % len(EXCITATIONS)]), noise)
    # Some of these joints move further than any that is believed without being told the unit.
    record, heldout = (Record(r["t"], {n: r[n] for n in "xz"}, confirmed=frozenset("txz")) for r in (made.seen, made.again))
    known = named_today(made.values)
    return Case(number, tuple(known), made.rig, known, record, made.kind, heldout)


def answered(work: Path, number: int, noise: float, seed: int, of: str) -> dict[str, Any]:
    """What was found in one record, from its file if it was found before."""
    path = work / f"{'' if of == 'laboratory' else of + '-'}seed{seed}-x{noise:g}" / f"{number:03d}.json"
    if path.exists():
        return dict(json.loads(path.read_text(encoding="utf-8")))
    case = make_case(number, noise, seed, of)
    begin = time.perf_counter()
    found = refine(case.record, heldout=case.heldout, inertia=case.rig.inertia)
    row = judge(case, found, time.perf_counter() - begin)
    row |= {"rate": case.record.rate_hz, "samples": case.record.samples, "values": case.values}
    path.parent.mkdir(parents=True, exist_ok=True)
    half = path.with_suffix(".part")
    half.write_text(json.dumps(row, indent=1), encoding="utf-8")
    half.replace(path)
    told = "+".join(row["hidden"]) or "nothing", "+".join(row["found"]) or "nothing"
    print(f"x{noise:g} {number} {told[0]} -> {told[1]} ({row['verdict']}), {row['seconds']:.1f} s", flush=True)
    return row


def main() -> None:
    """Run, print, and keep what was found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--records", type=int, default=72)
    parser.add_argument("--noise", type=float, nargs="+", default=[1.0, 10.0, 30.0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--set", choices=tuple(BEGIN), default="laboratory", dest="of")
    parser.add_argument("--only", type=int, nargs="*", default=None)
    parser.add_argument("--work", type=Path, default=None)
    parser.add_argument("--side-by-side", type=int, default=1, help="records at a time; seconds then say little")
    parser.add_argument("--tiny", action="store_true", help="one record")
    options = parser.parse_args()
    spawn = multiprocessing.get_context("spawn")
    numbers = [USUAL] if options.tiny else options.only if options.only is not None else range(options.records)
    with tempfile.TemporaryDirectory() as folder:
        for noise in options.noise[:1] if options.tiny else options.noise:
            # Every few records a process of its own: compiled programs of many lengths and rates do not pile up. (An executor
            # of `concurrent.futures` that replaces its processes can wait for ever: CPython issue 115634.)
            with spawn.Pool(options.side_by_side, partial(start, brief=True), maxtasksperchild=6) as pool:
                one = partial(answered, options.work or Path(folder), noise=noise, seed=options.seed, of=options.of)
                rows = list(pool.imap(one, numbers, chunksize=1))
            print(f"\nstrangers, noise x{noise:g}, seed {options.seed}\n{table(rows)}\n", flush=True)


if __name__ == "__main__":
    main()
