"""What a planned record would tell: errors of play, stiffness and damping over amplitude, frequency, rate, length and counts.

    python -m benchmarks.record_plans [--tiny]

A joint like the paper's (3.16 kg m^2, 0.0262 rad of play, 11 Hz in contact, 2 % damping), its base swept in frequency, both
angles with noise of 3e-5 rad. One thing at a time is changed from the plan that stands first. Errors are what the fit prints, one
standard error in per cent of the value, and how far the value is from the truth in those errors.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, fields

import numpy as np

import jaxbacklash as jb

INERTIA, PLAY = 3.16, 0.0262
STIFFNESS = INERTIA * (2 * np.pi * 11.0) ** 2
DAMPING = 2 * 0.02 * INERTIA * 2 * np.pi * 11.0
NOISE = 3e-5


@dataclass(frozen=True)
class Plan:
    """Amplitude of the base in plays, sweep from and to [Hz], samples per second, length [s], counts in a play (0: many)."""

    amplitude: float = 2.0
    low: float = 1.0
    high: float = 9.0
    rate: float = 500.0
    seconds: float = 12.0
    counts: int = 0


PLANS = [
    Plan(),
    *(Plan(amplitude=a) for a in (0.3, 0.5, 1.0, 4.0)),
    *(Plan(low=a, high=b) for a, b in ((0.2, 1.0), (1.0, 4.0), (6.0, 16.0))),
    *(Plan(rate=r) for r in (100.0, 200.0, 1000.0)),
    *(Plan(seconds=s) for s in (3.0, 30.0)),
    *(Plan(counts=c) for c in (4, 16)),
]


def record(plan: Plan) -> jb.Record:
    """What would be measured."""
    joint = jb.base_motion_joint(inertia=INERTIA, backlash=PLAY, stiffness=STIFFNESS, damping=DAMPING)
    sweep = jb.Chirp(plan.amplitude * PLAY, plan.low, plan.high, plan.seconds)
    motion = jb.simulate(joint, sweep, duration=plan.seconds, rate=plan.rate)
    rng = np.random.default_rng(0)
    channels = {
        name: np.asarray(row) + NOISE * rng.standard_normal(motion.t.size) for name, row in (("x", motion.x), ("z", motion.z))
    }
    if plan.counts:
        step = PLAY / plan.counts
        channels = {name: step * np.round(row / step) for name, row in channels.items()}
    return jb.Record(np.asarray(motion.t), channels, confirmed=frozenset({"t", "x", "z"}))


def told(plan: Plan) -> str:
    """The errors of the three parameters in words."""
    try:
        fit = jb.fit(record(plan), inertia=INERTIA, starts=2)
    except (jb.NoAnswer, jb.BadInput) as error:
        return f"no answer: {str(error)[:90]}"
    cells = []
    for name, true in (("backlash", PLAY), ("stiffness", STIFFNESS), ("damping", DAMPING)):
        one = fit.parameters[name]
        if one.value is None or not one.stderr:
            cells.append(f"{'not determined':>18}")
        else:
            cells.append(f"{100 * one.stderr / abs(one.value):9.2g} % ({(one.value - true) / one.stderr:+5.1f})")
    return "  ".join([*cells, f"{fit.score.rms:6.2f}"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tiny", action="store_true", help="two plans instead of all")
    tiny = parser.parse_args().tiny
    plans = PLANS[:2] if tiny else PLANS
    jb.start(brief=tiny)
    print(f"{'plan':30}{'play':>18}  {'stiffness':>18}  {'damping':>18}  {'rms/noise':>9}")
    for plan in plans:
        changed = [f"{one.name} {getattr(plan, one.name):g}" for one in fields(plan) if getattr(plan, one.name) != one.default]
        print(f"{', '.join(changed) or str_of(plan):30}{told(plan)}", flush=True)


def str_of(plan: Plan) -> str:
    """The plan that all others are compared with."""
    return f"{plan.amplitude:g} plays, {plan.low:g}-{plan.high:g} Hz, {plan.seconds:g} s"


if __name__ == "__main__":
    main()
