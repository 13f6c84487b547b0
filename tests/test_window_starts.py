"""Where the windows of a fit begin when its sensor changes, and what they may do where nobody measured."""

import jax.numpy as jnp
import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.model_builder import ModelBuilder
from jaxbacklash.effects import Contact, Damper
from jaxbacklash.fitting.setup import base_system, first_guess, make_problem, read_through
from jaxbacklash.mechanics import AbstractEffect, catalogue
from jaxbacklash.parameters import Scalar, param
from jaxbacklash.shooting.multiple_shooting import linearise, predictions, shoot, weighed
from jaxbacklash.system import System

PLAY, STIFFNESS, DAMPING, INERTIA = 0.02, 4e3, 2.0, 1.0


def record(observed="z", rate=200.0, seconds=6.1, offset=0.0):
    """A base that shakes with rising frequency and a link that is carried along; its own motion need not be the law's."""
    t = np.arange(round(rate * seconds)) / rate
    rng = np.random.default_rng(3)
    x = 0.05 * np.sin(2.0 * np.pi * (1.0 + 0.4 * t) * t)
    z = 0.015 * np.tanh(3.0 * np.sin(2.0 * np.pi * (1.0 + 0.4 * t) * t - 1.0)) + offset
    channels = {"x": x, observed: z if observed == "z" else x + z}
    return jb.Record(t, {n: c + 1e-5 * rng.standard_normal(t.size) for n, c in channels.items()}, confirmed=frozenset("txzy"))


def system(observed, **effects):
    laws = catalogue()
    made = {name: laws[name](value) for name, value in effects.items()}
    return System(INERTIA, Contact(PLAY, STIFFNESS), Damper(DAMPING), made, observed)


def shown(problem, starts):
    """What the sensor shows of the starts of all windows, and the speed of that (by a difference)."""
    guess = first_guess(problem)
    unknowns = type(guess)(guess.theta, starts, guess.coefficients)
    return np.asarray(predictions(problem, unknowns).motion)[:, 0]


@pytest.mark.parametrize("observed", ["z", "y"])
@pytest.mark.parametrize(
    ("before", "now"),
    [({"sensor_offset": 0.004}, {}), ({}, {"sensor_offset": 0.004}), ({"sensor_gain": 1.2}, {"sensor_offset": -0.002})],
    ids=["an offset goes", "an offset comes", "one for another"],
)
def test_another_sensor_shows_the_same_at_the_starts(observed, before, now):
    own, base_free = record(observed), ("backlash", "stiffness", "damping")
    builder = ModelBuilder(own, system(observed), base_free, 0.2)
    was, new = (make_problem(system(observed, **e), builder.windows, base_free) for e in (before, now))
    starts = np.asarray(first_guess(was).starts)
    moved = read_through(builder.windows, starts, new.system, was.system)
    assert shown(new, moved) == pytest.approx(shown(was, starts), abs=1e-12)
    assert np.max(np.abs(moved[0] - starts[0])) > 1e-3
    # And there and back again, speeds too.
    assert read_through(builder.windows, moved, was.system, new.system) == pytest.approx(starts, abs=1e-12)


def test_speeds_are_read_through_a_gain():
    own = record("y")
    builder = ModelBuilder(own, system("y"), ("backlash", "stiffness", "damping"), 0.2)
    plain, scaled = np.asarray(builder.windows.starts), system("y", sensor_gain=1.25)
    assert read_through(builder.windows, plain, scaled) == pytest.approx(plain / 1.25, rel=1e-12)


def test_the_first_guess_shows_what_was_measured():
    own = record(offset=0.004)
    builder = ModelBuilder(own, system("z"), ("backlash", "stiffness", "damping"), 0.2)
    problem = make_problem(system("z", sensor_offset=0.004), builder.windows, ("backlash", "stiffness", "damping"))
    sampled = np.asarray(builder.windows.weight)[:, 0] > 0.0
    seen = shown(problem, np.asarray(first_guess(problem).starts))[sampled]
    assert seen == pytest.approx(np.asarray(builder.windows.measured)[sampled, 0], abs=2e-4)


class AbstractBowed(AbstractEffect):  # no other test is to find it in the catalogue
    """A sensor that is neither a scale nor a shift."""

    beta: Scalar = param(unit="1/rad", null=0.0, scale=1.0)

    def observe(self, value: Scalar, state: tuple[Scalar, ...] = ()) -> Scalar:
        return value + self.beta * value**2


def test_a_sensor_of_the_users_own_is_read_through_too():
    own = record("y")
    builder = ModelBuilder(own, system("y"), ("backlash", "stiffness", "damping"), 0.2)
    bowed = System(INERTIA, Contact(PLAY, STIFFNESS), Damper(DAMPING), {"bowed": AbstractBowed(2.0)}, "y")
    plain = np.asarray(builder.windows.starts)
    moved = read_through(builder.windows, plain, bowed)
    assert moved[0] + 2.0 * moved[0] ** 2 == pytest.approx(plain[0], abs=1e-10)
    assert moved[1] * (1.0 + 4.0 * moved[0]) == pytest.approx(plain[1], rel=1e-9)


def test_what_cannot_be_read_through_stays_where_it_was():
    own = record("y")
    builder = ModelBuilder(own, system("y"), ("backlash", "stiffness", "damping"), 0.2)
    blind = System(INERTIA, Contact(PLAY, STIFFNESS), Damper(DAMPING), {"bowed": AbstractBowed(-1e9)}, "y")
    plain = np.zeros_like(np.asarray(builder.windows.starts))
    plain[0] = 0.5e-9  # the top of the bow, where it shows nothing of a motion
    assert np.array_equal(read_through(builder.windows, plain, blind), plain)


@pytest.mark.slow
def test_a_motion_that_runs_away_where_nobody_measured_costs_nothing():
    """Behind the end of a record the base rests at once; a spring that hardens may throw its link out of all numbers there."""
    own = record(seconds=6.11)
    base, free, _ = base_system(own, "joint", INERTIA)
    builder = ModelBuilder(own, base, free, 0.2)
    problem, _ = builder.problem({"cubic_stiffness": catalogue()["cubic_stiffness"](1e9)}, base)
    guess = first_guess(problem)
    starts, seen = np.array(guess.starts), np.asarray(builder.windows.weight) > 0.0
    empty = np.flatnonzero(~np.any(seen, axis=1))
    assert empty.size
    starts[:, empty] = [[1e3], [1e6]]
    away = type(guess)(guess.theta, starts, guess.coefficients)
    assert not np.all(np.isfinite(predictions(problem, away).motion))
    shot = shoot(problem, away)
    assert float(shot.cost) == pytest.approx(float(shoot(problem, guess).cost), rel=1e-9)
    blocks = linearise(problem, away, shot)
    assert all(np.all(np.isfinite(np.asarray(part))) for part in (blocks.diagonal, blocks.corner) if part is not None)


def test_a_weight_of_nothing_silences_all_but_no_other_does():
    value = jnp.asarray([1.0, jnp.nan, jnp.inf, jnp.nan])
    left = np.asarray(weighed(value, jnp.asarray([2.0, 0.0, 0.0, 1.0])))
    assert left[:3].tolist() == [2.0, 0.0, 0.0]
    assert np.isnan(left[3])
