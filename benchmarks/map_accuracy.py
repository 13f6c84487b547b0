"""How right a map is: Figures 2 and 3 of CASE 1 beside scipy with events, cell by cell.

    python -m benchmarks.map_accuracy [--tiny] [--cells 300] [--out DIR]

Every cell is followed over the same periods from the same start by both. Regular cells must agree in their exponents to
1e-4, chaotic ones within their joint error bars, and the sign in 97 cells of 100. Where the signs disagree both are run for
five times as long: a transient then agrees; a cell that still does not is started by ours where scipy's run ended, and the
same attractor then gives the same sign. Each scipy cell takes some ten seconds; they are spread over the cores.
"""

from __future__ import annotations

import argparse
import os
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

import jaxbacklash as jb
from jaxbacklash import program
from jaxbacklash.dynamics.errorbars import batch_error
from jaxbacklash.dynamics.family import PaperCase
from jaxbacklash.dynamics.follow import follow
from jaxbacklash.dynamics.lyapunov import lyapunov_spectrum
from jaxbacklash.dynamics.plan import Plan
from tests.independent import exponents

ZETA, REGULAR = 0.02, 1e-4


def by_scipy(job: tuple[float, int, int]) -> tuple[float, float, np.ndarray]:
    """Exponent, its error bar and the last samples (32, 2) of one cell."""
    inverse_alpha, periods, skip = job
    value, samples, growth = exponents.follow(exponents.Cell(inverse_alpha, ZETA), periods, skip, rtol=1e-10)
    length = 2.0 * np.pi / 0.2
    error = float(np.asarray(batch_error(np.arange(skip, periods + 1.0), growth[skip:, None]))[0]) / length
    return value, error, samples[-32:]


def ours(inverse_alpha: np.ndarray, periods: int, skip: int, start: np.ndarray | None = None):
    """The same by exact steps, all cells at once."""
    system, force = PaperCase(1, zeta=ZETA).build({"inverse_alpha": inverse_alpha})
    begin = np.zeros((2, inverse_alpha.size)) if start is None else start
    return follow(system, force, begin[0], begin[1], Plan(periods, skip, min(32, periods - skip)))[0]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tiny", action="store_true", help="four cells, few periods")
    parser.add_argument("--cells", type=int, default=300)
    parser.add_argument("--periods", type=int, default=400)
    parser.add_argument("--out", type=Path, help="folder for the figure")
    given = parser.parse_args()
    cells, periods, skip = (4, 30, 8) if given.tiny else (given.cells, given.periods, given.periods // 4)
    inverse_alpha = np.linspace(1.0, 5.0, cells)
    # Processes of scipy are forked before jax starts its threads.
    with ProcessPoolExecutor(1 if given.tiny else os.cpu_count()) as pool:
        theirs = list(pool.map(by_scipy, [(a, periods, skip) for a in inverse_alpha], chunksize=4))
    value, error = (np.array([row[k] for row in theirs]) for k in (0, 1))
    program.prepare_for_maps()
    jb.start()
    found = ours(inverse_alpha, periods, skip)
    exponent, stderr = np.asarray(found.lyapunov), np.asarray(found.stderr)
    both = np.hypot(error, stderr)
    regular = (value < 0.0) & (exponent < 0.0) & (both < 1e-3)
    chaotic = (value > 2.0 * error) & (exponent > 2.0 * stderr)
    away = np.abs(exponent - value)
    print(f"{cells} cells, {periods} periods, {skip} skipped: {regular.sum()} regular, {chaotic.sum()} chaotic in both")
    if regular.any():
        print(f"regular: median {np.median(away[regular]):.1e}, largest {away[regular].max():.1e}, wanted {REGULAR:.0e};")
        print(f"  {100 * np.mean(away[regular] <= REGULAR):.1f} % within it")
    if chaotic.any():
        ratio = away[chaotic] / both[chaotic]
        one, two = (100 * np.mean(ratio < size) for size in (1.0, 2.0))
        print(f"chaotic: {one:.0f} % within one joint error bar, {two:.0f} % within two")
    other = np.flatnonzero(np.sign(exponent) != np.sign(value))
    print(f"sign agrees in {100 * (1 - other.size / cells):.1f} % of the cells, wanted 97 %")
    if other.size and not given.tiny:
        explain(inverse_alpha[other], periods)
    sums = [lyapunov_spectrum(*PaperCase(1, inverse_alpha=float(a), zeta=ZETA).build({}), periods=60, skip=10).values.sum()
            for a in inverse_alpha[:: max(1, cells // 8)]]  # fmt: skip
    print(f"spectrum against the divergence -2 zeta: largest difference {np.abs(np.array(sums) + 2 * ZETA).max():.1e}")
    if given.out is not None:
        draw(given.out, inverse_alpha, found, value, np.array([row[2][:, 0] for row in theirs]).T)


def explain(inverse_alpha: np.ndarray, periods: int) -> None:
    """Cells whose sign disagrees, over a run five times as long, and ours from where scipy's ended."""
    long, skip = 5 * periods, 4 * periods
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        theirs = list(pool.map(by_scipy, [(a, long, skip) for a in inverse_alpha]))
    same = np.asarray(ours(inverse_alpha, long, skip).lyapunov)
    ends = np.array([row[2][-1] for row in theirs]).T
    continued = np.asarray(ours(inverse_alpha, periods, periods // 4, ends).lyapunov)
    for k, (a, row) in enumerate(zip(inverse_alpha, theirs)):
        if np.sign(same[k]) == np.sign(row[0]):
            word = "a transient: a longer run agrees"
        elif np.sign(continued[k]) == np.sign(row[0]):
            word = "another attractor: from scipy's last state ours agrees"
        else:
            word = "not explained"
        print(f"  1/alpha {a:.4f}: ours {same[k]:+.5f}, scipy {row[0]:+.5f}; {word}")


def draw(folder: Path, inverse_alpha: np.ndarray, found, value: np.ndarray, samples: np.ndarray) -> None:
    """Figures 2 and 3 of the paper with scipy's values on top."""
    from jaxbacklash.report.figures_maps import exponent_curve

    folder.mkdir(parents=True, exist_ok=True)
    figure = exponent_curve(
        inverse_alpha, found.lyapunov, found.stderr, name="inverse_alpha", unit="1", exponent_unit="1/tau",
        samples=np.asarray(found.p), title="CASE 1, 2ζ = 0.04; circles and red dots: scipy with events",
    )  # fmt: skip
    figure.axes[0].plot(inverse_alpha, value, "o", mfc="none", mec="black", mew=0.4, ms=4.0)
    figure.axes[1].plot(np.broadcast_to(inverse_alpha, samples.shape).ravel(), samples.ravel(), ",", color="red")
    figure.savefig(folder / "figures_2_and_3.png", dpi=150)
    print(f"written: {folder / 'figures_2_and_3.png'}")


if __name__ == "__main__":
    main()
