"""Steps of a fit: our block solver against optimistix's own solvers, on one residual from one start.

    python -m benchmarks.least_squares [--tiny]

The record is a multisine at 500 Hz with noise of 3e-5 rad on x and on z. The residual is that of multiple shooting
(`jaxbacklash.shooting.multiple_shooting.residual_rows`), first with windows that are free, from a stiffness 80 % and a play
50 % too large and half the damping, then tied into one trajectory, from where the free ones ended. Every solver is called by
`optimistix.least_squares`. Seconds are of the processor, so that what else the machine does counts for little; compiling
includes tracing.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import equinox as eqx
import jax
import lineax as lx
import numpy as np
import optimistix as optx

import jaxbacklash as jb
from benchmarks.fit_speed import NAMES, RIG, make_record, wild_start
from jaxbacklash.fitting.fit import prepare
from jaxbacklash.fitting.setup import first_guess, make_problem
from jaxbacklash.shooting.block_levenberg import BlockLevenbergMarquardt
from jaxbacklash.shooting.multiple_shooting import per_window, residual_rows
from jaxbacklash.shooting.problem import Problem, Unknowns
from jaxbacklash.shooting.windows import cut

MOST = 100
"""Steps at most."""
TIE = 100.0
"""Weight of the ties that make the windows one trajectory."""
NEAR = 1e-6
"""Relative and absolute tolerance of optimistix's solvers, of unknowns and of residuals."""
LARGEST = 200
"""Unknowns up to which optimistix's own solvers are run: a step of theirs grows with the third power."""
WINDOW = 0.1
"""Length of a shooting window [s]: longer than in a fit, so that a dense Jacobian has fewer columns."""
OURS = "block Levenberg-Marquardt"
THEIRS: dict[str, Callable[[], Any]] = {
    "optimistix.LevenbergMarquardt, QR": lambda: optx.LevenbergMarquardt(NEAR, NEAR),
    "optimistix.LevenbergMarquardt, normal": lambda: optx.LevenbergMarquardt(NEAR, NEAR, linear_solver=lx.Normal(lx.Cholesky())),
    "optimistix.Dogleg, QR": lambda: optx.Dogleg(NEAR, NEAR),
    "optimistix.LevenbergMarquardt, CG": lambda: optx.LevenbergMarquardt(
        NEAR, NEAR, linear_solver=lx.Normal(lx.CG(rtol=1e-6, atol=1e-6, max_steps=500))
    ),
}
"""All but the last take the Jacobian as a dense matrix, one tangent of the whole record for each unknown."""


def problem_of(seconds: float) -> tuple[Problem, Unknowns]:
    """The joint's problem of a record of so many seconds, its windows free, and where to begin."""
    system = jb.base_motion_joint(RIG.inertia, **wild_start())
    record = make_record(seconds)
    finest = float(prepare(system, [record], None)[0].panel)
    problem = make_problem(system, cut([record], WINDOW, longest_panel=(1.0 + 1e-6) * finest)[0], NAMES)
    start, used = first_guess(problem), int(problem.windows.used)
    # A program for any length of record has windows to spare: a dense Jacobian would count their unknowns too.
    of_windows = lambda p: (*per_window(p), p.windows.coefficients)  # noqa: E731
    problem = eqx.tree_at(of_windows, problem, [part[:used] for part in of_windows(problem)])
    return problem, Unknowns(start.theta, start.starts[:, :used], start.coefficients[:used])


def run(make: Callable[[], Any], problem: Problem, start: Unknowns) -> tuple[float, float, int, float, Unknowns, str]:
    """Seconds to compile and for a step, steps taken, the cost and the unknowns reached, and why it failed if it did."""

    @eqx.filter_jit
    def solve(problem: Problem, start: Unknowns) -> Any:
        found = optx.least_squares(
            residual_rows, make(), start, args=problem, has_aux=True, max_steps=MOST, throw=False
        )  # fmt: skip
        return found.value, found.stats.get("steps", found.stats["num_steps"]), found.result

    spent = []
    for _ in range(2):
        begin = time.process_time()
        value, steps, result = solve(problem, start)
        jax.block_until_ready(value)
        spent.append(time.process_time() - begin)
    cost = float(jax.jit(lambda u: residual_rows(u, problem)[1].cost)(value))
    failed = "" if result == optx.RESULTS.successful else "failed: " + optx.RESULTS[result].splitlines()[0][:60]
    return spent[0] - spent[1], spent[1] / int(steps), int(steps), cost, value, failed


def compare(title: str, problem: Problem, start: Unknowns, theirs: dict[str, Callable[[], Any]]) -> Unknowns:
    """The table of one problem, beside some of their solvers; where our solver ended."""
    count = sum(np.size(leaf) for leaf in jax.tree.leaves(start))
    rows = sum(np.size(row) for row in jax.eval_shape(lambda u: residual_rows(u, problem)[0], start))
    print(f"\n{title}: {count} unknowns, {rows} rows")
    print(f"{'':40}{'compile s':>10}{'ms a step':>11}{'steps':>7}{'cost - ours':>13}")
    solvers: dict[str, Callable[[], Any]] = {OURS: lambda: BlockLevenbergMarquardt(limit=MOST)}
    solvers |= theirs if count <= LARGEST else {}
    ended, least = start, np.nan
    for name, make in solvers.items():
        compiling, step, steps, cost, value, failed = run(make, problem, start)
        if name == OURS:
            ended, least = value, cost
        print(f"  {name:<38}{compiling:10.1f}{step * 1e3:11.1f}{steps:7d}{cost - least:13.2f}  {failed}", flush=True)
    return ended


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tiny", action="store_true", help="a short record, one of the other solvers")
    tiny = parser.parse_args().tiny
    jb.start(cache=False, devices=1, brief=tiny)
    theirs = dict(list(THEIRS.items())[-1:]) if tiny else THEIRS
    for seconds in (1.0,) if tiny else (1.0, 30.0):
        problem, start = problem_of(seconds)
        free = compare(f"{seconds:.0f} s, windows free", problem, start, theirs)
        if not tiny:
            tied = eqx.tree_at(lambda p: p.tie, problem, np.asarray(TIE))
            compare(f"{seconds:.0f} s, windows tied", tied, free, theirs)


if __name__ == "__main__":
    main()
