r"""The law of motion of a driven series, as tables fitted to its weak form.

A driven motion never comes back to a state with the drive where it was, so there are no neighbours to follow. But a system
with a measured input is one of states *and* inputs (Stark, 1999): with the drive among the regressors, states may be compared
whatever the drive did. For an oscillator of one degree of freedom that comparison is the restoring-force surface (Masri
and Caughey, 1979; Kerschen et al., 2006):

.. math:: \ddot s = f(s) - c(s)\,\dot s + r(w) + a_0 u + a_1 \dot u + a_2 \ddot u + a_3 \dddot u

with tables f, c and, where it predicts better, a table of friction r over the velocity of s or of the motion against the
ground, :math:`w = \dot s - a_2 \dot u`. Nothing of a joint is assumed: a contact shows as two kinks in f.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import minimize_scalar

ORDERS = 4  # of derivatives of the bump: the drive's third stands for a sensor that lags
POWER = 6  # of the bump (1 - tau^2)^6
CELLS = (16, 20, 24, 28, 34, 40, 48, 57, 68)  # of the table f that are tried
DAMPING_CELLS = 4
FRICTION_CELLS = 4  # on either side of rest, each some times as wide as the one before
FINEST = 0.02  # of the largest speed: the width of the cells next to rest
PARTS = 20  # contiguous stretches: left out in turn for the error, drawn anew for the interval
FOLDS = 4
MOVES = 3  # of the edges towards the kinks, while that predicts better
EVEN = 0.5
RIDGE = 1e-6  # on second differences of f: fills cells that the motion never visits
DRIFTS = (-0.9, -0.6, -0.4, -0.25, -0.12, 0.0, 0.12, 0.25, 0.4, 0.6, 0.9)
CLEARLY = 0.9  # a drift is believed that lowers the out-of-sample error by a tenth or more
FRICTIONS = ("none", "relative", "ground")


@dataclass(frozen=True, eq=False)
class Surface:
    """A fitted law, per sample: ``edges`` (K,) and ``force`` (K,) of f, linear between; ``damping_edges`` (D,) and ``damping``
    (D,) of c; ``friction_edges``, ``friction`` of r, None without; which ``against`` it acts; ``input`` (4,) the coefficients
    of the drive and its rates; ``error`` out-of-sample rms error of the weak form as a share of its rms value."""

    edges: np.ndarray
    force: np.ndarray
    damping_edges: np.ndarray
    damping: np.ndarray
    against: str
    friction_edges: np.ndarray | None
    friction: np.ndarray | None
    input: np.ndarray
    error: float

    def slopes(self, s: np.ndarray, v: np.ndarray, w: np.ndarray, scale: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives of the acceleration by s and by its velocity, at states (N,) with velocities ``w`` (N,) against the
        ground, where lengths of the table f have grown to ``scale`` (N,)."""
        by_s = _slope(self.edges, self.force, s / scale) - v * _slope(self.damping_edges, self.damping, s)
        by_v = -np.interp(s, self.damping_edges, self.damping)
        if self.friction_edges is not None and self.friction is not None:
            by_v = by_v + _slope(self.friction_edges, self.friction, v if self.against == "relative" else w)
        return by_s, by_v


def _slope(edges: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    cell = np.clip(np.searchsorted(edges, at) - 1, 0, edges.size - 2)
    return (np.diff(values) / np.diff(edges))[cell]


class WeakForm:
    r"""A driven series against bumps: :math:`\int \varphi\, d^k g/dt^k = (-1)^k \int \varphi^{(k)} g`, so nothing is
    differenced.

    Parameters
    ----------
    series, drive : (N,) with standard deviation 1
    reach : half-width of the bumps [samples]
    drift : by which share all lengths of the table f grow from the record's beginning to its end, as a wearing play does
    """

    def __init__(self, series: np.ndarray, drive: np.ndarray, reach: int, drift: float = 0.0) -> None:
        self.series, self.drive, self.reach, self.drift = series, drive, reach, drift
        self.scale = length_at(np.arange(series.size), series.size, drift)
        self.stride = max(1, reach // 4)
        bump = np.polynomial.Polynomial([1.0, 0.0, -1.0]) ** POWER
        tau = np.arange(-reach, reach + 1) / reach
        self._bumps = [(bump.deriv(k) if k else bump)(tau) / reach**k for k in range(ORDERS)]
        smooth = 2 * max(2, reach // 4) + 1
        from scipy.signal import savgol_filter  # half a second to import

        self.velocity = savgol_filter(series, smooth, 2, deriv=1)
        self.drive_velocity = savgol_filter(drive, smooth, 2, deriv=1)
        self.range = _inner(series / self.scale)

    def of(self, values: np.ndarray, order: int) -> np.ndarray:
        """The derivative of that order of ``values`` (N,), against each bump."""
        # A convolution turns the bump round, which is the sign of an odd derivative: both signs cancel.
        from scipy.signal import oaconvolve  # half a second to import

        return oaconvolve(values, self._bumps[order], mode="valid")[:: self.stride]

    @cached_property
    def acceleration(self) -> np.ndarray:
        """(R,)"""
        return self.of(self.series, 2)

    @cached_property
    def inputs(self) -> np.ndarray:
        """(R, 4) the drive and its first three rates."""
        return np.stack([self.of(self.drive, k) for k in range(ORDERS)], axis=1)

    def table(self, edges: np.ndarray) -> np.ndarray:
        """(R, K) the hats of a table of the series, one column an edge."""
        at = self.series / self.scale
        # A force that grows with its lengths keeps its stiffness.
        return np.stack([self.of(self.scale * _hat(edges, k, at), 0) for k in range(edges.size)], axis=1)

    @cached_property
    def damping(self) -> tuple[np.ndarray, np.ndarray]:
        """Edges, and (R, D) minus hats of the series times its velocity: rates of the hats' integrals."""
        edges = np.linspace(*_inner(self.series), DAMPING_CELLS + 1)
        # Splines carry their integral along; beyond the edges both end hats go on as they are.
        wide = np.concatenate([[self.series.min() - 1.0], edges, [self.series.max() + 1.0]])
        columns = []
        for k in range(edges.size):
            height = np.zeros(wide.size)
            height[k + 1] = 1.0
            height[0], height[-1] = float(k == 0), float(k == edges.size - 1)
            knots = np.concatenate([wide[:1], wide, wide[-1:]])
            columns.append(-self.of(BSpline(knots, height, 1).antiderivative()(self.series), 1))
        return edges, np.stack(columns, axis=1)

    def friction(self, speed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Edges, and (R, E) hats over a speed; those of the end cells are left to the damping."""
        half = np.geomspace(FINEST, 1.0, FRICTION_CELLS) * np.quantile(np.abs(speed), 0.995)
        edges = np.concatenate([-half[::-1], half])
        return edges, np.stack([self.of(_hat(edges, k, speed), 0) for k in range(1, edges.size - 1)], axis=1)


def _inner(values: np.ndarray) -> tuple[float, float]:
    low, high = np.quantile(values, [0.005, 0.995])
    return float(low), float(high)


def length_at(at: np.ndarray, samples: int, drift: float) -> np.ndarray:
    """Length at samples ``at`` of what grows steadily by a share ``drift`` over the record and is 1 in its middle."""
    return 1.0 + drift * (at / samples - 0.5)


def _hat(edges: np.ndarray, k: int, at: np.ndarray) -> np.ndarray:
    """The hat at an edge; the first and last cell go on beyond the ends."""
    height = np.zeros(edges.size)
    height[k] = 1.0
    cell = np.clip(np.searchsorted(edges, at) - 1, 0, edges.size - 2)
    return height[cell] + (at - edges[cell]) / (edges[cell + 1] - edges[cell]) * (height[cell + 1] - height[cell])


class Law:
    """One choice of tables, ready to be solved for any weights of the record's stretches.

    ``of(weights)`` is the least-squares `Surface` with the stretches (PARTS,) so weighted; ``error`` its out-of-sample error.
    """

    def __init__(self, weak: WeakForm, table: tuple[np.ndarray, np.ndarray], friction: str, ground: float) -> None:
        self.edges, self.hats = table
        self.damping_edges, damped = weak.damping
        self.against, self.friction_edges = friction, None
        columns = [self.hats, damped, weak.inputs]
        if friction != "none":
            speed = weak.velocity if friction == "relative" else weak.velocity - ground * weak.drive_velocity
            self.friction_edges, rubbed = weak.friction(speed)
            columns.append(rubbed)
        design = np.hstack(columns)
        self._scale = np.sqrt(np.mean(design**2, axis=0)) + 1e-300
        design, wanted = design / self._scale, weak.acceleration
        parts = np.array_split(np.arange(wanted.size), PARTS)
        self._gram = np.stack([design[p].T @ design[p] for p in parts])
        self._right = np.stack([design[p].T @ wanted[p] for p in parts])
        self._square = np.array([wanted[p] @ wanted[p] for p in parts])
        bend = np.zeros((self.edges.size - 2, design.shape[1]))
        for k in range(self.edges.size - 2):
            bend[k, k : k + 3] = [1.0, -2.0, 1.0]
        bend = bend / self._scale * np.median(self._scale[: self.edges.size])
        self._ridge = RIDGE * wanted.size * (bend.T @ bend) + 1e-12 * wanted.size * np.eye(design.shape[1])
        self.error = self._out_of_sample()

    def _solve(self, weights: np.ndarray) -> np.ndarray:
        gram = np.einsum("p,pij->ij", weights, self._gram) + self._ridge
        return np.linalg.solve(gram, weights @ self._right)

    def _out_of_sample(self) -> float:
        missed = 0.0
        fold = np.arange(PARTS) % FOLDS
        for k in range(FOLDS):
            theta, out = self._solve((fold != k).astype(float)), fold == k
            gram, right = self._gram[out].sum(axis=0), self._right[out].sum(axis=0)
            missed += float(self._square[out].sum() - 2.0 * theta @ right + theta @ gram @ theta)
        return float(np.sqrt(max(missed, 0.0) / self._square.sum()))

    def of(self, weights: np.ndarray) -> Surface:
        """The law that fits best."""
        theta = self._solve(weights) / self._scale
        force, damping, inputs, rubbed = np.split(theta, np.cumsum([self.edges.size, self.damping_edges.size, ORDERS]))
        friction = None if self.friction_edges is None else np.concatenate([[0.0], rubbed, [0.0]])
        return Surface(
            self.edges, force, self.damping_edges, damping, self.against, self.friction_edges, friction, inputs, self.error
        )


def find_drift(still: WeakForm, cells: int) -> float:
    """By which share the lengths of the law of motion grow over the record; 0 unless that predicts clearly better."""

    def error(drift: float) -> float:
        weak = WeakForm(still.series, still.drive, still.reach, drift)
        edges = np.linspace(*weak.range, cells + 1)
        return Law(weak, (edges, weak.table(edges)), "none", 0.0).error

    errors = [error(drift) for drift in DRIFTS]
    best = int(np.argmin(errors))
    if best in (0, len(DRIFTS) - 1) or errors[best] > CLEARLY * errors[DRIFTS.index(0.0)]:
        return 0.0
    near = (DRIFTS[best - 1], DRIFTS[best + 1])
    return float(minimize_scalar(error, bounds=near, method="bounded", options={"xatol": 0.005}).x)


def laws(weak: WeakForm, most: int) -> list[Law]:
    """For each number of cells (at most so many) the law that predicts best, with or without friction; best error first."""
    found = []
    for cells in CELLS:
        if cells > most:
            break
        edges = np.linspace(*weak.range, cells + 1)
        plain = Law(weak, (edges, weak.table(edges)), "none", 0.0)
        for _ in range(MOVES):
            edges = bent_edges(edges, plain.of(np.ones(PARTS)).force)
            moved = Law(weak, (edges, weak.table(edges)), "none", 0.0)
            if moved.error >= plain.error:
                break
            plain = moved
        ground = float(plain.of(np.ones(PARTS)).input[2])
        rubbed = [Law(weak, (plain.edges, plain.hats), friction, ground) for friction in FRICTIONS[1:]]
        found.append(min([plain, *rubbed], key=lambda one: one.error))
    return sorted(found, key=lambda one: one.error)


def bent_edges(edges: np.ndarray, values: np.ndarray) -> np.ndarray:
    """As many edges, moved to where a table bends: a kink, which an edge must meet, draws them near.

    Half of the cells' share goes by the square root of the bend, so that errors are spread evenly (de Boor, 1978), half by
    width.
    """
    width = np.diff(edges)
    bend = np.abs(np.diff(np.diff(values) / width))
    beside = 0.5 * (np.concatenate([bend[:1], bend]) + np.concatenate([bend, bend[-1:]]))
    root = np.sqrt(beside * width)
    share = (1.0 - EVEN) * root / max(root.sum(), 1e-300) + EVEN * width / width.sum()
    return np.interp(np.linspace(0.0, 1.0, edges.size), np.concatenate([[0.0], np.cumsum(share)]) / share.sum(), edges)
