"""Draw cases, run them, print the failures and a table by kind."""

from __future__ import annotations

import argparse
import collections
import shutil
import tempfile
from pathlib import Path

from tests.fuzz.draw import case_of, plan
from tests.fuzz.run import Worker, alone
from tests.fuzz.verdict import judge, snapshot
from tests.odd_files.paste import shell


def main() -> None:
    """Run as the options say."""
    words = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    words.add_argument("--count", type=int, default=500, help="how many cases")
    words.add_argument("--seed", type=int, default=0, help="seed of the draw")
    words.add_argument("--kind", default="", help="only kinds or doors whose name has this in it")
    words.add_argument("--first", type=int, default=0, help="place in the plan to begin at")
    told = words.parse_args()
    worker = Worker()
    spent: dict[str, float] = collections.defaultdict(float)
    table: dict[str, collections.Counter[str]] = collections.defaultdict(collections.Counter)
    for index, kind in enumerate(plan(told.count, told.seed)):
        if index < told.first or told.kind not in f"{kind.door} {kind.name}":
            continue
        folder = Path(tempfile.mkdtemp(prefix="fuzz-case-"))
        try:
            case = case_of(kind, index, told.seed, folder)
            before = snapshot(folder)
            run = alone(case, folder) if case.alone else worker(case, folder)
            verdict = judge(case, run, before, snapshot(folder), folder)
        finally:
            shutil.rmtree(folder, ignore_errors=True)
        spent[kind.door] += run.seconds
        table[f"{kind.door}: {kind.name}"]["failed" if verdict.failed else f"exit {run.code}"] += 1
        if verdict.failed:
            last = (run.err.strip().splitlines() or [""])[-1]
            print(
                f"{index} {kind.door}: {kind.name}  exit {run.code}, {run.seconds:.1f} s\n    {shell(case.words)[:300]}",
                flush=True,
            )
            print("".join(f"    {complaint}\n" for complaint in verdict.complaints) + f"    stderr: {last[:300]}", flush=True)
    worker.close()
    for name in sorted(table):
        print(f"{name:60s} " + ", ".join(f"{what} {count}" for what, count in sorted(table[name].items())))
    print("seconds:", ", ".join(f"{door} {seconds:.0f}" for door, seconds in sorted(spent.items())))
    print(
        "failed:",
        sum(counts["failed"] for counts in table.values()),
        "of",
        sum(sum(counts.values()) for counts in table.values()),
    )


if __name__ == "__main__":
    main()
