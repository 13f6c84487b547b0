"""How right a map is: Figures 2 and 3 of CASE 1 beside two independent computations, cell by cell.

    python -m benchmarks.map_accuracy [--tiny] [--cells 300] [--scipy 6] [--out DIR]

The referee of all cells is a Taylor series with located edges (`tests.independent.taylor`, it needs numba); an even choice of
``--scipy`` cells is followed by scipy with events as well, some ten seconds a cell in processes of their own. Everybody
follows every cell over the same periods from the same start. Regular cells must agree in their exponents to 1e-4, chaotic
ones within their joint error bars, and the sign in 97 cells of 100.

What does not agree is explained, or said not to be. Signs: both run on, five and twenty-five times as long, and a transient
then agrees; else each is started where the other ended, and two attractors side by side show when a start of one's own
decides the sign for both. Regular exponents: most cells pass through chaos first, so both programs settle at their own
moment, and a mean over a finite run remembers that; from one common start on the attractor nothing is left to remember. A cell
that has not settled by then is followed on first, by the referee alone.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tests.independent import exponents, taylor

# The package is imported where it is used: the processes of scipy import this file, and want no jax.
ZETA, OMEGA, REGULAR, SIGN = 0.02, 0.2, 1e-4, 0.97
PERIOD = 2.0 * np.pi / OMEGA
LONGER = (5, 25)


class Line(NamedTuple):
    """What one program says of N cells: exponent and error bar [1/tau], last 32 samples of p (32, N), last state (2, N)."""

    exponent: np.ndarray
    stderr: np.ndarray
    samples: np.ndarray
    end: np.ndarray


Follow = Callable[[np.ndarray, int, int, np.ndarray], Line]


def _line(rows: list[tuple[np.ndarray, np.ndarray]], periods: int, skip: int) -> Line:
    """From samples (periods + 1, 2) and growth (periods + 1,) of every cell."""
    from jaxbacklash.dynamics.errorbars import batch_error

    growth = np.stack([row[1] for row in rows], axis=1)[skip:]
    error = np.asarray(batch_error(np.arange(skip, periods + 1.0), growth)) / PERIOD
    samples = np.stack([row[0] for row in rows], axis=2)
    return Line((growth[-1] - growth[0]) / (periods - skip) / PERIOD, error, samples[-32:, 0], samples[-1])


def by_taylor(inverse_alpha: np.ndarray, periods: int, skip: int, start: np.ndarray) -> Line:
    """The referee of all cells; ``start`` (2, N)."""
    cells = [exponents.Cell(float(a), ZETA, OMEGA) for a in inverse_alpha]
    return _line([taylor.follow(cell, periods, start[:, k])[:2] for k, cell in enumerate(cells)], periods, skip)


def _scipy_cell(job: tuple[float, int, int]) -> tuple[np.ndarray, np.ndarray]:
    _, samples, growth = exponents.follow(exponents.Cell(job[0], ZETA, OMEGA), job[1], job[2], rtol=1e-11, atol=1e-13)
    return samples, growth


def by_scipy(inverse_alpha: np.ndarray, periods: int, skip: int, processes: int) -> Line:
    """The same by scipy with events, from rest. Processes are spawned: one that is forked beside jax's threads may hang."""
    jobs = [(float(a), periods, skip) for a in inverse_alpha]
    with ProcessPoolExecutor(processes, mp_context=multiprocessing.get_context("spawn")) as pool:
        return _line(list(pool.map(_scipy_cell, jobs)), periods, skip)


def by_ours(inverse_alpha: np.ndarray, periods: int, skip: int, start: np.ndarray) -> Line:
    """The same by exact steps, all cells at once."""
    from jaxbacklash.dynamics.family import PaperCase
    from jaxbacklash.dynamics.follow import follow
    from jaxbacklash.dynamics.plan import Plan

    system, force = PaperCase(1, zeta=ZETA, Omega=OMEGA).build({"inverse_alpha": inverse_alpha})
    found, _ = follow(system, force, start[0], start[1], Plan(periods, skip, min(32, periods - skip)))
    return Line(*(np.asarray(part) for part in (found.lyapunov, found.stderr, found.p, found.last)))


def kinds(one: Line, other: Line) -> tuple[np.ndarray, np.ndarray]:
    """Cells that are regular, and chaotic, in the eyes of both."""
    regular = (one.exponent < 0.0) & (other.exponent < 0.0) & (np.hypot(one.stderr, other.stderr) < 1e-3)
    chaotic = (one.exponent > 2.0 * one.stderr) & (other.exponent > 2.0 * other.stderr)
    return regular, chaotic


def compare(words: str, one: Line, other: Line) -> np.ndarray:
    """Print how two programs agree; returns the cells whose signs do not."""
    regular, chaotic = kinds(one, other)
    away = np.abs(one.exponent - other.exponent)
    cells = away.size
    print(f"\n{words}: {cells} cells, {regular.sum()} regular and {chaotic.sum()} chaotic in both")
    if regular.any():
        within = 100.0 * np.mean(away[regular] <= REGULAR)
        print(f"  regular: median {np.median(away[regular]):.1e}, largest {away[regular].max():.1e}; {within:.1f} % within 1e-4")
    if chaotic.any():
        ratio = away[chaotic] / np.hypot(one.stderr, other.stderr)[chaotic]
        inside = [100.0 * np.mean(ratio < size) for size in (1.0, 2.0, 3.0)]
        print("  chaotic: {:.0f} % within one joint error bar, {:.0f} % within two, {:.0f} % within three".format(*inside))
    unlike = np.flatnonzero(np.sign(one.exponent) != np.sign(other.exponent))
    share = 1.0 - unlike.size / cells
    print(f"  sign agrees in {100.0 * share:.1f} % of the cells (wanted 97 %): {'met' if share >= SIGN else 'NOT MET'}")
    return unlike


def explain_sign(inverse_alpha: np.ndarray, periods: int, ours: Follow, referee: Follow, longer=LONGER) -> list[str]:
    """Why the signs of some cells disagree: one of ``transient``, ``two attractors``, ``not explained`` and the numbers."""
    answers = [""] * inverse_alpha.size
    open_ = np.arange(inverse_alpha.size)
    for factor in longer:
        if not open_.size:
            break
        cells, long = inverse_alpha[open_], factor * periods
        skip = long - periods
        rest = np.zeros((2, cells.size))
        pair = ours(cells, long, skip, rest), referee(cells, long, skip, rest)
        agree = np.sign(pair[0].exponent) == np.sign(pair[1].exponent)
        # Each from where the other ended: if the start decides for both, there are two attractors.
        swapped = ours(cells, periods, periods // 4, pair[1].end), referee(cells, periods, periods // 4, pair[0].end)
        follows = np.sign(swapped[0].exponent) == np.sign(pair[1].exponent)
        follows &= np.sign(swapped[1].exponent) == np.sign(pair[0].exponent)
        for k, place in enumerate(open_):
            numbers = f"ours {pair[0].exponent[k]:+.5f}, referee {pair[1].exponent[k]:+.5f} after {skip} periods"
            if agree[k]:
                answers[place] = f"transient: {numbers}"
            elif follows[k]:
                answers[place] = f"two attractors: {numbers}, and either program goes on as the other from its last state"
            else:
                answers[place] = f"not explained: {numbers}"
        open_ = open_[~agree & ~follows]
    return answers


def explain_regular(
    inverse_alpha: np.ndarray, periods: int, end: np.ndarray, ours: Follow, referee: Follow, longer=LONGER
) -> tuple[np.ndarray, np.ndarray]:
    """What is left between exponents when both programs start from one state on the attractor, and where it was reached.

    From ``end`` (2, N) first; cells that still differ by more than 1e-4 had not settled there, so the referee follows them
    on, and both start again from where it ends.

    Returns
    -------
    differences (N,) [1/tau], and periods (N,) that the common start had been settling for
    """
    settled = np.full(inverse_alpha.size, periods)
    left = np.empty(inverse_alpha.size)
    open_ = np.arange(inverse_alpha.size)
    for factor in (1, *longer):
        cells = inverse_alpha[open_]
        start = end[:, open_] if factor == 1 else referee(cells, factor * periods, 0, np.zeros((2, cells.size))).end
        left[open_] = np.abs(ours(cells, periods, 0, start).exponent - referee(cells, periods, 0, start).exponent)
        settled[open_] = factor * periods
        open_ = open_[left[open_] > REGULAR]
        if not open_.size:
            break
    return left, settled


def divergence(inverse_alpha: np.ndarray) -> float:
    """Largest difference between the sum of a cell's spectrum and -2 zeta."""
    from jaxbacklash.dynamics.family import PaperCase
    from jaxbacklash.dynamics.lyapunov import lyapunov_spectrum

    cells = (PaperCase(1, inverse_alpha=float(a), zeta=ZETA).build({}) for a in inverse_alpha)
    return max(abs(float(lyapunov_spectrum(*cell, periods=60, skip=10).values.sum()) + 2.0 * ZETA) for cell in cells)


def draw(folder: Path, inverse_alpha: np.ndarray, found: Line, referee: Line) -> None:
    """Figures 2 and 3 of the paper with the referee's values on top."""
    from jaxbacklash.plot.drawing import on_page
    from jaxbacklash.plot.maps import exponent_curve

    folder.mkdir(parents=True, exist_ok=True)
    figure = on_page(
        exponent_curve, inverse_alpha, found.exponent, found.stderr, name="inverse_alpha", unit="1", exponent_unit="1/tau",
        samples=found.samples, title="CASE 1, 2ζ = 0.04; circles and red dots: the referee",
    )  # fmt: skip
    figure.axes[0].plot(inverse_alpha, referee.exponent, "o", mfc="none", mec="black", mew=0.4, ms=4.0)
    many = np.broadcast_to(inverse_alpha, referee.samples.shape)
    figure.axes[1].plot(many.ravel(), referee.samples.ravel(), ",", color="red")
    figure.savefig(folder / "figures_2_and_3.png", dpi=150)
    print(f"written: {folder / 'figures_2_and_3.png'}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tiny", action="store_true", help="a few cells and periods")
    parser.add_argument("--cells", type=int, default=300)
    parser.add_argument("--periods", type=int, default=400)
    parser.add_argument("--scipy", type=int, default=6, help="cells that scipy follows as well")
    parser.add_argument("--out", type=Path, help="folder for the figure")
    given = parser.parse_args()
    cells, periods, sample = (6, 40, 1) if given.tiny else (given.cells, given.periods, given.scipy)
    skip, inverse_alpha = periods // 4, np.linspace(1.0, 5.0, cells)
    rest = np.zeros((2, cells))

    import jaxbacklash as jb

    jb.start(brief=given.tiny)
    found, referee = by_ours(inverse_alpha, periods, skip, rest), by_taylor(inverse_alpha, periods, skip, rest)
    unlike = compare(f"ours and Taylor series, {periods} periods, {skip} skipped", found, referee)
    longer = LONGER[:1] if given.tiny else LONGER
    reasons = explain_sign(inverse_alpha[unlike], periods, by_ours, by_taylor, longer) if unlike.size else []
    for a, word in zip(inverse_alpha[unlike], reasons):
        print(f"  1/alpha {a:.4f}: {word}")
    regular, _ = kinds(found, referee)
    if regular.any():
        left, settled = explain_regular(inverse_alpha[regular], periods, referee.end[:, regular], by_ours, by_taylor, longer)
        later = np.sum(settled > periods)
        words = f", {later} of them from a start that had settled for up to {settled.max()} periods" if later else ""
        print(f"  regular cells, both from one start on the attractor: median {np.median(left):.1e}, largest {left.max():.1e}; "
              f"{100.0 * np.mean(left <= REGULAR):.1f} % within 1e-4{words}")  # fmt: skip
        for a, one, waited in zip(inverse_alpha[regular][left > REGULAR], left[left > REGULAR], settled[left > REGULAR]):
            print(f"    1/alpha {a:.4f}: not explained: {one:.1e} after {waited} periods")
    print(f"  spectrum against the divergence -2 zeta: {divergence(inverse_alpha[:: max(1, cells // 8)]):.1e} (wanted 1e-8)")
    if sample:
        chosen = np.linspace(0, cells - 1, sample + 2).round().astype(int)[1:-1]
        third = by_scipy(inverse_alpha[chosen], periods, skip, min(sample, os.cpu_count() or 1))
        for name, line in (("ours", found), ("Taylor series", referee)):
            part: Any = Line(*(a[..., chosen] for a in line))
            compare(f"{name} and scipy with events", part, third)
    if given.out is not None:
        draw(given.out, inverse_alpha, found, referee)


if __name__ == "__main__":
    main()
