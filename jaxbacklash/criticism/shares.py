"""What a table and the model's parameters can both say, and how much of a torque a table predicts."""

from __future__ import annotations

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

from ..mechanics import Drive
from ..parameters import unravel, values, with_values
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


def _given(latent: Latent) -> Callable[[jax.Array], jax.Array]:
    """What the model gives along the motion (N,), its torque less what its inertia takes, as a function of its free
    parameters in the problem's units; only differences of it mean something."""
    problem = latent.inside.smoother.problem
    zero = jnp.zeros(latent.t.size)
    drive = Drive(jnp.asarray(latent.x), jnp.asarray(latent.dx), zero)
    y, dy, t = jnp.asarray(latent.y), jnp.asarray(latent.dy), jnp.asarray(latent.t)
    parts = [latent.record == number for number in np.unique(latent.record)]
    ddy = jnp.asarray(np.concatenate([np.gradient(latent.dy[rows], latent.t[rows]) for rows in parts]))

    def given(theta: jax.Array) -> jax.Array:
        system = unravel(latent.system, problem.parameters(theta))
        state = (y, dy, *(zero for _ in system.state_names[2:]))
        return system.torques(system.instant(t, state, drive), state)[0] - system.inertia * ddy

    return given


def slopes_along(latent: Latent, theta: np.ndarray) -> np.ndarray:
    """How the model's torque changes with its parameters, (N, q)."""
    return np.asarray(jax.jit(jax.jacfwd(_given(latent)))(jnp.asarray(theta)))


def torque_with(latent: Latent, theta: np.ndarray) -> tuple[System, np.ndarray]:
    """The system at other parameters, and the torque missing from it (N,): what one system gives less the other lacks."""
    given, problem = _given(latent), latent.inside.smoother.problem
    change = np.asarray(given(latent.inside.point.unknowns.theta) - given(jnp.asarray(theta)))
    vector = np.asarray(problem.parameters(jnp.asarray(theta)))
    return with_values(latent.system, dict(zip(values(latent.system), vector))), latent.torque + change


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
