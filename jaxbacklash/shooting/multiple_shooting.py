r"""Multiple shooting: the misfit of all windows side by side, and its derivatives in blocks.

Unknowns: the parameters :math:`\theta` that are free (few), and per window a start s (state of the link) and the m
coefficients c of the input's spline (base motion, or a smooth force). Misfit, all in units of the noise:

* measured minus predicted motion, window by window;
* measured input minus the spline, so that the noise in x (or F) is carried through the model instead of ignored;
* end of a window minus start of the next, where they are tied.

Minimising over s and c is what whitening the residual with both noises amounts to, to first order; it also holds beyond it.
Window w meets only its own unknowns, the first few of window w + 1, and the parameters: the normal equations form a block
tridiagonal matrix with a border, and everything costs in proportion to the length of the record.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from ..mechanics import Drive
from ..solvers.plain_panels import PlainMap
from ..solvers.substeps import run_panels
from .active_laws import rebuild_active
from .chunks import by_chunks
from .input_spline import input_tangents, lags, local_coefficients, spline_input
from .panel_tangents import drive, plain_of
from .problem import Problem, Unknowns
from .tangents import rows, trajectories
from .windows import Windows

Array = Any


KEPT = 10.0
"""How sharply what a law remembers is tied from window to window, even where the motion is not: a tenth of its reach costs half a
unit, and a hundred-thousandth where the motion is tied a hundred times as sharply. The record does not show it: left free it
would fit noise, and more in a window than a joint can do. Friction that never slips uses little of its reach, and a jump by
little of that is a large one in torque."""


class Blocks(eqx.Module):
    """Normal equations J^T J and gradient J^T r by blocks; B = n + m unknowns a window.

    ``diagonal`` (W, B, B); ``below`` (W, B, B) couples window w + 1 (rows) to window w (columns); ``border`` (W, B, q);
    ``corner`` (q, q); ``slope`` (W, B) and ``slope_theta`` (q,) gradients; ``cost`` half the sum of squares; ``seen`` (W, B)
    and ``seen_theta`` (q,), the diagonal as far as it comes from samples and not from ties; ``ends`` (W, U, n) as `Met.end_rows`.
    """

    diagonal: Array
    below: Array
    border: Array
    corner: Array
    slope: Array
    slope_theta: Array
    cost: Array
    seen: Array = None
    seen_theta: Array = None
    ends: Array = None


class Prediction(eqx.Module):
    """What one window predicts: ``motion`` (M,) measured channel, or (M C,) of several, ``input`` (R,) spline as `Windows.shown`,
    ``end`` (n,)."""

    motion: Array
    input: Array
    end: Array


class Trajectory(eqx.Module):
    """What one window runs through: ``times`` (M,), ``states`` and ``drive`` at the samples, ``end`` state."""

    times: Array
    states: tuple[Array, ...]
    drive: Drive
    end: tuple[Array, ...]


def trajectory(problem: Problem, theta: Array, start: Array, local: Array, t0: Array, force: Array) -> Trajectory:
    """Simulate one window.

    Parameters
    ----------
    theta : (q,) free parameters
    start : (n,) state at the first sample
    local : (m + 5,) spline coefficients, the last five shared with the next window
    t0 : start time [s]
    force : (P+1,) force at panel edges
    """
    w = problem.windows
    system = problem.rebuild(theta)
    along = drive(w, *spline_input(w, lags(w, system, t0), local), force)
    state = tuple(start[i] for i in range(start.shape[0]))
    begin, panel = system.passed(t0, w.panel)
    end, states = run_panels(system, begin, state, along, panel, w.every, system.switches)
    times = begin + panel * w.every * jnp.arange(w.samples)
    return Trajectory(times, states, jax.tree.map(lambda v: v[: -1 : w.every], along), end)


def predict(problem: Problem, theta: Array, start: Array, local: Array, t0: Array, force: Array) -> Prediction:
    """What one window predicts; the arguments are those of `trajectory`."""
    w = problem.windows
    path = trajectory(problem, theta, start, local, t0, force)
    motion = jax.vmap(problem.rebuild(theta).output)(path.times, path.states, path.drive)
    measured = w.shown @ local if w.intervals else jnp.zeros((0,))
    return Prediction(motion.ravel(), measured, jnp.stack(path.end))


def predictions(problem: Problem, unknowns: Unknowns) -> Prediction:
    """Predictions of all windows, stacked on the leading axis."""
    return _predict_all(problem, unknowns.theta, unknowns.starts, local_coefficients(problem.windows, unknowns.coefficients))[0]


def _predict_all(problem: Problem, theta: Array, starts: Array, local: Array) -> tuple[Prediction, Any, Array, Array]:
    w = problem.windows
    system = problem.rebuild(theta)
    u, du = jax.vmap(lambda t0, c: spline_input(w, lags(w, system, t0), c))(w.t0, local)
    end, states = trajectories(w, system, starts, u, du)
    kept = tuple(s[:, :: w.every] for s in states)
    at = jax.vmap(jax.vmap(lambda u, du, f: drive(w, u, du, f)))(u, du, w.force)
    samples = jax.tree.map(lambda v: v[:, : -1 : w.every], at)
    times = system.passed(w.t0[:, None] + w.panel * w.every * jnp.arange(w.samples), w.panel)[0]
    motion = jax.vmap(jax.vmap(system.output))(times, kept, samples).reshape(w.count, -1)
    measured = local @ w.shown.T if w.intervals else jnp.zeros((w.count, 0))
    return Prediction(motion, measured, end.T), states, u, du


def residuals(problem: Problem, unknowns: Unknowns, predicted: Prediction | None = None) -> tuple[Array, Array, Array]:
    """Motion (W, M), input (W, R or 0) and tie (W, n) residuals in units of the noise."""
    p = predictions(problem, unknowns) if predicted is None else predicted
    following = jnp.concatenate([unknowns.starts[:, 1:], unknowns.starts[:, :1]], axis=1).T
    return _residuals(problem.windows, p, following, tie_weights(problem, unknowns.starts.shape[0]))


def _residuals(w: Windows, p: Prediction, following: Array, tie_weight: Array) -> tuple[Array, Array, Array]:
    return (
        weighed(p.motion - w.measured, w.weight), weighed(p.input - w.input, w.input_weight),
        weighed(p.end - following, tie_weight),
    )  # fmt: skip


def weighed(value: Array, weight: Array) -> Array:
    """A value times its weight, nothing where it has none: there a motion may run away, and nobody measured it."""
    return jnp.where(weight > 0.0, value, 0.0) * weight


def tie_weights(problem: Problem, states: int) -> Array:
    """How sharply each window's end is tied to the next window's start, (W, n) for ``states`` = n."""
    w = problem.windows
    # Of plain arrays NumPy makes it at once, without a program for each of these operations.
    xp: Any = np if all(isinstance(a, np.ndarray | np.generic) for a in (problem.tie, w.drop, w.tie)) else jnp
    # Other internal states have no common scale; a loose tie is enough for what they carry from window to window.
    sharp = problem.tie * xp.concatenate([w.drop, xp.full(states - w.drop.shape[0], w.drop[1])])
    reach = xp.asarray(problem.system.reach)
    kept = xp.maximum(problem.tie, 1.0) ** 2 * KEPT / reach
    return w.tie[:, None] * xp.where(xp.isinf(reach), sharp, kept)


class Shot(eqx.Module):
    """All windows run through: what they ``predicted``, ``states`` (W, P) and the input ``u``, ``du`` (W, P+1) along them, the
    residuals ``motion``, ``input`` and ``tie`` in units of the noise, ``cost`` half the sum of their squares."""

    predicted: Prediction
    states: tuple[Array, ...]
    u: Array
    du: Array
    motion: Array
    input: Array
    tie: Array
    cost: Array


def shoot(problem: Problem, unknowns: Unknowns) -> Shot:
    """Run through all windows: a sixth of the work of a linearisation, and all that is needed to turn a step down."""
    shot = by_chunks(_shoot, (_bare(problem), unknowns.theta), _windows(problem, unknowns), problem.windows.used)
    beside = sum(0.5 * jnp.sum(row**2) for row in _prior_rows(problem, unknowns))
    return eqx.tree_at(lambda s: s.cost, shot, jnp.sum(shot.cost) + beside)


def residual_rows(unknowns: Unknowns, problem: Problem) -> tuple[tuple[Array, ...], Shot]:
    """Everything whose sum of squares a fit makes small, in units of the noise, as arrays of any shape; and what was run through.

    Half of that sum is the ``cost`` of the `Shot`. `linearise` builds J^T J and J^T r of these rows.
    """
    shot = shoot(problem, unknowns)
    return (shot.motion, shot.input, shot.tie, *_prior_rows(problem, unknowns)), shot


def _prior_rows(problem: Problem, unknowns: Unknowns) -> tuple[Array, Array, Array]:
    """The rows of a sum of squares that hold what no sample does: (W, m) of the spline, and twice (W, n) of the starts."""
    w = problem.windows
    spline = jnp.sqrt(_whisper(w)) * (unknowns.coefficients - w.coefficients)
    return spline, *_first_rows(problem, unknowns.starts.T)


def _shoot(shared: tuple[Problem, Array], own: Window) -> Shot:
    problem, theta = shared
    problem = eqx.tree_at(per_window, problem, own.data, is_leaf=lambda v: v is None)
    predicted, states, u, du = _predict_all(problem, theta, own.start.T, own.local)
    motion, base, tie = _residuals(problem.windows, predicted, own.following, tie_weights(problem, own.start.shape[1]))
    cost = 0.5 * (jnp.sum(motion**2, axis=1) + jnp.sum(base**2, axis=1) + jnp.sum(tie**2, axis=1))
    return Shot(predicted, states, u, du, motion, base, tie, cost)


def linearise(problem: Problem, unknowns: Unknowns, shot: Shot) -> Blocks:
    """The blocks of the normal equations at a point where the windows were run through."""
    return assembled(problem, unknowns, shot, meet(problem, unknowns, shot))


def meet(problem: Problem, unknowns: Unknowns, shot: Shot, columns: Columns | None = None) -> Met:
    """Each window's own normal equations, of n + m + 5 unknowns and q parameters; the derivatives come from `tangents.rows`. The
    sizes of K ``columns`` are more parameters, which come after those."""
    lead = _windows(problem, unknowns), eqx.tree_at(lambda s: (s.cost, s.predicted), shot, (None, None)), columns
    shared = _bare(problem)
    plain = plain_of(shared.windows, rebuild_active(problem), unknowns.theta)
    return by_chunks(_meet, (shared, unknowns.theta, plain), lead, problem.windows.used)


def assembled(problem: Problem, unknowns: Unknowns, shot: Shot, met: Met) -> Blocks:
    """The blocks of all windows, from each one's own normal equations."""
    n, m = unknowns.starts.shape[0], problem.windows.intervals
    q = met.slope.shape[1] - n - problem.windows.basis.shape[2]
    blocks = assemble(met.gram, met.slope, met.end_rows, shot.tie, met.tie_weight, met.seen, n, m, q, shot.cost)
    return _ridge(problem, unknowns, replace(blocks, ends=met.end_rows), n)


def _windows(problem: Problem, unknowns: Unknowns) -> Window:
    starts = unknowns.starts.T
    following = jnp.concatenate([starts[1:], starts[:1]])
    return Window(per_window(problem), starts, following, local_coefficients(problem.windows, unknowns.coefficients))


def _bare(problem: Problem) -> Problem:
    return eqx.tree_at(per_window, problem, replace=(None,) * len(per_window(problem)), is_leaf=lambda v: v is None)


class Window(eqx.Module):
    """What some windows bring: their part of the `Windows`, ``start`` and ``following`` (W, n), ``local`` (W, m + 5)."""

    data: tuple[Array, ...]
    start: Array
    following: Array
    local: Array


class Columns(eqx.Module):
    """What K more parameters do, each at size 1: ``torques`` (W, K, P+1) on the link at panel edges, and what the measured
    channels show more, ``shown`` (W, K, M C)."""

    torques: Array
    shown: Array


class Met(eqx.Module):
    """Each window's own normal equations, in the unknowns it sees (U = n + m + 5 + q): ``gram`` (W, U, U), ``slope`` (W, U),
    ``end_rows`` (W, U, n) weighted, ``tie_weight`` (W, n), ``seen`` (W, U) the samples' part of the diagonal of ``gram``."""

    gram: Array
    slope: Array
    end_rows: Array
    tie_weight: Array
    seen: Array


def per_window(problem: Problem) -> tuple[Array, ...]:
    """The arrays of a problem that have the windows on their leading axis, the unknowns apart."""
    w = problem.windows
    return w.t0, w.measured, w.weight, w.tie, w.input, w.input_weight, w.force


def _meet(shared: tuple[Problem, Array, PlainMap | None], lead: tuple[Window, Shot, Columns | None]) -> Met:
    (problem, theta, plain), (own, shot, columns) = shared, lead
    problem = eqx.tree_at(per_window, problem, own.data, is_leaf=lambda v: v is None)
    w = problem.windows
    n, q = own.start.shape[1], theta.shape[0]
    basis, lagged = input_tangents(problem, theta, own.local)
    rebuild = rebuild_active(problem)
    torques = None if columns is None else columns.torques
    run = rebuild, theta, problem.active, plain, shot.states, shot.u, shot.du
    motion_rows, end_rows = rows(w, *run, basis, lagged, torques)
    if columns is not None:
        q += columns.shown.shape[1]
        motion_rows = motion_rows + jnp.pad(columns.shown, ((0, 0), (motion_rows.shape[1] - columns.shown.shape[1], 0), (0, 0)))
    tie_weight = tie_weights(problem, n)
    weighted = jnp.concatenate([weighed(motion_rows, w.weight[:, None, :]), weighed(end_rows, tie_weight[:, None, :])], axis=2)
    gram = jnp.einsum("wir,wjr->wij", weighted, weighted)
    unseen = jnp.sum(weighted[:, :, -n:] ** 2, axis=2)  # what a tie adds is no sample, and would damp every step
    slope = jnp.einsum("wir,wr->wi", weighted, jnp.concatenate([shot.motion, shot.tie], axis=1))
    if w.intervals:
        # The input's own samples meet its coefficients alone.
        scaled = w.shown * w.input_weight[:, :, None]
        by_itself = jnp.einsum("wri,wrj->wij", scaled, scaled)
        # Nor is what holds its knots.
        unseen = unseen + jnp.pad(jnp.sum(scaled[:, w.samples :] ** 2, axis=1), ((0, 0), (n, q)))
        gram = gram + jnp.pad(by_itself, ((0, 0), (n, q), (n, q)))
        slope = slope + jnp.pad(jnp.einsum("wri,wr->wi", scaled, shot.input), ((0, 0), (n, q)))
    seen = jnp.diagonal(gram, axis1=1, axis2=2) - unseen
    return Met(gram, slope, weighted[:, :, -n:], tie_weight, seen)


def assemble(
    gram: Array, slope: Array, end_rows: Array, tie: Array, tie_weight: Array, seen: Array, n: int, m: int, q: int, cost: Array
) -> Blocks:
    """Normal equations by blocks, from each window's own Gram matrix.

    ``gram`` (W, U, U) and ``slope`` (W, U) of the unknowns each window sees: its own n + m, those it shares with the next
    window (the first ones after that window's start), and q parameters; ``end_rows`` (W, U, n) weighted tangents of its end;
    ``seen`` (W, U) the samples' part of the diagonal.
    """
    size, own = n + m, slice(0, n + m)
    shared = slice(n + m, gram.shape[1] - q)
    theta = slice(gram.shape[1] - q, gram.shape[1])
    k = shared.stop - shared.start
    diagonal = gram[:, own, own]
    border = gram[:, own, theta]
    gradient = slope[:, own]

    # Unknowns of window w + 1 as window w sees them: its start through the tie, its first spline coefficients.
    # Padding and joining instead of indexed updates, whose scatters cost more than the whole simulation on a CPU.
    weighted = -tie_weight[:, :, None] * jnp.swapaxes(end_rows, 1, 2)  # (W, n, unknowns): start of w + 1 against window w
    cross = weighted[:, :, shared]
    rest = size - n - k
    upper = jnp.concatenate([(tie_weight**2)[:, :, None] * jnp.eye(n), cross], axis=2)
    lower = jnp.concatenate([jnp.swapaxes(cross, 1, 2), gram[:, shared, shared]], axis=2)
    carried = jnp.pad(jnp.concatenate([upper, lower], axis=1), ((0, 0), (0, rest), (0, rest)))

    def join(start_rows: Array, shared_rows: Array) -> Array:
        return jnp.pad(jnp.concatenate([start_rows, shared_rows], axis=1), ((0, 0), (0, rest), (0, 0)))

    below = join(weighted[:, :, own], gram[:, shared, own])
    border_next = join(weighted[:, :, theta], gram[:, shared, theta])
    slope_next = join((-tie_weight * tie)[:, :, None], slope[:, shared, None])[:, :, 0]

    shift = lambda a: jnp.concatenate([jnp.zeros_like(a[:1]), a[:-1]])  # noqa: E731
    return Blocks(
        diagonal + shift(carried),
        below,
        border + shift(border_next),
        jnp.sum(gram[:, theta, theta], axis=0),
        gradient + shift(slope_next),
        jnp.sum(slope[:, theta], axis=0),
        cost,
        seen[:, own] + shift(jnp.pad(seen[:, shared], ((0, 0), (n, rest)))),
        jnp.sum(seen[:, theta], axis=0),
    )


def _ridge(problem: Problem, unknowns: Unknowns, blocks: Blocks, n: int) -> Blocks:
    w = problem.windows
    level, change = _whisper(w), unknowns.coefficients - w.coefficients
    _, gradient, curvature = _first_remembered(problem, unknowns.starts.T)
    slope = blocks.slope + jnp.concatenate([gradient, level * change], axis=1)
    size = blocks.diagonal.shape[1]
    added = jnp.concatenate([curvature, jnp.full(change.shape, level)], axis=1)
    diagonal = blocks.diagonal + added[:, :, None] * jnp.eye(size)
    if problem.system.observed == "T":
        # Inside the play T says nothing of where the link is: a whisper of stiffness keeps the matrix regular, pulling nowhere.
        whisper = jnp.concatenate([(1e-5 * w.drop) ** 2, jnp.full(n - 2, (1e-5 * w.drop[1]) ** 2), jnp.zeros(size - n)])
        diagonal = diagonal + jnp.diag(whisper)
    bare = jnp.diagonal(diagonal, axis1=1, axis2=2) == 0.0
    diagonal = diagonal + jnp.where(bare, 1.0, 0.0)[:, :, None] * jnp.eye(size)
    # What no sample has seen is damped like what one has, so that the step stays finite.
    seen = jnp.where(blocks.seen > 0.0, blocks.seen, 1.0)
    return replace(blocks, diagonal=diagonal, slope=slope, seen=seen)


def _first_remembered(problem: Problem, starts: Array) -> tuple[Array, Array, Array]:
    """What holds the memory with which a window begins that goes on from none: its cost, slope (W, n) and curvature (W, n)."""
    reach = jnp.asarray(problem.system.reach)
    within, beyond = _first_rows(problem, starts)
    curvature = jnp.where(beyond == 0.0, 1.0, 1.0 + KEPT**2) * _alone(problem)[:, None]
    cost = 0.5 * (jnp.sum(within**2) + jnp.sum(beyond**2))
    return cost, (within + KEPT * beyond) / reach, curvature / reach**2


def _first_rows(problem: Problem, starts: Array) -> tuple[Array, Array]:
    """The rows, twice (W, n), that hold the memory with which a window begins that goes on from none.

    Nothing else does, and such a window, begun far beyond all reach, would hold up the search of all. Within its reach any is
    nearly as likely as another, and none lies beyond.
    """
    alone, share = _alone(problem)[:, None], starts / jnp.asarray(problem.system.reach)
    return alone * share, alone * KEPT * (share - jnp.clip(share, -1.0, 1.0))


def _alone(problem: Problem) -> Array:
    """1 for windows that go on from none, else 0, (W,)."""
    w = problem.windows
    return (1.0 - jnp.concatenate([jnp.zeros(1), w.tie[:-1]])) * (jnp.arange(w.count) < w.used)


def _whisper(w: Windows) -> Array:
    # Coefficients that hardly touch a sample (the end of a record, empty windows) are held by a whisper of a prior at
    # the smoothing spline; a thousandth of the weight of one sample changes no estimate.
    return 1e-6 * jnp.max(w.input_weight, initial=0.0) ** 2
