r"""A quick look at which effects may be missing: weak-form regression on the measured motion, no simulation.

What the model's torque leaves of :math:`J\ddot y` is averaged under a bump that carries the derivatives, and regressed on the
torques the absent effects would exert on the measured motion, beside the ways in which the model's own parameters can still move.
It is fast and never gets lost, but noise in the motion biases it: it proposes shapes and starting values, simulation decides.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from scipy import linalg

from ..compiled import kept_jit
from ..mechanics import AbstractEffect, Drive, canonical_name
from ..parameters import ravel, specs, unravel
from ..records import Record
from ..signals import Bump, choose_intervals, fit_spline
from ..system import System

ORDER = 8
"""Order of the autoregression that whitens the rows."""


@dataclass(frozen=True)
class Motion:
    """The measured motion, smoothed, at the samples: arrays (N,) of t [s], y, dy, x, dx [rad, rad/s], F [N m]."""

    t: np.ndarray
    y: np.ndarray
    dy: np.ndarray
    x: np.ndarray
    dx: np.ndarray
    force: np.ndarray


def motion(record: Record, window: float = 0.1) -> Motion:
    """Smoothed motion of link and base."""
    t, zero = record.t, np.zeros(record.samples)

    def smooth(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        if not np.any(values):
            return zero, zero
        spline = fit_spline(t, values, t[0], window / choose_intervals(t, values, window))
        return spline(t), spline(t, 1)

    x, dx = smooth(record.channels.get("x", zero))
    seen, rate = smooth(record.channels[record.observed_name])
    y, dy = (seen + x, rate + dx) if record.observed_name == "z" else (seen, rate)
    return Motion(t, y, dy, x, dx, record.channels.get("F", zero))


class QuickLook:
    """The record seen through the bump, ready to be regressed on any law."""

    def __init__(self, record: Record) -> None:
        self.motion = motion(record)
        self._columns: dict[str, np.ndarray] = {}
        self._bump = Bump(record.samples, record.dt)
        zero = np.zeros(record.samples)
        raw = record.channels[record.observed_name]
        carried = record.channels.get("x", zero) if record.observed_name == "z" else zero
        self._acceleration = self._bump.against(raw + carried, 2)

    def missing(self, system: System, free: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
        """Missing torque under the bump (R,), and how it falls with each free parameter of the model (R, q)."""
        m = self.motion
        vector, names = jnp.asarray(ravel(system)), list(specs(system))
        seeds = np.zeros((len(free), vector.size))
        seeds[np.arange(len(free)), [names.index(n) for n in free]] = 1.0
        torque, columns = _torques(system, vector, jnp.asarray(seeds), m.t, m.y, m.dy, m.x, m.dx)
        left = float(system.inertia) * self._acceleration - self.average(m.force + np.asarray(torque))
        by = self.average(np.asarray(columns))
        for j, name in enumerate(free):
            if name == "inertia":
                by[j] = -self._acceleration
        return left, by.T

    def column(self, effect: AbstractEffect, system: System) -> np.ndarray:
        """Torque of an effect on the measured motion, under the bump (R,)."""
        m = self.motion
        return self.average(np.asarray(_own_torque(effect, system, m.t, m.y, m.dy, m.x, m.dx)))

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
        worth = self._worth(system, free, variants)
        return [variants[k] for k in np.argsort(-worth)[:keep]]

    def share(self, system: System, free: tuple[str, ...], variants: list[AbstractEffect]) -> float:
        """Share of what a model leaves that the likeliest shape of a law takes away, 0 to 1."""
        return float(np.max(self._worth(system, free, variants)) ** 2)

    def _worth(self, system: System, free: tuple[str, ...], variants: list[AbstractEffect]) -> np.ndarray:
        """Correlation of each variant's torque with what the model leaves, none where physics forbids its sign."""
        left, by = self.missing(system, free)
        name = canonical_name(variants[0])
        if name not in self._columns or self._columns[name].shape[1] != len(variants):
            self._columns[name] = np.stack([self.column(v, system) for v in variants], axis=1)
        columns = self._columns[name]
        white = _whitener(left - by @ np.linalg.lstsq(by, left, rcond=None)[0])
        left, by, columns = white(left), white(by), white(columns)
        basis = np.linalg.qr(by)[0]
        left, columns = left - basis @ (basis.T @ left), columns - basis @ (basis.T @ columns)
        size = np.linalg.norm(columns, axis=0) * max(float(np.linalg.norm(left)), 1e-300)
        fall = np.where(size > 0.0, columns.T @ left / np.where(size > 0.0, size, 1.0), 0.0)
        signed = np.array([fixed_sign(v) for v in variants])
        return np.where(signed, np.maximum(fall, 0.0), np.abs(fall))

    def average(self, torque: np.ndarray) -> np.ndarray:
        """One or several signals (..., N) under the bump (..., R)."""
        return self._bump.against(torque)


def fixed_sign(effect: AbstractEffect) -> bool:
    """True when physics forbids the torque of a law to change its sign."""
    return any(s.null is not None and s.lower >= s.null for s in specs(effect).values() if not s.fixed)


def _whitener(residual: np.ndarray) -> Any:
    """A filter that makes rows like ``residual`` white: an autoregression from the Yule-Walker equations."""
    n = residual.size
    order = min(ORDER, n // 10)
    lags = np.array([residual[: n - k] @ residual[k:] for k in range(order + 1)]) / n
    lags[0] *= 1.0 + 1e-9
    weights = linalg.solve_toeplitz(lags[:-1], lags[1:]) if lags[0] > 0.0 else np.zeros(order)
    taps = np.concatenate([[1.0], -weights])
    from scipy.signal import lfilter  # half a second to import, and a plain fit does without

    return lambda rows: lfilter(taps, [1.0], rows, axis=0)[order:]


@kept_jit
def _torques(system: System, vector: Any, seeds: Any, t: Any, y: Any, dy: Any, x: Any, dx: Any) -> tuple[Any, Any]:
    """All torque on the link along a motion (N,), and its derivatives (q, N) along ``seeds`` (q, p)."""
    own = jnp.zeros((len(system.state_names) - 2, t.shape[0]))
    if own.shape[0]:
        own = jnp.stack([s for n in sorted(system.effects) for s in _states(system.effects[n], system, t, y, dy, x, dx)])

    def along(vector: Any) -> Any:
        known = unravel(system, vector)

        def at(t: Any, y: Any, dy: Any, x: Any, dx: Any, own: Any) -> Any:
            state = (y, dy, *(own[i] for i in range(own.shape[0])))
            return known.torques(known.instant(t, state, Drive(x, dx)), state)[0]

        return jax.vmap(at, in_axes=(0, 0, 0, 0, 0, 1))(t, y, dy, x, dx, own)

    torque = along(vector)
    return torque, jax.vmap(lambda e: jax.jvp(along, (vector,), (e,))[1])(seeds)


@kept_jit
def _own_torque(effect: AbstractEffect, system: System, t: Any, y: Any, dy: Any, x: Any, dx: Any) -> Any:
    """Torque of one effect along a motion (N,)."""
    alone = _beside(effect, system)
    states = _states(effect, system, t, y, dy, x, dx)

    def at(t: Any, y: Any, dy: Any, x: Any, dx: Any, own: Any) -> Any:
        now = alone.instant(t, (y, dy), Drive(x, dx))
        return effect.torque(now.seen_by(own)) + jnp.zeros_like(y)

    return jax.vmap(at)(t, y, dy, x, dx, states)


def _beside(effect: AbstractEffect, system: System) -> System:
    return System(system.inertia, system.contact, system.damper, {canonical_name(effect): effect}, system.observed)


def _states(effect: AbstractEffect, system: System, t: Any, y: Any, dy: Any, x: Any, dx: Any) -> tuple[Any, ...]:
    """Internal states of a law along a motion, by Heun's method at the samples."""
    if not effect.states:
        return ()
    alone = System(system.inertia, system.contact, system.damper, {}, system.observed)

    def instant(at: Any) -> Any:
        t, y, dy, x, dx = at
        return alone.instant(t, (y, dy), Drive(x, dx))

    def step(own: Any, pair: Any) -> tuple[Any, Any]:
        a, b = pair
        h = b[0] - a[0]
        first = effect.rate(instant(a).seen_by(own))
        trial = tuple(s + h * r for s, r in zip(own, first))
        second = effect.rate(instant(b).seen_by(trial))
        return tuple(s + 0.5 * h * (p + q) for s, p, q in zip(own, first, second)), own

    rows = (t, y, dy, x, dx)
    begin = effect.start(instant(tuple(v[0] for v in rows)))
    begin = tuple(jnp.asarray(s, dtype=y.dtype) for s in begin)
    end, path = jax.lax.scan(step, begin, (tuple(v[:-1] for v in rows), tuple(v[1:] for v in rows)))
    return tuple(jnp.append(p, e) for p, e in zip(path, end))
