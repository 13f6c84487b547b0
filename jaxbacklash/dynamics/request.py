"""What is asked of a map: of which model, over which axes, for how long, in which tiles; and what a map holds."""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from ..errors import BadInput
from .family import Family
from .plan import Plan

LANES = 1024
"""Cells in a tile: their numbers stay in a core's own cache."""
VARIABLES = {"lyapunov": "f8", "lyapunov_stderr": "f8", "period": "i4", "unresolved": "i1", "poincare": "f8"}
"""What a map holds, and as what; `KEPT` has a leading dimension ``sample``."""
KEPT = ("poincare",)


def package_version() -> str:
    """The version of this package, which stands above this layer but is loaded whenever a part of it is."""
    return str(sys.modules[__name__.partition(".")[0]].__version__)


@dataclass(frozen=True)
class Request:
    """Everything that decides a map's numbers: what, over which axes, how long, from where, in which tiles."""

    family: Family
    axes: tuple[tuple[str, tuple[float, ...]], ...]
    plan: Plan
    start: tuple[float, float]
    tile: tuple[int, ...]
    exact: bool | None = None
    period: float | None = None
    panels: int | None = None

    @property
    def names(self) -> list[str]:
        return [name for name, _ in self.axes]

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(len(values) for _, values in self.axes)

    @property
    def cells(self) -> int:
        return int(np.prod(self.shape))

    def tiles(self) -> list[tuple[slice, ...]]:
        """The map cut into boxes of the tile's shape, smaller at its far sides."""
        cuts = [[slice(i, min(i + step, size)) for i in range(0, size, step)] for size, step in zip(self.shape, self.tile)]
        return [tuple(box) for box in product(*cuts)]

    def fingerprint(self) -> str:
        """A name for this map's numbers: two requests share it when they give the same bits."""
        told = {
            "family": self.family.identity(), "axes": self.axes, "start": self.start, "tile": self.tile, "exact": self.exact,
            "plan": [self.plan.periods, self.plan.skip, self.plan.samples], "version": package_version(),
            "period": self.period, "panels": self.panels,
        }  # fmt: skip
        return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()


def request(
    family: Family, axes: Mapping[str, Any], *, periods: int = 400, skip: int = 100, samples: int = 32,
    start: tuple[float, float] = (0.0, 0.0), exact: bool | None = None, period: float | None = None,
    panels: int | None = None, lanes: int = LANES,
) -> Request:  # fmt: skip
    """A checked request for a map over one or more axes, each the name of a parameter with its values, in order of dimension.

    ``exact``, ``period`` [s] and ``panels`` are those of `follow`: a drive without a period of its own, a chirp or a measured
    base motion, needs ``period``, the time between two samples.

    Returns
    -------
    what `run_map` computes

    Raises
    ------
    BadInput
        An unknown parameter, an axis without finite values, or a plan that cannot be followed.

    Examples
    --------
    >>> joint = jb.base_motion_joint(inertia=3.16, backlash=0.026, stiffness=11000.0, damping=20.0)
    >>> family = jb.dynamics.NamedParameters(joint, jb.Harmonic(0.05, 9.7))
    >>> jb.dynamics.request(family, {"drive.amplitude": [0.03, 0.05], "damping": [10.0, 20.0]}).names
    ['drive.amplitude', 'damping']
    """
    if not axes:
        raise BadInput("a map needs at least one axis")
    checked = []
    for name, values in axes.items():
        family.unit(name)
        numbers = np.asarray(values, dtype=float)
        if numbers.ndim != 1 or not numbers.size or not np.all(np.isfinite(numbers)):
            raise BadInput(f"axis {name}: wanted a list of finite numbers")
        checked.append((name, tuple(float(v) for v in numbers)))
    shape, room = [len(v) for _, v in checked], lanes
    tile: list[int] = []
    for size in reversed(shape):
        tile.insert(0, min(size, max(1, room)))
        room //= tile[0]
    if period is not None and not 0.0 < period < np.inf:
        raise BadInput(f"period {period}: wanted a time above 0")
    begun, plan = (float(start[0]), float(start[1])), Plan(periods, skip, samples)
    return Request(family, tuple(checked), plan, begun, tuple(tile), exact, period, panels)
