"""Which effects are found on made-up records like measured ones that were published: named or said to be incomplete, and in time.

    python -m benchmarks.real_likeness [--kinds pendulum two_modes] [--records 6] [--seed 0] [--limit 120]
                                       [--out FILE.json] [--tiny]

The kinds are those of `tests.independent.likenesses`, whose simulation shares nothing with the package. A record is right when
exactly what hides in it was named, or the verdict is *incomplete*; what no catalogue holds must be incomplete. Errors of the
parameters of records that were named are in standard errors, and inside where the 95 % interval holds the truth. A search that
takes longer than --limit seconds is ended and counts as wrong, since it should end by itself. The seconds are those of the first
run in a process that has read or compiled the programs of that kind before: each kind begins with a record that is not counted,
unless --cold is given.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import time
import traceback
import warnings
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from jaxbacklash.criticism.refine import refine
from jaxbacklash.program import start
from tests.independent.likenesses import KINDS, make_likeness

IN_TIME = 30.0
"""Seconds in which an answer is wanted."""
SAME = {"coulomb_joint": "coulomb_ground", "lugre": "dahl", "bouc_wen": "dahl"}
"""Laws that are one where the base rests, and the family of friction that gives."""
UNCOUNTED = 999_999
"""Seed of the record with which a kind begins."""


def judged(kind: str, seed: int, size: float) -> dict[str, Any]:
    """What one record says about the method."""
    one = make_likeness(kind, seed, size)
    begin, used = time.perf_counter(), time.process_time()
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        found = refine(one.record, **one.how)
    seconds, used = time.perf_counter() - begin, time.process_time() - used
    exact = one.hidden is not None and {SAME.get(n, n) for n in found.effects} == {SAME.get(n, n) for n in one.hidden}
    complete = found.verdict.complete
    row: dict[str, Any] = {
        "kind": one.kind, "seed": seed, "hidden": one.hidden, "found": list(found.effects), "verdict": found.verdict.word,
        "alternatives": [list(a) for a in found.alternatives], "seconds": seconds, "processor": used,
        "right": exact or not complete, "named": exact and complete,
        "rms": found.fit.score.rms, "warned": [str(w.message) for w in said],
        "path": [f"+{s.added}" if s.added else "-".join(("", *s.dropped)) for s in found.stages[1:]], "off": {}, "outside": [],
    }  # fmt: skip
    named = {SAME.get(n.partition(".")[0], n.partition(".")[0]) + n[len(n.partition(".")[0]) :]: e
             for n, e in found.fit.parameters.items()}  # fmt: skip
    for name, truth in one.values.items() if row["named"] else ():
        estimate = named.get(name)
        if estimate is None or estimate.value is None or not estimate.stderr:
            continue
        row["off"][name] = (estimate.value - truth) / estimate.stderr
        if estimate.ci95 is None or not estimate.ci95[0] <= truth <= estimate.ci95[1]:
            row["outside"].append(name)
    return row


def serve(pipe: Any) -> None:
    """Answer one record after the other, in a process of its own that can be ended."""
    start(brief=True)
    while (asked := pipe.recv()) is not None:
        try:
            pipe.send(judged(*asked))
        except Exception:
            pipe.send({"failed": traceback.format_exc(limit=-6)})


class Worker:
    """A process that refines; it is ended and begun anew where it takes too long."""

    def __init__(self) -> None:
        self.process: Any = None

    def ask(self, asked: tuple[str, int, float], limit: float) -> dict[str, Any]:
        """The answer to one record, or what went wrong."""
        if self.process is None:
            spawn = multiprocessing.get_context("spawn")
            self.pipe, other = spawn.Pipe()
            self.process = spawn.Process(target=partial(serve, other), daemon=True)
            self.process.start()
        self.pipe.send(asked)
        kind, seed, *_ = asked
        base = {"kind": kind, "seed": seed, "found": [], "right": False, "named": False, "off": {}, "outside": []}
        if self.pipe.poll(limit):
            answer = dict(self.pipe.recv())
            return base | {"verdict": "failed", "seconds": 0.0} | answer
        self.end()
        return base | {"verdict": "not ended", "seconds": limit}

    def end(self) -> None:
        """End the process."""
        if self.process is not None:
            self.process.terminate()
            self.process.join()
            self.process = None


def line(row: dict[str, Any]) -> str:
    """One record in words and numbers."""
    hidden = "unknown" if row.get("hidden", ()) is None else "+".join(row.get("hidden", ()))
    mark = "  " if row["right"] and row["seconds"] <= IN_TIME else "! "
    told = f"{mark}{row['kind']} {row['seed']}: {hidden} -> {'+'.join(row['found']) or 'nothing'} ({row['verdict']})"
    told += f", {row['seconds']:.1f} s"
    told += f" ({row['processor']:.1f} s of the processor)" if "processor" in row else ""
    if "rms" in row:
        told += f", rms {row['rms']:.3f}, path {' '.join(row['path'])}"
    if row["off"]:
        told += "; off by " + ", ".join(f"{n} {v:+.1f}" for n, v in row["off"].items())
    return told + (f"\n{row['failed']}" if "failed" in row else "")


def table(rows: list[dict[str, Any]]) -> str:
    """The kinds in one table."""
    lines = [f"{'kind':28s} records right named  in 30 s  median s  longest s  inside  worst off"]
    for kind in dict.fromkeys(r["kind"] for r in rows):
        some = [r for r in rows if r["kind"] == kind]
        off = [abs(v) for r in some for v in r["off"].values()]
        outside = sum(len(r["outside"]) for r in some)
        seconds = [r["seconds"] for r in some]
        lines.append(
            f"{kind:28s} {len(some):7d} {sum(r['right'] for r in some):5d} {sum(r['named'] for r in some):5d} "
            f"{sum(s <= IN_TIME for s in seconds):8d} {np.median(seconds):9.1f} {max(seconds):10.1f}  "
            + (f"{len(off) - outside} of {len(off)}  {max(off):.1f}" if off else "-")
        )
    return "\n".join(lines)


def main() -> None:
    """Run, print, and keep what was found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kinds", nargs="*", default=list(KINDS), choices=list(KINDS))
    parser.add_argument("--records", type=int, default=6)
    parser.add_argument("--seed", type=int, default=0, help="the first record's")
    parser.add_argument("--only", type=int, nargs="*", default=None)
    parser.add_argument("--limit", type=float, default=120.0)
    parser.add_argument("--cold", action="store_true")
    parser.add_argument("--out", type=Path, default=None)
    parser.add_argument("--tiny", action="store_true", help="one short record of one kind")
    options = parser.parse_args()
    kinds = ["hardening_spring"] if options.tiny else options.kinds
    seeds = [options.seed] if options.tiny else options.only or range(options.seed, options.seed + options.records)
    size, worker, rows = 0.3 if options.tiny else 1.0, Worker(), []
    for kind in kinds:
        if not (options.cold or options.tiny):
            worker.ask((kind, UNCOUNTED, size), 10.0 * options.limit)
        for seed in seeds:
            rows.append(worker.ask((kind, seed, size), options.limit))
            print(line(rows[-1]), flush=True)
    worker.end()
    print(f"\n{table(rows)}")
    if options.out is not None:
        options.out.write_text(json.dumps(rows, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
