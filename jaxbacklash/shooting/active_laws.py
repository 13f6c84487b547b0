"""A catalogue of which only the laws that act are evaluated, in a program that holds them all.

Most laws stand at their null values in any model, and neither they nor their derivatives add anything. Which ones act is
data, like the values themselves, so that no model needs a program of its own. One law after the other is called, which for the
derivatives of many panels costs less than the laws that are left out where a panel is long work, as with dry friction or internal
states; where it is short, or for the motion alone, one piece of code for all laws is faster.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

import jax
import jax.numpy as jnp

from ..mechanics import AbstractEffect, Instant
from ..parameters import Scalar, specs
from ..system import State, System
from .problem import Problem

Array = Any
FEW = 4
"""Laws that are all evaluated: calling them one by one would cost more."""


class ActiveLaws(System):  # type: ignore[misc]  # mypy takes parameters that must be given for ones with a default
    """A system that asks only some of its laws for their torque: the first ``count`` of ``order`` (L,), which counts the laws of
    `exerting` from zero. The others are known to exert nothing."""

    order: Array = None
    count: Array = None

    def torques(self, now: Instant, state: State) -> tuple[Scalar, Scalar]:
        """As those of a system whose other laws are not there."""
        # All that a law may look at is handed to it: what each found by itself would be carried along once for every law.
        seen = {f.name: v for f in fields(now) if f.name != "state" and (v := getattr(now, f.name)) is not None}
        states = dict(self._own_states(state))
        own = {name: states[name] for name in exerting(self)}

        def of(name: str) -> Callable[[Any, Any, Any], tuple[Scalar, Scalar]]:
            def exerted(seen: Any, own: Any, effects: Any) -> tuple[Scalar, Scalar]:
                torque = jnp.zeros_like(now.y) + effects[name].torque(replace(now, **seen, state=own[name]))
                none = jnp.zeros_like(torque)
                return (torque, none) if effects[name].port == "joint" else (none, torque)

            return exerted

        laws = [of(name) for name in own]

        def add(k: Array, sums: tuple[Scalar, Scalar]) -> tuple[Scalar, Scalar]:
            joint, ground = jax.lax.switch(self.order[k], laws, seen, own, self.effects)
            return sums[0] + joint, sums[1] + ground

        none = jnp.zeros_like(now.y)
        joint, ground = jax.lax.fori_loop(0, self.count, add, (self.bare_torque(now) + none, none))
        return joint + ground, joint


def exerting(system: System) -> list[str]:
    """The laws of a system that can exert a torque on its link, in the order of its states."""
    laws = system.effects
    return [n for n in sorted(laws) if laws[n].port != "motor" and type(laws[n]).torque is not AbstractEffect.torque]


def active_laws(system: System, base: Array, directions: Array) -> tuple[Array, Array]:
    """Which laws act: ``order`` (L,), those first, and their number ``count``.

    Parameters
    ----------
    system : its laws and their null values
    base : (p,) all parameter values
    directions : (p, q) how they move; a law acts if any of its parameters may move, or a strength is not at its null value
    """
    described = list(specs(system).items())
    moving = jnp.any(directions != 0.0, axis=1)
    found: list[Array] = []
    for law in exerting(system):
        own = [(i, spec) for i, (name, spec) in enumerate(described) if name.startswith(f"{law}.")]
        strong = [base[i] != spec.null for i, spec in own if spec.null is not None and not spec.fixed]
        moved = [moving[i] for i, _ in own]
        # A law without a strength never vanishes.
        found.append(jnp.any(jnp.stack([*strong, *moved])) if strong else jnp.asarray(True))
    active = jnp.stack(found)
    return jnp.argsort(~active, stable=True), jnp.sum(active)


def rebuild_active(problem: Problem) -> Callable[[Array], System]:
    """As ``problem.rebuild``, for derivatives: a system of many laws asks only those that act, where that is faster."""
    long = problem.system.slides or len(problem.system.state_names) > problem.system.mechanical
    if not long or len(exerting(problem.system)) <= FEW:
        return problem.rebuild
    order, count = active_laws(problem.system, problem.base, problem.directions)

    def rebuild(theta: Array) -> System:
        s = problem.rebuild(theta)
        return ActiveLaws(s.inertia, s.contact, s.damper, s.effects, s.observed, s.smoothed, s.motor, order, count)

    return rebuild
