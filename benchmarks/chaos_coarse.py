"""Does the interval of the exponent hold the truth where a flow is sampled coarsely, or finely, or for a short time?

    python -m benchmarks.chaos_coarse [--tiny] [--cases 64] [--seed 1] [--noise 0]

Cases are drawn: a system, 4 to 100 samples an orbit (maps: 1), 1500 to 6000 samples, a start. Truths are published values, else
the exponent of the equations from shadow trajectories. Each line is one case; the last ones count, over the cases that got a
number, how often the 95 % interval holds the truth and how far the value is off, by samples an orbit.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass, replace

import numpy as np

from jaxbacklash import chaos
from tests.independent.chaotic import DUFFING, HENON, LOGISTIC, LORENZ, ROSSLER, TWO_PI, Chaotic, case_1, with_noise

ORBITS = {"Lorenz": 0.75, "Rossler": 5.87, "Duffing": TWO_PI, "CASE 1, 1/alpha = 2": TWO_PI / 0.2}  # time of one [1/rate]
SYSTEMS = (LORENZ, ROSSLER, DUFFING, case_1(2.0), HENON, LOGISTIC)
MAP_SHARE = 0.1  # of the cases, for each map
FINEST_STEP = 100.0  # integration steps an orbit, at least


@dataclass(frozen=True)
class Case:
    """A system sampled ``an_orbit`` times an orbit, for ``samples`` samples, from the start that ``seed`` draws."""

    system: Chaotic
    an_orbit: float
    samples: int
    seed: int

    def series(self) -> np.ndarray:
        """The measured coordinate, without noise."""
        return self.system.series(self.samples, 1, self.seed)[0]

    def truth(self) -> float:
        """Largest exponent per unit of time."""
        return truth(self.system.name)


def truth(name: str) -> float:
    """Published exponent, else that of the equations at their own fine step."""
    system = next(one for one in SYSTEMS if one.name == name)
    return system.published or system.exponent(6000, 12)[0]


def sampled(system: Chaotic, an_orbit: float) -> Chaotic:
    """The same flow with so many samples an orbit, integrated in steps as fine as before."""
    dt = ORBITS[system.name] / an_orbit
    steps = max(4, int(np.ceil(dt / (ORBITS[system.name] / FINEST_STEP))) * 4)
    settle = max(500, int(np.ceil(system.transient * system.dt / dt))) if system.name != "Lorenz" else 500
    return replace(system, dt=dt, steps=steps, transient=settle)


def drawn(count: int, seed: int) -> list[Case]:
    """So many cases at random, the same for the same seed."""
    rng = np.random.default_rng([seed, 57])
    flows = [one for one in SYSTEMS if not one.is_map]
    maps = [one for one in SYSTEMS if one.is_map]
    found = []
    for number in range(count):
        samples = round(np.exp(rng.uniform(np.log(1500.0), np.log(6000.0))))
        if rng.uniform() < MAP_SHARE * len(maps):
            found.append(Case(maps[rng.integers(len(maps))], 1.0, samples, 1000 * seed + number))
            continue
        an_orbit = float(np.exp(rng.uniform(np.log(4.0), np.log(100.0))))
        found.append(Case(sampled(flows[rng.integers(len(flows))], an_orbit), an_orbit, samples, 1000 * seed + number))
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tiny", action="store_true", help="two short cases")
    parser.add_argument("--cases", type=int, default=64)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--noise", type=float, default=0.0, help="share of the signal's standard deviation")
    asked = parser.parse_args()
    cases = drawn(asked.cases, asked.seed)
    if asked.tiny:
        cases = [Case(HENON, 1.0, 1000, 1), Case(sampled(LORENZ, 8.0), 8.0, 1000, 1)]
    print(f"{'system':<22}{'an orbit':>9}{'samples':>8}{'truth':>9}{'value':>9}{'low':>9}{'high':>9}  verdict      s", flush=True)
    rows: list[tuple[float, float, bool, bool]] = []
    for case in cases:
        begun = time.perf_counter()
        series = with_noise(case.series(), asked.noise, case.seed) if asked.noise else case.series()
        found = chaos(series, case.system.dt, seed=case.seed)
        right = case.truth()
        line = f"{case.system.name:<22}{case.an_orbit:9.1f}{case.samples:8d}{right:9.4f}"
        if found.lyapunov is not None and found.interval is not None:
            low, high = found.interval
            inside = low <= right <= high
            rows.append((case.an_orbit, found.lyapunov / right, inside, True))
            line += f"{found.lyapunov:9.4f}{low:9.4f}{high:9.4f} {' ' if inside else '*'}{found.verdict.word:<11}"
        else:
            line += f"{'':27}  {found.verdict.word:<11}"
        print(f"{line}{time.perf_counter() - begun:5.1f}", flush=True)
    for low, high in ((0.0, 3.0), (4.0, 8.0), (8.0, 16.0), (16.0, 40.0), (40.0, 101.0), (0.0, 101.0)):
        part = [one for one in rows if low <= one[0] < high]
        if part:
            off = np.array([one[1] for one in part])
            print(
                f"{low:5.0f} to {high:3.0f} samples an orbit: {sum(one[2] for one in part):3d} of {len(part):3d} intervals hold "
                f"the truth; value over truth {np.median(off):.3f} in the median, {off.min():.3f} to {off.max():.3f}"
            )
    print(f"no number in {len(cases) - len(rows)} of {len(cases)}")


if __name__ == "__main__":
    main()
