"""What the last word says of a record whose windows do not all end at the noise."""

from types import SimpleNamespace

import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.evidence import leaves_a_rest
from jaxbacklash.criticism.verdict import borne_out, judge_rest, not_added
from jaxbacklash.mechanics import catalogue


def model(*names, misfit, freedom):
    """A last model: the effects named, each somewhere inside its range."""
    laws = catalogue()
    joint = jb.base_motion_joint(inertia=3.0, backlash=0.02, stiffness=1e4, damping=20.0)
    system = joint.with_effects(*(laws[name]() for name in names))
    return SimpleNamespace(names=frozenset(names), free=(), system=system, misfit=misfit, freedom=freedom)


def score(rms, median):
    return SimpleNamespace(rms=rms, median=median, nrmse=1e-3 * rms, observed="z")


def fit(rms, median, held=None, held_median=None):
    heldout = None if held is None else score(held, held_median or held)
    return SimpleNamespace(score=score(rms, median), heldout=heldout)


@pytest.mark.parametrize("names", [(), ("gravity",)])
@pytest.mark.parametrize(("rms", "few"), [(1.02, False), (1.22, True)])
def test_a_complete_model_that_misses_in_a_few_windows_says_so(names, rms, few):
    final = model(*names, misfit=1.01, freedom=20_000)
    verdict = judge_rest(final, [fit(30.0, 20.0), fit(rms, 1.01)])
    assert verdict.complete
    assert f"{rms:.3g} times the noise" in verdict.text
    assert ("in a few windows (the median window is off by 1.01 times the noise)" in verdict.text) == few
    assert all(name in verdict.text for name in names)
    assert verdict.text.endswith(".")


@pytest.mark.parametrize(("freedom", "complete"), [(2_000, True), (8_000, True), (20_000, False), (80_000, False)])
def test_a_long_record_tells_a_little_more_than_noise_from_noise(freedom, complete):
    final = model("cubic_stiffness", misfit=1.032, freedom=freedom)
    verdict = judge_rest(final, [fit(1.4, 1.3), fit(1.032, 1.03)])
    assert verdict.complete == complete
    assert ("noise explains" in verdict.text) != complete


@pytest.mark.parametrize(
    ("misfit", "before", "after", "said"),
    [
        (17.0, 34.0, 20.0, None),
        (1.0, 34.0, 1.02, None),
        (1.0, 34.0, 3.0, "still missed, by 3 times"),
        (1.0, None, None, None),
    ],
)
def test_what_a_held_out_record_says_against_a_model_is_told(misfit, before, after, said):
    fits = [fit(33.0, 33.0, before), fit(misfit, misfit, after)]
    verdict = judge_rest(model("gravity", misfit=misfit, freedom=20_000), fits)
    assert verdict.here == (misfit < 1.1)
    assert verdict.complete == (verdict.here and said is None)
    assert ("held-out" in verdict.text) == (said is not None)
    assert said is None or said in verdict.text
    assert verdict.text.startswith("Incomplete: ") != verdict.complete
    assert "  " not in verdict.text


@pytest.mark.parametrize(
    ("errors", "kept"),
    [
        ([(3.0, 3.0), (1.0, 1.0)], 2),  # what was added carries over
        ([(1.1, 1.1), (1.7, 1.7)], 1),  # and here it does not
        ([(5.0, 5.0), (1.2, 1.2), (1.9, 1.9), (1.8, 1.8)], 2),
        ([(5.0, 5.0), (6.0, 6.0), (1.0, 1.0)], 3),  # a first addition may help only beside the second
        ([(1.6, 1.4), (5.6, 0.99)], 2),  # a few windows do not outweigh all others
        ([(1.6, 1.4), (5.6, 1.07)], 1),
        ([None, None], 2),
    ],
)
def test_only_what_the_held_out_record_bears_out_is_kept(errors, kept):
    assert borne_out([fit(2.0, 2.0, *(own or ())) for own in errors]) == kept


def test_what_is_not_borne_out_is_told_with_both_errors():
    said = not_added(fit(3.0, 3.0, 1.11), fit(1.0, 1.0, 1.73), ["torque_ripple"])
    assert said.startswith("torque_ripple would lower the error here from 3 to 1 times the noise")
    assert said.endswith("raise it on the held-out record from 1.11 to 1.73: it is not added.")


def test_of_a_law_that_stays_in_nothing_is_said():
    assert not_added(fit(1.0, 1.0, 1.1), fit(1.0, 1.0, 1.7), []) == ""


def test_a_few_windows_of_a_held_out_record_that_are_missed_are_told():
    fits = [fit(5.0, 4.0, 1.6, 1.4), fit(1.0, 1.0, 5.6, 0.99)]
    verdict = judge_rest(model("dahl", misfit=1.0, freedom=20_000), fits)
    assert verdict.complete
    few = "a few windows are missed (its error is 5.6 times the noise, 0.56 % of the motion, in the median window 0.99)"
    assert few in verdict.text


def test_a_joint_that_explains_one_record_alone_says_that_the_other_is_missed():
    verdict = judge_rest(model(misfit=1.0, freedom=20_000), [fit(1.0, 1.0, 4.0)])
    assert "The held-out record is still missed, by 4 times" in verdict.text
    assert verdict.word == "incomplete"


def test_a_short_record_leaves_a_clear_rest_later_than_a_long_one():
    """Of noise alone the root of the reduced chi-square has a standard deviation of 0.7 % in 10 000 values, 0.2 % in 100 000."""
    assert not leaves_a_rest(model("gravity", misfit=1.0136, freedom=9_400))
    assert leaves_a_rest(model("gravity", misfit=1.0136 + 0.03, freedom=9_400))
    assert leaves_a_rest(model("gravity", misfit=1.0236, freedom=94_000))
