"""The fit's own problem with corrected data in place of the record's: same shapes, so that no program is compiled anew.

A correction changes only data, never how the model moves. So the misfit that would be left after a step of all unknowns, the
windows' and the parameters', is a quadratic function of a small correction: three looks at the windows tell how much it
brings, how large it is, and with what error, with everything else free to make up for it (a score test, Rao 1948).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import equinox as eqx
import numpy as np

from ..errors import BadInput, NoAnswer
from ..fitting.continuation import continued
from ..fitting.friction_homotopy import sliding_speeds
from ..fitting.result import Fit
from ..fitting.score import Score, score
from ..fitting.search import search
from ..fitting.settings import LOOSEST
from ..parameters import values, with_values
from ..records import Record
from ..shooting.information import freedom
from ..shooting.levenberg import Levenberg, Minimum, minimise
from ..shooting.problem import Problem, Unknowns
from ..shooting.windows import Layout, Windows, cut
from ..system import System
from .kinds import Corrected, Kind

STEPS = 12
"""Steps allowed to a search that goes on from where the last one ended."""
ROUNDS, SETTLED = 5, 0.3
"""How often the size and the model are searched for in turn, and the share of its error by which the size may still move."""


@dataclass(frozen=True)
class Point:
    """The model on data without a cause of this ``size``, known to ``stderr``: ``problem`` and ``unknowns`` where a search has
    ended, ``cost`` half the sum of squares, ``freedom`` the samples less the unknowns, ``layout`` of the windows, ``schur``
    (q, q) the information about the parameters."""

    size: float
    stderr: float
    problem: Problem
    unknowns: Unknowns
    cost: float
    freedom: float
    layout: Layout
    schur: np.ndarray

    @property
    def misfit(self) -> float:
        """Root of the reduced sum of squares."""
        return float(np.sqrt(2.0 * self.cost / self.freedom))

    def system(self) -> System:
        """The fitted system."""
        moved = np.asarray(self.problem.parameters(self.unknowns.theta))
        return with_values(self.problem.system, dict(zip(values(self.problem.system), moved)))


class Bench:
    """A fit, and its records cut into the same windows after a correction."""

    def __init__(self, fit: Fit) -> None:
        assert fit.problem is not None
        assert fit.unknowns is not None
        self.fit, self.problem, self.unknowns = fit, fit.problem, fit.unknowns
        w = self.problem.windows
        self._panel, self._length, self._intervals = float(w.panel), w.samples, w.intervals
        self.layout = self.cut(fit.records)[1]
        self.group = max(1, round(fit.score.length / (self._length * self.layout.dt)))

    def cut(self, records: Sequence[Record]) -> tuple[Windows, Layout]:
        """Windows of the same lengths and panels as the fit's."""
        longest = self._panel * (1.0 + 1e-6)
        return cut(records, self._length * records[0].dt, longest_panel=longest, least=self._intervals)

    def corrected(self, kind: Kind, size: float) -> list[Corrected]:
        """All records without a cause of this size."""
        return [kind.corrected(record, size) for record in self.fit.records]

    def look(self, kind: Kind, size: float, problem: Problem, at: Unknowns) -> float:
        """Half the sum of squares that a step of all unknowns would leave on data without a cause of this size."""
        stats = minimise(self._with(problem, kind, self.corrected(kind, size))[0], at, Levenberg(limit=1)).stats
        return float(stats["cost"] - stats["promise"])

    def parabola(self, kind: Kind, size: float, problem: Problem, at: Unknowns) -> tuple[float, float, float]:
        """Where the misfit is least along a cause's size: by how much the sum of squares falls there, the size, its error."""
        h = kind.step(self.fit.records[0])
        low, here, high = (self.look(kind, size + s, problem, at) for s in (-h, 0.0, h))
        slope, curvature = (high - low) / (2.0 * h), (high - 2.0 * here + low) / h**2
        if not (np.isfinite(slope) and curvature > 0.0):
            return 0.0, size, np.inf
        return slope**2 / curvature, size - slope / curvature, curvature**-0.5

    def here(self) -> Point:
        """The fit as it is."""
        return self._point(0.0, self.problem, self.unknowns, self.layout, None)

    def settle(self, kind: Kind, size: float, system: System | None) -> Point | None:
        """The model and the size of a cause searched for in turn: from where the fit has ended, or from a system far from it."""
        if system is None:
            try:
                problem, layout = self._with(self.problem, kind, self.corrected(kind, size))
            except BadInput:  # so corrected it is no record any more
                return None
            point = self._go_on(size, problem, self.unknowns, layout)
        else:
            found = self._anew(kind, size, system)
            if found is None:
                return None
            point = found
        point = self._in_turn(kind, point)
        # What a model leaves out beside a cause it need not leave out without it: windows that were let go are joined again.
        joined = self._joined(point)
        return point if joined is None else self._in_turn(kind, joined)

    def _in_turn(self, kind: Kind, point: Point) -> Point:
        for _ in range(ROUNDS if kind.step(self.fit.records[0]) > 0.0 else 0):
            try:
                _, moved, error = self.parabola(kind, point.size, point.problem, point.unknowns)
                if not np.isfinite(error):
                    break
                problem, layout = self._with(point.problem, kind, self.corrected(kind, moved))
            except BadInput:
                break
            arrived = abs(moved - point.size) < SETTLED * error
            after = self._go_on(moved, problem, point.unknowns, layout, error)
            if not after.cost < 1.02 * point.cost:
                break
            point = after
            if arrived:
                break
        return point

    def _joined(self, point: Point) -> Point | None:
        """The point fitted by continuation; None where its windows stay as loose as they were."""
        loose = float(point.problem.tie)
        found = continued(point.problem, point.unknowns, first=max(loose, LOOSEST), speeds=sliding_speeds(point.problem))
        if found.tie <= loose:
            return None
        return self._point(point.size, found.problem, found.minimum.value, point.layout, found.minimum, point.stderr)

    def score(self, point: Point) -> tuple[Score, ...]:
        """The scores of a point on its own data."""
        return score(point.problem, point.unknowns, point.layout, group=self.group)[0]

    def _anew(self, kind: Kind, size: float, system: System) -> Point | None:
        """The model searched for on corrected records from a system that may be far off; None where that leads nowhere."""
        try:
            done = self.corrected(kind, size)
            windows, layout = self.cut([one.record for one in done])
            found = search(system, self._weighed(windows, layout, kind, done), self.fit.free, starts=1, seed=0)
        except (BadInput, NoAnswer):
            return None
        return self._point(size, found.problem, found.unknowns, layout, None)

    def _go_on(self, size: float, problem: Problem, at: Unknowns, layout: Layout, stderr: float = np.nan) -> Point:
        found = minimise(problem, at, Levenberg(limit=STEPS))
        return self._point(size, problem, found.value, layout, found, stderr)

    def _point(
        self, size: float, problem: Problem, unknowns: Unknowns, layout: Layout, found: Minimum | None, stderr: float = np.nan
    ) -> Point:
        if found is None:
            found = minimise(problem, unknowns, Levenberg(limit=1))
        count = freedom(problem, tied=float(problem.tie) > 0.0)
        schur = np.asarray(found.stats["schur"])
        return Point(size, stderr, problem, unknowns, float(found.stats["cost"]), count, layout, schur)

    def _with(self, problem: Problem, kind: Kind, done: Sequence[Corrected]) -> tuple[Problem, Layout]:
        """A problem with corrected data."""
        if kind.measured_only:
            measured = np.asarray(problem.windows.measured).copy()
            for first, count, one in self._rows(self.layout):
                record = done[one].record
                measured[first : first + count] = _in_rows(record.channels[record.observed_name], count, self._length)
            windows = eqx.tree_at(
                lambda w: (w.measured, w.weight), problem.windows, (measured, np.asarray(self.problem.windows.weight))
            )
            layout = self.layout
        else:
            windows, layout = self.cut([one.record for one in done])
        windows = self._weighed(windows, layout, kind, done)
        return eqx.tree_at(lambda p: p.windows, problem, windows), layout

    def _weighed(self, windows: Windows, layout: Layout, kind: Kind, done: Sequence[Corrected]) -> Windows:
        """Windows with the fit's own noise of the measured channel, or that of the correction, and what this has left of it."""
        weight = np.asarray(windows.weight).copy()
        for first, count, one in self._rows(layout):
            noise = done[one].noise or self.fit.noise[one]
            share = _in_rows(done[one].share, count, self._length)
            weight[first : first + count] = np.where(share > 0.0, 1.0 / (noise * np.where(share > 0.0, share, 1.0)), 0.0)
        return eqx.tree_at(lambda w: w.weight, windows, weight)

    def _rows(self, layout: Layout) -> list[tuple[int, int, int]]:
        return [(first, count, one) for one, (first, count) in enumerate(zip(layout.first, layout.windows))]


def _in_rows(values: np.ndarray, count: int, length: int) -> np.ndarray:
    padded = np.zeros(count * length)
    padded[: values.size] = values
    return padded.reshape(count, length)
