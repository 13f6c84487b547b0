"""What a system says at many samples of a motion at once, by one program whatever their number."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp
import numpy as np

from .compiled import kept_jit
from .mechanics import AbstractEffect, Drive, Instant
from .system import System

SEEN = (
    "t", "y", "dy", "x", "dx", "z", "dz", "deflection", "contact", "stiffness", "inertia", "drifted", "damping", "rubbed",
)  # fmt: skip
"""What a law without internal states sees of a moment, where the direction of sliding is not known."""
FEWEST = 1024
"""Samples of the smallest program; larger ones have twice, four times, ... as many."""


@dataclass(frozen=True)
class Pointwise:
    """``now``, what effects see (arrays (N,)); ``torque`` on the link but the driving force, and ``joint``, the part of it
    that acts through the joint [N m]."""

    now: Instant
    torque: np.ndarray
    joint: np.ndarray


def along(system: System, t: Any, y: Any, dy: Any, x: Any, dx: Any, force: Any = 0.0) -> Pointwise:
    """What a system says along a motion, arrays (N,) or numbers, its internal states at rest: [s, rad, rad/s, N m]."""
    rows = [np.asarray(row, float) for row in np.broadcast_arrays(t, y, dy, x, dx, force)]
    size, (t, y, dy, x, dx, _) = rows[0].size, rows
    *seen, torque, joint = (np.asarray(row)[:size] for row in _along(system, tuple(padded(row) for row in rows)))
    told: dict[str, Any] = dict(zip(SEEN[5:], seen))
    now = Instant(t, y, dy, x, dx, **told)
    return Pointwise(now, torque, joint)


def exerted(effect: AbstractEffect, now: Instant) -> np.ndarray:
    """Torque of one law without internal states (N,) at what it sees, arrays (N,) or numbers [N m]."""
    rows = tuple(padded(np.asarray(row, float)) for row in np.broadcast_arrays(*(getattr(now, name) for name in SEEN)))
    return np.asarray(_exerted(effect, rows))[: now.t.size]


def padded(row: np.ndarray) -> np.ndarray:
    """The samples (N, ...), the last one repeated until there are as many as a program takes."""
    room = max(FEWEST, 1 << (row.shape[0] - 1).bit_length())
    return np.pad(row, [(0, room - row.shape[0])] + [(0, 0)] * (row.ndim - 1), mode="edge")


def torques(system: System, rows: Any) -> tuple[Instant, Any, Any]:
    """What effects see, and the torques, at the rows t, y, dy, x, dx and force, all of one shape."""
    t, y, dy, x, dx, force = rows
    state = (y, dy, *(jnp.zeros_like(y) for _ in system.state_names[2:]))
    now = system.instant(t, state, Drive(x, dx, force))
    return now, *system.torques(now, state)


@kept_jit
def _exerted(effect: AbstractEffect, rows: Any) -> Any:
    return jnp.broadcast_to(effect.torque(Instant(**dict(zip(SEEN, rows)))), rows[0].shape)


@kept_jit
def _along(system: System, rows: Any) -> tuple[Any, ...]:
    now, torque, joint = torques(system, rows)
    said = (*(getattr(now, name) for name in SEEN[5:]), torque, joint)
    return tuple(jnp.broadcast_to(v, rows[0].shape) for v in said)
