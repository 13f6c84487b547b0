"""Which effects are found on records whose hidden ones are known: exact sets, false additions, intervals, by kind of record.

    python -m benchmarks.effect_recovery [--set laboratory|rigs|outside] [--noise 1 10 30] [--duration 20] [--tiny] [--out FILE]

Every record has its own random rig, excitation (chirp, multisine, stepped or modulated sine), strengths, and on every
third an encoder with counts of three noises; the simulation is non-smooth and shares nothing with the package. Each
effect hides alone, and some in pairs and triples; some records hide nothing, some an effect outside the catalogue. A
set counts as identifiable when every effect in it is more than 6 of the standard errors strong that a fit of the true model
has, begun at the truth. A second record of the same joint under another excitation is only predicted. The set ``rigs`` holds
the laws that real rigs add, alone, in pairs and beside others, the set ``outside`` what no law of the catalogue describes. It
needs numba.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jaxbacklash.criticism.evidence import standard_errors
from jaxbacklash.criticism.fitted_model import FittedModel
from jaxbacklash.criticism.model_builder import strengths
from jaxbacklash.criticism.model_fitter import ModelFitter
from jaxbacklash.criticism.refine import refine
from jaxbacklash.criticism.refinement import Refinement
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.mechanics import catalogue
from jaxbacklash.parameters import specs, with_values
from jaxbacklash.program import start
from jaxbacklash.records import Record
from jaxbacklash.shooting.windows import observed_noise
from tests.independent.generator import make_effects, make_excitation, make_rig, measure, simulate_truth
from tests.independent.rigs import OUTSIDE_CATALOGUE, OUTSIDE_STRENGTHS, Rig

RATE, SIGMA = 500.0, 3e-5  # Hz, rad
SURE = 6.0
JOINT = ("backlash", "stiffness", "damping")
EXCITATIONS = ("chirp", "multisine", "stepped", "modulated")
SINGLES = (
    "gravity", "preload", "gap_spring", "asymmetric_gap", "asymmetric_stiffness", "cubic_stiffness", "contact_damping",
    "hunt_crossley", "coulomb_joint", "stribeck", "coulomb_ground", "quadratic_drag", "torque_ripple", "dahl", "lugre",
    "bouc_wen", "flexible_link", "gap_drift", "stiffness_drift", "sensor_delay", "sensor_gain",
)  # fmt: skip
SETS: tuple[tuple[str, ...], ...] = (
    *((name,) for name in SINGLES), (), (), (), (), (), (), *((name,) for name in SINGLES[:13]),
    ("gravity", "coulomb_joint"), ("asymmetric_gap", "contact_damping"), ("gap_spring", "coulomb_ground"),
    ("cubic_stiffness", "gravity"), ("sensor_delay", "coulomb_joint"), ("gap_drift", "gravity"), ("dahl", "gravity"),
    ("preload", "hunt_crossley"), ("torque_ripple", "coulomb_joint"), ("quadratic_drag", "asymmetric_gap"),
    ("stiffness_drift", "coulomb_ground"), ("flexible_link", "gravity"), ("asymmetric_stiffness", "gap_spring"),
    ("gravity", "coulomb_joint", "asymmetric_gap"), ("cubic_stiffness", "contact_damping", "gravity"),
    ("gap_spring", "coulomb_ground", "asymmetric_gap"), ("preload", "torque_ripple", "coulomb_joint"),
    *((name,) for name in OUTSIDE_CATALOGUE), *((name,) for name in OUTSIDE_CATALOGUE),
)  # fmt: skip
RIG_SINGLES = (
    "gravity:off", "transmission_error", "load_friction", "relaxation", "contact_exponent", "damping_drift", "disturbance",
    "sensor_filter", "clock_drift", "contact_damping:pushes", "hunt_crossley:pushes",
)  # fmt: skip
RIG_SETS: tuple[tuple[str, ...], ...] = (
    *((name,) for name in RIG_SINGLES), *((name,) for name in RIG_SINGLES), *((name,) for name in RIG_SINGLES),
    ("friction_drift", "coulomb_joint"), ("friction_drift", "coulomb_ground"), ("friction_drift", "stribeck"),
    ("friction_drift", "coulomb_joint"), ("friction_drift", "coulomb_ground"), ("friction_drift", "dahl"),
    ("transmission_error", "coulomb_joint"), ("transmission_error", "gravity"), ("load_friction", "coulomb_joint"),
    ("load_friction", "gravity"), ("relaxation", "gravity"), ("relaxation", "coulomb_ground"), ("contact_exponent", "gravity"),
    ("contact_exponent", "coulomb_joint"), ("damping_drift", "gravity"), ("damping_drift", "coulomb_joint"),
    ("disturbance", "coulomb_joint"), ("disturbance", "asymmetric_gap"), ("sensor_filter", "coulomb_joint"),
    ("sensor_filter", "gap_spring"), ("clock_drift", "gravity"), ("clock_drift", "coulomb_joint"),
    ("gravity:off", "coulomb_joint"), ("gravity:off", "asymmetric_gap"), ("contact_damping:pushes", "gravity"),
    ("hunt_crossley:pushes", "coulomb_ground"),
    ("gravity:off", "transmission_error"), ("relaxation", "disturbance"), ("load_friction", "contact_exponent"),
    ("sensor_filter", "damping_drift"), ("clock_drift", "disturbance"), ("contact_damping:pushes", "transmission_error"),
    ("gravity:off", "load_friction"), ("hunt_crossley:pushes", "clock_drift"),
)  # fmt: skip
OUTSIDE_SETS = tuple((name,) for name in OUTSIDE_STRENGTHS) * 4
SETS_OF = {"laboratory": SETS, "rigs": RIG_SETS, "outside": OUTSIDE_SETS}
BEGIN = {"laboratory": 7000, "rigs": 9000, "outside": 11000}
"""Where the random numbers of a set of records begin."""
TODAY = {"unknown_disturbance": ("disturbance", {"w": "omega"})}
"""What records were made to hide outside the catalogue that is in it today: its name, and those of its parameters."""
OUTSIDE = tuple(OUTSIDE_STRENGTHS)
PHASE = {"torque_ripple": "phi", "disturbance": "phi", "transmission_error": "psi", "gravity": "phi0"}
"""The phase of a law that repeats."""
HYSTERESIS = {"lugre": "dahl", "bouc_wen": "dahl"}


@dataclass(frozen=True)
class Case:
    """A record with its answer."""

    number: int
    hidden: tuple[str, ...]
    rig: Rig
    values: dict[str, dict[str, float]]
    record: Record
    kind: str
    heldout: Record | None = None


def make_case(number: int, noise: float, duration: float, of: str = "laboratory") -> Case:
    """Record ``number`` of a set: the same joint and motion at every noise."""
    rng, sets = np.random.default_rng(BEGIN[of] + number), SETS_OF[of]
    hidden = sets[number % len(sets)]
    rig, values = make_rig(rng), make_effects(rng, *hidden)
    sigma = SIGMA * noise

    def measured(kind: str, random: np.random.Generator) -> Record:
        truth = simulate_truth(rig, values, make_excitation(random, kind, duration), RATE, duration)
        seen = measure(truth, random, sigma, sigma, 3.0 * sigma if number % 3 == 2 else None)
        return Record(seen["t"], {"x": seen["x"], "z": seen["z"]})

    kind, other = (EXCITATIONS[n % len(EXCITATIONS)] for n in (number, number + 1))
    heldout = measured(other, np.random.default_rng(10000 + BEGIN[of] + number))
    known = named_today(values)
    return Case(number, tuple(known), rig, known, measured(kind, rng), kind, heldout)


def named_today(values: dict[str, dict[str, float]]) -> dict[str, dict[str, float]]:
    """Effects with their values by the names that the catalogue has today."""
    found = {}
    for name, own in values.items():
        now, renamed = TODAY.get(name, (name, {}))
        found[now] = {renamed.get(key, key): value for key, value in own.items()}
    return found


def family(names: Any) -> frozenset[str]:
    """Names with the hysteresis family taken as one."""
    return frozenset(HYSTERESIS.get(n, n) for n in names)


def true_model(case: Case) -> tuple[ModelFitter, FittedModel]:
    """The true model fitted, begun at the truth, and what fitted it."""
    base, free, _ = base_system(case.record, "joint", case.rig.inertia)
    fitter = ModelFitter(case.record, with_values(base, {n: getattr(case.rig, n) for n in JOINT}), free, 0.2)
    laws = catalogue()
    return fitter, fitter.fit_model({n: laws[n](**v) for n, v in case.values.items()})


def hidden_strengths(case: Case, model: FittedModel) -> dict[str, float]:
    """How strong each hidden effect is, in standard errors that the true model ends with (Cramer-Rao)."""
    errors = dict(zip(model.free, standard_errors(model)))
    laws = catalogue()
    return {
        name: max(
            (
                abs(case.values[name][n] - (specs(laws[name])[n].null or 0.0)) / errors[f"{name}.{n}"]
                for n in strengths(laws[name]) if f"{name}.{n}" in errors
            ),
            default=0.0,
        )
        for name in case.values
    }  # fmt: skip


def missed(case: Case, found: Refinement, fitter: ModelFitter, true: FittedModel) -> float | None:
    """By how much the criterion of the true model, begun at the truth, is below that of the model found, fitted in the same way
    and both at the looser of their ties: where it is not, no search that goes by the evidence names the truth. None where the
    search has taken the noise for less, in units of which all this is."""
    if not math.isclose(found.fit.noise[0], observed_noise(case.record)):
        return None
    other = fitter.fit_model(dict(found.fit.system.effects))
    tie = min(true.tie, other.tie)
    return other.criterion_at(tie) - true.criterion_at(tie)


def is_right(case: Case, found: Refinement) -> bool:
    """Whether exactly what hides was named, or what is outside the catalogue was admitted to be unknown."""
    if set(case.hidden) & set(OUTSIDE):
        return not found.verdict.complete
    return family(found.effects) == family(case.hidden)


def true_joint(case: Case, found: Refinement) -> dict[str, float]:
    """Play, stiffness and damping of the rig, the stiffness at the deflection at which the model found states it."""
    truth = {n: getattr(case.rig, n) for n in JOINT}
    power, own = case.values.get("contact_exponent"), found.fit.system.effects.get("contact_exponent")
    if power is not None and own is not None:
        truth["stiffness"] *= (float(own.d0) / power["d0"]) ** (power["p"] - 1.0)
    return truth


def own_intervals(case: Case, found: Refinement) -> dict[str, bool]:
    """Whether the 95 % intervals of the parameters of laws that hide and were named hold the truth.

    A wave may be found with the other sign, half a period on.
    """
    held = {}
    for name, values in case.values.items():
        told = {key: found.fit.parameters.get(f"{name}.{key}") for key in values}
        phase, turns = PHASE.get(name), 0.0
        if phase in values and (one := told[phase]) is not None and one.value is not None:
            turns = float(np.round((one.value - values[phase]) / np.pi))
        for key, true in values.items():
            one = told[key]
            if one is None or one.ci95 is None:
                continue
            if key == phase:
                true += turns * np.pi
            elif key == next(iter(values)) and turns % 2.0:
                true = -true
            held[f"{name}.{key}"] = bool(one.ci95[0] <= true <= one.ci95[1])
    return held


def judge(case: Case, found: Refinement, seconds: float) -> dict[str, Any]:
    """What one record says about the method."""
    truth = true_joint(case, found)
    intervals = {name: found.fit.parameters[name].ci95 for name in truth}
    inside = {name: bool(ci is not None and ci[0] <= truth[name] <= ci[1]) for name, ci in intervals.items()}
    unknown = bool(set(case.hidden) & set(OUTSIDE))
    exact = family(found.effects) == family(case.hidden)
    last = found.fit
    truly = true_model(case) if case.hidden and not unknown else None
    sure = truly is None or all(strength > SURE for strength in hidden_strengths(case, truly[1]).values())
    return {
        "number": case.number, "hidden": list(case.hidden), "kind": case.kind, "found": list(found.effects),
        "alternatives": [list(a) for a in found.alternatives], "verdict": found.verdict.word,
        "right": is_right(case, found),
        "here": found.verdict.here, "median": last.score.median, "held": None if last.heldout is None else last.heldout.median,
        "rms": [s.fit.score.rms for s in found.stages], "inside": inside, "intervals": intervals, "seconds": seconds,
        "own": own_intervals(case, found),
        "joint": {n: found.fit.parameters[n].value for n in truth}, "truth": truth,
        "identifiable": sure, "missed": None if truly is None or exact else missed(case, found, *truly),
    }  # fmt: skip


def confusion(rows: list[dict[str, Any]]) -> list[str]:
    """For every effect how often it hid and was named, how often something else was named for it, and how often it was named
    where it was not; friction with memory is one."""
    pairs = [(family(r["hidden"]), family(r["found"])) for r in rows if not set(r["hidden"]) & set(OUTSIDE)]
    lines = [f"{'effect':22s} hidden named  false  named in its place"]
    for name in sorted(frozenset().union(*(hidden | found for hidden, found in pairs))):
        hid = [(hidden, found) for hidden, found in pairs if name in hidden]
        missed = [found - hidden for hidden, found in hid if name not in found]
        false = sum(name in found for hidden, found in pairs if name not in hidden)
        instead = ", ".join("+".join(sorted(names)) or "nothing" for names in missed)
        lines.append(f"{name:22s} {len(hid):6d} {len(hid) - len(missed):5d} {false:6d}  {instead}".rstrip())
    return lines


def table(rows: list[dict[str, Any]]) -> str:
    """The confusion in words and numbers."""
    named = [r for r in rows if r["hidden"] and not set(r["hidden"]) & set(OUTSIDE)]
    clean = [r for r in rows if not r["hidden"]]
    unknown = [r for r in rows if set(r["hidden"]) & set(OUTSIDE)]
    sure = [r for r in named if r["identifiable"]]
    known = [r for r in rows if not set(r["hidden"]) & set(OUTSIDE)]
    cover = [v for r in known for v in r["inside"].values()]
    own = [v for r in known if r["right"] for v in r["own"].values()]
    share = lambda some: f"{sum(r['right'] for r in some)} of {len(some)}"  # noqa: E731
    low = [r["median"] <= 1.05 for r in named if r["right"]]
    held = [r["held"] <= 1.1 for r in named if r["right"] and r["held"] is not None]
    unseen = f", on the held-out record at most 1.1 in {sum(held)} of {len(held)}" if held else ""
    lines = [
        f"exact sets {share(named)}; of the identifiable {share(sure)}",
        f"clean records left alone {share(clean)}; unknown admitted {share(unknown)}",
        f"median error over noise, of the exact sets, at most 1.05 in {sum(low)} of {len(low)}{unseen}",
        f"95 % intervals of play, stiffness, damping that hold the truth: {sum(cover)} of {len(cover)}",
        f"95 % intervals of the parameters of laws, of the exact sets: {sum(own)} of {len(own)}",
        f"median time {np.median([r['seconds'] for r in rows]):.1f} s",
    ]
    for r in (r for r in rows if not r["right"]):
        names = "+".join(r["hidden"]) or "nothing", "+".join(r["found"]) or "nothing"
        lines.append(
            f"  {r['number']:3d} {r['kind']:10s} {names[0]} -> {names[1]} ({r['verdict']}; alternatives {r['alternatives']}; "
            f"identifiable {r['identifiable']}; rms {r['rms'][0]:.2f} -> {r['rms'][-1]:.2f}"
            + (")" if r["missed"] is None else f"; the true model begun at the truth is {r['missed']:+.1f} ahead)")
        )
    return "\n".join([*lines, *confusion(rows)])


def main() -> None:
    """Run, print, and keep what was found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--set", choices=tuple(BEGIN), default="laboratory", dest="of")
    parser.add_argument("--noise", type=float, nargs="+", default=[1.0, 10.0, 30.0])
    parser.add_argument("--duration", type=float, default=20.0)
    parser.add_argument("--only", type=int, nargs="*", default=None)
    parser.add_argument("--tiny", action="store_true")
    parser.add_argument("--out", type=Path, default=None)
    options = parser.parse_args()
    start(brief=options.tiny)
    everything: dict[str, Any] = {}
    numbers = options.only if options.only is not None else range(len(SETS_OF[options.of]))
    for noise in options.noise[:1] if options.tiny else options.noise:
        rows = []
        for number in [0] if options.tiny else numbers:
            case = make_case(number, noise, 8.0 if options.tiny else options.duration, options.of)
            begin = time.perf_counter()
            found = refine(case.record, heldout=case.heldout, inertia=case.rig.inertia)
            rows.append(judge(case, found, time.perf_counter() - begin))
            words = number, "+".join(case.hidden), "->", "+".join(found.effects), found.verdict.word
            print(*words, f"{rows[-1]['seconds']:.1f} s", flush=True)
        print(f"\nnoise x{noise:g}, {options.duration:g} s\n{table(rows)}\n", flush=True)
        everything[f"{noise:g}"] = rows
    if options.out is not None:
        options.out.write_text(json.dumps(everything, indent=1))


if __name__ == "__main__":
    main()
