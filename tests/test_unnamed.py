"""Torques outside the catalogue: seen along one direction where the sum of all looks like noise, and not where none is."""

from types import SimpleNamespace

import equinox as eqx
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.evidence import SURE, demanded, leaves_noise
from jaxbacklash.criticism.unnamed import Unnamed, best_fall, glimpses, unnamed
from jaxbacklash.criticism.verdict import judge_rest

from .hidden import fitter, hidden, noisier

RHYTHM = {"A": 0.8, "w": 33.0, "phi": 0.4}


def fitted(record, inertia, *names):
    """What fits a record, and its joint with some effects fitted."""
    own = fitter(record, inertia)
    return own, own.fit_model({n: own.laws[n].guesses(own.base)[0] for n in names})


@pytest.mark.parametrize(
    ("kind", "values", "beside", "words"),
    [
        ("unknown_disturbance", RHYTHM, (), ("a rhythm of its own of 5.25 Hz",)),  # 33 rad/s
        (
            "speed_stiffness", {"s": 700.0}, ("cubic_stiffness",),
            ("deflection and speed in contact", "deflection and the square of speed in contact"),
        ),
    ],
)  # fmt: skip
def test_what_no_law_has_is_seen_though_all_that_is_left_looks_like_noise(kind, values, beside, words):
    record, rig, _, _ = hidden(kind, "multisine", 3, **values)
    own, model = fitted(noisier(record, 20.0, 4), rig.inertia, *beside)
    assert model.misfit < 1.03
    found = unnamed(own, model)
    assert found is not None
    assert found.words in words
    assert found.fall > 4.0 * SURE * demanded(own)


@pytest.mark.slow
@pytest.mark.xfail(reason="a model that leaves out a torque promises more than a trajectory gains", strict=False)
def test_what_it_promises_comes_true():
    """A user's own law of that form, fitted beside the model, takes off the sum of squares what was foretold."""
    record, rig, _, _ = hidden("speed_stiffness", "multisine", 3, s=700.0)
    record = noisier(record, 20.0, 4)
    own, model = fitted(record, rig.inertia, "cubic_stiffness")
    found = unnamed(own, model)

    class Stiffening(jb.AbstractEffect):
        s: float = jb.param(unit="N m s/rad^2", null=0.0, default=300.0)
        catalogued = False

        def torque(self, now):
            return -self.s * now.deflection * abs(now.dz)

    base = eqx.tree_at(lambda s: s.effects, model.system, {n: model.system.effects[n] for n in model.names})
    fits = [
        jb.fit(record, system=base if law is None else base.with_effects(law), free=free, starts=1)
        for law, free in ((None, model.free), (Stiffening(), (*model.free, "stiffening.s")))
    ]
    assert all(f.tied for f in fits)
    assert 2.0 * (fits[0].cost - fits[1].cost) == pytest.approx(found.fall, rel=0.2)


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "times"), [("chirp", 1.0), ("multisine", 10.0), ("stepped", 30.0)])
def test_a_right_model_asks_for_none(kind, times):
    """Of a dozen measurements of three joints, none."""
    for seed in (5, 6, 7):
        record, rig, _, _ = hidden(None, kind, seed)
        for draw in range(4):
            own, model = fitted(noisier(record, times, 100 * seed + draw), rig.inertia)
            assert leaves_noise(model)
            assert unnamed(own, model) is None


@pytest.mark.slow
def test_friction_that_the_model_holds_is_no_unnamed_torque():
    record, rig, _, _ = hidden("coulomb_joint", "chirp", 4)
    own, model = fitted(record, rig.inertia, "coulomb_joint")
    assert leaves_noise(model)
    assert unnamed(own, model) is None


def test_nothing_is_told_of_a_model_that_leaves_more_than_noise():
    record, rig, _, _ = hidden("gravity", "multisine", 3)
    own, model = fitted(record, rig.inertia)
    assert not leaves_noise(model)
    assert unnamed(own, model) is None


def test_what_the_model_can_do_itself_is_no_glimpse():
    """Speed in the play is speed less speed in contact: no torque of its own beside contact damping and damping."""
    record, rig, _, _ = hidden("contact_damping", "multisine", 3)
    own, model = fitted(record, rig.inertia, "contact_damping")
    assert not any("speed in the play" in g.words for g in glimpses(own, model, own.weak_form))


@pytest.mark.parametrize(
    ("rise", "fall"),
    [
        (lambda s: 2.0 * (s - 0.5) ** 2 - 0.5, 0.5),  # between what is tried
        (lambda s: (s - 1.0) ** 2 - 1.0, 1.0),
        (lambda s: -s, 2.0),  # no lowest point: the farther of what was tried
        (lambda s: 5.0 * s, 0.0),  # nothing to gain: its lowest point is at no torque
        (lambda s: abs(s - 1.0) - 1.0, 1.0),  # a corner
    ],
)
def test_the_best_fall_is_tried_and_not_believed(rise, fall):
    assert best_fall(rise) == pytest.approx(fall)


@pytest.mark.parametrize("names", [(), ("cubic_stiffness",)])
def test_the_verdict_says_what_goes_with_the_rest(names):
    joint = jb.base_motion_joint(inertia=3.0, backlash=0.02, stiffness=1e4, damping=20.0)
    final = SimpleNamespace(
        names=frozenset(names), free=(), system=joint.with_effects(*(jb.catalogue()[n]() for n in names)), misfit=1.005,
        freedom=2e4,
    )  # fmt: skip
    scores = [SimpleNamespace(rms=rms, median=1.0, nrmse=0.01, observed="z") for rms in (1.2, 1.0)]
    fits = [SimpleNamespace(score=score, heldout=None) for score in scores]
    assert judge_rest(final, fits).complete
    verdict = judge_rest(final, fits, Unnamed("deflection and speed in contact", 530.4))
    assert verdict.word == "incomplete"
    assert "goes with deflection and speed in contact" in verdict.text
    assert "evidence 530" in verdict.text
    assert all(name in verdict.text for name in names)
