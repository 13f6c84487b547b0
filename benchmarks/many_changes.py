"""Is a growth of the play found among many records, and is none claimed where nothing grows?

    python -m benchmarks.many_changes [--tiny]

Records of 5 s at 200 Hz of one joint, made by a program that shares nothing with the package, are fitted by `fit_each`. From
record to record the play scatters by a hundredth, stiffness and damping by three, which no record's own error tells. Half of the
records have a play that is a tenth larger. From both halves series of 40 records are drawn: without a change, and with one in
the middle.
"""

from __future__ import annotations

import argparse

import numpy as np

import jaxbacklash as jb
from benchmarks.many_records import DAMPING, FINE, INERTIA, PLAY, SIGMA, STIFFNESS, follow
from jaxbacklash.many.change import find_change
from jaxbacklash.records import Record

LENGTH, GROWTH = 40, 0.1


def record_of(number: int, growth: float) -> Record:
    """A record of the joint on some day."""
    rng = np.random.default_rng([23, number])
    omega = 2.0 * np.pi * rng.uniform(0.5, 8.0, 6)
    amplitude = 0.3 * rng.uniform(0.5, 1.0, 6) / omega
    times = np.arange(1000) / 200.0
    day = 1.0 + np.array([0.01, 0.03, 0.03]) * rng.standard_normal(3)
    truth = np.array([PLAY * (1.0 + growth), STIFFNESS, DAMPING]) * day
    x, y = follow(times, amplitude, omega, rng.uniform(0.0, 6.28, 6), INERTIA, *map(float, truth), FINE)
    noise = SIGMA * rng.standard_normal((2, times.size))
    return Record(times, {"x": x + noise[0], "z": y - x + noise[1]}, path=f"day{number:03d}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tiny", action="store_true", help="few records and draws")
    given = parser.parse_args()
    size, draws = (LENGTH // 2, 5) if given.tiny else (120, 100)
    jb.start(brief=given.tiny)
    records = [record_of(k, GROWTH * (k >= size)) for k in range(2 * size)]
    # Two processes that begin together compile the same programs, each for itself.
    each = jb.fit_each(records, inertia=INERTIA, workers=1 if given.tiny else None)
    shown = [*range(LENGTH // 2), *range(size, size + LENGTH // 2)]
    print(jb.Each("fit", tuple(each.rows[k] for k in shown)))
    values, errors = each.numbers("backlash"), each.numbers("backlash", "stderr")
    rng = np.random.default_rng(0)
    found = claimed = placed = 0
    for draw in range(draws):
        half = LENGTH // 2
        before = rng.permutation(size)[: min(LENGTH, size)]
        after = size + rng.permutation(size)[:half]
        grown = np.concatenate([before[:half], after])
        change = find_change(values[grown], errors[grown] ** 2, draw)
        assert change is not None
        found += change.claimed
        placed += change.between[0] <= half <= change.between[1]
        none = find_change(values[before], errors[before] ** 2, draw)
        claimed += none is not None and none.claimed
    print(f"\n{draws} draws of {LENGTH} records whose play grows by {100 * GROWTH:.0f} % in the middle: found in {found},")
    print(f"  the middle within what is said of the place in {placed}")
    print(f"{draws} draws of {min(LENGTH, size)} records where nothing grows: a change claimed in {claimed}")


if __name__ == "__main__":
    main()
