"""The table of odd files: kind, what was found, and behind failures the command and what it said."""

from __future__ import annotations

import argparse
import collections
import tempfile
from pathlib import Path

import jaxbacklash as jb
from tests.odd_files.draw import draft_of, plan
from tests.odd_files.judge import Verdict, judge


def main() -> None:
    """Draw, judge, print."""
    words = argparse.ArgumentParser(prog="python -m tests.odd_files", description=__doc__)
    words.add_argument("--count", type=int, default=150, help="how many files")
    words.add_argument("--seed", type=int, default=0, help="seed of the draw")
    words.add_argument("--full", action="store_true", help="fit every file instead of reading it")
    words.add_argument("--kind", default="", help="only files of a kind whose name has this in it")
    words.add_argument("--keep", type=Path, default=None, help="folder to leave the files in")
    told = words.parse_args()
    jb.start()
    found: collections.Counter[str] = collections.Counter()
    with tempfile.TemporaryDirectory() as scratch:
        for index, kinds in enumerate(plan(told.count, told.seed)):
            if told.kind not in " ".join(each.name for each in kinds):
                continue
            draft = draft_of(kinds, index, told.seed)
            folder = (told.keep or Path(scratch)) / f"{index:03d}"
            folder.mkdir(parents=True, exist_ok=True)
            verdict = judge(draft, folder, told.full)
            found[verdict.found] += 1
            _print(index, " + ".join(draft.kinds), draft.right, verdict)
    print(", ".join(f"{name}: {times}" for name, times in found.most_common()))


def _print(index: int, kinds: str, right: str, verdict: Verdict) -> None:
    print(f"{index:4d}  {verdict.found:8s} (right: {right:7s}) {kinds}", flush=True)
    if verdict.failed:
        print(f"      {verdict.command}\n      {verdict.detail}", flush=True)


if __name__ == "__main__":
    main()
