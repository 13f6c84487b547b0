"""Exponents from series alone beside those of the literature or of the equations.

    python -m benchmarks.chaos_literature [--tiny] [--seeds 6] [--samples 10000] [--values 10]

Each series is analysed as a user would, clean and with 2 % noise. The truth is the published value where there is one, else the
exponent of the equations from shadow trajectories; for CASE 1 at values of 1/alpha spread over those at which it is
chaotic. "inside" counts how often the 95 % interval holds the truth; "none" how often no number was given.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from jaxbacklash import chaos
from tests.independent.chaotic import HELD_BACK, KNOWN, Chaotic, case_1, with_noise

RANGE = np.linspace(1.2, 5.2, 81)  # of 1/alpha


def chaotic_values(count: int) -> list[Chaotic]:
    """CASE 1 at values of 1/alpha spread over those where its exponent is clearly above zero and settled."""
    found = []
    for value in RANGE:
        system = case_1(round(float(value), 3))
        rate, error = system.exponent(1500, 4)
        if rate > 0.01 and error < 0.15 * rate:
            found.append(system)
    return [found[k] for k in np.unique(np.linspace(0, len(found) - 1, count).round().astype(int))]


def row(system: Chaotic, samples: int, seeds: int, noise: float) -> tuple[list[float], int]:
    """Print one line; ratios of exponent and truth, and how many intervals hold it."""
    begun = time.perf_counter()
    truth = system.published or system.exponent(6000, 12)[0]
    ratios, curves, inside, none = [], [], 0, 0
    for seed, series in enumerate(with_noise(system.series(samples, seeds, 7), noise, 7)):
        found = chaos(series, system.dt, clean=noise > 0.0, seed=seed)
        if found.lyapunov is None or found.interval is None:
            none += 1
            continue
        ratios.append(found.lyapunov / truth)
        inside += found.interval[0] <= truth <= found.interval[1]
        if found.curve.slope is not None:
            curves.append(found.curve.slope / system.dt / truth)
    middle = f"{np.median(ratios):8.3f}{100 * np.max(np.abs(np.array(ratios) - 1.0)):8.1f}" if ratios else f"{'':16}"
    curve = f"{np.median(curves):8.3f}" if curves else f"{'none':>8}"
    seconds = (time.perf_counter() - begun) / seeds
    print(
        f"{system.name:<26}{100 * noise:5.0f}{truth:10.4f}{middle}{curve}{inside:6d}/{len(ratios):<3d}{none:5d}{seconds:8.1f}",
        flush=True,
    )
    return ratios, inside


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tiny", action="store_true", help="one short series of a map")
    parser.add_argument("--seeds", type=int, default=6)
    parser.add_argument("--samples", type=int, default=10000)
    parser.add_argument("--values", type=int, default=10, help="values of 1/alpha for CASE 1")
    asked = parser.parse_args()
    samples, seeds = (1500, 1) if asked.tiny else (asked.samples, asked.seeds)
    systems = [KNOWN[2]] if asked.tiny else [*KNOWN, *chaotic_values(asked.values), *HELD_BACK]
    print(f"{samples} samples, {seeds} seeds; ratio: exponent over truth, median; worst error in %; curve: stretching alone")
    print(f"{'system':<26}{'noise':>5}{'truth':>10}{'ratio':>8}{'worst':>8}{'curve':>8}{'inside':>9}{'none':>6}{'s':>8}")
    for noise in (0.0, 0.02):
        every: list[float] = []
        held = 0
        for system in systems:
            ratios, inside = row(system, samples, seeds, noise)
            every += ratios
            held += inside
        off = np.abs(np.array(every) - 1.0)
        if off.size:
            bar = 0.10 if noise == 0.0 else 0.20
            print(
                f"noise {100 * noise:.0f} %: {100 * np.mean(off <= bar):.0f} % within {100 * bar:.0f} %, median error "
                f"{100 * np.median(off):.1f} %; the interval holds the truth in {100 * held / off.size:.0f} % of {off.size}"
            )


if __name__ == "__main__":
    main()
