"""The search for a minimum of the multiple-shooting misfit: optimistix with a Levenberg-Marquardt of our own."""

from __future__ import annotations

from functools import partial
from typing import Any

import equinox as eqx
import jax
import numpy as np

from ..compiled import kept_jit
from .multiple_shooting import residual_rows
from .problem import Problem, Unknowns

Array = Any
MOST = 1000
"""Steps of any search at most, turned down or kept: more than its limit leads to, so that it is the limit that tells."""


class Levenberg(eqx.Module):
    """How a search goes, as data.

    It ends when a full step promises to lower half the sum of squares by less than ``atol`` (in units of the noise, so 1e-3 means
    that no parameter would move by 5 % of its standard error), or by less than ``rtol`` of what it exceeds the noise by, when a
    dozen steps together gained hardly more than that, or after ``limit`` steps, kept or turned down; a limit of 1 only looks at
    the start. ``damping`` is the first. Where it ends it also looks at looser ties, of the weight ``beside``; 0: it does not.
    """

    rtol: Array = eqx.field(default=0.0, converter=np.asarray)
    atol: Array = eqx.field(default=1e-3, converter=np.asarray)
    damping: Array = eqx.field(default=1e-3, converter=np.asarray)
    limit: Array = eqx.field(default=60, converter=np.asarray)
    beside: Array = eqx.field(default=0.0, converter=np.asarray)


class Minimum(eqx.Module):
    """Where a search ended: ``value``, and ``stats``: the ``cost``, what was ``predicted``, the ``steps`` taken, and undamped the
    ``schur`` information, the ``score`` and the ``promise``, by how much the next step would lower the cost; under
    ``beside`` the same with looser ties where they were looked at."""

    value: Unknowns
    stats: dict[str, Any]

    @property
    def beside(self) -> Minimum:
        """The look at looser ties, as a search of one step with them would have told it."""
        return Minimum(self.value, self.stats | self.stats["beside"] | {"steps": np.asarray(1)})


def minimise(problem: Problem, start: Unknowns, how: Levenberg, max_steps: int = MOST) -> Minimum:
    """Run the search from ``start``."""
    # As NumPy arrays: what comes back from several devices would tie all later computations to them.
    return Minimum(*jax.tree.map(np.asarray, _minimise(problem, start, how, max_steps)))


def ready(problem: Problem, start: Unknowns, how: Levenberg, max_steps: int = MOST) -> None:
    """Compile what `minimise` will run."""
    _minimise.ready(problem, start, how, max_steps)  # type: ignore[attr-defined]


def fetch(problem: Problem, start: Unknowns, how: Levenberg, max_steps: int = MOST) -> None:
    """Read what `minimise` will run, if an earlier process has kept it."""
    _minimise.fetch(problem, start, how, max_steps)  # type: ignore[attr-defined]


def _takes_long(problem: Problem, *rest: Any) -> bool:
    """Whether a search may take many steps: that of a joint and nothing else, as `fit` makes it, takes few."""
    return bool(problem.system.effects)


@partial(kept_jit, lasting=_takes_long)
def _minimise(problem: Problem, start: Unknowns, how: Levenberg, max_steps: int) -> tuple[Unknowns, dict[str, Any]]:
    # Asked for only while tracing: a program that was kept need not wait for optimistix, diffrax and lineax to load.
    import optimistix as optx

    from .block_levenberg import BlockLevenbergMarquardt

    solver = BlockLevenbergMarquardt(rtol=how.rtol, atol=how.atol, damping=how.damping, limit=how.limit, beside=how.beside)
    rows: Any = residual_rows  # optimistix's types take rows or rows with something beside, not both
    found: optx.Solution = optx.least_squares(rows, solver, start, args=problem, has_aux=True, max_steps=max_steps, throw=False)
    return found.value, found.stats
