"""Laws followed along a measured motion: their torque, its derivatives, and the states of those with a memory. No simulation."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ..compiled import kept_jit
from ..mechanics import AbstractEffect, Drive, canonical_name
from ..parameters import ravel, unravel
from ..records import Record
from ..records.force import force_edges
from ..signals import choose_intervals, fit_spline, span
from ..system import System

FINEST = 5e-4
"""Longest step [s] for states along a motion: half of the time in which the quickest of them follow."""


@dataclass(frozen=True)
class Motion:
    """The measured motion, smoothed, at the samples: arrays (N,) of t [s], y, dy, x, dx [rad, rad/s], F [N m]."""

    t: np.ndarray
    y: np.ndarray
    dy: np.ndarray
    x: np.ndarray
    dx: np.ndarray
    force: np.ndarray

    @property
    def rows(self) -> tuple[np.ndarray, ...]:
        """t, y, dy, x, dx."""
        return self.t, self.y, self.dy, self.x, self.dx

    @property
    def substeps(self) -> int:
        """Steps a sample that follow the states of laws."""
        return max(1, int(np.ceil(float(np.median(np.diff(self.t))) / FINEST - 1e-9)))


def motion(record: Record) -> Motion:
    """Smoothed motion of link and base."""
    x, dx = smooth(record.t, record.channels.get("x", np.zeros(record.samples)))
    seen, rate = smooth(record.t, record.channels[record.observed_name])
    y, dy = (seen + x, rate + dx) if record.observed_name == "z" else (seen, rate)
    return Motion(record.t, y, dy, x, dx, force_edges(record, 1))


def smooth(t: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A measured angle (N,) without its noise, and its rate."""
    if not np.any(values):
        return np.zeros_like(values), np.zeros_like(values)
    window = span(float((t[-1] - t[0]) / (t.size - 1)))
    spline = fit_spline(t, values, t[0], window / choose_intervals(t, values, window))
    return spline(t), spline(t, 1)


def torques(system: System, seeds: np.ndarray, m: Motion) -> tuple[np.ndarray, np.ndarray]:
    """All torque on the link along a motion (N,), and its derivatives (q, N) along ``seeds`` (q, p) of the parameters."""
    torque, columns = _torques(system, jnp.asarray(ravel(system)), jnp.asarray(seeds), m.rows, m.substeps)
    return np.asarray(torque), np.asarray(columns)


def own_torques(shapes: list[AbstractEffect], system: System, m: Motion, begun: np.ndarray | None = None) -> np.ndarray:
    """Torque of one law at each of its shapes (K, N), in a system like this one along a motion.

    ``begun`` (K, S) is how far its states are at the first sample from where they would rest, zero unless given.
    """
    joint = _joint(system)
    if begun is not None:
        rung = zip(own_torques(shapes, system, m), ringing(shapes, system, m), begun)
        return np.stack([torque + offset @ columns for torque, columns, offset in rung])
    if shapes[0].states and len({jax.tree.structure(s) for s in shapes}) == 1:
        # States are followed sample by sample, which takes no longer for several shapes than for one.
        vectors = np.stack([ravel(s) for s in shapes])
        return np.asarray(_own_torques(shapes[0], vectors, joint, m.rows, m.substeps))
    return np.stack([np.asarray(_own_torque(s, joint, m.rows, m.substeps)) for s in shapes])


def ringing(shapes: list[AbstractEffect], system: System, m: Motion) -> np.ndarray:
    """Torque (K, S, N) of one law at each of its shapes for each state that is 1 more at the first sample: what it does later of
    itself, where it is linear in its states."""
    vectors = np.stack([ravel(s) for s in shapes])
    return np.asarray(_ringing(shapes[0], vectors, _joint(system), m.rows, m.substeps))


def own_tangents(effect: AbstractEffect, system: System, seeds: np.ndarray, m: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Torque of one law and its derivatives (q, N) along ``seeds`` (q, p) of the effect's parameters, its states following."""
    joint, vector = _joint(system), jnp.asarray(ravel(effect))
    torque, columns = _own_tangents(effect, vector, jnp.asarray(seeds), joint, m.rows, m.substeps)
    return np.asarray(torque), np.asarray(columns)


def own_states(effect: AbstractEffect, system: System, m: Motion, begun: np.ndarray | None = None) -> tuple[np.ndarray, ...]:
    """Internal states of a law along a motion, (N,) each; ``begun`` (S,) is how far they are from rest at the first sample."""
    begun = np.zeros(len(effect.states)) if begun is None else np.asarray(begun)
    return tuple(np.asarray(s) for s in _followed(effect, _joint(system), m.rows, m.substeps, begun))


def _joint(system: System) -> System:
    """The joint alone: what an effect sees of a system does not depend on other effects' programs."""
    return System(system.inertia, system.contact, system.damper, {}, system.observed)


@kept_jit
def _torques(system: System, vector: Any, seeds: Any, rows: Any, substeps: int) -> tuple[Any, Any]:
    t, y, dy, x, dx = rows
    own = jnp.zeros((len(system.state_names) - 2, t.shape[0]))
    if own.shape[0]:
        names = sorted(system.effects)
        own = jnp.stack([s for n in names for s in _states(system.effects[n], _joint(system), rows, substeps)])

    def along(vector: Any) -> Any:
        known = unravel(system, vector)

        def at(t: Any, y: Any, dy: Any, x: Any, dx: Any, own: Any) -> Any:
            state = (y, dy, *(own[i] for i in range(own.shape[0])))
            return known.torques(known.instant(t, state, Drive(x, dx)), state)[0]

        return jax.vmap(at, in_axes=(0, 0, 0, 0, 0, 1))(t, y, dy, x, dx, own)

    torque = along(vector)
    return torque, jax.vmap(lambda e: jax.jvp(along, (vector,), (e,))[1])(seeds)


def _alone(effect: AbstractEffect, joint: System, rows: Any, substeps: int, begun: Any = None) -> Any:
    beside = System(joint.inertia, joint.contact, joint.damper, {canonical_name(effect): effect}, joint.observed)
    at_motor = effect.port == "motor"  # then the motion is that of the motor
    states = _states(effect, joint, rows, substeps, begun)

    def at(t: Any, y: Any, dy: Any, x: Any, dx: Any, own: Any) -> Any:
        now = beside.instant(t, (y, dy), Drive(x, dx))
        now = replace(now, th=y, dth=dy) if at_motor else now
        torque = effect.torque(now.seen_by(own)) + jnp.zeros_like(y)
        if type(effect).reshape is AbstractEffect.reshape:
            return torque
        # Where it moves the play, the contact's torque is another.
        return torque + beside.bare_torque(now) - joint.bare_torque(joint.instant(t, (y, dy), Drive(x, dx)))

    t, y, dy, x, dx = rows
    return jax.vmap(at)(t, y, dy, x, dx, states)


_own_torque = kept_jit(_alone)


@kept_jit
def _own_torques(effect: AbstractEffect, vectors: Any, joint: System, rows: Any, substeps: int) -> Any:
    return jax.vmap(lambda vector: _alone(unravel(effect, vector), joint, rows, substeps))(vectors)


@kept_jit
def _ringing(effect: AbstractEffect, vectors: Any, joint: System, rows: Any, substeps: int) -> Any:
    still = jnp.zeros(len(effect.states))

    def of(vector: Any) -> Any:
        along = lambda begun: _alone(unravel(effect, vector), joint, rows, substeps, begun)  # noqa: E731
        return jax.vmap(lambda e: jax.jvp(along, (still,), (e,))[1])(jnp.eye(still.size))

    return jax.vmap(of)(vectors)


@kept_jit
def _own_tangents(effect: AbstractEffect, vector: Any, seeds: Any, joint: System, rows: Any, substeps: int) -> tuple[Any, Any]:
    def along(vector: Any) -> Any:
        return _alone(unravel(effect, vector), joint, rows, substeps)

    return along(vector), jax.vmap(lambda e: jax.jvp(along, (vector,), (e,))[1])(seeds)


@kept_jit
def _followed(effect: AbstractEffect, joint: System, rows: Any, substeps: int, begun: Any) -> tuple[Any, ...]:
    return _states(effect, joint, rows, substeps, begun)


def _states(effect: AbstractEffect, joint: System, rows: Any, substeps: int, begun: Any = None) -> tuple[Any, ...]:
    """Internal states by Heun's method, the motion straight between its samples in ``substeps`` parts; ``begun`` (S,) is how far
    they are from rest at the first of them."""
    if not effect.states:
        return ()

    def instant(at: Any) -> Any:
        t, y, dy, x, dx = at
        return joint.instant(t, (y, dy), Drive(x, dx))

    def step(own: Any, pair: Any) -> tuple[Any, Any]:
        a, b = pair

        def part(k: Any, own: Any) -> Any:
            left, right = (tuple(u + (v - u) * ((k + i) / substeps) for u, v in zip(a, b)) for i in (0.0, 1.0))
            h = right[0] - left[0]
            first = effect.rate(instant(left).seen_by(own))
            tried = tuple(s + h * r for s, r in zip(own, first))
            second = effect.rate(instant(right).seen_by(tried))
            return tuple(s + 0.5 * h * (p + q) for s, p, q in zip(own, first, second))

        for k in range(substeps):
            own = part(float(k), own)
        # One array, as the compiler may copy several of them whole at every sample.
        return own, jnp.stack(own)

    begin = effect.start(instant(tuple(v[0] for v in rows)))
    begin = tuple(jnp.asarray(s, dtype=rows[1].dtype) for s in begin)
    begin = begin if begun is None else tuple(s + begun[i] for i, s in enumerate(begin))
    _, path = jax.lax.scan(step, begin, (tuple(v[:-1] for v in rows), tuple(v[1:] for v in rows)))
    return tuple(jnp.concatenate([b[None], path[:, i]]) for i, b in enumerate(begin))
