"""Derivatives with only the laws that act evaluated: the same as with all of them."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxbacklash.fitting.setup import first_guess
from jaxbacklash.mechanics import Drive
from jaxbacklash.parameters import specs
from jaxbacklash.shooting import active_laws as module
from jaxbacklash.shooting.active_laws import ActiveLaws, active_laws, exerting, rebuild_active
from jaxbacklash.shooting.multiple_shooting import linearise, shoot

from .hidden import fitter, hidden


@pytest.fixture(scope="module")
def builder():
    record, rig, _, _ = hidden("coulomb_joint", "chirp", 3, 3.0)
    return fitter(record, rig.inertia)


def asked(builder, effects, extra=()):
    problem, _ = builder.problem(effects, builder.base, extra=extra)
    order, count = active_laws(problem.system, problem.base, problem.directions)
    return problem, [exerting(problem.system)[k] for k in np.asarray(order)[: int(count)]]


def test_only_what_is_in_the_model_or_judged_is_asked(builder):
    effects = {"coulomb_joint": builder.laws["coulomb_joint"](Tc=2.0), "gravity": builder.laws["gravity"](G=0.0)}
    problem, names = asked(builder, effects)
    assert len(exerting(problem.system)) > module.FEW
    assert set(names) == {"coulomb_joint", "gravity"}
    assert set(asked(builder, effects, ["preload.T0"])[1]) == {"coulomb_joint", "gravity", "preload"}
    assert isinstance(rebuild_active(problem)(jnp.zeros(problem.directions.shape[1])), ActiveLaws)


@pytest.mark.parametrize(
    "names",
    [
        ("coulomb_joint",),
        pytest.param(("coulomb_ground", "gravity"), marks=pytest.mark.slow),
        pytest.param(("lugre", "torque_ripple"), marks=pytest.mark.slow),
    ],
)
def test_derivatives_are_those_of_all_laws(builder, monkeypatch, names):
    effects = {name: builder.laws[name].guesses(builder.base)[0] for name in names}
    problem, _ = builder.problem(effects, builder.base, extra=["preload.T0", "cubic_stiffness.k3"])
    guess = first_guess(problem)
    shot = jax.jit(shoot)(problem, guess)
    found = eqx.filter_jit(lambda p, u, s: linearise(p, u, s))(problem, guess, shot)
    monkeypatch.setattr(module, "FEW", 1000)
    assert not isinstance(rebuild_active(problem)(guess.theta), ActiveLaws)
    whole = eqx.filter_jit(lambda p, u, s: linearise(p, u, s))(problem, guess, shot)
    for mine, other in zip(jax.tree.leaves(found), jax.tree.leaves(whole)):
        scale = float(np.max(np.abs(other), initial=0.0)) + 1e-300
        np.testing.assert_allclose(np.asarray(mine) / scale, np.asarray(other) / scale, atol=1e-11)


def test_a_law_exerts_nothing_at_its_null_values(builder):
    """What is not asked must have nothing to say."""
    for name in exerting(builder.problem({}, builder.base, extra=["gravity.G"])[0].system):
        described = specs(builder.laws[name]())
        nulls = {n: s.null for n, s in described.items() if s.null is not None and not s.fixed}
        assert nulls, name
        law = builder.laws[name](**nulls)
        now = builder.base.instant(0.3, (0.7, 1.1), Drive(0.2, 0.5, 0.0))
        assert float(law.torque(now)) == 0.0, name
