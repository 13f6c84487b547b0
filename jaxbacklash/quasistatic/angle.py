"""What depends on the angle, whichever way the joint goes: the gear's transmission error, an encoder off its centre, a wrong
ratio.

It is a free smooth function, a straight line with cubic splines, as fine as predicts passes that were left out, and waves of one
turn and half a turn of motor and link where the motion covers them. It cancels in the play, which is what differs between the
directions at one angle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..signals import BSplines

PIECES = (0, 3, 6, 12, 24)
"""Pieces of the spline that are tried; 0 is a straight line."""
COVERED = 0.75
"""Turns that a motion has to cover before a wave of that period is told from a straight line."""
DRIFTS = 10
"""Slow functions of time, at most."""


@dataclass(frozen=True)
class Wave:
    """One wave over the angle: ``name`` of what turns, ``order`` of its turn, ``period`` in the angle's unit."""

    name: str
    order: int
    period: float


@dataclass(frozen=True)
class Curve:
    """A linear family of functions of the angle between ``low`` and ``high``."""

    low: float
    high: float
    pieces: int
    waves: tuple[Wave, ...]

    def rows(self, angle: np.ndarray) -> np.ndarray:
        """The family's functions at some angles (N,), shape (N, K): a constant, a line, splines, and a sine and cosine a wave."""
        at = np.clip((angle - self.low) / max(self.high - self.low, 1e-300), 0.0, 1.0)
        columns = [np.ones_like(at), at - 0.5]
        if self.pieces:
            inner = np.linspace(0.0, 1.0, self.pieces + 1)
            knots = np.concatenate([np.zeros(3), inner, np.ones(3)])
            # A constant and a line are sums of all splines: two of these would be one too many each.
            columns += list(BSplines(at, knots, 3).of(np.eye(knots.size - 4)).T[1:-1])
        for wave in self.waves:
            turn = 2.0 * np.pi * angle / wave.period
            columns += [np.cos(turn), np.sin(turn)]
        return np.stack(columns, axis=1)

    def at(self, angle: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
        """One function of the family, (N,), a part of the angles at a time."""
        parts = np.array_split(angle, max(1, angle.size // 100_000))
        return np.concatenate([self.rows(part) @ coefficients for part in parts])

    def wave_at(self, index: int) -> slice:
        """Where a wave's two columns stand."""
        first = 2 + (self.pieces + 1 if self.pieces else 0) + 2 * index
        return slice(first, first + 2)


def waves(low: float, high: float, *, ratio: float | None, angular: bool) -> tuple[Wave, ...]:
    """The waves that a motion from ``low`` to ``high`` (of the link, in rad) can tell: of the motor's turn, where the gear's
    ``ratio`` is known, and of the link's."""
    if not angular:
        return ()
    found = []
    turning = [("link", 2.0 * np.pi)]
    if ratio is not None and abs(ratio) > 1.5:
        turning.insert(0, ("motor", 2.0 * np.pi / abs(ratio)))
    for name, turn in turning:
        found += [Wave(name, order, turn / order) for order in (1, 2) if high - low > COVERED * turn]
    return tuple(found)


def families(low: float, high: float, told: tuple[Wave, ...]) -> list[Curve]:
    """The families to choose from, the plainest first."""
    plain = [Curve(low, high, pieces, ()) for pieces in PIECES]
    return plain + ([Curve(low, high, pieces, told) for pieces in PIECES[:4]] if told else [])


def drift_rows(t: np.ndarray, groups: int) -> np.ndarray:
    """Slow functions of time without a constant, (N, K): one for every four groups at most: the play itself changes
    sign with every one."""
    count = min(DRIFTS, max(1, groups // 4)) if groups >= 4 else 0
    at = 2.0 * (t - t[0]) / max(t[-1] - t[0], 1e-300) - 1.0
    return np.polynomial.legendre.legvander(at, count)[:, 1:]
