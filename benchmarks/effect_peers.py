"""Which effects are found: PySINDy, an expert's weak-form regression, and `refine`, on the same records.

    python -m benchmarks.effect_peers [--records 25] [--parts x1 x10 x30 cut] [--methods sindy weak refine] [--work DIR] [--tiny]

The records are those of `benchmarks.effect_recovery`: random rigs, non-smooth simulation, every third with an encoder.
Twenty-five hide nothing (four), one, two or three effects; two more hide what is in no catalogue; `--records 171` takes
every record of that laboratory, eighteen that hide nothing and twelve unknown ones among them. The same joints and
motions are measured with 1, 10 and 30 times the noise of 3e-5 rad, and at the first noise cut to the 5 s in their middle.
Every answer is one JSON file in --work, so that a killed run goes on where it was. Peers: `peers/sindy.py` (its column says
so if pysindy is not installed) and `peers/weak_form.py`. Needs numba. Peers have no intervals, and PySINDy no notion of its
being incomplete.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.effect_recovery import OUTSIDE as BEYOND
from benchmarks.effect_recovery import SETS, Case, family, make_case
from benchmarks.peers import sindy, weak_form
from jaxbacklash.records import Record
from tests.independent.rigs import OUTSIDE_CATALOGUE

# Chosen by what they hide, before any was run: nothing, one effect (a rig's commonest), two or three, something unknown.
CLEAN, SINGLE = (21, 22, 23, 24), (0, 2, 3, 5, 6, 8, 10, 12, 13, 16, 17, 19)
SEVERAL, UNKNOWN = (40, 41, 42, 43, 45, 50, 53, 54, 55), (57, 58)
# In an order in which the first dozen are already a fair sample.
FEW = (*(n for group in zip(SINGLE[:4], SEVERAL[:4], CLEAN) for n in group), *SINGLE[4:], *SEVERAL[4:])
# Twenty-five are too few to tell methods apart that name nearly all: the whole laboratory, each set on three rigs, follows.
OUTSIDE = tuple(n for n in range(3 * len(SETS)) if set(SETS[n % len(SETS)]) & set(OUTSIDE_CATALOGUE))
NUMBERS = (*FEW, *(n for n in range(3 * len(SETS)) if n not in (*FEW, *OUTSIDE)))
PARTS = {"x1": 1.0, "x10": 10.0, "x30": 30.0, "cut": 1.0}
CUT = 5.0  # s
JOINT = ("backlash", "stiffness", "damping")


def the_case(number: int, part: str, duration: float) -> Case:
    """A record of one part; its own time is kept in a cut, since drifts count it."""
    case = make_case(number, PARTS[part], duration)
    if part != "cut":
        return case
    t = case.record.t
    inside = np.abs(t - t[0] - 0.5 * duration) <= 0.5 * CUT + 1e-9
    channels = {n: v[inside] for n, v in case.record.channels.items()}
    return Case(case.number, case.hidden, case.rig, case.values, Record(t[inside], channels), case.kind)


def by_peer(identify: Callable[..., Any]) -> Callable[[Case], dict[str, Any]]:
    """A peer's answer to a record, in plain numbers."""

    def answer(case: Case) -> dict[str, Any]:
        found = identify(case.record.t, case.record.channels["x"], case.record.channels["z"], case.rig.inertia)
        joint = {n: float(getattr(found, n)) for n in JOINT}
        return {"found": list(found.effects), "joint": joint, "complete": bool(getattr(found, "complete", True)), "inside": None}

    return answer


def by_refine(case: Case) -> dict[str, Any]:
    """Ours."""
    from jaxbacklash.criticism.refine import refine

    found = refine(case.record, inertia=case.rig.inertia)
    estimates = {n: found.fit.parameters[n] for n in JOINT}
    inside = {}
    for name, estimate in estimates.items():
        ci, truth = estimate.ci95, getattr(case.rig, name)
        inside[name] = bool(ci is not None and ci[0] <= truth <= ci[1])
    joint = {n: None if e.value is None else float(e.value) for n, e in estimates.items()}
    return {"found": list(found.effects), "joint": joint, "complete": found.verdict.complete, "inside": inside,
            "alternatives": [list(a) for a in found.alternatives]}  # fmt: skip


METHODS: dict[str, Callable[[Case], dict[str, Any]]] = {
    "sindy": by_peer(sindy.identify),
    "weak": by_peer(weak_form.identify),
    "refine": by_refine,
}
TITLES = {"sindy": "PySINDy", "weak": "weak form, expert", "refine": "jaxbacklash.refine"}


def where(work: Path, number: int, part: str, duration: float, method: str) -> Path:
    """The file of one answer."""
    return work / f"{part}-{duration:g}s" / f"{number:03d}-{method}.json"


def answered(work: Path, number: int, part: str, duration: float, method: str) -> dict[str, Any]:
    """A method's answer to one record, from its file if it was found before."""
    path = where(work, number, part, duration, method)
    if path.exists():
        return dict(json.loads(path.read_text(encoding="utf-8")))
    case = the_case(number, part, duration)
    row = {"number": number, "hidden": list(case.hidden), "kind": case.kind, "truth": {n: getattr(case.rig, n) for n in JOINT}}
    begin, spent = time.perf_counter(), time.process_time()
    try:
        row |= METHODS[method](case)
    except (np.linalg.LinAlgError, ValueError) as broken:  # a peer that breaks down has named nothing
        row |= {"found": [], "joint": dict.fromkeys(JOINT), "complete": False, "inside": None, "broken": str(broken)}
    row |= {"seconds": time.perf_counter() - begin, "cpu": time.process_time() - spent}
    path.parent.mkdir(parents=True, exist_ok=True)
    half = path.with_suffix(".part")
    half.write_text(json.dumps(row, indent=1), encoding="utf-8")
    half.replace(path)
    return row


def take_over(work: Path, files: list[Path], duration: float) -> None:
    """Keep what `benchmarks.effect_recovery --out` found by refine on the same records, where nothing is kept yet."""
    for file in files:
        for noise, rows in json.loads(file.read_text(encoding="utf-8")).items():
            for row in rows:
                path = where(work, row["number"], f"x{noise}", duration, "refine")
                if path.exists() or f"x{noise}" not in PARTS or row["number"] not in (*NUMBERS, *OUTSIDE):
                    continue
                truth = row.get("truth", dict.fromkeys(JOINT))
                kept = {k: row[k] for k in ("number", "hidden", "kind", "found", "inside", "alternatives", "seconds")}
                kept |= {
                    "joint": row.get("joint", dict.fromkeys(JOINT)),
                    "truth": truth,
                    # What a held-out record says against a model no peer was told.
                    "complete": row.get("here", row["verdict"] == "complete"),
                }
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(json.dumps(kept, indent=1), encoding="utf-8")


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """What a column of the table says of one method."""
    unknown = [r for r in rows if set(r["hidden"]) & set(BEYOND)]
    known = [r for r in rows if r not in unknown]
    clean = [r for r in known if not r["hidden"]]
    exact = [r for r in known if family(r["found"]) == family(r["hidden"])]
    off = {
        n: [abs(r["joint"][n] / r["truth"][n] - 1.0) for r in known if r["joint"][n] is not None]
        for n in ("backlash", "stiffness")
    }
    cpu = [r["cpu"] for r in rows if "cpu" in r]
    inside = [v for r in known for v in (r["inside"] or {}).values()]
    return {
        "exact": len(exact), "of": len(known),
        "false_on_clean": sum(bool(r["found"]) for r in clean), "clean": len(clean),
        "admitted": sum(not r["complete"] for r in unknown), "unknown": len(unknown),
        "backlash": float(np.median(off["backlash"])) if off["backlash"] else None,
        "stiffness": float(np.median(off["stiffness"])) if off["stiffness"] else None,
        "held": sum(inside), "intervals": len(inside),
        "cpu": float(np.median(cpu)) if cpu else None,
    }  # fmt: skip


def table(part: str, columns: dict[str, list[dict[str, Any]] | None]) -> str:
    """One part of the comparison, a line a method, and what each named wrongly."""
    share = lambda a, b: f"{a} of {b}" if b else "-"  # noqa: E731
    percent = lambda v: "-" if v is None else f"{100 * v:.3g} %"  # noqa: E731
    heads = ("exact sets", "false on clean", "unknown admitted", "play off", "stiffness off", "intervals hold", "CPU s a record")
    widths = (12, 16, 18, 11, 15, 16, 16)
    lines = [part, f"  {'':<20}" + "".join(f"{head:>{width}}" for head, width in zip(heads, widths))]
    for method, rows in columns.items():
        if rows is None:
            lines.append(f"  {TITLES[method]:<20}{'not installed':>14}")
            continue
        s = summary(rows)
        held = f"{s['held']} of {s['intervals']}" if s["intervals"] else "has none"
        cpu = "-" if s["cpu"] is None else f"{s['cpu']:.2f}"
        admitted = "cannot" if method == "sindy" else share(s["admitted"], s["unknown"])
        lines.append(
            f"  {TITLES[method]:<20}{share(s['exact'], s['of']):>12}{share(s['false_on_clean'], s['clean']):>16}{admitted:>18}"
            f"{percent(s['backlash']):>11}{percent(s['stiffness']):>15}{held:>16}{cpu:>16}"
        )
    for method, rows in columns.items():
        for r in rows or []:
            if set(r["hidden"]) & set(BEYOND) or family(r["found"]) == family(r["hidden"]) or method == "sindy":
                continue
            told = "+".join(r["hidden"]) or "nothing", "+".join(r["found"]) or "nothing"
            lines.append(f"    {TITLES[method]}: {r['number']} {told[0]} -> {told[1]}{'' if r['complete'] else ', incomplete'}")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--records",
        type=int,
        default=len(FEW),
        help=f"the first so many of the {len(NUMBERS)}; two unknown ones come with {len(FEW)}, {len(OUTSIDE)} with all",
    )
    parser.add_argument("--parts", nargs="+", choices=tuple(PARTS), default=list(PARTS))
    parser.add_argument("--methods", nargs="+", choices=tuple(METHODS), default=list(METHODS))
    parser.add_argument("--duration", type=float, default=20.0, help="of the whole records [s]")
    parser.add_argument(
        "--work", type=Path, default=Path("effect_peers"), help="folder of the answers; a run goes on from what is there"
    )
    parser.add_argument(
        "--recovery",
        type=Path,
        nargs="+",
        default=[],
        help="take over refine's answers from benchmarks.effect_recovery --out FILE",
    )
    parser.add_argument("--table", action="store_true", help="run nothing, print the tables of what is there")
    parser.add_argument("--tiny", action="store_true", help="two short records by the peers, one by refine; keeps nothing")
    options = parser.parse_args()
    if options.tiny:
        tiny()
        return
    from jaxbacklash.program import start

    start()
    take_over(options.work, options.recovery, options.duration)
    unknown = OUTSIDE if options.records >= len(NUMBERS) else UNKNOWN if options.records >= len(FEW) else ()
    numbers = (*NUMBERS[: options.records], *unknown)
    for part in options.parts:
        columns: dict[str, list[dict[str, Any]] | None] = {}
        for method in options.methods:
            if method == "sindy" and not sindy.installed():
                columns[method] = None
                continue
            columns[method] = rows = []
            for number in numbers:
                if options.table:
                    path = where(options.work, number, part, options.duration, method)
                    rows += [json.loads(path.read_text(encoding="utf-8"))] if path.exists() else []
                    continue
                r = answered(options.work, number, part, options.duration, method)
                rows.append(r)
                told = "+".join(r["hidden"]) or "nothing", "+".join(r["found"]) or "nothing"
                print(f"{part} {TITLES[method]} {number} {told[0]} -> {told[1]}, {r['seconds']:.1f} s", flush=True)
        print(f"\n{table(part, columns)}\n", flush=True)


def tiny() -> None:
    """Two records of 8 s for the peers, one for refine: of a length for which others have compiled it."""
    import tempfile

    from jaxbacklash.program import start

    start(brief=True)
    with tempfile.TemporaryDirectory() as folder:
        columns: dict[str, list[dict[str, Any]] | None] = {}
        for method, numbers in (("sindy", (0, 21)), ("weak", (0, 21)), ("refine", (21,))):
            if method == "sindy" and not sindy.installed():
                columns[method] = None
                continue
            columns[method] = [answered(Path(folder), n, "x1", 8.0, method) for n in numbers]
        print(table("x1, tiny", columns))


if __name__ == "__main__":
    main()
