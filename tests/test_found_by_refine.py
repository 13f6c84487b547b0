"""What `refine` names on records whose hidden laws are hard to tell: under noise, beside friction, from a near relative."""

import numpy as np
import pytest

import jaxbacklash as jb

pytest.importorskip("numba", reason="the independent simulation needs numba")

from benchmarks.effect_recovery import family
from benchmarks.effect_strangers import make_case
from jaxbacklash.records import Record

from .hidden import hidden, noisier
from .independent.generator import make_effects, make_excitation, make_rig, measure, simulate_truth

LINK = {"J2": 0.4, "k2": 13400.0, "c2": 1.4}
JOINT = ("backlash", "stiffness", "damping")

pytestmark = pytest.mark.slow

NOT_YET = pytest.mark.xfail(reason="the search by evidence, unlike the one before it, does not find this yet", strict=False)


def measured(seed, kind, sigma, *names, seconds=20.0, **values):
    """A record of a rig drawn from ``seed`` with hidden laws, noise of ``sigma`` [rad] in both channels, and the rig."""
    rng = np.random.default_rng(seed)
    rig = make_rig(rng)
    effects = values or make_effects(rng, *names)
    seen = measure(simulate_truth(rig, effects, make_excitation(rng, kind, seconds), 500.0, seconds), rng, sigma, sigma, None)
    return Record(seen["t"], {"x": seen["x"], "z": seen["z"]}), rig


def test_gravity_is_found_beside_friction_that_holds_the_link():
    """A slow chirp that begins below the friction, thirty times the usual noise."""
    record, rig = measured(9032, "chirp", 9e-4, "gravity", "coulomb_joint")
    found = jb.refine(record, inertia=rig.inertia)
    assert set(found.effects) == {"gravity", "coulomb_joint"}
    assert found.fit.score.median < 1.05
    for name in JOINT:
        number = found.fit.parameters[name]
        assert abs(number.value - getattr(rig, name)) < 4.0 * number.stderr


def test_friction_that_grows_during_a_fit_is_softened_as_far_as_a_step_can_follow():
    """Begun at a small friction that falls with speed: softened as that allowed, the grown one could not be integrated."""
    record, rig = measured(7036, "chirp", 3e-5, "stribeck")
    found = jb.refine(record, inertia=rig.inertia)
    assert found.effects == ("stribeck",)
    assert found.fit.score.median < 1.05


@NOT_YET
@pytest.mark.parametrize("number", [30, 70])
def test_what_free_windows_hide_and_what_friction_holds_up_is_found(number):
    """30: the joint alone explains every window apart, and no trajectory of it follows. 70: a weak gain beside dry friction."""
    case = make_case(number, 10.0, 11)
    assert set(jb.refine(case.record, inertia=case.rig.inertia).effects) == set(case.hidden)


@pytest.mark.parametrize(
    ("seed", "name", "kind"), [(7008, "coulomb_joint", "chirp"), (7013, "dahl", "multisine"), (7148, "dahl", "modulated")]
)
def test_friction_under_thirty_times_the_noise_gives_only_where_it_does(seed, name, kind):
    record, rig = measured(seed, kind, 9e-4, name)
    assert family(jb.refine(record, inertia=rig.inertia).effects) == {name}


@NOT_YET
@pytest.mark.parametrize(("seed", "times", "link"), [(3, 15.0, LINK), (4, 30.0, None)])
def test_a_flexible_link_under_noise_is_found_whole(seed, times, link):
    """The heavy link of the second has made the joint seem a fifth less stiff."""
    rig = hidden(None, "chirp", seed, 1.0)[1]
    inertia, omega = 0.27 * rig.inertia, 2.7 * np.sqrt(rig.stiffness / rig.inertia)
    link = link or {"J2": inertia, "k2": inertia * omega**2, "c2": 0.02 * inertia * omega}
    record = noisier(hidden("flexible_link", "chirp", seed, **link)[0], times, seed + 1)
    found = jb.refine(record, inertia=rig.inertia)
    assert found.effects == ("flexible_link",)
    assert found.fit.parameters["flexible_link.J2"].value == pytest.approx(link["J2"], rel=0.2)
    assert found.fit.parameters["stiffness"].value == pytest.approx(rig.stiffness, rel=0.1)


@pytest.mark.parametrize("times", [1.0, 10.0])
def test_no_link_is_found_where_none_bends(times):
    record, rig, _, _ = hidden(None, "chirp", 5)
    assert jb.refine(noisier(record, times, 6), inertia=rig.inertia).effects == ()


def test_a_delay_is_not_taken_for_a_flexible_link():
    record, rig, _, _ = hidden("sensor_delay", "chirp", 1)
    assert jb.refine(record, inertia=rig.inertia).effects == ("sensor_delay",)


@pytest.mark.parametrize("kind", [pytest.param(kind, marks=NOT_YET) for kind in ("chirp", "stepped")])
def test_a_delay_hides_no_flexible_link(kind):
    record, rig, _, _ = hidden("flexible_link", kind, 5, **LINK)
    late = round(3e-3 / record.dt)
    record = Record(record.t[:-late], {"x": record.channels["x"][late:], "z": record.channels["z"][:-late]})
    found = jb.refine(record, inertia=rig.inertia)
    assert found.effects == ("flexible_link", "sensor_delay")
    assert found.verdict.complete


@NOT_YET
def test_friction_that_falls_with_speed_is_told_from_a_constant_one_under_noise():
    truth = {"Tc": 6.0, "Ts": 8.0, "vs": 0.3}
    record, rig, _, _ = hidden("stribeck", "multisine", 5, **truth)
    found = jb.refine(noisier(record, 30.0, 1), inertia=rig.inertia)
    assert found.effects == ("stribeck",)
    np.testing.assert_allclose([found.fit.parameters[f"stribeck.{n}"].value for n in truth], list(truth.values()), rtol=0.2)


def test_constant_friction_is_not_taken_for_one_that_falls_with_speed():
    record, rig, _, _ = hidden("coulomb_joint", "multisine", 5, Tc=6.0)
    assert jb.refine(record, inertia=rig.inertia).effects == ("coulomb_joint",)


@pytest.mark.parametrize("seed", [pytest.param(5, marks=NOT_YET), 11])
def test_dry_friction_under_twenty_times_the_noise_is_followed_by_one_trajectory(seed):
    record, rig, _, _ = hidden("coulomb_joint", "chirp", seed)
    found = jb.refine(noisier(record, 20.0, seed + 100), inertia=rig.inertia)
    assert found.effects == ("coulomb_joint",)
    assert found.verdict.complete


def test_a_load_and_gravity_are_not_left_to_a_ripple_of_the_lowest_order():
    """Over a small swing both are the weight of a link whose zero is not the vertical: G sin y + T0 = G' sin(y + phi0)."""
    record, rig = measured(3, "multisine", 3e-5, seconds=12.0, preload={"T0": 2.0}, gravity={"G": -3.0})
    found = jb.refine(record, inertia=rig.inertia)
    assert found.effects == ("gravity",)
    weight, zero = (found.fit.parameters[f"gravity.{n}"] for n in ("G", "phi0"))
    assert weight.value * np.cos(zero.value) == pytest.approx(-3.0, rel=0.1)
    assert weight.value * np.sin(zero.value) == pytest.approx(2.0, rel=0.02)


@pytest.mark.parametrize(("name", "seed"), [("dahl", 1), ("dahl", 2), pytest.param("bouc_wen", 2, marks=NOT_YET)])
def test_friction_with_a_memory_is_named_or_stands_beside_its_relative(name, seed):
    record, rig, _, _ = hidden(name, "multisine", seed)
    found = jb.refine(noisier(record, 5.0, seed), inertia=rig.inertia)
    assert family(found.effects) == {"dahl"}
    assert name in found.effects or (name,) in found.alternatives
