"""Which effects are found on drives whose hidden ones are known: exact sets, false additions, intervals of every parameter.

    python -m benchmarks.drive_recovery [--records 60] [--noise 1 10] [--seconds 20] [--only 3 8] [--tiny] [--out FILE]

Every record has a random rig (motor, gear, joint with play, link), a servo that follows a multisine, torque read with noise and
encoders that count, on motor and link, of every third record on the motor alone. (A current with a known kt is a torque.) A tenth
of the records hides nothing, a tenth a torque outside the catalogue, the rest one law, two or three at drawn strengths. The
simulation is non-smooth and shares nothing with the package (`tests.independent.drives`). A set counts as identifiable when every
effect in it is more than 6 of the standard errors strong that a fit of the true model has, begun at the truth. Two records of
each joint: the second is only predicted. Answers are written to --out one by one, so that a killed run goes on where it was. It
needs numba.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.effect_recovery import SURE, Case, confusion, hidden_strengths, own_intervals
from jaxbacklash.criticism.evidence import standard_errors
from jaxbacklash.criticism.fitted_model import FittedModel
from jaxbacklash.criticism.model_fitter import ModelFitter
from jaxbacklash.criticism.refine import refine
from jaxbacklash.criticism.refinement import Refinement
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.mechanics import catalogue
from jaxbacklash.parameters import with_values
from jaxbacklash.program import start
from jaxbacklash.records import Record
from tests.independent.drives import OUTSIDE, DriveRig, random_rig, servo_record

NAMES = ("motor_inertia", "motor_damping", "inertia", "backlash", "stiffness", "damping")
HIDES = (1, 2, 0, 1, 1, 2, 1, None, 3, 1)
"""How many laws records hide, by turns; None for a torque outside the catalogue."""
LAWS = (
    "coulomb_motor", "gravity", "transmission_error", "coulomb_joint", "cogging", "coulomb_ground", "preload", "torque_ripple",
    "asymmetric_gap", "load_friction",
)  # fmt: skip
ENCODERS = ("motor link", "motor link", "motor")
"""Where encoders are, by turns."""
FRICTION = ("coulomb_joint", "load_friction")
"""Of these a record hides one at most: friction in the joint."""


def drawn(name: str, rig: DriveRig, rng: np.random.Generator) -> dict[str, float]:
    """A law's parameters at a strength that a rig of this size may have."""
    phase = lambda: float(rng.uniform(-1.4, 1.4))  # noqa: E731
    torque = 40.0 * rig.inertia  # of the link where it swings as it does here [N m]
    share = float(rng.uniform(0.03, 0.2)) * torque
    sign = float(rng.choice([-1.0, 1.0]))
    return {
        "coulomb_motor": {"Tc": share / rig.ratio},
        "cogging": {"A": 0.4 * share / rig.ratio, "P": float(rng.choice([4, 6, 8, 12])), "phi": phase()},
        "coulomb_joint": {"Tc": 0.5 * share},
        "coulomb_ground": {"Tc": 0.5 * share},
        "gravity": {"G": sign * float(rng.uniform(5.0, 12.0)) * rig.inertia, "phi0": float(rng.choice([0.0, 0.3, -0.5]))},
        "preload": {"T0": 0.5 * sign * share},
        "torque_ripple": {"A": 0.3 * sign * share, "N": float(rng.uniform(8.0, 40.0)), "phi": phase()},
        "transmission_error": {
            "e": sign * float(rng.uniform(0.03, 0.15)) * rig.backlash, "M": float(rng.integers(8, 31)), "psi": phase()
        },
        "asymmetric_gap": {"z0": sign * float(rng.uniform(0.05, 0.3)) * rig.backlash},
        "load_friction": {"mu": float(rng.uniform(0.05, 0.2))},
        "motor_fan": {"q": 0.3 * share / rig.ratio**3},
        "swing_damping": {"c": 30.0 * share},
    }[name]  # fmt: skip


def hidden_set(rng: np.random.Generator, number: int) -> tuple[str, ...]:
    """Names of what a record hides; single laws go through the catalogue by turns."""
    count, turn = HIDES[number % len(HIDES)], number // len(HIDES)
    if count is None:
        return (tuple(OUTSIDE)[turn % len(OUTSIDE)],)
    if count == 1:
        alone = sum(h == 1 for h in HIDES) * turn + sum(h == 1 for h in HIDES[: number % len(HIDES)])
        return (LAWS[alone % len(LAWS)],)
    while True:
        names = tuple(str(n) for n in rng.choice(LAWS, count, replace=False))
        if sum(n in FRICTION for n in names) <= 1:
            return names


def make_case(number: int, noise: float, seconds: float) -> Case:
    """Record ``number``: the same rig and laws at every noise."""
    rng = np.random.default_rng(7000 + number)
    hidden = hidden_set(rng, number)
    rig = random_rig(rng)
    values = {name: drawn(name, rig, rng) for name in hidden}

    encoders = ENCODERS[number % len(ENCODERS)]

    def measured(seed: int) -> Record:
        bits = tuple(int(b - np.round(np.log2(noise))) for b in (14, 17))
        seen = servo_record(rig, values, np.random.default_rng(seed), seconds, noise=0.002 * noise, bits=(bits[0], bits[1]))
        return Record(seen["t"], {name: seen[name] for name in ("torque", *encoders.split())}, ratio=rig.ratio)

    record, heldout = measured(8000 + number), measured(9000 + number)
    return Case(number, hidden, rig, values, record, encoders, heldout)  # type: ignore[arg-type]


def true_model(case: Case) -> FittedModel:
    """The true model fitted, begun at the truth."""
    base, free, _ = base_system(case.record, "joint", None)
    fitter = ModelFitter(case.record, with_values(base, {n: getattr(case.rig, n) for n in NAMES}), free, None)
    laws = catalogue()
    return fitter.fit_model({n: laws[n](**v) for n, v in case.values.items()})


def over_bound(case: Case, found: Refinement, true: FittedModel) -> dict[str, float]:
    """Errors of the parameters told, over the standard errors that the true model has, begun at the truth: the Cramer-Rao bound
    of a record whose torque and angles are read with noise."""
    bound = dict(zip(true.free, standard_errors(true)))
    told = {n: found.fit.parameters[n].value for n in NAMES}
    return {n: (value - getattr(case.rig, n)) / bound[n] for n, value in told.items() if value is not None}


def judged(case: Case) -> dict[str, Any]:
    """What one record says about the method."""
    begin = time.perf_counter(), time.process_time()
    found = refine(case.record, heldout=case.heldout)
    wall, processor = time.perf_counter() - begin[0], time.process_time() - begin[1]
    intervals = {n: found.fit.parameters[n].ci95 for n in NAMES}
    inside = {n: bool(ci is not None and ci[0] <= getattr(case.rig, n) <= ci[1]) for n, ci in intervals.items()}
    unknown = bool(set(case.hidden) & set(OUTSIDE))
    exact = set(found.effects) == set(case.hidden)
    true = None if unknown else true_model(case)
    sure = true is None or all(strength > SURE for strength in hidden_strengths(case, true).values())
    return {
        "number": case.number, "encoders": case.kind, "hidden": list(case.hidden), "found": list(found.effects),
        "verdict": found.verdict.word, "bounds": {} if true is None else over_bound(case, found, true),
        "alternatives": [list(a) for a in found.alternatives], "right": not found.verdict.complete if unknown else exact,
        "rms": [s.fit.score.rms for s in found.stages], "held": found.fit.heldout and found.fit.heldout.median,
        "inside": inside, "own": own_intervals(case, found), "seconds": wall, "processor": processor, "identifiable": sure,
        "values": case.values,
    }  # fmt: skip


def table(rows: list[dict[str, Any]]) -> str:
    """The rows in words and numbers."""
    share = lambda some: f"{sum(r['right'] for r in some)} of {len(some)}"  # noqa: E731
    unknown, clean = [r for r in rows if set(r["hidden"]) & set(OUTSIDE)], [r for r in rows if not r["hidden"]]
    named = [r for r in rows if r["hidden"] and r not in unknown]
    known = [*named, *clean]
    right = [r for r in known if r["right"]]
    rms = lambda some: float(np.sqrt(np.mean(np.square(some)))) if some else float("nan")  # noqa: E731
    lines = [
        f"exact sets {share(named)}; of the identifiable {share([r for r in named if r['identifiable']])}; clean {share(clean)}; "
        f"unknown admitted {share(unknown)}",
        *(f"95 % intervals of {n} that hold the truth: {sum(r['inside'][n] for r in known)} of {len(known)}" for n in NAMES),
        *(f"error of {n} over its bound, of the exact sets, rms: {rms([r['bounds'][n] for r in right if n in r['bounds']]):.2f}"
          for n in NAMES),
        f"of the parameters of laws, of the exact sets: {sum(v for r in rows if r['right'] for v in r['own'].values())} of "
        f"{sum(len(r['own']) for r in rows if r['right'])}",
        f"seconds, median {np.median([r['seconds'] for r in rows]):.1f}, longest {max(r['seconds'] for r in rows):.1f}; of the "
        f"processor {np.median([r['processor'] for r in rows]):.1f} and {max(r['processor'] for r in rows):.1f}",
    ]
    for r in (r for r in rows if not r["right"]):
        names = "+".join(r["hidden"]) or "nothing", "+".join(r["found"]) or "nothing"
        seen = f"encoders on {r['encoders']}; {r['verdict']}; alternatives {r['alternatives']}; identifiable {r['identifiable']}"
        lines.append(f"  {r['number']:3d} {names[0]} -> {names[1]} ({seen})")
    return "\n".join([*lines, *confusion(known)])


def main() -> None:
    """Run, print, and keep what was found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--records", type=int, default=60)
    parser.add_argument("--noise", type=float, nargs="+", default=[1.0, 10.0])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--only", type=int, nargs="*", default=None)
    parser.add_argument("--tiny", action="store_true", help="one short record that hides nothing")
    parser.add_argument("--out", type=Path, default=None, help="a file of JSON lines, gone on with where it is there")
    options = parser.parse_args()
    start(brief=True)
    numbers = [HIDES.index(0)] if options.tiny else options.only if options.only is not None else range(options.records)
    seconds = 3.0 if options.tiny else options.seconds
    known = {}
    if options.out is not None and options.out.exists():
        lines = options.out.read_text(encoding="utf-8").splitlines()
        known = {(r["number"], r["noise"]): r for r in map(json.loads, lines)}
    for noise in options.noise[:1] if options.tiny else options.noise:
        rows = []
        for number in numbers:
            row = known.get((number, noise))
            if row is None:
                row = {"noise": noise, **judged(make_case(number, noise, seconds))}
                if options.out is not None:
                    with options.out.open("a", encoding="utf-8") as file:
                        file.write(json.dumps(row) + "\n")
            rows.append(row)
            told = "+".join(row["hidden"]) or "nothing", "+".join(row["found"]) or "nothing"
            print(f"x{noise:g} {number} {told[0]} -> {told[1]} ({row['verdict']}), {row['seconds']:.1f} s", flush=True)
        print(f"\ndrives, noise x{noise:g}\n{table(rows)}\n", flush=True)


if __name__ == "__main__":
    main()
