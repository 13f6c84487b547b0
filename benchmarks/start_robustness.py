"""From how many wild starting values does the fit reach the same minimum?

    python -m benchmarks.start_robustness [FOLDER] [--tiny] [--starts 100]

Play, stiffness and damping each begin at their reference values times a random factor between a third and three
(log-uniform), and the fit runs from there alone, without the estimate it would make itself. The reference is the fit as
a user calls it. A start has arrived when all three values lie within a fifth of a standard error of the reference;
minima lower than the reference's are counted beside, since they would put the reference to shame. The record is a
chaotic one of our own; with a FOLDER, also every `*/train.csv` in it whose neighbour `answer.json` tells the inertia.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np

import jaxbacklash as jb
from benchmarks.interval_coverage import RIG, Case, excitation, measured
from tests.independent import events

FACTOR = 3.0
NEAR = 0.2  # standard errors
NAMES = ("backlash", "stiffness", "damping")


def starts(count: int, seed: int = 0) -> np.ndarray:
    """Factors on (b, k, c), (count, 3), log-uniform between 1 / FACTOR and FACTOR."""
    return FACTOR ** np.random.default_rng(seed).uniform(-1.0, 1.0, (count, len(NAMES)))


def begin_at(record: jb.Record, inertia: float, values: np.ndarray) -> jb.System:
    """The base model with inertia [kg m^2] and (b, k, c) as given, observed as the record is."""
    joint = jb.base_motion_joint(inertia, *values)
    return jb.System(joint.inertia, joint.contact, joint.damper, observed=record.observed_name)


def values_of(fitted: jb.Fit) -> np.ndarray:
    """The fitted (b, k, c), whatever their verdicts."""
    contact, damper = fitted.system.contact, fitted.system.damper
    return np.array([contact.backlash, contact.stiffness, damper.damping], float)


def examine(name: str, record: jb.Record, inertia: float, count: int) -> int:
    """Fit one record from `count` starts; print how many arrive and where the others end; return how many fail."""
    clock = time.perf_counter()
    reference = jb.fit(record, inertia=inertia)
    best, near = values_of(reference), NEAR * np.sqrt(np.diag(reference.covariance))
    lost, lower = [], 0
    for factors in starts(count):
        try:
            fitted = jb.fit(record, system=begin_at(record, inertia, best * factors), starts=1)
        except (jb.BadInput, jb.NoAnswer) as refusal:
            lost.append((factors, str(refusal)))
            continue
        found = values_of(fitted)
        if np.all(np.abs(found - best) < near) and fitted.tied == reference.tied:
            continue
        if fitted.tied >= reference.tied and fitted.cost < reference.cost - 1.0:
            lower += 1
        ratios = " ".join(f"{r:.4g}" for r in found / best)
        untied = "" if fitted.tied else ", not tied"
        lost.append((factors, f"ended at {ratios} of it, cost {fitted.cost:.6g} after {fitted.steps} steps{untied}"))
    seconds = time.perf_counter() - clock
    tied = "tied" if reference.tied else "not tied: the model misfits"
    arrived = f"{count - len(lost)} of {count} starts reach the minimum"
    print(f"{name}: {arrived} ({tied}, cost {reference.cost:.6g}) in {seconds:.0f} s")
    if lower:
        print(f"  {lower} starts found a lower minimum than the fit's own")
    for factors, why in lost:
        print(f"  from {' '.join(f'{f:.3g}' for f in factors)} of (b, k, c): {why}")
    return len(lost)


def growth(case: Case) -> float:
    """How far a change of 1e-9 rad in the link's start has grown by the end, as a factor."""
    t = np.arange(0.0, case.seconds, 0.01)
    joint = RIG.inertia, RIG.backlash, RIG.stiffness, RIG.damping
    base = excitation(case.driven, case.seconds)
    pair = [events.simulate(events.Joint(*joint, base=base, y0=y0), t, rtol=1e-10, atol=1e-13)[0] for y0 in (0.0, 1e-9)]
    return float(np.max(np.abs(pair[1] - pair[0])[-100:]) / 1e-9)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="?", type=Path, help="records to examine besides our own")
    parser.add_argument("--tiny", action="store_true", help="a record of 4 s and five starts")
    parser.add_argument("--starts", type=int, default=100, help="starts per record")
    options = parser.parse_args()
    jb.start(brief=options.tiny)
    count = 5 if options.tiny else options.starts
    case = Case("base", seconds=4.0 if options.tiny else 20.0)
    print(f"own record: {case}; 1e-9 rad in its start grow by a factor of {growth(case):.2g}")
    examine("own record", measured(case, 0), RIG.inertia, count)
    for path in sorted(options.folder.glob("*/train.csv")) if options.folder else ():
        answer = path.with_name("answer.json")
        if not answer.is_file():
            continue
        told = json.loads(answer.read_text())
        hidden = ", ".join(told["effects"]) or "nothing missing"
        examine(f"{path.parent.name} ({hidden})", jb.read_record(path), told["truth"]["J"], count)


if __name__ == "__main__":
    main()
