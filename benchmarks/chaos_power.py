"""How often do the surrogates see chaos for what it is, over the number of samples and of swings?

    python -m benchmarks.chaos_power [--tiny] [--seeds 10] [--noise 0.1]

Where the test seldom rejects for chaotic series of a length, a series of that length that fails to reject is undecided and not
noise: `timeseries.verdict` takes its bounds from this table. Each series is tested as ``chaos`` tests it.
"""

from __future__ import annotations

import argparse

import numpy as np

from jaxbacklash.timeseries import choose_delay, embedding_dimension, mean_period, surrogate_test
from tests.independent.chaotic import DUFFING, HENON, LOGISTIC, LORENZ, ROSSLER, with_noise


def rejects(series: np.ndarray, seed: int) -> tuple[bool, float]:
    """Whether the surrogates are rejected at 5 %, and the number of swings in the series."""
    rng = np.random.default_rng(seed)
    series = (series - series.mean()) / series.std()
    period, delay = mean_period(series), choose_delay(series, rng).samples
    theiler = int(np.clip(max(np.ceil(period), 3 * delay), 3, series.size // 20))
    m = min(max(embedding_dimension(series, delay, theiler, rng).cao or 4, 2), 6)
    return surrogate_test(series, m, delay, theiler, rng).p_value <= 0.05, series.size / period


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tiny", action="store_true", help="one short series of a map")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--noise", type=float, default=0.1, help="share of the signal's standard deviation")
    asked = parser.parse_args()
    systems = [HENON] if asked.tiny else [LORENZ, ROSSLER, HENON, LOGISTIC, DUFFING]
    print(f"{'system':<12}{'samples':>8}{'swings':>8}{'rejects':>10}")
    for system in systems:
        for samples in (300,) if asked.tiny else (300, 500, 1000, 2000, 5000):
            rows = with_noise(system.series(samples, 1 if asked.tiny else asked.seeds, 9), asked.noise, 9)
            found = [rejects(row, seed) for seed, row in enumerate(rows)]
            swings = np.median([one[1] for one in found])
            print(f"{system.name:<12}{samples:8d}{swings:8.0f}{sum(one[0] for one in found):6d}/{len(found)}", flush=True)


if __name__ == "__main__":
    main()
