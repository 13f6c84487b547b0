"""Laws with a memory tuned on the measured motion: the right one of a family comes first, no static law is taken for one."""

import numpy as np
import pytest

pytest.importorskip("numba")

from jaxbacklash.criticism import tuning
from jaxbacklash.criticism.evidence import AS_WELL
from jaxbacklash.criticism.quick_look import QuickLook
from jaxbacklash.criticism.tuning import Tuned, apart, lead, told, tune
from jaxbacklash.criticism.workbench import strengths
from jaxbacklash.effects import BoucWen, CoulombGround, CoulombJoint, Dahl, Gravity, Lugre, Stribeck
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.mechanics import Instant
from jaxbacklash.parameters import values
from jaxbacklash.records import Record
from tests.independent.generator import make_excitation, measure, simulate_truth
from tests.independent.rigs import Rig

RIG = Rig(inertia=3.0, backlash=0.024, stiffness=12000.0, damping=18.0)
DURATION = 10.0
FAMILY = (Dahl, Lugre, BoucWen)
RIVALS = (Gravity(1.0), CoulombJoint(1.0), CoulombGround(1.0), Stribeck(1.0, 2.0, 0.1))
DEMANDED = 6.4  # evidence

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


def leads(effects):
    """Laws of the family as tuned; what the weak form says for each against dry friction and gravity; what for Dahl's alone."""
    seen = record(effects)
    base, free, _ = base_system(seen, "joint", RIG.inertia)
    look = QuickLook(seen)
    tuned = {law: tune(look, base, free, law.guesses(base)) for law in FAMILY}
    rivals = [apart(e, strengths(e)) for e in RIVALS]
    alone = lead(look, free, tuned[Dahl], base, [([], 0)])
    return tuned, {law: lead(look, free, t, base, rivals) for law, t in tuned.items()}, alone


@pytest.mark.parametrize("name", HIDDEN)
def test_the_right_law_is_tuned_to_its_values(name):
    tuned, ahead, alone = leads({name: HIDDEN[name]})
    law = FAMILY[list(HIDDEN).index(name)]
    assert max(ahead, key=ahead.get) is law
    assert ahead[Dahl] > max(DEMANDED, (1.0 - AS_WELL) * alone)
    # Near enough to start a fit from: the shape of a knee and the slope before it can stand in for one another.
    found = values(tuned[law].effect)
    level, slope = TELLING[name]
    assert found[level] == pytest.approx(HIDDEN[name][level], rel=0.1)
    assert found[slope] == pytest.approx(HIDDEN[name][slope], rel=0.2)
    joint = values(tuned[law].system)
    assert joint["backlash"] == pytest.approx(RIG.backlash, rel=0.01)
    assert joint["stiffness"] == pytest.approx(RIG.stiffness, rel=0.01)


@pytest.mark.parametrize("name", ["coulomb_joint", "gravity", "nothing"])
def test_no_memory_is_seen_where_there_is_none(name):
    static = {"coulomb_joint": {"coulomb_joint": {"Tc": 3.0}}, "gravity": {"gravity": {"G": -30.0}}, "nothing": {}}
    _, ahead, alone = leads(static[name])
    assert ahead[Dahl] < max(DEMANDED, (1.0 - AS_WELL) * alone)


@pytest.mark.parametrize("sigma", [6e-4, 1e-3])
def test_what_the_weak_form_would_say_of_a_law_is_about_what_it_says_of_the_truth(sigma):
    """Told from dry friction alone, and the fall measured with the true law, over ten records' noise. It is told low, as what dry
    friction leaves holds the law's torque too."""
    level, slope = HIDDEN["dahl"]["Fc"], HIDDEN["dahl"]["sigma"]
    law, dry = Dahl(level, slope), CoulombJoint(level)
    expected, measured = [], []
    for seed in range(10):
        seen = record({"dahl": HIDDEN["dahl"]}, seed=seed, sigma=sigma)
        base, free, _ = base_system(seen, "joint", RIG.inertia)
        look = QuickLook(seen)
        expected.append(told(look, free, law, base, dry))
        tuned = Tuned(law, base, residual(look, free, base, law), 1)
        measured.append(lead(look, free, tuned, base, [([dry], 1)]))
    assert np.mean(expected) < np.mean(measured) < 2.5 * np.mean(expected)
    assert told(look, free, law, base, law) == pytest.approx(0.0, abs=1e-6)


def residual(look, free, base, law):
    left, by = look.missing(base, free)
    design = np.column_stack([by, look.column(law, base)])
    return left - design @ np.linalg.lstsq(design, left, rcond=None)[0]


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
    look = QuickLook(seen)
    tangents = tuning.own_tangents
    monkeypatch.setattr(tuning, "own_tangents", lambda *of: tuple(np.full(np.shape(v), size) for v in tangents(*of)))
    with np.errstate(all="raise"):
        found = tune(look, base, free, Dahl.guesses(base))
    assert np.all(np.isfinite(found.left))
