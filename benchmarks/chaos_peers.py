"""The same series through nolds and neurokit2: exponent, delay, dimension, and how long it took.

    python -m benchmarks.chaos_peers [--tiny] [--samples 5000 20000] [--series N] [--only SYSTEM ...]

Each peer is called as its documentation shows, with its own defaults, except that all are told the delay found here where
they take one; a peer that is not installed is left out. A row is over as many series as hold 25,000 samples together, one at
least: "error" is the root mean square of the exponent's errors against the literature, "exponent" the mean. Seconds are those
of one series: of the exponent alone with the peers, and here of everything it needs, as `chaos` goes about it: noise taken off
where that gains, interval included. Ratios within one run are what counts.
"""

from __future__ import annotations

import argparse
import importlib
import importlib.resources
import time
import warnings
from collections.abc import Callable
from types import ModuleType
from unittest.mock import patch

import numpy as np

from jaxbacklash.timeseries import choose_delay, embedding_dimension, largest_exponent, mean_period, projective
from jaxbacklash.timeseries.analyse import WORTH_IT_DB, vectors
from tests.independent.chaotic import HENON, LOGISTIC, LORENZ, ROSSLER, Chaotic, with_noise

TOGETHER = 25_000
SYSTEMS = (LORENZ, ROSSLER, HENON, LOGISTIC)
Answer = tuple[float, int | None, int | None]


def here(series: np.ndarray) -> Answer:
    """Exponent per sample, delay, dimension."""
    rng = np.random.default_rng(0)
    series = (series - series.mean()) / series.std()
    delay, period = choose_delay(series, rng).samples, mean_period(series)
    theiler = int(max(period, 3 * delay))
    window, apart = vectors(period)
    cleaned = projective(series, window=window, delay=apart)
    if cleaned.gain_db is not None and cleaned.gain_db >= WORTH_IT_DB:
        series = (cleaned.series - cleaned.series.mean()) / cleaned.series.std()
    dimension = embedding_dimension(series, delay, theiler, rng).cao
    found = largest_exponent(series, delay, theiler, rng)
    return (np.nan if found is None else found.value), delay, dimension


def nolds_rosenstein(nolds: ModuleType) -> Callable[[np.ndarray, int], Answer]:
    """lyap_r with the delay given."""

    def call(series: np.ndarray, delay: int) -> Answer:
        return float(nolds.lyap_r(series, emb_dim=5, lag=delay)), None, None

    return call


def nolds_eckmann(nolds: ModuleType) -> Callable[[np.ndarray, int], Answer]:
    """The largest of lyap_e's exponents."""

    def call(series: np.ndarray, delay: int) -> Answer:
        return float(np.max(nolds.lyap_e(series))), None, None

    return call


def neurokit(nk: ModuleType) -> Callable[[np.ndarray, int], Answer]:
    """complexity_lyapunov after Rosenstein, with neurokit2's own delay and dimension."""

    def call(series: np.ndarray, delay: int) -> Answer:
        own = int(nk.complexity_delay(series, method="fraser1986")[0])
        dimension = int(nk.complexity_dimension(series, delay=own, method="afnn")[0])
        exponent, _ = nk.complexity_lyapunov(series, delay=own, dimension=dimension, method="rosenstein1993")
        return float(exponent), own, dimension

    return call


def imported(name: str) -> ModuleType:
    """A peer's module. nolds 0.6 asks for the files of a module, which Python below 3.12 has for packages only."""
    files = importlib.resources.files
    with patch.object(importlib.resources, "files", lambda module: files(str(module).rsplit(".", 1)[0])):
        return importlib.import_module(name)


PEERS = {
    "nolds lyap_r": ("nolds", nolds_rosenstein),
    "nolds lyap_e": ("nolds", nolds_eckmann),
    "neurokit2": ("neurokit2", neurokit),
}


def row(
    system: Chaotic, many: list[np.ndarray], name: str, call: Callable[[np.ndarray, int], Answer], delays: list[int],
    own: float | None,
) -> float:  # fmt: skip
    """Print one line; its seconds a series."""
    truth = (system.published or system.exponent()[0]) * system.dt
    begun, answers = time.perf_counter(), []
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            answers = [call(series, delay) for series, delay in zip(many, delays)]
    except Exception as why:
        print(f"  {name:<16}failed: {type(why).__name__}: {why}"[:110], flush=True)
        return time.perf_counter() - begun
    seconds = (time.perf_counter() - begun) / len(many)
    exponent = np.array([answer[0] for answer in answers])
    times = "" if own is None else f"{seconds / own:9.1f}"
    error = 100.0 * np.sqrt(np.mean((exponent / truth - 1.0) ** 2))
    _, delay, dimension = answers[0]
    chosen = f"{delay or '–':>7}{dimension or '–':>6}"
    print(f"  {name:<16}{exponent.mean() / system.dt:10.4f}{error:9.1f}{chosen}{seconds:9.1f}{times}", flush=True)
    return seconds


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tiny", action="store_true", help="one short series")
    parser.add_argument("--samples", type=int, nargs="+", default=[5000, 20000])
    parser.add_argument("--series", type=int, help="series a row; without it as many as hold 25,000 samples together")
    parser.add_argument("--only", nargs="+", help="systems, by name")
    asked = parser.parse_args()
    systems = [s for s in SYSTEMS if asked.only is None or s.name in asked.only]
    if not systems:
        parser.error(f"--only: one of {', '.join(s.name for s in SYSTEMS)}")
    peers = {}
    for name, (module, make) in PEERS.items():
        try:
            peers[name] = make(imported(module))
        except ImportError:
            print(f"{module} is not installed: {name} is left out")
    for samples in [600] if asked.tiny else asked.samples:
        count = 1 if asked.tiny else asked.series or max(1, TOGETHER // samples)
        for system in (HENON,) if asked.tiny else systems:
            for noise in (0.0, 0.02):
                many = list(with_noise(system.series(samples, count, 8), noise, 8))
                print(f"{system.name}, {samples} samples, {100 * noise:.0f} % noise, {count} series")
                print(f"  {'':<16}{'exponent':>10}{'error %':>9}{'delay':>7}{'dim':>6}{'s':>9}{'times':>9}")
                delays = [choose_delay(series, np.random.default_rng(0)).samples for series in many]
                own = row(system, many, "jaxbacklash", lambda series, _: here(series), delays, None)
                for name, call in peers.items():
                    row(system, many, name, call, delays, own)


if __name__ == "__main__":
    main()
