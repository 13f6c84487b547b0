r"""The Gaussian smoother behind `latent`: windows, starts, the input's spline and an unknown torque, solved together.

Unknowns of each window: its start, its coefficients of the input's spline, and K values of a torque that is piecewise linear
in time and runs on into the next window; and the model's q free parameters. Rows as in a fit (measured motion, measured
input, ends tied to starts), plus a prior that wants the torque's first or second differences small. The matrix is block
tridiagonal with a border, so the torque is estimated with all of the record at once, and its uncertainty counts what is not
known of starts, input and parameters.
"""

from __future__ import annotations

from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import jax.scipy.linalg as jsl
import numpy as np

from ..compiled import kept_jit, lasting_jit
from ..shooting.block_tridiagonal import Eliminated, eliminate, inverse_diagonal, solve_upper
from ..shooting.input_spline import local_coefficients
from ..shooting.multiple_shooting import (
    Blocks,
    Prediction,
    Trajectory,
    assemble,
    predict,
    residuals,
    shoot,
    tie_weights,
    trajectory,
)
from ..shooting.problem import Problem, Unknowns

Array = Any
RIDGE = 1e-10
"""Precision of every torque value by itself, in its unit: holds what no row touches."""
ROUNDING = 1e-13
"""Least share of a parameter's information that may be left when all else is unknown: less is rounding."""
LEEWAY = 0.5
"""How far a parameter may move while the torque is sought: standard deviation of its prior, in units of its value."""
NOTHING = 1e8
"""Precision that stands for no torque at all."""


class Point(eqx.Module):
    """Where the smoother stands: ``unknowns`` of the windows, ``torque`` (W, K) in units of ``Smoother.unit``."""

    unknowns: Unknowns
    torque: Array


class Smoother(eqx.Module):
    """A problem with an unknown torque: ``hats`` (P + 1, K + 1) its basis at panel edges, ``unit`` [N m] of its values,
    ``present`` (W,) 1 for windows that hold samples, ``home`` (q,) where the parameters were fitted, ``held`` 1 to keep them
    there, else 0."""

    problem: Problem
    hats: Array
    unit: Array
    present: Array
    home: Array
    held: Array

    @property
    def nodes(self) -> int:
        return self.hats.shape[1] - 1


class Improved(eqx.Module):
    """What one Gauss-Newton step found: ``point`` after the full step under the likeliest prior ``best`` = (order,
    log precision); ``evidence`` (G,) of the priors tried and ``without`` that of no torque; ``cost`` and ``rough`` (3,), the
    torque's squared differences of order 0, 1, 2, at the point where the step began."""

    point: Point
    best: Array
    evidence: Array
    without: Array
    cost: Array
    rough: Array


def make_hats(panels: int, nodes: int) -> np.ndarray:
    """Piecewise linear basis of K values a window and the first of the next, at the P + 1 panel edges."""
    at = np.linspace(0.0, nodes, panels + 1)
    return np.maximum(0.0, 1.0 - np.abs(at[:, None] - np.arange(nodes + 1)))


def _places(s: Smoother, n: int) -> tuple[np.ndarray, np.ndarray]:
    # Those that the window before sees too come first: five coefficients of the spline, none of a held torque, then one value of
    # the torque.
    m, nodes = s.problem.windows.intervals, s.nodes
    shared = s.problem.windows.basis.shape[2] - m
    spline = np.concatenate([n + np.arange(shared), n + 1 + np.arange(shared, m), n + m + nodes + np.arange(shared)])
    torque = np.concatenate([[n + shared], n + m + np.arange(1, nodes), [n + m + nodes + shared]])
    return spline.astype(int), torque.astype(int)


def _locals(s: Smoother, at: Point) -> tuple[Array, Array]:
    following = jnp.concatenate([at.torque[1:, :1], jnp.zeros_like(at.torque[:1, :1])])
    return local_coefficients(s.problem.windows, at.unknowns.coefficients), jnp.concatenate([at.torque, following], axis=1)


def linearise(s: Smoother, at: Point) -> Blocks:
    """Residuals and normal equations at a point, with no prior on the torque."""
    problem, u, w = s.problem, at.unknowns, s.problem.windows
    n, m, nodes, q = u.starts.shape[0], w.intervals, s.nodes, u.theta.shape[0]
    spline, torque = _locals(s, at)
    in_spline, in_torque = _places(s, n)
    own = n + spline.shape[1] + torque.shape[1]
    seeds = jnp.eye(own + q)

    def one(start: Array, c: Array, a: Array, t0: Array, f: Array) -> tuple[Prediction, Prediction]:
        def run(s_: Array, c_: Array, a_: Array, th: Array) -> Prediction:
            return predict(problem, th, s_, c_, t0, f + s.unit * (s.hats @ a_))

        def push(e: Array) -> Any:
            tangent = (e[:n], e[in_spline], e[in_torque], (1.0 - s.held) * e[own:])
            return jax.jvp(run, (start, c, a, u.theta), tangent)

        return jax.vmap(push, out_axes=(None, 0))(seeds)

    predicted, tangents = jax.vmap(one, in_axes=(1, 0, 0, 0, 0))(u.starts, spline, torque, w.t0, w.force)
    motion, base, tie = residuals(problem, u, predicted)
    sharp = tie_weights(problem, u.starts.shape[0])
    rows = jnp.concatenate(
        [tangents.motion * w.weight[:, None], tangents.input * w.input_weight[:, None], tangents.end * sharp[:, None]], axis=2
    )
    right = jnp.concatenate([motion, base, tie], axis=1)
    gram = jnp.einsum("wir,wjr->wij", rows, rows)
    slope = jnp.einsum("wir,wr->wi", rows, right)
    blocks = assemble(
        gram, slope, rows[:, :, -n:], tie, sharp, jnp.diagonal(gram, axis1=1, axis2=2), n, m + nodes, q, 0.5 * jnp.sum(right**2)
    )  # fmt: skip

    # As in a fit, a whisper of a prior holds what no sample touches.
    level = 1e-6 * jnp.max(w.input_weight, initial=0.0) ** 2
    weak = np.zeros(n + m + nodes)
    weak[in_torque[:nodes]] = RIDGE
    ridge = jnp.asarray(weak) + level * jnp.zeros(weak.size).at[in_spline[:m]].set(1.0)
    apart = jnp.zeros((w.count, weak.size)).at[:, in_spline[:m]].set(u.coefficients - w.coefficients)
    apart = apart.at[:, in_torque[:nodes]].set(at.torque)
    diagonal = blocks.diagonal + jnp.diag(ridge)
    bare = jnp.diagonal(diagonal, axis1=1, axis2=2) == 0.0
    diagonal = diagonal + jnp.where(bare, 1.0, 0.0)[:, :, None] * jnp.eye(weak.size)
    away = (u.theta - s.home) / LEEWAY**2
    cost = blocks.cost + 0.5 * jnp.sum(ridge * apart**2) + 0.5 * jnp.sum((u.theta - s.home) * away)
    corner = blocks.corner + jnp.eye(q) / LEEWAY**2
    slope = blocks.slope + ridge * apart
    return Blocks(diagonal, blocks.below, blocks.border, corner, slope, blocks.slope_theta + away, cost)


class Solved(eqx.Module):
    """A system solved for its parameters: the windows ``eliminated``; the Cholesky factor ``schur`` (q, q) of the information
    about the parameters; their step ``theta`` (q,); ``promise`` >= 0, what the step takes off the cost; ``log_determinant`` of it
    all."""

    eliminated: Eliminated
    schur: Array
    theta: Array
    promise: Array
    log_determinant: Array


def solve(linear: Blocks, diagonal: Array, below: Array, slope: Array, used: Array) -> Solved:
    """Solve the system of the first ``used`` windows, a prior's ``diagonal``, ``below`` and ``slope`` added."""
    own = linear.diagonal + diagonal, linear.below + below, linear.border
    return solve_parameters(eliminate(*own, linear.corner, linear.slope + slope, linear.slope_theta, used), linear.corner)


def solve_parameters(eliminated: Eliminated, corner: Array) -> Solved:
    """The parameters' step of a system whose windows are eliminated; ``corner`` (q, q) their information alone."""
    schur = _factored(eliminated.schur, jnp.diag(corner))
    theta = jsl.cho_solve((schur, True), eliminated.score)
    # The factor may hold more than the Schur complement, where that is lost in rounding.
    promise = eliminated.gain + 0.5 * theta @ eliminated.score
    log_determinant = eliminated.factor.log_determinant + 2.0 * jnp.sum(jnp.log(jnp.diagonal(schur)))
    return Solved(eliminated, schur, theta, promise, log_determinant)


def _factored(information: Array, alone: Array) -> Array:
    """Cholesky factor of the information about the parameters (q, q); each has ``alone`` (q,) of it where all else is known.

    What the record does not tell, like the shape of a law of no strength, has none left, or less by rounding.
    """
    size = jnp.sqrt(jnp.where(alone > 0.0, alone, 1.0))
    values, vectors = jnp.linalg.eigh(information / jnp.outer(size, size))
    return size[:, None] * jnp.linalg.cholesky((vectors * jnp.maximum(values, ROUNDING)) @ vectors.T)


def torque_places(s: Smoother, at: Point) -> np.ndarray:
    """Where a window's own torque values stand among its unknowns, (K,)."""
    return _places(s, at.unknowns.starts.shape[0])[1][: s.nodes]


def prior(s: Smoother, at: Point) -> tuple[Array, Array, Array, Array]:
    """Diagonal, below (3, W, B, B), slope (3, W, B) and squared size (3,) of the differences of order 0, 1 and 2."""
    n, m, nodes = at.unknowns.starts.shape[0], s.problem.windows.intervals, s.nodes
    place = np.eye(n + m + nodes)[:, _places(s, n)[1][:nodes]]
    following = jnp.concatenate([at.torque[1:], jnp.zeros_like(at.torque[:1])])
    both = jnp.concatenate([at.torque, following], axis=1)
    found = []
    for order in range(3):
        rows = np.eye(nodes, 2 * nodes)
        for _ in range(order):
            rows = np.roll(rows, 1, axis=1) - rows
        gram = rows.T @ rows
        own, link, after = gram[:nodes, :nodes], gram[nodes:, :nodes], gram[nodes:, nodes:]
        on = s.present[:, None, None]
        before = jnp.concatenate([jnp.zeros_like(on[:1]), on[:-1]])
        diagonal = on * (place @ own @ place.T) + before * (place @ after @ place.T)
        change = (both @ rows.T) * s.present[:, None]
        gradient = change @ rows
        slope = gradient[:, :nodes] + jnp.concatenate([jnp.zeros_like(gradient[:1, nodes:]), gradient[:-1, nodes:]])
        found.append((diagonal, on * (place @ link @ place.T), slope @ place.T, jnp.sum(change**2)))
    diagonal, below, slope, rough = (jnp.stack(part) for part in zip(*found))
    return diagonal, below, slope, rough


@lasting_jit
def improve(s: Smoother, at: Point, orders: Array, log_precisions: Array) -> Improved:
    """One Gauss-Newton step under the likeliest of G priors.

    Parameters
    ----------
    s, at : the smoother and the point to linearise at
    orders, log_precisions : (G,) order of the differences (1 or 2) and the logarithm of their precision
    """
    linear = linearise(s, at)
    diagonal, below, slope, rough = prior(s, at)
    rows = jnp.sum(s.present) * s.nodes

    def under(order: Array, precision: Array) -> Solved:
        scaled = precision * diagonal[order], precision * below[order], precision * slope[order]
        return solve(linear, *scaled, s.problem.windows.used)

    def evidence(prior: Any) -> Array:
        order, log_precision = prior
        precision = jnp.exp(log_precision)
        done = under(order, precision)
        least = linear.cost + 0.5 * precision * rough[order] - done.promise
        return 0.5 * rows * log_precision - 0.5 * done.log_determinant - least

    told = jax.lax.map(evidence, (orders, log_precisions))
    told = jnp.where(jnp.isfinite(told), told, -jnp.inf)
    without = evidence((jnp.asarray(0), jnp.log(NOTHING)))
    index = jnp.argmax(told)
    done = under(orders[index], jnp.exp(log_precisions[index]))
    local = done.eliminated.local(done.theta)
    u = at.unknowns
    n, m, nodes = u.starts.shape[0], s.problem.windows.intervals, s.nodes
    in_spline, in_torque = _places(s, n)
    theta = jnp.clip(u.theta + done.theta, s.problem.lower, s.problem.upper)
    moved = Unknowns(theta, u.starts + local[:, :n].T, u.coefficients + local[:, in_spline[:m]])
    best = jnp.stack([orders[index].astype(float), log_precisions[index]])
    point = Point(moved, at.torque + local[:, in_torque[:nodes]])
    return Improved(point, best, told, without, linear.cost, rough)


@kept_jit
def misfit(problem: Problem, unknowns: Unknowns) -> Array:
    """Root mean square of what a trajectory leaves of the measured channel, in units of the noise."""
    rows = jnp.sum(problem.windows.weight > 0.0)
    return jnp.sqrt(jnp.sum(shoot(problem, unknowns).motion ** 2) / jnp.maximum(rows, 1))


@lasting_jit
def finish(s: Smoother, at: Point, order: Array, log_precision: Array) -> tuple[Array, Array, Trajectory, Blocks]:
    """Standard errors of the torque (W, K) in its unit and of the parameters (q,) in theirs, the trajectories, the normal
    equations."""
    linear = linearise(s, at)
    diagonal, below, slope, _ = prior(s, at)
    precision = jnp.exp(log_precision)
    scaled = precision * diagonal[order], precision * below[order], precision * slope[order]
    done = solve(linear, *scaled, s.problem.windows.used)
    place = torque_places(s, at)
    factor = done.eliminated.factor
    reach = solve_upper(factor, done.eliminated.halfway[:, :, :-1])
    through = jnp.einsum("wbi,ij->wbj", reach[:, place], jnp.linalg.inv(done.schur).T)
    spread = jnp.sqrt(inverse_diagonal(factor)[:, place] + jnp.sum(through**2, axis=2))
    loose = jnp.sqrt(jnp.diagonal(jsl.cho_solve((done.schur, True), jnp.eye(done.schur.shape[0]))))
    spline, torque = _locals(s, at)
    w = s.problem.windows

    def run(start: Array, c: Array, a: Array, t0: Array, f: Array) -> Trajectory:
        return trajectory(s.problem, at.unknowns.theta, start, c, t0, f + s.unit * (s.hats @ a))

    paths = jax.vmap(run, in_axes=(1, 0, 0, 0, 0))(at.unknowns.starts, spline, torque, w.t0, w.force)
    return spread, (1.0 - s.held) * loose, paths, linear
