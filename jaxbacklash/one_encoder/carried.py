r"""Where windows of a drive with one encoder begin: a filter along the record finds the side that is not seen.

Nothing shows the other side but what it does through the joint. An extended Kalman filter, a window at a time, carries the state
of both sides on by the model and sets it right by the samples of each window: with prior covariance P, sensitivities C of the M
samples to the window's start and their weights W,

.. math:: s \leftarrow s + (I + P C^\top W C)^{-1} P C^\top W\,(y - h(s)),

twice, since an edge of the play may lie between. What comes in between windows is what ties of a given weight let pass. It is
where `jaxbacklash.fitting.setup.first_guess` begins. A second link behind a play (a law that ``plays``) is found alike: while it
is in its play nothing shows on which side it will leave, so that each window is tried with it at either edge as well.

Source: Bell and Cathey, IEEE Trans. Automatic Control 38 (1993) 294, on the iterated filter as a Gauss-Newton method.
"""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ..compiled import kept_jit
from ..mechanics import AbstractEffect, Drive
from ..parameters import ravel, specs, values, with_values
from ..shooting.chunks import scan_used
from ..shooting.input_spline import local_coefficients
from ..shooting.multiple_shooting import trajectory
from ..shooting.problem import Problem, changed
from ..system import System

Array = Any
PASSES = 1e-2
"""Weight of the ties between windows, whose torque left out the filter lets pass: that of a model which may lack a law."""


def one_side(system: System) -> bool:
    """Whether this is a drive of which motor or link is not seen."""
    return system.motor is not None and len(system.channels) == 1


def hides(system: System) -> bool:
    """Whether something moves unseen behind a play: the other side of a drive, or a second link."""
    return one_side(system) or bool(system.plays)


def filtered(problem: Problem, theta: Array) -> tuple[np.ndarray, float]:
    """What `carried` says, found without the laws that do nothing at ``theta``: with the whole catalogue it would be some minutes
    in the compiler."""
    at = problem.parameters(np.asarray(theta))
    system = with_values(problem.system, dict(zip(specs(problem.system), map(float, np.asarray(at)))))
    system = system.without(*(name for name, law in system.effects.items() if not law.states and _is_null(law)))
    still = np.zeros((ravel(system).size, problem.directions.shape[1]))
    bare = changed(problem, system=system, base=np.asarray(ravel(system)), directions=still)
    starts, surprise = carried(bare, np.zeros(still.shape[1]))
    return np.asarray(starts), float(surprise)


def _is_null(law: AbstractEffect) -> bool:
    """Whether a law stands at the values at which it vanishes."""
    found = values(law)
    nulls = {name: spec.null for name, spec in specs(law).items() if spec.null is not None and not spec.fixed}
    return bool(nulls) and all(float(found[name]) == null for name, null in nulls.items())


@kept_jit
def carried(problem: Problem, theta: Array) -> tuple[Array, Array]:
    """Starts (n, W) of all windows, as the filter has them, from the middle of the play at the beginning of each record; and
    minus the log likelihood of the samples, but for a constant, as the filter predicts each window from those before.

    Parameters
    ----------
    problem : of a drive with one encoder
    theta : (q,) free parameters in units of their scale
    """
    w, system = problem.windows, problem.rebuild(theta)
    local = local_coefficients(w, w.coefficients)
    follows = jnp.concatenate([jnp.zeros(1), w.tie[:-1]])
    n = len(system.state_names)
    loose = jnp.zeros(n).at[: system.mechanical].set((PASSES * w.drop) ** -2)
    at_first = _open(problem, system)

    def step(carry: Any, at: Any) -> Any:
        (state, spread), (t0, start, follow, own, force, measured, weight) = carry, at
        fresh = jnp.stack(system.rest(t0, start[0], start[1], Drive(jnp.zeros_like(start[0]))))
        prior = jnp.where(follow > 0.0, state, fresh)
        spread = jnp.where(follow > 0.0, spread + jnp.diag(loose), jnp.diag(at_first))

        def run(begin: Array) -> tuple[Array, Array]:
            path = trajectory(problem, theta, begin, own, t0, force)
            return jax.vmap(system.output)(path.times, path.states, path.drive).ravel(), jnp.stack(path.end)

        def seen(begin: Array) -> Any:
            (shown, end), push = jax.linearize(run, begin)
            by_start, end_by_start = jax.vmap(push, out_axes=1)(jnp.eye(n))
            weighted = by_start.T * weight**2
            gain = jnp.linalg.inv(jnp.eye(n) + spread @ weighted @ by_start) @ spread
            off = jnp.where(weight > 0.0, measured - shown, 0.0) - by_start @ (prior - begin)
            own = (weight[:, None] * by_start) @ spread @ (weight[:, None] * by_start).T + jnp.eye(weight.size)
            surprise = 0.5 * ((weight * off) @ jnp.linalg.solve(own, weight * off) + jnp.linalg.slogdet(own)[1])
            return prior + gain @ (weighted @ off), gain, end, end_by_start, surprise

        def likely(begin: Array) -> tuple[Array, Array]:
            found = seen(seen(begin)[0])[0]
            off, change = weight * jnp.where(weight > 0.0, measured - run(found)[0], 0.0), found - prior
            cost = off @ off + change @ jnp.linalg.solve(spread + jnp.diag(1e-6 * at_first), change)
            return jnp.nan_to_num(cost, nan=jnp.inf), found

        begin = seen(prior)[0]
        if system.plays:  # within a play nothing shows on which side it will be left
            costs, ends = jax.vmap(likely)(_across(system, prior))
            begin = ends[jnp.argmin(costs)]
        found, gain, end, end_by_start, surprise = seen(begin)
        after = end + end_by_start @ (found - begin)
        sound = jnp.all(jnp.isfinite(after)) & jnp.all(jnp.isfinite(found))
        after, found = jnp.where(sound, after, fresh), jnp.where(sound, found, fresh)
        left = jnp.where(sound, end_by_start @ gain @ end_by_start.T, jnp.diag(at_first))
        return (after, 0.5 * (left + left.T)), (found, jnp.where(sound, surprise, jnp.inf))

    begun = jnp.zeros(n), jnp.zeros((n, n))
    starts, surprises = scan_used(step, begun, (w.t0, w.starts.T, follows, local, w.force, w.measured, w.weight), w.used)
    return starts.T, jnp.sum(surprises)


def _across(system: System, state: Array) -> Array:
    """A state (n,), and the same with each second link at both edges of its play, (K, n)."""
    found = [state]
    for name in system.plays:
        law = system.effects[name]
        place = system.state_names.index(f"{name}.{law.states[0]}")
        found += [state.at[place].set(state[0] + side * 0.55 * getattr(law, law.plays)) for side in (-1.0, 1.0)]
    return jnp.stack(found)


def _open(problem: Problem, system: System) -> Array:
    """Variance (n,) of a start of which nothing is known: what is hidden anywhere in its play, as fast as what is seen at
    most."""
    w = problem.windows
    play = 0.0 if system.contact is None else getattr(system.contact, "backlash", 0.0)
    used = jnp.any(w.weight > 0.0, axis=1)
    speed = jnp.sum(jnp.where(used, w.starts[1] ** 2, 0.0)) / jnp.maximum(jnp.sum(used), 1)
    found = jnp.zeros(len(system.state_names)).at[: system.mechanical].set((0.1 * w.drop) ** -2)
    if system.motor is not None and one_side(system):
        own = jnp.stack([(0.5 * play) ** 2, 0.1 * speed])
        found = found.at[:2].set(own) if "motor" in system.channels else found.at[2:4].set(system.motor.ratio**2 * own)
    for name in system.plays:
        first, law = system.state_names.index(f"{name}.{system.effects[name].states[0]}"), system.effects[name]
        found = found.at[first : first + 2].set(jnp.stack([(0.5 * getattr(law, law.plays)) ** 2, 0.1 * speed]))
    return found
