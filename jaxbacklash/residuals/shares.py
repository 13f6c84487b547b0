"""What a table and the model's parameters can both say, and how much of a torque a table predicts."""

from __future__ import annotations

from typing import Any

import jax
import numpy as np

from ..compiled import kept_jit
from ..parameters import unravel, values, with_values
from ..pointwise import padded, torques
from ..system import System
from .latent import Latent

ALIKE = 0.05
"""A parameter's torque that a table follows to this share is one that the table can replace."""


def plainest(
    latent: Latent, at_nodes: np.ndarray, table: np.ndarray, covariance: np.ndarray, theta: np.ndarray, slopes: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of all tables and parameters that say the same, those with the plainest table.

    A table over z' can hold any damping, one over z any stiffness: along such directions nothing but a prior would choose
    between table and parameter. Over one coordinate the table with the least total variation is taken, so that friction
    shows as a jump and no slope; over two the one with the least mean square. The covariance returned is that of the table
    with such directions, and its level, taken as settled.
    """
    weight = weights(latent, latent.torque)
    size = np.sqrt(np.sum(weight[:, None] * slopes**2, axis=0))
    size = np.where(size > 0.0, size, np.inf)  # a sensor's parameter gives no torque
    rows, unit = at_nodes * weight[:, None], slopes / size
    gram = rows.T @ at_nodes
    gram[np.diag_indices_from(gram)] += 1e-9 * np.trace(gram) / gram.shape[0]
    held = np.linalg.solve(gram, rows.T @ unit)
    outside = np.sqrt(weight)[:, None] * (unit - at_nodes @ held)
    _, singular, axes = np.linalg.svd(outside, full_matrices=False)
    alike = axes[singular < ALIKE]
    columns = held @ alike.T
    settled = np.concatenate([columns, np.ones((table.size, 1))], axis=1)
    away = np.eye(table.size) - settled @ np.linalg.pinv(settled.T @ gram @ settled) @ settled.T @ gram
    covariance = away @ covariance @ away.T
    if not alike.size:
        return table, covariance, theta
    if at_nodes.shape[1] <= 12:
        steps, many = np.diff(np.eye(table.size), axis=0), 30
        gram = 1e-3 * gram / np.trace(gram)
    else:
        steps, many = np.zeros((1, table.size)), 1
    amount = np.zeros(alike.shape[0])
    scale = float(np.max(np.abs(table))) + 1e-300
    for _ in range(many):  # iteratively reweighted squares come to absolute values
        sharp = 1.0 / np.maximum(np.abs(steps @ (table - columns @ amount)) / scale, 1e-3)
        metric = steps.T @ (sharp[:, None] * steps) + gram
        amount = np.linalg.pinv(columns.T @ metric @ columns, rcond=1e-10) @ (columns.T @ metric @ table)
    return table - columns @ amount, covariance, theta + (alike.T @ amount) / size


def _moved(latent: Latent) -> tuple[np.ndarray, ...]:
    """The smoothed motion: t, y, dy, x, dx, no force, and the link's acceleration, (N,) each."""
    parts = [latent.record == number for number in np.unique(latent.record)]
    ddy = np.concatenate([np.gradient(latent.dy[rows], latent.t[rows]) for rows in parts])
    return latent.t, latent.y, latent.dy, latent.x, latent.dx, np.zeros(latent.t.size), ddy


@kept_jit
def _given(system: System, vector: Any, rows: Any) -> Any:
    """What the model gives along a motion (N,), its torque less what its inertia takes, at a vector of its parameters; only
    differences of it mean something."""
    known = unravel(system, vector)
    return torques(known, rows[:-1])[1] - known.inertia * rows[-1]


@kept_jit
def _slopes(system: System, base: Any, directions: Any, theta: Any, rows: Any) -> Any:
    return jax.jacfwd(lambda theta: _given(system, base + directions @ theta, rows))(theta)


def slopes_along(latent: Latent, theta: np.ndarray) -> np.ndarray:
    """How the model's torque changes with its parameters, (N, q)."""
    problem = latent.inside.smoother.problem
    rows = tuple(padded(row) for row in _moved(latent))
    slopes = _slopes(latent.system, problem.base, problem.directions, np.asarray(theta), rows)
    return np.asarray(slopes)[: latent.t.size]


def torque_with(latent: Latent, theta: np.ndarray) -> tuple[System, np.ndarray]:
    """The system at other parameters, and the torque missing from it (N,): what one system gives less the other lacks."""
    problem, rows = latent.inside.smoother.problem, tuple(padded(row) for row in _moved(latent))
    base, directions = np.asarray(problem.base), np.asarray(problem.directions)
    here, there = (base + directions @ np.asarray(at) for at in (latent.inside.point.unknowns.theta, theta))
    change = (np.asarray(_given(latent.system, vector, rows))[: latent.t.size] for vector in (here, there))
    missing = latent.torque + next(change) - next(change)
    return with_values(latent.system, dict(zip(values(latent.system), there))), missing


def weights(latent: Latent, torque: np.ndarray) -> np.ndarray:
    return 1.0 / (latent.stderr**2 + (0.05 * size_of(torque)) ** 2)


def size_of(torque: np.ndarray) -> float:
    return 3.0 * float(np.sqrt(np.mean(torque**2))) + 1e-300


def out_of_sample(latent: Latent, at_nodes: np.ndarray, torque: np.ndarray, penalty: np.ndarray) -> tuple[float, float]:
    """Mean square of the torque that tables made from other stretches of the record leave, and of the torque itself."""
    length = max(0.5, (latent.t[-1] - latent.t[0]) / 40.0)
    fold = (np.floor((latent.t - latent.t[0]) / length).astype(int) + latent.record) % 5
    weight = weights(latent, latent.torque)
    left = np.zeros(torque.size)
    for k in range(5):
        used = fold != k
        rows = at_nodes[used] * weight[used, None]
        beta = np.linalg.solve(rows.T @ at_nodes[used] + penalty, rows.T @ torque[used])
        left[fold == k] = torque[fold == k] - at_nodes[fold == k] @ beta
    total = float(np.sum(weight))
    return float(np.sum(weight * left**2)) / total, float(np.sum(weight * torque**2)) / total
