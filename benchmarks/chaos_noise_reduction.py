"""What noise reduction gains, what it says it gains, and whether it invents chaos.

    python -m benchmarks.chaos_noise_reduction [--tiny] [--samples 5000]

Above: gain in dB of the projective and of the paper's simple method against the true series, the projective one's own
estimate, whether `chaos` would use it (estimated at 2 dB or more), and Cao's dimension before and after. Below: verdicts on
IAAFT surrogates of chaotic series, analysed with noise reduction as a user would, and cleaned first and passed off as
measured. "chaotic" should not occur: no verdict rests on a cleaned series, and what is mostly noise is left as it is, since
a projection would put structure where none was.
"""

from __future__ import annotations

import argparse

import numpy as np

from jaxbacklash import chaos
from jaxbacklash.timeseries import choose_delay, embedding_dimension, iaaft, mean_period
from jaxbacklash.timeseries.analyse import WORTH_IT_DB, clean_series
from tests.independent.chaotic import HELD_BACK, HENON, KNOWN, LORENZ, ROSSLER, case_1, with_noise


def gains(samples: int, systems: list, shares: tuple[float, ...]) -> None:
    """Print the table of gains."""
    heads = ("noise %", 8), ("found %", 9), ("projective", 12), ("estimated", 11), ("used", 6), ("simple", 8), ("dimension", 14)
    print(f"{'system':<24}" + "".join(f"{name:>{width}}" for name, width in heads))
    for system in systems:
        true = system.series(samples, 1, 5)[0]
        true = (true - true.mean()) / true.std()
        for share in shares:
            noisy, rng = with_noise(true, share, 5), np.random.default_rng(0)
            period, delay = mean_period(noisy), choose_delay(noisy, rng).samples
            theiler = int(max(period, 3 * delay))
            projected, averaged = clean_series(noisy, period)
            decibel = [20.0 * np.log10(share / np.sqrt(np.mean((one.series - true) ** 2))) for one in (projected, averaged)]
            dimensions = [embedding_dimension(one, delay, theiler, rng).cao for one in (noisy, projected.series)]
            estimate = "–" if projected.gain_db is None else f"{projected.gain_db:.1f}"
            used = "yes" if projected.gain_db is not None and projected.gain_db >= WORTH_IT_DB else "no"
            print(
                f"{system.name:<24}{100 * share:8.0f}{100 * projected.noise:9.2f}"
                f"{decibel[0]:12.1f}{estimate:>11}{used:>6}{decibel[1]:8.1f}"
                f"{dimensions[0]!s:>8} to {dimensions[1]!s:<3}",
                flush=True,
            )


def invented(samples: int, systems: list, count: int) -> None:
    """Print the verdicts on cleaned surrogates."""
    for system in systems:
        series = system.series(samples, 1, 6)[0]
        words, forced = [], []
        for number, one in enumerate(iaaft((series - series.mean()) / series.std(), count, np.random.default_rng(6))):
            found = chaos(one, seed=number)
            words.append(found.verdict.word)
            assert found.cleaned is not None
            forced.append(chaos(found.cleaned.series, clean=False, seed=number).verdict.word)
        for what, said in (("as a user would", words), ("cleaned, then passed off as measured", forced)):
            told = ", ".join(f"{said.count(word)} {word}" for word in sorted(set(said)))
            print(f"{count} surrogates of {system.name}, {what}: {told}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tiny", action="store_true", help="one short series")
    parser.add_argument("--samples", type=int, default=5000)
    parser.add_argument("--surrogates", type=int, default=20)
    asked = parser.parse_args()
    if asked.tiny:
        gains(1000, [HENON], (0.02,))
        invented(1000, [HENON], 1)
        return
    gains(asked.samples, [*KNOWN, case_1(2.0), *HELD_BACK], (0.02, 0.05, 0.10))
    invented(asked.samples, [LORENZ, ROSSLER, HENON], asked.surrogates)


if __name__ == "__main__":
    main()
