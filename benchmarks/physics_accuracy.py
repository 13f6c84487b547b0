"""Position error of the simulators against exact, event-located solutions, by step and by corner width.

    python -m benchmarks.physics_accuracy [--tiny]

Chaos makes a long comparison meaningless, so each forcing period (or each quarter second of a chirp) is started from
the exact state and its largest position error is taken, in units of the half play x_0. The table shows the median and
the largest over the periods, and the order measured between neighbouring rows.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

import jaxbacklash as jb
from jaxbacklash.excitation import AbstractExcitation, Chirp
from jaxbacklash.parameters import with_values
from jaxbacklash.simulation import simulate
from tests.independent import events, motions

STEPS = (64, 128, 256, 512, 1024, 2048)
WIDTHS = (0.1, 0.03, 0.01, 0.003, 0.001)


@dataclass
class Case:
    """A system, its drive, and the exact motion sampled ``per_period`` times in each of ``periods`` periods."""

    name: str
    system: Any
    drive: AbstractExcitation
    exact: Any
    period: float
    half_play: float
    first: int


def cases() -> list[Case]:
    """The four cases of the paper that have an exact solution piece by piece."""
    one, force_one = jb.case_1()
    two, force_two = jb.case_2()
    sweep = motions.Chirp(amplitude=0.07, f0=0.0, rate=0.4, corner=6.0, order=0.5, ramp=1.0)
    base = Chirp(0.07, 0.0, 12.0, 30.0, corner=6.0)
    joint = dict(inertia=3.16, backlash=0.02618, stiffness=13000.0, damping=12.0)
    period = 2 * np.pi / 40.0
    return [
        Case("CASE 1", one, force_one, events.case1(), period, 0.005, 20),
        Case("CASE 2", two, force_two, events.case2(), period, 0.005, 20),
        Case("base-motion chirp", jb.base_motion_joint(**joint), base, events.Joint(base=sweep, **joint), 0.25, 0.01309, 8),
        Case(
            "two-link chirp", jb.two_link(**joint, gravity=-45.0), base,
            events.TwoLink(base=sweep, C=-45.0 / 3.16, **joint), 0.25, 0.01309, 8,
        ),
    ]  # fmt: skip


def errors(case: Case, periods: int, panels: int, t: np.ndarray, y: np.ndarray, v: np.ndarray, **how: Any) -> np.ndarray:
    """Largest position error of each period in half plays, every period started from the exact state."""
    samples = (t.size - 1) // periods
    found = []
    for k in range(periods):
        piece = slice(k * samples, (k + 1) * samples + 1)
        path = simulate(
            case.system, case.drive, duration=case.period, rate=samples / case.period, t0=t[k * samples],
            y0=y[k * samples], dy0=v[k * samples], panels_per_sample=max(1, panels // samples), **how,
        )  # fmt: skip
        found.append(np.max(np.abs(np.asarray(path.y) - y[piece])) / case.half_play)
    return np.array(found)


def study(case: Case, periods: int, steps: tuple[int, ...], widths: tuple[float, ...]) -> dict[str, float]:
    """Print the tables of one case; returns the largest error of the finest step."""
    samples = 32
    t = (case.first + np.arange(periods * samples + 1) / samples) * case.period
    y, v = events.simulate(case.exact, np.concatenate([[0.0], t]))
    y, v = y[1:], v[1:]
    print(f"\n{case.name}: position error per period of {case.period:.4g} s, in half plays ({periods} periods)")
    print("  located Runge-Kutta            median    largest   order   time a period")
    before, last = None, {}
    for n in steps:
        errors(case, 1, n, t[: samples + 1], y, v)
        begin = time.perf_counter()
        found = errors(case, periods, n, t, y, v)
        spent = (time.perf_counter() - begin) / periods
        order = "" if before is None else f"{np.log2(before / np.median(found)):5.2f}"
        before = np.median(found)
        step = f"{n:5d} panels ({case.period / n * 1e3:7.4f} ms)"
        print(f"  {step}  {before:9.2e}  {found.max():9.2e}  {order:>5}   {spent * 1e3:6.2f} ms")
        last[n] = float(found.max())
    print("  smoothed corner, adaptive Dopri8, half-width in half plays")
    before = None
    for width in widths:
        smooth = with_values(case.system, {"width": width * case.half_play})
        found = errors(Case(**{**case.__dict__, "system": smooth}), periods, samples, t, y, v, adaptive=True)
        order = "" if before is None else f"{np.log(before[0] / np.median(found)) / np.log(before[1] / width):5.2f}"
        before = (np.median(found), width)
        print(f"  {width:6.3f}                       {before[0]:9.2e}  {found.max():9.2e}  {order:>5}")
    return last


def default_errors(all_cases: list[Case], periods: int) -> None:
    """The error of the defaults: `simulate` at 500 Hz, and the fit's panels of at most 2 ms."""
    print("\nDefaults, largest error per period in half plays")
    for case in all_cases:
        samples = max(4, round(case.period * 500.0))
        t = (case.first + np.arange(periods * samples + 1) / samples) * case.period
        y, v = (a[1:] for a in events.simulate(case.exact, np.concatenate([[0.0], t])))
        default = _default(case, periods, samples, t, y, v)
        fit = errors(case, periods, samples, t, y, v)
        both = (f"{e.max():9.2e} (median {np.median(e):.1e})" for e in (default, fit))
        print("  {:<20} simulate {}   fit {}".format(case.name, *both))


def _default(case: Case, periods: int, samples: int, t: np.ndarray, y: np.ndarray, v: np.ndarray) -> np.ndarray:
    from jaxbacklash.simulation import default_panels

    return errors(case, periods, samples * default_panels(case.system, samples / case.period), t, y, v)


def oracle() -> None:
    r"""Free vibration of a mass with play: period 2 pi / omega_0 + 4 (b/2) / (omega_0 (A - b/2)), exactly."""
    print("\nFree vibration, error of the period relative to the exact one")
    system = jb.base_motion_joint(1.0, 2.0, 1.0, 0.0)
    for amplitude in (1.2, 2.0, 5.0, 20.0):
        exact = 2 * np.pi + 4.0 / (amplitude - 1.0)
        row = []
        for n in (100, 400, 1600):
            path = simulate(system, duration=exact, rate=n / exact, y0=amplitude, dy0=0.0, panels_per_sample=1)
            # At the turning point speed / acceleration is the time by which the period is missed.
            late = float(path.dy[-1]) / (amplitude - 1.0)
            row.append(abs(late) / exact)
        told = "  ".join(f"{n} panels {e:.1e}" for n, e in zip((100, 400, 1600), row))
        print(f"  amplitude {amplitude:4.1f} half plays: {told}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tiny", action="store_true", help="two periods, few settings")
    tiny = parser.parse_args().tiny
    jb.start(brief=tiny)
    oracle()
    chosen = cases()[:1] if tiny else cases()
    periods = 2 if tiny else 24
    for case in chosen:
        study(case, periods, STEPS[:3] if tiny else STEPS, WIDTHS[:2] if tiny else WIDTHS)
    default_errors(chosen, periods)


if __name__ == "__main__":
    main()
