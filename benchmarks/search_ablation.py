"""What each number of the search is worth: halved, doubled and switched off, on records whose hidden effects are known.

    python -m benchmarks.search_ablation [--only SCATTER CLOSE] [--records 12] [--noise 1 10] [--work DIR] [--tiny]

Records are every few of those of `benchmarks.effect_recovery`, so that each kind of effect is among them, and as many of
`benchmarks.effect_strangers`. For each number the table says which records are named otherwise than with the number as it is, how
many of these became right and wrong, and how the time changed. A number whose row changes nothing has no place in the search.
Every answer is a line of a file in --work, so that a killed run goes on where it was. It needs numba.
"""

from __future__ import annotations

import argparse
import importlib
import json
import pkgutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import jaxbacklash
from benchmarks import effect_recovery, effect_strangers
from jaxbacklash.criticism.refine import refine
from jaxbacklash.fitting import settings
from jaxbacklash.program import start

SEED = 61


OFF = {
    "MOST_LAWS": 99, "MOST_FITTED": 99, "MOST_STEPS": 10**6, "CLEAR_SHARE": 0.0, "PROMISING": 0.0, "CLOSE": 0.0, "SCATTER": 0.0,
    "MEASURING": 0.0, "SEEN": 0.0, "LOOSE": 1e3, "FALLEN": 1e9, "WITHIN_CHANCE": 0.0, "SOFT": 1e-9, "STABLE": 1e9,
}  # fmt: skip
"""Values at which a rule does nothing, of the numbers that have one."""


def numbers() -> list[str]:
    """Every number of `jaxbacklash.fitting.settings`.

    Numbers that compiled programs hold (steps of the least-squares search, lengths of windows) are not among them: each value
    would compile all programs anew. `benchmarks.least_squares` and `benchmarks.fit_speed` measure those.
    """
    return [name for name in vars(settings) if name.isupper()]


def other_values(name: str) -> list[tuple[str, float]]:
    """Other values of a number to try, by what they are called."""
    value = getattr(settings, name)
    kind = type(value)
    found = [("halved", kind(value / 2)), ("doubled", kind(value * 2))]
    return [*found, ("off", OFF[name])] if name in OFF else found


@contextmanager
def changed(name: str, value: float) -> Iterator[None]:
    """The number has another value in every module that knows it, for as long as this lasts."""
    stated = getattr(settings, name)
    names = [f"jaxbacklash.{m.name}" for p in ("criticism", "fitting") for m in pkgutil.iter_modules(_path(p), f"{p}.")]
    holders = [m for m in map(importlib.import_module, names) if getattr(m, name, None) is stated]
    for module in holders:
        setattr(module, name, value)
    try:
        yield
    finally:
        for module in holders:
            setattr(module, name, stated)


def _path(package: str) -> list[str]:
    return [str(Path(folder) / package) for folder in jaxbacklash.__path__]


def cases(records: int, noises: list[float], duration: float = 20.0) -> Iterator[tuple[str, Any]]:
    """Records by what they are called: laboratory ones that go through all sets, and strangers."""
    sets = len(effect_recovery.SETS)
    for noise in noises:
        for k in range(records):
            number = k * sets // records
            yield f"laboratory {number} x{noise:g}", effect_recovery.make_case(number, noise, duration)
            yield f"stranger {k} x{noise:g}", effect_strangers.make_case(k, noise, SEED)


def answers(work: Path, setting: str, records: list[tuple[str, Any]]) -> dict[str, dict[str, Any]]:
    """What `refine` says of each record, with the setting that is in force; those asked before come from their file."""
    path = work / f"{setting.replace(' ', '-')}.jsonl"
    known = {r["record"]: r for r in map(json.loads, path.read_text(encoding="utf-8").splitlines())} if path.exists() else {}
    for name, case in records:
        if name in known:
            continue
        begin = time.perf_counter()
        found = refine(case.record, inertia=case.rig.inertia)
        row = {
            "record": name, "found": sorted(found.effects), "complete": found.verdict.complete,
            "right": effect_recovery.is_right(case, found), "seconds": time.perf_counter() - begin,
        }  # fmt: skip
        known[name] = row
        with path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")
    return {name: known[name] for name, _ in records}


def compared(setting: str, before: dict[str, dict[str, Any]], after: dict[str, dict[str, Any]]) -> str:
    """A row of the table."""
    other = [n for n in before if (before[n]["found"], before[n]["complete"]) != (after[n]["found"], after[n]["complete"])]
    won = sum(after[n]["right"] and not before[n]["right"] for n in other)
    lost = sum(before[n]["right"] and not after[n]["right"] for n in other)
    ratio = sum(r["seconds"] for r in after.values()) / sum(r["seconds"] for r in before.values())
    which = ", ".join(other[:3]) + (", ..." if len(other) > 3 else "")
    return f"| {setting} | {len(other)} | {won} | {lost} | {ratio:.2f} | {which or '-'} |"


def main() -> None:
    """Run, and print the table as far as it has come."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="*", default=None, help="names of numbers")
    parser.add_argument("--records", type=int, default=12, help="of the laboratory, and as many strangers, at each noise")
    parser.add_argument("--noise", type=float, nargs="+", default=[1.0, 10.0])
    parser.add_argument("--work", type=Path, default=None)
    parser.add_argument("--tiny", action="store_true", help="one number on one record")
    options = parser.parse_args()
    start(brief=options.tiny)
    asked = [n for n in numbers() if options.only is None or n in options.only]
    with tempfile.TemporaryDirectory() as folder:
        work = options.work or Path(folder)
        work.mkdir(parents=True, exist_ok=True)
        if options.tiny:  # the record of `benchmarks.effect_recovery --tiny`
            asked, some = ["CLOSE"], [next(cases(1, [1.0], 8.0))]
        else:
            some = list(cases(options.records, options.noise))
        as_it_is = answers(work, "as it is", some)
        print(f"{len(some)} records, {sum(r['right'] for r in as_it_is.values())} right with all numbers as they are")
        print("| number | otherwise named | became right | became wrong | time | which |\n|---|---|---|---|---|---|", flush=True)
        for name in asked:
            for called, value in other_values(name)[-1:] if options.tiny else other_values(name):
                setting = f"{name} {called} ({value:g})"
                with changed(name, value):
                    print(compared(setting, as_it_is, answers(work, setting, some)), flush=True)


if __name__ == "__main__":
    main()
