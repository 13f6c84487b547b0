"""A panel of a system with many laws: advanced in loops, it is the same panel."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxbacklash.mechanics import Drive, catalogue
from jaxbacklash.models import base_motion_joint, linear_oscillator
from jaxbacklash.solvers import substeps
from jaxbacklash.solvers.substeps import one_panel

JOINTS = {"play": base_motion_joint(3.0, 0.026, 13000.0, 12.0), "no play": linear_oscillator(3.0, 13000.0, 12.0)}
LAWS = {"dahl": {"Fc": 3.0}, "cubic_stiffness": {"k3": 1e7}, "gravity": {"G": -20.0}, "preload": {"T0": 1.0},
        "quadratic_drag": {"q": 0.5}}  # fmt: skip


@pytest.mark.parametrize("name", JOINTS)
def test_loops_change_nothing(name, monkeypatch):
    """At random states across the play, panels with none, one and two crossings; and so for the derivatives."""
    laws = catalogue()
    system = JOINTS[name].with_effects(*(laws[law](**values) for law, values in LAWS.items()))
    rng = np.random.default_rng(7)
    count, h = 4000, 0.004
    x, dx = rng.normal(0.0, 0.3, count), rng.normal(0.0, 2.0, count)
    states = (x + rng.normal(0.0, 0.014, count), dx + rng.normal(0.0, 1.5, count), rng.uniform(-1e-3, 1e-3, count))
    edges = Drive(jnp.stack([x, x + h * dx]), jnp.stack([dx, dx + h]), jnp.zeros((2, count)))

    states = tuple(jnp.asarray(s) for s in states)

    def ends_and_tangents():
        def panel(states, edges):
            a, b = (jax.tree.map(lambda v, k=k: v[k], edges) for k in (0, 1))
            return jnp.stack(one_panel(system, 0.0, states, a, b, h, system.switches))

        def both(states):  # a function of its own each time, so that JAX does not take it for one it has traced
            return jax.jvp(jax.vmap(panel, in_axes=(0, 1)), (states, edges), (jax.tree.map(jnp.ones_like, states), edges))

        return len(str(jax.make_jaxpr(both)(states))), *jax.jit(both)(states)

    short, end, moved = ends_and_tangents()
    monkeypatch.setattr(substeps, "MANY", 1000)
    long, as_it_was, moved_as_it_was = ends_and_tangents()
    np.testing.assert_allclose(end, as_it_was, rtol=1e-11, atol=1e-13)
    scale = np.max(np.abs(moved_as_it_was), axis=0)
    np.testing.assert_allclose(moved / scale, moved_as_it_was / scale, atol=1e-9)
    assert short < 0.6 * long  # what the compiler is spared
