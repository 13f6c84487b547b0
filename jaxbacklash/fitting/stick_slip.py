r"""Records of transmitted force: the link is not seen, but dry friction holds it, so that it forgets where it began.

Sticking and sliding make the trajectory follow from the base motion alone, and it does not diverge: one run through the whole
record replaces the windows' free starts. Each step of the search takes the normal equations of the tied windows at such a run,
with starts and input eliminated, moves the parameters, and runs again, so that a model that misses much cannot hide it in gaps
between windows.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from ..effects import Contact
from ..mechanics import Drive
from ..shooting.chunks import scan_used
from ..shooting.input_spline import local_coefficients
from ..shooting.levenberg import Levenberg, minimise
from ..shooting.multiple_shooting import trajectory
from ..shooting.problem import Problem, Unknowns
from ..system import System
from .settings import SHORTEST, TIGHTEST

Array = Any


def sticks_and_slips(system: System) -> bool:
    """Whether the transmitted force is observed and dry friction holds the link to the ground."""
    return system.observed == "T" and "ground" in system.slides


@eqx.filter_jit
def march(problem: Problem, theta: Array, coefficients: Array) -> Array:
    """Starts (n, W) of all windows along one run through each record, from rest where the first force says the link is.

    Parameters
    ----------
    theta : (q,) free parameters in units of their scale
    coefficients : (W, m) of the input's spline
    """
    w, system = problem.windows, problem.rebuild(theta)
    local = local_coefficients(problem.windows, coefficients)
    follows = jnp.concatenate([jnp.zeros(1), w.tie[:-1]])
    level = 10.0 / jnp.max(w.weight)

    def step(state: Array, at: Any) -> tuple[Array, Array]:
        t0, first, follow, own, force = at
        x, dx = (w.basis[order, 0] @ own for order in (0, 1))
        fresh = jnp.stack(system.rest(t0, x + place(system, t0, x, first, level), jnp.zeros_like(x), Drive(x, dx)))
        begin = jnp.where(follow > 0.0, state, fresh)
        path = trajectory(problem, theta, begin, own, t0, force)
        return jnp.stack(path.end), begin

    begun = jnp.zeros(len(system.state_names))
    return scan_used(step, begun, (w.t0, w.measured[:, 0], follows, local, w.force), w.used).T


def place(system: System, t: Array, x: Array, force: Array, level: Array) -> Array:
    """Relative position at which the contact carries this force, with the base at ``x``; the middle of the play where it carries
    less than noise."""
    if system.contact is None:
        return jnp.zeros_like(force)
    pressed = force / jnp.maximum(system.contact.stiffness, 1e-300)
    if not isinstance(system.contact, Contact):
        return pressed
    low, high = system.edges(t, x)
    return jnp.where(force > level, high + pressed, jnp.where(force < -level, low + pressed, 0.5 * (low + high)))


def run(problem: Problem, theta: Any) -> tuple[Unknowns, dict[str, Any]]:
    """One run with these parameters, and what it shows: ``cost``, ``schur``, ``score``, ``predicted``."""
    coefficients = np.asarray(problem.windows.coefficients)
    unknowns = Unknowns(np.asarray(theta), np.asarray(march(problem, theta, coefficients)), coefficients)
    tied = eqx.tree_at(lambda p: p.tie, problem, np.asarray(TIGHTEST))
    return unknowns, minimise(tied, unknowns, Levenberg(limit=1)).stats


def search_stick_slip(
    problem: Problem, theta: Any, *, limit: int = 30, tell: Callable[[int], None] = lambda step: None
) -> tuple[Unknowns, dict[str, Any], int]:
    """Levenberg-Marquardt over the parameters alone, each trial a run of its own: where it ended, what it shows, steps taken."""
    lower = _with_lightest(problem)
    theta = np.clip(np.asarray(theta, float), lower, problem.upper)
    unknowns, seen = run(problem, theta)
    rows = float(np.sum(np.asarray(problem.windows.weight) > 0.0))
    damping, steps = 1e-2, 1
    while steps < limit and _sound(seen):
        move = _step(seen["schur"], seen["score"], damping)
        least_gain = 1e-2 * max(1.0, 2.0 * float(seen["cost"]) / rows)
        if 0.5 * float(seen["score"] @ move) < least_gain and damping < 1.0:
            break
        trial = _within(problem, theta, np.clip(theta + move, lower, problem.upper))
        further, shown = run(problem, trial)
        steps += 1
        tell(steps)
        gain = float(seen["cost"] - shown["cost"])
        if gain > 0.0 and _sound(shown):
            theta, unknowns, seen = trial, further, shown
            damping = max(0.2 * damping, 1e-9)
            if gain < least_gain:
                break
        else:
            damping = max(10.0 * damping, 1e-6)
            if damping > 1e4:
                break
    return unknowns, {**seen, "steps": steps}, steps


def _sound(seen: dict[str, Any]) -> bool:
    """Whether a run stayed finite, and so did its derivatives."""
    return bool(np.isfinite(seen["cost"]) and np.all(np.isfinite(seen["schur"])) and np.all(np.isfinite(seen["score"])))


def _step(schur: np.ndarray, score: np.ndarray, damping: float) -> np.ndarray:
    scale = np.sqrt(np.maximum(np.diag(schur), 0.0))
    scale = np.where(scale > 1e-12 * np.max(scale, initial=1e-300), scale, np.inf)
    scaled = schur / np.outer(scale, scale) + (damping + 1e-12) * np.eye(scale.size)
    return np.asarray(np.linalg.lstsq(scaled, score / scale, rcond=None)[0] / scale)


def _within(problem: Problem, old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Values that must keep their sign stay between half and twice what they are."""
    scale = np.sum(problem.directions, axis=0)
    offset = np.sum(np.where(problem.directions != 0.0, problem.base[:, None], 0.0), axis=0)
    value = offset + scale * old
    kept = (np.clip(offset + scale * new, 0.5 * value, 2.0 * value) - offset) / np.where(scale == 0.0, 1.0, scale)
    return np.where(problem.shrink, kept, new)


def _with_lightest(problem: Problem) -> np.ndarray:
    """Lower bounds, with one for the inertia, below which the record's rate would show nothing of it."""
    lower = np.array(problem.lower, float)
    column = np.flatnonzero(problem.directions[0])
    if column.size and problem.system.contact is not None:
        dt = float(problem.windows.panel) * problem.windows.every
        lightest = float(problem.system.contact.stiffness) * (SHORTEST * dt / np.pi) ** 2
        j = int(column[0])
        lower[j] = max(lower[j], (lightest - float(problem.base[0])) / float(problem.directions[0, j]))
    return lower


def correlation(residual: np.ndarray, weight: np.ndarray) -> float:
    """How many neighbouring samples of a run's residual (W, M) count for one, at least 1: a misfit in one piece is no noise."""
    values = (residual * weight)[weight > 0.0]
    size = 1 << (2 * values.size - 1).bit_length()
    spectrum = np.abs(np.fft.rfft(values, size)) ** 2
    lags = np.fft.irfft(spectrum)[: values.size // 4]
    lags = lags / max(float(lags[0]), 1e-300)
    first = int(np.argmax(lags <= 0.0)) or lags.size
    return float(max(1.0, 2.0 * np.sum(lags[:first]) - 1.0))
