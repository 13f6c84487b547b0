r"""How a trajectory answers to torques on its link, and to shifts of what is shown, to first order: many of them at a time.

A torque :math:`s_k \tau_k(t)` on the link, of size :math:`s_k = 0`, is one more parameter of the problem. How the measured
channels and the ends of windows move with it comes from one run through the windows that carries the tangents of all torques
along; the normal equations and the elimination of the windows are those of a fit. What comes out is what a score test asks
(Rao 1948). `jaxbacklash.criticism.force_test` holds laws without a sensitivity at strength zero against a model with it.
"""

from __future__ import annotations

from typing import Any

import jax.numpy as jnp
import numpy as np

from ..compiled import kept_jit
from .damped_step import solve
from .multiple_shooting import Columns, assembled, meet, shoot
from .problem import Problem, Unknowns

Array = Any
TOGETHER = 10
"""Columns of one run: a program is compiled for so many, and for no other number where no more are asked for at a time."""


def information_beside(
    problem: Problem, unknowns: Unknowns, torques: np.ndarray, shown: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Information and score of a problem's parameters and of K columns more, the windows' unknowns marginalised.

    Parameters
    ----------
    problem : with its q free parameters
    unknowns : where the trajectory is
    torques : (K, W, P + 1) on the link at panel edges [N m], those that go with a column of size 1
    shown : (K, W, M C) what the measured channels show more with it

    Returns
    -------
    (q + K, q + K) and (q + K,), the parameters first, in units of their scale

    Examples
    --------
    >>> information, score = information_beside(problem, unknowns, torques, np.zeros_like(measured)[None])  # doctest: +SKIP
    """
    count, q = len(torques), problem.directions.shape[1]
    more = -count % TOGETHER
    padded = (np.concatenate([value, np.zeros((more, *value.shape[1:]))]) for value in (torques, shown))
    lead = (np.ascontiguousarray(np.swapaxes(value, 0, 1)) for value in padded)
    schur, score, _ = map(np.asarray, _information(problem, unknowns, *lead))
    return schur[: q + count, : q + count], score[: q + count]


def torque_scores(problem: Problem, unknowns: Unknowns) -> tuple[np.ndarray, np.ndarray]:
    """How fast the cost of a fit falls with a torque on the link, by its values at `TOGETHER` times of each window.

    Nothing makes up for a small torque to first order at a minimum, so that this is the gradient with all unknowns held. A torque
    that is straight between those times has as its score the sum of its values times these.

    Parameters
    ----------
    problem : with its q free parameters
    unknowns : where a fit ended

    Returns
    -------
    (W, K) and (W, K), the times [s] from a window's start to its end, alike apart, and the scores for 1 N m; of windows with data
    """
    w, count = problem.windows, np.shape(problem.windows.force)[0]
    at, nodes = np.linspace(0.0, 1.0, np.shape(w.force)[1]), np.arange(TOGETHER)
    hats = np.maximum(1.0 - np.abs(at * (TOGETHER - 1.0) - nodes[:, None]), 0.0)  # (K, P + 1)
    torques = np.ascontiguousarray(np.broadcast_to(hats, (count, *hats.shape)))
    shown = np.zeros((count, TOGETHER, np.shape(w.measured)[1]))
    scores, used = -np.asarray(_information(problem, unknowns, torques, shown)[2]), int(w.used)
    length = float(w.panel) * (at.size - 1)
    times = np.asarray(w.t0)[:, None] + length / (TOGETHER - 1.0) * nodes
    return times[:used], scores[:used]


def ready(problem: Problem, unknowns: Unknowns) -> None:
    """Compile what `information_beside` will run for at most `TOGETHER` columns."""
    torques, shown = (np.zeros((len(a), TOGETHER, a.shape[1])) for a in (problem.windows.force, problem.windows.measured))
    _information.ready(problem, unknowns, torques, shown)  # type: ignore[attr-defined]


@kept_jit
def _information(problem: Problem, unknowns: Unknowns, torques: Array, shown: Array) -> tuple[Array, Array, Array]:
    shot = shoot(problem, unknowns)
    met = meet(problem, unknowns, shot, Columns(torques, shown))
    done = solve(assembled(problem, unknowns, shot, met), jnp.asarray(0.0), problem.windows.used)
    return done.schur, done.score, met.slope[:, -torques.shape[1] :]
