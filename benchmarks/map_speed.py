"""How fast a map is: ours against a C program, numba, diffrax step by step, and scipy with events, in one run.

    python -m benchmarks.map_speed [--tiny]

CASE 1 over 256 x 64 cells of 1/alpha and zeta, 400 periods, 100 of them skipped, exponent included. Compiling is apart. A
fixed-step program is as accurate as its steps are many, so the C program is run with more and more steps a period; its error
is the median, over regular cells, of the difference from our exponent with legs half as long, whose search for edges is far
finer. "As accurate" means the median error of our own run against that same reference. It needs gcc and numba.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable
from typing import Any

import jax
import numpy as np

import jaxbacklash as jb
from benchmarks.peers import map_peers
from jaxbacklash import program
from jaxbacklash.dynamics.family import PaperCase
from jaxbacklash.dynamics.maps import LANES, request, run_map
from jaxbacklash.solvers import linear_pieces
from tests.independent import exponents

STEPS = (64, 128, 256, 512, 1024, 2048, 4096)
ROUNDS = 3
FLOOR = """\
  Where the error stops falling it is no longer that of the steps: most cells pass through chaos before they settle, so another
  program settles at another phase of the same motion, and a mean over finitely many periods then differs by some 6e-5. A
  user to whom that is enough is served by the fewest steps that reach it: that row is the honest rival, and may be faster."""


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    """Seconds of the work and what it returned."""
    begun = time.perf_counter()
    answer = work()
    return time.perf_counter() - begun, answer


def fastest(work: Callable[[], Any], rounds: int = ROUNDS) -> tuple[float, Any]:
    """The shortest of some runs, which other work on the machine disturbed least."""
    runs = [timed(work) for _ in range(rounds)]
    return min(spent for spent, _ in runs), runs[-1][1]


def operations(lanes: int) -> tuple[int, float]:
    """Arithmetic operations of one leg of one lane, as handed to the compiler, and the divisions and roots beside them."""
    one = np.ones(lanes)
    pieces = linear_pieces.LinearPieces(*(one * n for n in (0.04, 0.0, 0.0, 1.0, 0.0, 0.5, 0.2)))
    motion = linear_pieces.Motion(0 * one, 0 * one, one, 0 * one, 0 * one, one, 0 * one, 300 * one)

    def legs(pieces: Any, motion: Any) -> Any:
        play, contact = linear_pieces.branches(pieces)
        return jax.lax.fori_loop(0, 100, lambda _, m: linear_pieces.leg(pieces, play, contact, m), motion)

    text = jax.jit(legs).lower(pieces, motion).as_text()
    body = text.split("stablehlo.while", 1)[-1]
    light = sum(body.count(f"stablehlo.{name} ") for name in ("add", "subtract", "multiply", "select", "maximum", "minimum"))
    return light, sum(body.count(f"stablehlo.{name} ") for name in ("divide", "sqrt"))


def legs_a_period(wanted: Any) -> float:
    """Legs that the slowest lane of a tile takes in a period, on average: what is really executed."""
    from jaxbacklash.dynamics.normal_form import normal_form
    from jaxbacklash.solvers.exact_periods import begin

    grids = np.meshgrid(*(np.array(values) for _, values in wanted.axes), indexing="ij")
    system, drive = wanted.family.build({name: g.ravel()[: LANES] for name, g in zip(wanted.names, grids)})
    pieces = normal_form(system, drive).pieces  # type: ignore[arg-type]
    y = begin(0.0 * pieces.omega, 0.0 * pieces.omega)
    one = jax.numpy.ones_like(pieces.omega)
    now = linear_pieces.Motion(y.p, y.v, y.dp, y.dv, y.side, one, 0 * one, 10 * 2 * np.pi / pieces.omega)
    play, contact = linear_pieces.branches(pieces)
    step = jax.jit(lambda m: linear_pieces.leg(pieces, play, contact, m))
    count = 0
    while bool((now.left > 0.0).any()):
        now, count = step(now), count + 1
    return count / 10.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tiny", action="store_true", help="few cells, few periods")
    parser.add_argument("--peak", type=float, default=16.0, help="peak of a core in operations a cycle (Zen 4: 16)")
    parser.add_argument("--ghz", type=float, default=3.7, help="clock of a core under this load")
    given = parser.parse_args()
    program.prepare_for_maps()
    jb.start(cache=False)
    shape, periods, skip = ((16, 8), 40, 20) if given.tiny else ((256, 64), 400, 100)
    axes = {"inverse_alpha": np.linspace(1.0, 5.0, shape[0]), "zeta": np.linspace(0.005, 0.03, shape[1])}
    wanted = request(PaperCase(1), axes, periods=periods, skip=skip, samples=min(16, periods - skip))
    grids = [np.ascontiguousarray(g.ravel()) for g in np.meshgrid(*axes.values(), indexing="ij")]
    cells = wanted.cells
    rounds = 1 if given.tiny else ROUNDS

    first, _ = timed(lambda: run_map(wanted))
    ours, map_ = fastest(lambda: run_map(wanted), rounds)
    exponent, period = map_.lyapunov.values.ravel(), map_.period.values.ravel()
    regular = (period > 0) & (exponent < -1e-3)
    print(f"{cells} cells x {periods} periods on {os.cpu_count()} cores, best of {rounds}; {regular.sum()} regular cells")
    legs = legs_a_period(wanted)
    light, heavy = operations(64)
    work = cells * periods * legs * (light + heavy)
    share = work / ours / ((os.cpu_count() or 1) * given.peak * given.ghz * 1e9)
    print(f"ours: {ours:.2f} s (first call, with compiling, {first:.1f} s)")
    print(f"  {legs:.1f} legs a period, {light} light operations and {heavy} divisions or roots a leg;")
    peak = f"{given.ghz} GHz x {given.peak:.0f}"
    print(f"  {work / ours / 1e9:.1f} G operations a second, {100 * share:.0f} % of the peak at {peak}")

    # The settings are read when the program is traced, so it is traced anew.
    reach = linear_pieces.REACH, linear_pieces.TURN
    linear_pieces.REACH, linear_pieces.TURN = 0.5 * reach[0], 0.5 * reach[1]
    jax.clear_caches()
    reference = run_map(wanted)
    linear_pieces.REACH, linear_pieces.TURN = reach
    jax.clear_caches()
    truth, settled = reference.lyapunov.values.ravel(), reference.period.values.ravel()
    same = regular & (settled == period)
    median = float(np.median(np.abs(exponent - truth)[same]))
    print(f"  median error of regular cells: {median:.1e}")

    program_c = map_peers.c_program()
    program_c(*grids, 2, 1, 64)
    print("\nC, RK4, SIMD and OpenMP        s   ours/C   median error of regular cells")
    equal = None
    for steps in STEPS[: 2 if given.tiny else None]:
        spent, (found, _) = fastest(lambda steps=steps: program_c(*grids, periods, skip, steps), rounds)
        error = float(np.median(np.abs(found - truth)[same]))
        print(f"  {steps:5d} steps a period   {spent:8.2f} {ours / spent:8.2f}   {error:.1e}")
        if equal is None and error <= median:
            equal = steps
    print(f"  as accurate as ours: {f'{equal} steps' if equal else f'not with {STEPS[-1]} steps'}")
    print(FLOOR)

    numba_map = map_peers.numba_program()
    few = [g[:: max(1, cells // 2048)] for g in grids]
    numba_map(*few, 2, 1, 128)
    spent, _ = fastest(lambda: numba_map(*few, periods, skip, 128), rounds)
    print(f"\nnumba, 128 steps: {spent * cells / len(few[0]):.2f} s (from {len(few[0])} cells)")
    by_diffrax, short = map_peers.diffrax_program(), max(4, periods // 20)
    jax.block_until_ready(by_diffrax(*grids, periods=short, skip=1, steps=128))
    spent, _ = timed(lambda: jax.block_until_ready(by_diffrax(*grids, periods=short, skip=1, steps=128)))
    print(f"diffrax, one step a solver step, Tsit5, 128 steps: {spent * periods / short:.1f} s (from {short} periods)")
    few_cells = [exponents.Cell(float(a), float(z)) for a, z in zip(*(g[:: cells // 3] for g in grids))]
    spent, _ = timed(lambda: [exponents.follow(cell, 4, 1, rtol=1e-9) for cell in few_cells])
    print(f"scipy with events: {spent / len(few_cells) / 4 * cells * periods:.0f} s (from {len(few_cells)} cells and 4 periods)")


if __name__ == "__main__":
    main()
