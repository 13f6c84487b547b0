"""Laws with a memory tuned on the measured motion: the right one of a family comes first, no static law is taken for one."""

import numpy as np
import pytest

pytest.importorskip("numba")

from scipy.linalg import expm

from jaxbacklash.effects import BoucWen, Dahl, FlexibleLink, Lugre
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.mechanics import Instant
from jaxbacklash.parameters import values
from jaxbacklash.records import Record
from jaxbacklash.regression import tuning
from jaxbacklash.regression.along_motion import own_torques
from jaxbacklash.regression.tuning import tune
from jaxbacklash.regression.weak_form import WeakForm
from tests.independent.generator import make_excitation, measure, simulate_truth
from tests.independent.likenesses import make_likeness
from tests.independent.rigs import Rig

RIG = Rig(inertia=3.0, backlash=0.024, stiffness=12000.0, damping=18.0)
DURATION = 10.0
FAMILY = (Dahl, Lugre, BoucWen)

HIDDEN = {
    "dahl": {"Fc": 5.0, "sigma": 2000.0},
    "lugre": {"sigma0": 4000.0, "sigma1": 3.0, "Fc": 4.0, "Fs": 7.0, "vs": 0.1},
    "bouc_wen": {"sigma": 2500.0, "Fc": 6.0, "n": 1.8, "beta": 0.6},
}
TELLING = {"dahl": ("Fc", "sigma"), "lugre": ("Fc", "sigma0"), "bouc_wen": ("Fc", "sigma")}


def record(effects, seed=11, sigma=3e-5):
    rng = np.random.default_rng(seed)
    truth = simulate_truth(RIG, effects, make_excitation(rng, "multisine", DURATION), 500.0, DURATION)
    seen = measure(truth, rng, sigma, sigma)
    return Record(seen["t"], {"x": seen["x"], "z": seen["z"]})


@pytest.mark.parametrize("name", HIDDEN)
def test_the_right_law_is_tuned_to_its_values(name):
    seen = record({name: HIDDEN[name]})
    base, free, _ = base_system(seen, "joint", RIG.inertia)
    law = FAMILY[list(HIDDEN).index(name)]
    tuned = tune(WeakForm(seen), base, free, law.guesses(base))
    # Near enough to start a fit from: the shape of a knee and the slope before it can stand in for one another.
    found = values(tuned.effect)
    level, slope = TELLING[name]
    assert found[level] == pytest.approx(HIDDEN[name][level], rel=0.1)
    assert found[slope] == pytest.approx(HIDDEN[name][slope], rel=0.2)
    joint = values(tuned.system)
    assert joint["backlash"] == pytest.approx(RIG.backlash, rel=0.01)
    assert joint["stiffness"] == pytest.approx(RIG.stiffness, rel=0.01)


@pytest.mark.parametrize("seed", [2, 3])
def test_what_swings_behind_the_link_is_found_in_a_decay_that_began_with_it_away_from_rest(seed):
    """Two masses let go from anywhere (an exact solution): the law's states at the first sample are regressed with it."""
    one = make_likeness("two_modes", seed)
    base, free, _ = base_system(one.record, one.how["model"], one.how["inertia"])
    form = WeakForm(one.record)
    shapes = FlexibleLink.guesses(base, form.motion)
    tuned = tune(form, base, free, shapes)
    # Which part of the two frequencies is the joint's a decay does not tell; that there are two it does.
    rows = form.acceleration.size
    assert form.evidence(base, free, shapes) > 0.5 * rows
    assert np.any(form.begun(tuned.effect, base, free) != 0.0)


def test_states_that_begin_away_from_rest_add_what_the_law_then_does_of_itself():
    seen = make_likeness("two_modes", 0).record
    base, _, _ = base_system(seen, "linear", 1.0)
    m, law = WeakForm(seen).motion, FlexibleLink(0.2, 400.0, 0.5)
    offset = np.array([0.01, -0.3])
    added = (own_torques([law], base, m, offset[None]) - own_torques([law], base, m))[0]
    rates = np.array([[0.0, 1.0], [-400.0 / 0.2, -0.5 / 0.2]])
    exact = np.array([[400.0, 0.5] @ expm(rates * t) @ offset for t in m.t[:500]])
    assert added[:500] == pytest.approx(exact, abs=0.02 * np.max(np.abs(exact)))  # Heun's method at the record's samples


def test_lugre_can_find_its_way_back_from_a_static_level_below_the_sliding_one():
    """The slope by Fs does not vanish below Fc; with Fs left out the law is that of Fs = Fc."""

    def rate(static, speed=0.05):
        zero = 0.0
        now = Instant(zero, zero, speed, zero, zero, zero, speed, zero, zero, 1e4, 3.0, (0.5,))
        return float(Lugre(sigma0=3000.0, sigma1=1.0, Fc=4.0, Fs=static, vs=0.1).rate(now)[0])

    assert rate(3.0) < rate(3.5) < rate(4.0) < rate(5.0)
    assert rate(0.0) == rate(4.0)


@pytest.mark.parametrize("size", [1e200, np.inf, np.nan])
def test_a_law_that_runs_away_explains_nothing_and_overflows_nothing(monkeypatch, size):
    seen = record({})
    base, free, _ = base_system(seen, "joint", RIG.inertia)
    form = WeakForm(seen)
    tangents = tuning.own_tangents
    monkeypatch.setattr(tuning, "own_tangents", lambda *of: tuple(np.full(np.shape(v), size) for v in tangents(*of)))
    with np.errstate(all="raise"):
        found = tune(form, base, free, Dahl.guesses(base))
    assert np.all(np.isfinite(found.left))
