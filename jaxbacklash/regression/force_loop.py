r"""What a loop of transmitted force against prescribed motion shows by itself: play, stiffness, and where the link slides.

A slow base motion x moves a link that dry friction holds to the ground through the play: :math:`z = y - x` follows -x until
the contact force reaches what friction holds, and stays there while the link slides. So z is -x in a stop of half-width
:math:`r = b/2 + T_c/k` (Prandtl's stop operator), whatever k is, and :math:`T = k\,\delta(z)` is linear in k. Two widths are
searched, the rest is least squares. Inertia and damping are left to the fit by simulation, which starts from here.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from ..records import Record

NOTHING = 0.1
"""Share of the sliding force below which the joint counts as carrying nothing; what is more, only contact can carry."""


@dataclass(frozen=True)
class Plateau:
    """Travel over which the joint carries next to nothing, passing from one side to the other: ``median`` of ``count``
    passages [m or rad] and its standard error; both None where there is no passage."""

    median: float | None
    stderr: float | None
    count: int

    def as_json(self, unit: str) -> dict[str, object]:
        told: dict[str, object] = {"value": self.median, "stderr": self.stderr, "unit": unit, "passages": self.count}
        return told if self.median is not None else told | {"why": "the force never passes from one side to the other"}


@dataclass(frozen=True)
class Loop:
    """A record's force loop: ``backlash`` total play [m or rad], ``stiffness`` [N/m or N m/rad], ``sliding`` the force at which
    the link slides [N or N m] (as much as the record shows, where it never does), ``share`` of the mean square of T that the
    loop leaves unexplained, ``plateau`` read off without any model."""

    backlash: float
    stiffness: float
    sliding: float
    share: float
    plateau: Plateau


def read_loop(record: Record, most: int = 1500) -> Loop:
    """The loop of a record of transmitted force.

    Parameters
    ----------
    record : with base motion ``x`` and transmitted force ``T``, signed as in `jaxbacklash.records.orientation`
    most : samples that are looked at, evenly spaced; a slow loop needs no more
    """
    step = max(1, record.samples // most)
    x, force = (np.asarray(record.channels[name][::step], float) for name in ("x", "T"))
    reach = 0.5 * float(np.ptp(x))
    size = float(force @ force) + 1e-300

    def solve(half: float, z: np.ndarray) -> tuple[float, float]:
        pressed = z - np.clip(z, -half, half)
        stiffness = max(float(pressed @ force) / max(float(pressed @ pressed), 1e-300), 0.0)
        return float(np.sum((force - stiffness * pressed) ** 2)) / size, stiffness

    def at(point: np.ndarray) -> float:
        width, half = point
        if not 0.0 < width <= 2.0 * reach or not 0.0 <= half < width:
            return 2.0
        return solve(half, stop(x, width))[0]

    found = []
    for width in reach * np.concatenate([np.geomspace(0.02, 1.0, 28), [2.0]]):
        z = stop(x, width)
        found += [(solve(share * width, z)[0], width, share * width) for share in np.linspace(0.02, 0.95, 16)]
    _, width, half = min(found)
    fine = {"xatol": 1e-4 * width, "fatol": 1e-6, "maxfev": 120}
    from scipy.optimize import minimize  # a seventh of a second to import, and only records of a force need it

    polished = minimize(at, (width, half), method="Nelder-Mead", options=fine)
    width, half = (float(v) for v in polished.x)
    share, stiffness = solve(half, stop(x, width))
    largest = float(np.quantile(np.abs(force), 0.99))
    stiffness = max(stiffness, 1e-3 * largest / reach)
    sliding = min(stiffness * (width - half), largest)
    return Loop(2.0 * half, stiffness, sliding, share, read_plateau(record.channels["x"], record.channels["T"]))


def stop(x: np.ndarray, width: float) -> np.ndarray:
    """Prandtl's stop operator: -x kept within -width ... width, shape (N,), beginning in the middle."""
    z, before, found = 0.0, float(x[0]), []
    for now in x.tolist():
        z = min(max(z - (now - before), -width), width)
        before = now
        found.append(z)
    return np.asarray(found)


def read_plateau(x: np.ndarray, force: np.ndarray) -> Plateau:
    """How far the base travels while the force is below a tenth of its sliding level, on its way from one side to the other.

    Parameters
    ----------
    x, force : (N,) base motion and transmitted force
    """
    side = np.where(np.abs(force) < NOTHING * sliding_level(force), 0, np.sign(force)).astype(int)
    ends = np.flatnonzero(np.diff(side)) + 1
    starts = np.concatenate([[0], ends])
    stops = np.concatenate([ends, [side.size]])
    widths = [
        abs(float(x[last] - x[first]))
        for first, last in zip(starts[1:-1], stops[1:-1])
        if side[first] == 0 and side[first - 1] * side[last] < 0
    ]
    # Noise at a threshold makes passages of no width, beside the real ones.
    widths = [w for w in widths if w > 0.25 * max(widths)]
    if not widths:
        return Plateau(None, None, 0)
    # Of normal values: the standard deviation from the median deviation, and from it that of their median.
    spread = float(np.median(np.abs(np.asarray(widths) - np.median(widths)))) / NormalDist().inv_cdf(0.75)
    return Plateau(float(np.median(widths)), float(np.sqrt(0.5 * np.pi / len(widths))) * spread, len(widths))


def sliding_level(force: np.ndarray) -> float:
    """The force at which the link slides: the median of the larger half."""
    size = np.abs(force)
    return float(np.median(size[size > 0.5 * np.quantile(size, 0.98)]))
