r"""Weak-form regression: which laws the measured motion speaks for, without simulating anything.

What the model's torque leaves of :math:`J\ddot y` is averaged under a bump that carries the derivatives, and regressed on the
torques the absent effects would exert on the measured motion, beside the ways in which the model's own parameters can still move.
It is fast and never gets lost, but noise in the motion biases it: it proposes shapes and starting values, simulation decides.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy import linalg

from ..mechanics import AbstractEffect, canonical_name
from ..parameters import free_specs, ravel, specs
from ..records import Record
from ..system import System
from .along_motion import Motion, motion, own_torques, ringing, torques
from .averaged import Averaged

ORDER = 8
"""Order of the autoregression that whitens the rows."""
RUNAWAY = 1e30
"""A torque this large, whatever its unit, belongs to a motion that has run away, and explains nothing. Its fourth power, which a
regression forms, stays within double precision."""


class WeakForm(Averaged):
    """A record averaged under bumps, ready to be regressed on any law of its joint and link; a drive's motor is their base, as it
    was measured.

    Where the link is not seen, or the motor is not, there is nothing to regress on: the form is ``blind``, and the motion of the
    one behind the gear stands for that of the other.
    """

    def __init__(self, record: Record) -> None:
        seen = _one_for_both(record) if record.blind else record.on_its_base()
        super().__init__(seen)
        self.record = record
        self.motion: Motion = motion(seen)
        self.blind = record.blind or record.kind == "transmitted"
        self._columns: dict[str, tuple[np.ndarray, np.ndarray]] = {}
        self._rung: dict[str, tuple[np.ndarray, np.ndarray]] = {}
        self._kept: dict[str, Any] = {}
        self._last: tuple[System, tuple[str, ...], Any] | None = None

    def missing(self, system: System, free: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
        """Missing torque under the bump (R,), and how it falls with each free parameter of the model (R, q).

        That of the system asked for last is remembered: many laws are held against it.
        """
        if self._last is not None and self._last[0] is system and self._last[1] == free:
            return self._last[2]
        torque, columns = self.along(system, free)
        left = float(system.inertia) * self.acceleration - self.average(self.motion.force + torque)
        by = self.average(columns)
        for j, name in enumerate(free):
            if name == "inertia":
                # The base of a drive's joint pushes nothing that was measured: with its inertia free all could be nothing.
                by[j] = 0.0 if self.record.kind == "drive" else -self.acceleration
        self._last = system, free, (left, by.T)
        return left, by.T

    def along(self, system: System, free: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
        """All torque on the link along the motion (N,), and how it changes with each free parameter of the model (q, N)."""
        system = system.on_its_base()
        torque, columns = torques(system, seeds_of(system, free), self.motion)
        return _bounded(torque), _bounded(columns)

    def column(self, effect: AbstractEffect, system: System) -> np.ndarray:
        """Torque of an effect on the measured motion, under the bump (R,)."""
        return self.average(_bounded(own_torques([effect], system, self.motion)[0]))

    def rung(self, effect: AbstractEffect, system: System) -> np.ndarray:
        """Under the bump (R, S), what a law that rings adds on the measured motion for each of its states that does not begin at
        rest; no columns for one that does not ring."""
        if not effect.rings:
            return np.zeros((self.acceleration.size, 0))
        return self.average(_bounded(ringing([effect], system, self.motion)[0])).T

    def begun(self, effect: AbstractEffect, system: System, free: tuple[str, ...]) -> np.ndarray:
        """How far the states (S,) of a law that rings are from rest at the first sample, regressed beside a model."""
        left, by = self.missing(system, free)
        rung = self.rung(effect, system)
        design = np.column_stack([by, self.column(effect, system), rung])
        white = whitener(left - design @ np.linalg.lstsq(design, left, rcond=None)[0])
        found = np.linalg.lstsq(white(design), white(left), rcond=None)[0][by.shape[1] :]
        # The law's own strength is left as it is: its states are for the torque that it makes at the strength found.
        return found[1:] / found[0] if found[0] > 0.0 else np.zeros(rung.shape[1])

    def choose(
        self, system: System, free: tuple[str, ...], variants: list[AbstractEffect], keep: int = 1
    ) -> list[AbstractEffect]:
        """The likeliest of several shapes of a law beside a fitted model, the best first.

        Parameters
        ----------
        system, free : the model and the parameters in which it can still move
        variants : the law at several shapes, each at a strength of its typical size
        keep : how many to give back
        """
        if len(variants) <= keep:
            return variants
        share = self._correlations(system, free, variants) ** 2
        rows = self.acceleration.size
        # A shape that has one more free parameter than another must bring as much more as chance would.
        fall = share * (rows - ORDER) - np.log(rows) * np.array([len(free_specs(v)) for v in variants])
        return [variants[k] for k in np.argsort(-fall, kind="stable")[:keep]]

    def kept(self, name: str, make: Callable[[], Any]) -> Any:
        """What was made for a law before, or is now: rows that do not go with the model."""
        if name not in self._kept:
            self._kept[name] = make()
        return self._kept[name]

    def evidence(self, system: System, free: tuple[str, ...], variants: list[AbstractEffect]) -> float:
        """Fall of the sum of squares, in units of the rows' own variance, by the likeliest shape of a law: near 1 by chance."""
        share = float(np.max(self._correlations(system, free, variants)) ** 2)
        return share * (self.acceleration.size - ORDER)

    def _correlations(self, system: System, free: tuple[str, ...], variants: list[AbstractEffect]) -> np.ndarray:
        """Correlation of each variant's torque with what the model leaves, none where physics forbids its sign."""
        if self.blind:
            return np.zeros(len(variants))
        left, by = self.missing(system, free)
        name, told = canonical_name(variants[0]), np.stack([ravel(v) for v in variants])
        if name not in self._columns or not np.array_equal(self._columns[name][0], told):
            self._columns[name] = told, self.average(_bounded(own_torques(variants, system, self.motion))).T
        columns = self._columns[name][1]
        if variants[0].rings:
            rung = self._rung_by(variants, system)
            return np.array([_explained(left, by, np.column_stack([c, r])) for c, r in zip(columns.T, rung)])
        white = whitener(left - by @ np.linalg.lstsq(by, left, rcond=None)[0])
        left, by, columns = white(left), white(by), white(columns)
        basis = np.linalg.qr(by)[0]
        left, columns = left - basis @ (basis.T @ left), columns - basis @ (basis.T @ columns)
        size = np.linalg.norm(columns, axis=0) * max(float(np.linalg.norm(left)), 1e-300)
        fall = np.where(size > 0.0, columns.T @ left / np.where(size > 0.0, size, 1.0), 0.0)
        signed = np.array([fixed_sign(v) for v in variants])
        return np.where(signed, np.maximum(fall, 0.0), np.abs(fall))

    def _rung_by(self, variants: list[AbstractEffect], system: System) -> np.ndarray:
        """What each variant of a law that rings adds under the bump (K, R, S), made once for the same variants."""
        name, told = canonical_name(variants[0]), np.stack([ravel(v) for v in variants])
        if name not in self._rung or not np.array_equal(self._rung[name][0], told):
            self._rung[name] = told, self.average(_bounded(ringing(variants, system, self.motion))).transpose(0, 2, 1)
        return self._rung[name][1]


def seeds_of(parametrised: Any, free: tuple[str, ...]) -> np.ndarray:
    """Directions (q, p) of free parameters among all that something has, zero for those that it has not."""
    names = list(specs(parametrised))
    return np.array([[float(own == name) for own in names] for name in free]).reshape(len(free), len(names))


def _one_for_both(record: Record) -> Record:
    """A drive of which motor or link is not seen, as if no play were between them."""
    place = record.channels["link"] if "link" in record.channels else record.channels["motor"] / record.ratio
    return dataclasses.replace(record, channels={"x": place, "y": place}, ratio=1.0, per_kt=False)


def _explained(left: np.ndarray, by: np.ndarray, columns: np.ndarray) -> float:
    """Multiple correlation of a law that rings, ``columns`` (R, 1 + S) its torque and what it does of itself, with what a model
    leaves (R,) whatever its parameters; none where that torque would have to count below zero.

    The torque of such a law is a narrow band, which a filter that whitens all that is left would take away: rows are whitened
    as what is left beside the law.
    """
    design = np.column_stack([by, columns])
    white = whitener(left - design @ np.linalg.lstsq(design, left, rcond=1e-10)[0])
    left, design = white(left), white(design)
    share = np.linalg.lstsq(design, left, rcond=1e-10)[0]
    if share[by.shape[1]] <= 0.0:
        return 0.0
    less, more = (left - d @ np.linalg.lstsq(d, left, rcond=1e-10)[0] for d in (design[:, : by.shape[1]], design))
    return float(np.sqrt(max(1.0 - (more @ more) / max(float(less @ less), 1e-300), 0.0)))


def _bounded(torques: np.ndarray) -> np.ndarray:
    """Torques along the motion (..., N), none of a law whose own motion runs away when it is led along: it speaks for nothing."""
    return np.where(np.max(np.abs(torques), axis=-1, keepdims=True) < RUNAWAY, torques, 0.0)


def fixed_sign(effect: AbstractEffect) -> bool:
    """True when physics forbids the torque of a law to change its sign."""
    return any(s.null is not None and s.lower >= s.null for s in specs(effect).values() if not s.fixed)


def whitener(residual: np.ndarray) -> Any:
    """A filter that makes rows like ``residual`` white: an autoregression from the Yule-Walker equations."""
    n = residual.size
    order = min(ORDER, n // 10)
    lags = np.array([residual[: n - k] @ residual[k:] for k in range(order + 1)]) / n
    lags[0] *= 1.0 + 1e-9
    weights = linalg.solve_toeplitz(lags[:-1], lags[1:]) if lags[0] > 0.0 else np.zeros(order)
    taps = np.concatenate([[1.0], -weights])
    # Each row less what the rows before it tell; scipy.signal would take half a second to import.
    return lambda rows: np.lib.stride_tricks.sliding_window_view(rows, order + 1, axis=0) @ taps[::-1]
