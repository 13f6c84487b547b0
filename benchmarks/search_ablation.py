"""What each rule of the search for missing effects is worth: each is switched off by itself, on records whose answer is known.

    python -m benchmarks.search_ablation [--records 3] [--all] [--noise 1 10] [--seed 58] [--rule NAME ...] [--side-by-side 2]
                                         [--work DIR] [--table benchmarks/search_ablation.md] [--tiny]

The rules are those of `benchmarks.search_rules`. The records are of the laboratory (`benchmarks.effect_recovery`) and of
strangers (`benchmarks.effect_strangers`), --records of each at each noise, drawn once for all so that more of them hold those of
fewer; two at a time on two cores the default is meant for about an hour.

Each record is searched with all rules on, twice: once so that every program is at hand, and once to see what it says, which rules
act on it, and how long each takes. A rule that is never asked on a record, or always answers what its stand-in would have
answered and has no model fitted, cannot change the record, so that only rules that act are switched off; a search without one of
them ends after three times as many fits as with all. A record is changed where other effects are named, the verdict is another,
or an error, on the record or on the held-out one, differs by more than 1 %. It is worse where a right answer becomes wrong or,
if that stays as it is, where the error on the held-out record is larger by more than 1 %; better the other way round. Seconds are
summed over records: saved where the rule acts, and spent in it wherever it is asked; with several records at a time they say
less, and a search that asks for another program without a rule waits for the compiler once.

Every answer is a JSON file in --work, so that a killed run goes on where it was; what it holds is of one state of the package.
It needs numba.
"""

from __future__ import annotations

import argparse
import json
import math
import multiprocessing
import re
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import effect_recovery, effect_strangers
from benchmarks.effect_recovery import Case, is_right
from benchmarks.search_rules import RULES
from benchmarks.search_switches import Rule, counted, replaced
from jaxbacklash.criticism.refine import refine
from jaxbacklash.program import start

WHERE = {"laboratory": len(effect_recovery.SETS), "strangers": 72}
"""How many records there are of each kind."""
DURATION = 20.0  # s, of a record of the laboratory
ALIKE = 0.01
"""Errors that differ by a larger share are not the same."""
MANY, MORE = 3, 20
"""A search without a rule may make so many times the fits of that with all, and some more."""
FITS = Rule("fits", "criticism.workbench:Workbench._count", None, "counts the fits of a search")
TINY = ("few refitted", "unnamed torque")


def drawn(count: int) -> list[tuple[str, int]]:
    """So many records of each kind, by kind and number, in an order that is always the same."""
    order = {kind: np.random.default_rng(58).permutation(most) for kind, most in WHERE.items()}
    return [(kind, int(number)) for kind, numbers in order.items() for number in numbers[:count]]


def make_case(kind: str, number: int, noise: float, seed: int, duration: float = DURATION) -> Case:
    """A record with its answer."""
    if kind == "laboratory":
        return effect_recovery.make_case(number, noise, duration)
    return effect_strangers.make_case(number, noise, seed)


def answer(case: Case) -> dict[str, Any]:
    """What a search says of a record."""
    begun = time.perf_counter()
    found = refine(case.record, heldout=case.heldout, inertia=case.rig.inertia)
    last = found.fit
    return {
        "found": list(found.effects), "verdict": found.verdict.word, "right": is_right(case, found), "misfit": last.score.rms,
        "held": None if last.heldout is None else last.heldout.rms, "alternatives": [list(a) for a in found.alternatives],
        "seconds": time.perf_counter() - begun,
    }  # fmt: skip


def with_all(case: Case) -> dict[str, Any]:
    """The answer with all rules on, ``repeats`` whether it is the same twice, and what of each rule that run has seen."""
    first = answer(case)
    with counted((*RULES, FITS)) as tallies:
        row = answer(case)
    fits = tallies.pop(FITS.name).calls
    rules = {name: {"acted": t.acted, "seconds": t.seconds} for name, t in tallies.items()}
    return row | {"hidden": list(case.hidden), "fits": fits, "repeats": not changed(first, row), "rules": rules}


def without(case: Case, rule: Rule, fits: int) -> dict[str, Any]:
    """The answer with one rule off, of a search that may make some times the ``fits`` of that with all rules."""
    begun = time.perf_counter()
    with replaced("criticism.workbench:MOST_FITS", MANY * fits + MORE), replaced(rule.at, rule.instead):
        try:
            return answer(case)
        except Exception as error:  # a search that was never without this rule may end in any way
            return {"failed": f"{type(error).__name__}: {error}"[:200], "right": False, "seconds": time.perf_counter() - begun}


def ablated(job: tuple[str, int, float], work: Path, names: Sequence[str], seed: int, duration: float) -> dict[str, Any]:
    """One record with all rules on, and with each of those named off that acts on it; from files what was found before."""
    kind, number, noise = job
    folder = work / f"{kind}-seed{seed}-x{noise:g}-{duration:g}s" / f"{number:03d}"
    case = make_case(kind, number, noise, seed, duration)
    told = f"{kind} x{noise:g} {number}"
    whole = folder / "all-rules.json"
    if whole.exists() and not set(names) <= set(json.loads(whole.read_text(encoding="utf-8"))["rules"]):
        whole.unlink()  # of an earlier table of rules
    fresh = not whole.exists()
    row = kept(whole, lambda: with_all(case))
    acting = [rule for rule in RULES if rule.name in names and row["rules"][rule.name]["acted"]]
    if fresh:
        print(f"{told}: {said(row)}; {len(acting)} of {len(names)} rules act", flush=True)
    elif not all(file_of(folder, rule).exists() for rule in acting):
        answer(case)  # so that no rule is charged for reading programs
    off = {}
    for rule in acting:
        new = not file_of(folder, rule).exists()
        off[rule.name] = kept(file_of(folder, rule), partial(without, case, rule, row["fits"]))
        if new and changed(row, off[rule.name]):
            print(f"{told} without '{rule.name}': {said(off[rule.name])}", flush=True)
    return row | {"record": told, "off": off}


def file_of(folder: Path, rule: Rule) -> Path:
    """Where the answer without a rule is kept."""
    return folder / f"{re.sub('[^a-z0-9]+', '-', rule.name.lower())}.json"


def kept(path: Path, make: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """What is in a file, made and written where there is none."""
    if path.exists():
        return dict(json.loads(path.read_text(encoding="utf-8")))
    row = make()
    path.parent.mkdir(parents=True, exist_ok=True)
    half = path.with_suffix(".part")
    half.write_text(json.dumps(row, indent=1), encoding="utf-8")
    half.replace(path)
    return row


def said(row: dict[str, Any]) -> str:
    """An answer in a few words."""
    if "failed" in row:
        return f"failed ({row['failed']})"
    held = "" if row["held"] is None else f", held out {row['held']:.3f}"
    named = "+".join(row["found"]) or "nothing"
    right = "right" if row["right"] else "wrong"
    return f"{named} ({row['verdict']}, {right}), error {row['misfit']:.3f}{held}, {row['seconds']:.1f} s"


def changed(whole: dict[str, Any], off: dict[str, Any]) -> bool:
    """Whether an answer is another: names, verdict, or an error."""
    if "failed" in off or any(whole[key] != off[key] for key in ("found", "verdict")):
        return True
    return any(apart(whole[key], off[key]) for key in ("misfit", "held"))


def apart(one: float | None, other: float | None) -> int:
    """The sign of how far the ``other`` error is above the ``one``, 0 where they are alike."""
    if one is None or other is None or math.isclose(one, other, rel_tol=ALIKE):
        return 0
    return 1 if other > one or math.isnan(other) else -1


def worse(whole: dict[str, Any], off: dict[str, Any]) -> int:
    """1 where an answer is worse without a rule, -1 where it is better, 0 where neither."""
    if whole["right"] != off["right"]:
        return 1 if whole["right"] else -1
    return 1 if "failed" in off else apart(whole["held"], off["held"])


def table(rows: Sequence[dict[str, Any]], rules: Iterable[Rule]) -> str:
    """The rules in a table in Markdown, those that make most difference first, and below it each record that changes."""
    lines = [
        "| rule | acted on | changed | worse | better | seconds saved | seconds in it | what it is for |",
        "|---|--:|--:|--:|--:|--:|--:|---|",
    ]
    counts = {}
    for rule in rules:
        pairs = [(row, row["off"][rule.name]) for row in rows if rule.name in row["off"]]
        signs = [worse(*pair) for pair in pairs if changed(*pair)]
        saved = sum(row["seconds"] - off["seconds"] for row, off in pairs)
        spent = sum(row["rules"][rule.name]["seconds"] for row in rows)
        counts[rule] = len(pairs), len(signs), signs.count(1), signs.count(-1), saved, spent
    for rule, (acted, *told, saved, spent) in sorted(counts.items(), key=lambda one: (-one[1][2], -one[1][1], -one[1][0])):
        cells = [acted, *told, f"{saved:+.0f}"] if acted else ["did not act", "", "", "", ""]
        lines.append(f"| {' | '.join(map(str, [rule.name, *cells, f'{spent:.1f}', rule.why]))} |")
    lines.append("")
    for row in rows:
        others = {name: off for name, off in row["off"].items() if changed(row, off)}
        again = "" if row["repeats"] else "; a second run of the same search ended otherwise"
        lines += [f"* {row['record']}, hidden {'+'.join(row['hidden']) or 'nothing'}: {said(row)}{again}"]
        lines += [f"  * without *{name}*: {said(off)}" for name, off in others.items()]
    return "\n".join(lines)


def main() -> None:
    """Run, print, and keep the table where it is wanted."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--records", type=int, default=3, help="of each kind at each noise")
    parser.add_argument("--all", action="store_true", help="every record of both kinds")
    parser.add_argument("--noise", type=float, nargs="+", default=[1.0, 10.0])
    parser.add_argument("--seed", type=int, default=58, help="of the strangers")
    parser.add_argument("--rule", nargs="+", default=None, choices=[rule.name for rule in RULES], metavar="NAME")
    parser.add_argument("--side-by-side", type=int, default=2, help="records at a time")
    parser.add_argument("--work", type=Path, default=None, help="where answers are kept")
    parser.add_argument("--table", type=Path, default=None, help="a Markdown file to write")
    parser.add_argument("--tiny", action="store_true", help="one short record and two rules")
    options = parser.parse_args()
    names = options.rule or (TINY if options.tiny else [rule.name for rule in RULES])
    rules = [rule for rule in RULES if rule.name in names]
    count = max(WHERE.values()) if options.all else options.records
    jobs = [(kind, number, noise) for noise in options.noise for kind, number in drawn(count)]
    if options.tiny:
        jobs = [("laboratory", 0, 1.0)]
    with tempfile.TemporaryDirectory() as folder:
        work = options.work or Path(folder)
        if options.tiny:
            start(brief=True)
            rows = [ablated(jobs[0], work, names, options.seed, 6.0)]
        else:
            one = partial(ablated, work=work, names=names, seed=options.seed, duration=DURATION)
            spawn = multiprocessing.get_context("spawn")
            # Every record a process of its own: compiled programs of many lengths and rates do not pile up.
            with spawn.Pool(options.side_by_side, partial(start, brief=True), maxtasksperchild=1) as pool:
                rows = list(pool.imap(one, jobs, chunksize=1))
    sizes = Counter(f"{kind} x{noise:g}" for kind, _, noise in jobs)
    sample = "Records: " + ", ".join(f"{size} of {name}" for name, size in sizes.items())
    right = sum(row["right"] for row in rows)
    head = f"{sample}; with all rules {right} are right, in {sum(row['seconds'] for row in rows):.0f} s"
    title = "# Rules of the search, each switched off by itself"
    text = f"{title}\n\n{head}. Made by `benchmarks.search_ablation`.\n\n{table(rows, rules)}\n"
    print(f"\n{text}", flush=True)
    if options.table is not None:
        options.table.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
