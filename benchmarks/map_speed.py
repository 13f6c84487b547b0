"""How fast a map is: ours against a C program, numba, diffrax step by step, and scipy with events, in one run.

    python -m benchmarks.map_speed [--tiny]

CASE 1 over 256 x 64 cells of 1/alpha and zeta, 400 periods, 100 of them skipped, exponent included. Compiling is apart.

A fixed-step program is as accurate as its steps are many, so the C program is run with more and more steps a period. Its error
is the median, over regular cells, of the difference from a referee: our exponent with legs half as long. All start where the
map's motions end, on their attractors, with the same tangent vector, and follow the same periods. "As accurate" means the error
of our own run against that referee.

The floor of the C program's error, some 6e-5, is likely the tangent vector's turn: it turns as it shrinks, and where in its
turn a finite run ends moves a regular exponent by as much. A step over an edge errs in the tangent by the order of the step,
since the stiffness jumps there; over 300 periods the turn is then lost, and the error stays near 6e-5 until the steps are many
thousands: measured with equal starts on 158 cells 1.6e-4 with 64 steps, 5.5e-5 with 256 and with 4096, 3.1e-5 with 16384. It
needs gcc and numba.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable, Sequence
from typing import Any

import jax
import numpy as np

import jaxbacklash as jb
from benchmarks.peers import map_peers
from jaxbacklash.dynamics.family import PaperCase
from jaxbacklash.dynamics.follow import BLOCK, follow
from jaxbacklash.dynamics.maps import run_map
from jaxbacklash.dynamics.normal_form import normal_form
from jaxbacklash.dynamics.periodicity import periodicity
from jaxbacklash.dynamics.plan import CHUNK, Plan
from jaxbacklash.dynamics.request import request
from jaxbacklash.solvers import linear_pieces
from jaxbacklash.solvers.exact_periods import begin
from tests.independent import exponents

STEPS = (64, 128, 256, 512, 1024, 2048)
ROUNDS = 3
TURN = 7e-5
"""What a regular cell's exponent moves by with the turn of its tangent vector at the end of the run: below it a fixed-step
program tells nothing of that turn."""


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
        both = linear_pieces.branches(pieces)
        return jax.lax.fori_loop(0, 100, lambda _, m: linear_pieces.leg(pieces, both, m), motion)

    text = jax.jit(legs).lower(pieces, motion).as_text()
    body = text.split("stablehlo.while", 1)[-1]
    light = sum(body.count(f"stablehlo.{name} ") for name in ("add", "subtract", "multiply", "select", "maximum", "minimum"))
    return light, sum(body.count(f"stablehlo.{name} ") for name in ("divide", "sqrt"))


def legs_a_period(system: Any, drive: Any, start: np.ndarray) -> tuple[float, float]:
    """Legs that a cell takes in a period, and what is executed since a block waits for its slowest cell; means over a map."""
    pieces = normal_form(system, drive).pieces
    lanes = min(BLOCK, start.shape[1])
    most = start.shape[1] // lanes * lanes
    blocks = jax.tree.map(lambda a: a[:most].reshape(-1, lanes), (pieces, *start))

    def one(block: Any) -> Any:
        pieces, p, v = block
        y, both = begin(p, v), linear_pieces.branches(pieces)
        now = linear_pieces.Motion(*y[:4], y.side, 1.0 + 0.0 * p, 0.0 * p, CHUNK * 2.0 * np.pi / pieces.omega)

        def go(carry: Any) -> Any:
            count, now = carry
            return count + (now.left > 0.0), linear_pieces.leg(pieces, both, now)

        return jax.lax.while_loop(lambda c: (c[1].left > 0.0).any(), go, (jax.numpy.zeros(lanes), now))[0]

    count = np.asarray(jax.jit(lambda b: jax.lax.map(one, b))(blocks)) / CHUNK
    return float(count.mean()), float(count.max(axis=1).mean())


def regular_cells(system: Any, drive: Any, start: np.ndarray, plan: Plan) -> tuple[np.ndarray, np.ndarray]:
    """Exponents from the given starts, and which cells are periodic with a negative one."""
    found, _ = follow(system, drive, *start, plan)
    period = periodicity(found.p, found.v, found.lyapunov, found.stderr)
    return np.asarray(found.lyapunov), (period > 0) & (np.asarray(found.lyapunov) < -1e-3)


def beside_c(grids: list[np.ndarray], start: np.ndarray, plan: Plan, ours: float, truth: np.ndarray, same: np.ndarray,
             median: float, steps: Sequence[int]) -> None:  # fmt: skip
    """The table of the C program, and in words where it is ahead and how many steps it would need."""
    program_c = map_peers.c_program()
    program_c(*grids, start, 2, 1, 64)
    print("\nC, RK4, SIMD and OpenMP        s   ours/C   median error of regular cells")
    table = []
    for count in steps:
        rounds = ROUNDS if count < 512 else 1
        spent, (found, _) = fastest(lambda count=count: program_c(*grids, start, plan.periods, plan.skip, count), rounds)
        table.append((count, spent, float(np.median(np.abs(found - truth)[same]))))
        print(f"  {count:5d} steps a period   {spent:8.2f} {ours / spent:8.2f}   {table[-1][2]:.1e}")
    counts, times, errors = (np.array(column, dtype=float) for column in zip(*table))
    ahead = counts[times < ours]
    if ahead.size:
        print(f"  C is ahead up to {ahead[-1]:.0f} steps a period, at {ahead[0]:.0f} by {ours / times[0]:.1f} times: its step")
        print("  is a tenth of the work of a leg, stays in registers and does not stop at the edges.")
    equal = counts[errors <= median]
    order = np.log(errors[-2] / errors[-1]) / np.log(counts[-1] / counts[-2])
    if equal.size:
        print(f"  as accurate as ours: {equal[0]:.0f} steps")
    elif order > 0.3:
        need = counts[-1] * (errors[-1] / median) ** (1.0 / order)
        print(f"  as accurate as ours: by the slope of the last rows (order {order:.1f}) with {need:.0e} steps, "
              f"in {times[-1] * need / counts[-1]:.0e} s")  # fmt: skip
    else:
        print(f"  as accurate as ours: not with {counts[-1]:.0f} steps, and the last rows do not tell with how many")
    enough = counts[errors <= TURN]
    if enough.size:
        print(f"  right but for the turn of the tangent vector at the end ({TURN:.0e}): {enough[0]:.0f} steps;")
        print("  to whom that is enough, that row is the honest rival")


def against(spent: float, ours: float) -> str:
    """A peer's time with 128 steps, and what that is to ours: as it is, and with the steps of the C program's last row."""
    more = STEPS[-1] / 128
    as_many = f"with {STEPS[-1]} steps, as wrong as C there, {more * spent / ours:.0f} times"
    return f"{spent:.2f} s, {spent / ours:.1f} times ours; {as_many}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tiny", action="store_true", help="few cells, few periods")
    parser.add_argument("--peak", type=float, default=16.0, help="peak of a core in operations a cycle (Zen 4: 16)")
    parser.add_argument("--ghz", type=float, default=3.7, help="clock of a core under this load")
    given = parser.parse_args()
    jb.start(cache=False)
    shape, periods, skip = ((16, 8), 40, 20) if given.tiny else ((256, 64), 400, 100)
    axes = {"inverse_alpha": np.linspace(1.0, 5.0, shape[0]), "zeta": np.linspace(0.005, 0.03, shape[1])}
    wanted = request(PaperCase(1), axes, periods=periods, skip=skip, samples=min(16, periods - skip))
    grids = [np.ascontiguousarray(g.ravel()) for g in np.meshgrid(*axes.values(), indexing="ij")]
    cells = wanted.cells
    rounds = 1 if given.tiny else ROUNDS

    first, _ = timed(lambda: run_map(wanted))
    ours, _ = fastest(lambda: run_map(wanted), rounds)
    system, drive = wanted.family.build(dict(zip(wanted.names, grids)))
    start = np.ascontiguousarray(follow(system, drive, 0.0 * grids[0], 0.0 * grids[0], wanted.plan)[0].last)
    exponent, regular = regular_cells(system, drive, start, wanted.plan)
    print(f"{cells} cells x {periods} periods on {os.cpu_count()} cores, best of {rounds}; {regular.sum()} regular cells")
    taken, legs = legs_a_period(system, drive, start)
    light, heavy = operations(64)
    work = cells * periods * legs * (light + heavy)
    share = work / ours / ((os.cpu_count() or 1) * given.peak * given.ghz * 1e9)
    print(f"ours: {ours:.2f} s (first call, with compiling, {first:.1f} s)")
    print(f"  {taken:.1f} legs a period, {legs:.1f} executed; {light} light operations and {heavy} divisions or roots a leg;")
    peak = f"{given.ghz} GHz x {given.peak:.0f}"
    print(f"  {work / ours / 1e9:.1f} G operations a second, {100 * share:.0f} % of the peak at {peak}")

    # The settings are read when the program is traced, so it is traced anew.
    reach = linear_pieces.REACH, linear_pieces.TURN
    linear_pieces.REACH, linear_pieces.TURN = 0.5 * reach[0], 0.5 * reach[1]
    jax.clear_caches()
    truth, also = regular_cells(system, drive, start, wanted.plan)
    linear_pieces.REACH, linear_pieces.TURN = reach
    jax.clear_caches()
    same = regular & also
    median = float(np.median(np.abs(exponent - truth)[same]))
    print(f"  median error of regular cells: {median:.1e}")
    beside_c(grids, start, wanted.plan, ours, truth, same, median, STEPS[: 2 if given.tiny else None])

    numba_map = map_peers.numba_program()
    few = [g[:: max(1, cells // 2048)] for g in grids]
    numba_map(*few, 2, 1, 128)
    spent, _ = fastest(lambda: numba_map(*few, periods, skip, 128), rounds)
    print(f"\nnumba, 128 steps: {against(spent * cells / len(few[0]), ours)} (from {len(few[0])} cells)")
    by_diffrax, short = map_peers.diffrax_program(), max(4, periods // 20)
    jax.block_until_ready(by_diffrax(*grids, periods=short, skip=1, steps=128))
    spent, _ = timed(lambda: jax.block_until_ready(by_diffrax(*grids, periods=short, skip=1, steps=128)))
    print(f"diffrax, one step a solver step, Tsit5, 128 steps: {against(spent * periods / short, ours)} (from {short} periods)")
    few_cells = [exponents.Cell(float(a), float(z)) for a, z in zip(*(g[:: cells // 3] for g in grids))]
    spent, _ = timed(lambda: [exponents.follow(cell, 4, 1, rtol=1e-9) for cell in few_cells])
    print(f"scipy with events: {spent / len(few_cells) / 4 * cells * periods:.0f} s (from {len(few_cells)} cells and 4 periods)")


if __name__ == "__main__":
    main()
