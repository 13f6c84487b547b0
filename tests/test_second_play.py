"""A second link behind a play of its own: what it contains, and joints of every kind in front of it."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.effects import FlexibleLink, SecondPlay
from jaxbacklash.mechanics import canonical_name
from jaxbacklash.models import free_axis, linear_oscillator

from .hidden import hidden

LINK = {"J2": 0.6, "k2": 17000.0, "c2": 3.0}
SHAKEN = jb.Harmonic(0.05, 14.0)


def joint(*laws):
    return jb.base_motion_joint(3.2, 0.024, 12000.0, 20.0).with_effects(*laws)


def test_without_its_play_it_is_a_flexible_link():
    one, other = (jb.simulate(joint(law), SHAKEN, duration=1.5) for law in (SecondPlay(**LINK, b2=0.0), FlexibleLink(**LINK)))
    np.testing.assert_allclose(one.z, other.z, atol=1e-7)
    (simpler,) = SecondPlay(**LINK, b2=0.008).simpler()
    assert canonical_name(simpler) == "flexible_link"
    assert {n: float(getattr(simpler, n)) for n in LINK} == LINK


def test_inside_its_play_only_the_damper_pulls_at_it():
    """A second link that nothing damps flies on at its speed until it meets the other side of its play."""
    system = free_axis(1.0, 2.0).with_effects(SecondPlay(0.5, 1e4, 0.0, 0.02))
    path = jb.simulate(system, duration=2.0, y0=0.0, dy0=0.5)
    y2, t = np.asarray(path.states[2]), np.asarray(path.t)
    behind = y2 - np.asarray(path.y)
    flying = t < t[np.argmax(behind > 0.01)]
    np.testing.assert_allclose(y2[flying], 0.5 * t[flying], atol=1e-12)
    assert 0.01 < behind.max() < 0.02  # caught by the spring beyond half its play


@pytest.mark.parametrize("front", ["spring", "free"])
def test_its_edges_are_met_behind_a_joint_without_play(front):
    """Located steps, of fourth order as where nothing switches, and the adaptive referee, which takes corners as they come."""
    bare = linear_oscillator(3.2, 12000.0, 20.0) if front == "spring" else free_axis(3.2, 5.0)
    law, how = SecondPlay(0.6, 17000.0, 1.0, 0.008), {"duration": 0.8, "y0": 0.05, "dy0": 0.8}
    coarse, finer, finest = (jb.simulate(bare.with_effects(law), panels_per_sample=n, **how) for n in (2, 4, 16))
    assert np.max(np.abs(finest.states[2] - finest.y)) > 0.0042
    referee = jb.simulate(bare.with_effects(law), adaptive=True, **how)
    np.testing.assert_allclose(finest.y, referee.y, atol=2e-8)
    one, other = (np.max(np.abs(np.asarray(path.y - finest.y))) for path in (coarse, finer))
    assert one < 1e-5
    assert other < one / 5.0


@pytest.mark.parametrize("name", ["J2", "k2", "c2", "b2"])
def test_derivatives_across_its_contacts(name):
    """The motion of half a second, through contacts of both joints, by each parameter: against differences."""
    values = {**LINK, "b2": 0.008}

    @jax.jit
    def motion(share):
        law = SecondPlay(**{**values, name: share * values[name]})
        path = jb.simulate(joint(law), SHAKEN, duration=0.6, panels_per_sample=2)
        return jnp.stack([path.z, path.states[2] - path.y])

    z, behind = np.asarray(motion(1.0))
    assert np.ptp(z) > 0.024
    assert np.count_nonzero(np.diff(np.abs(behind) > 0.004)) > 6
    exact = np.asarray(jax.jvp(motion, (1.0,), (1.0,))[1])
    sides = [(np.asarray(motion(1.0 + s)) - np.asarray(motion(1.0 - s))) / (2.0 * s) for s in (1e-5, 2e-5)]
    difference = (4.0 * sides[0] - sides[1]) / 3.0
    error = np.abs(exact - difference) / np.max(np.abs(difference), axis=1, keepdims=True)
    assert np.quantile(error, 0.98) < 1e-3


@pytest.mark.slow
def test_a_fit_finds_it_by_its_name():
    """A chirp of 10 s, the second link never seen: without a value from the user all that it says is within 5 % of the truth."""
    true = {"J2": 0.6, "k2": 17000.0, "c2": 4.0, "b2": 0.01}
    record, rig, _, _ = hidden("second_play", "chirp", 5, 10.0, **true)
    found = jb.fit(record, inertia=rig.inertia, effects=["second_play"])
    assert found.score.median < 1.1
    for name in ("backlash", "stiffness", "damping"):
        assert found.parameters[name].value == pytest.approx(getattr(rig, name), rel=0.01)
    for name, value in true.items():
        number = found.parameters[f"second_play.{name}"]
        assert number.value == pytest.approx(value, rel=0.05)
        assert abs(number.value - value) < 4.0 * number.stderr
