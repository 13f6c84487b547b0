"""Tables over coordinates: which knots, how rough, and their basis along a smoothed motion."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.linalg import solveh_banded

from ..compiled import kept_jit
from ..effects.learned import basis_at, coordinate
from ..mechanics import Instant
from ..pointwise import along, padded
from .latent import Latent, record_rows


def varies(latent: Latent, names: tuple[str, ...]) -> bool:
    moves = {name: float(np.ptp(getattr(latent, name))) for name in names}
    if "side" in moves and len(np.unique(latent.side)) < 2:
        return False
    same = not np.any(latent.x) and not np.any(latent.dx)  # with a base at rest y is z: one of the two is enough
    return all(v > 0.0 for v in moves.values()) and not (same and set(names) & {"y", "dy"} and "t" not in names)


def choose_knots(latent: Latent, name: str, dimensions: int) -> tuple[float, ...]:
    values = getattr(latent, name)
    if name == "side":
        return (-1.0, 0.0, 1.0)
    count = 12 if dimensions == 1 else 6
    low, high = np.quantile(values, [0.002, 0.998])
    at = np.linspace(0.0, 1.0, count)
    if name in ("t", "deflection"):
        knots = low + (high - low) * at
    elif name in ("dz", "dy", "dx") and low < 0.0 < high:
        # A pair close to zero lets the torque jump where the motion reverses.
        half = count // 2
        outer = np.geomspace(0.01, 1.0, half) if half > 3 else np.array([0.01, 0.3, 1.0])
        knots = np.concatenate([low * outer[::-1], high * outer])
    else:
        knots = 0.5 * (low + (high - low) * at) + 0.5 * np.quantile(values, np.clip(at, 0.002, 0.998))
    gap = 1e-6 * (high - low)
    return tuple(float(k) for k in np.maximum.accumulate(knots) + gap * np.arange(knots.size))


def motions_of(latent: Latent) -> list[tuple[slice, Instant]]:
    """Each record's windows and what effects see along its smoothed motion, sample by sample."""
    path, found = latent.inside.path, []
    for rows in record_rows(latent.records, path.times.shape[1]):
        t, y, dy, x, dx = (np.asarray(v)[rows].ravel() for v in (path.times, *path.states[:2], path.drive.x, path.drive.dx))
        found.append((rows, along(latent.system, t, y, dy, x, dx).now))
    return found


def basis_at_nodes(
    latent: Latent, motions: list[tuple[slice, Instant]], names: tuple[str, ...], knots: tuple[tuple[float, ...], ...]
) -> np.ndarray:
    """The table's basis along the motion, as values of the piecewise linear torque that follows it closest: (W, K, R)."""
    nodes = latent.inside.smoother.nodes
    windows, per = latent.inside.path.times.shape
    found = np.zeros((windows, nodes, int(np.prod([len(row) for row in knots]))))
    for rows, now in motions:
        seen = basis_along(names, knots, now)
        found[rows] = _project(seen, per / nodes, (rows.stop - rows.start) * nodes).reshape(-1, *found.shape[1:])
    return found


def basis_along(names: tuple[str, ...], knots: tuple[tuple[float, ...], ...], now: Instant) -> np.ndarray:
    """The table's basis at many moments (N,), (N, R)."""
    values = [np.asarray(coordinate(name, now)) for name in names]
    filled = _basis(tuple(padded(value) for value in values), tuple(np.asarray(row) for row in knots))
    return np.asarray(filled)[: values[0].shape[0]]


_basis = kept_jit(basis_at)


def _project(along: np.ndarray, spacing: float, count: int) -> np.ndarray:
    """Least-squares fit of piecewise linear functions with ``count`` values, ``spacing`` samples apart, to each column."""
    samples = along.shape[0]
    at = np.arange(samples) / spacing
    left = np.minimum(at.astype(int), count - 2)
    right = np.clip(at - left, 0.0, 1.0)
    rows = np.tile(np.arange(samples), 2)
    hats = sparse.csr_array((np.concatenate([1.0 - right, right]), (np.concatenate([left, left + 1]), rows)), (count, samples))
    gram = hats @ hats.T
    banded = np.stack([np.concatenate([[0.0], gram.diagonal(1)]), gram.diagonal()])
    banded[1] += 1e-6 * banded[1].max()
    return solveh_banded(banded, hats @ along)


def at_times(latent: Latent, phi: np.ndarray) -> np.ndarray:
    """(W, K, R) at the latent torque's own times, (N, R)."""
    parts, per = [], latent.inside.path.times.shape[1]
    for number, rows in enumerate(record_rows(latent.records, per)):
        parts.append(phi[rows].reshape(-1, phi.shape[2])[: int(np.sum(latent.record == number))])
    return np.concatenate(parts)


def smoothness(shape: tuple[int, ...]) -> np.ndarray:
    """Penalty on a table's size and, ten times as much, on its differences between neighbours along each coordinate."""
    total = np.eye(int(np.prod(shape)))
    for axis, count in enumerate(shape):
        step = np.diff(np.eye(count), axis=0)
        gram = step.T @ step
        before, after = int(np.prod(shape[:axis])), int(np.prod(shape[axis + 1 :]))
        total += 10.0 / count * np.kron(np.kron(np.eye(before), gram), np.eye(after))
    return total
