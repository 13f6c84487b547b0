"""The torque of a law that remembers along a fitted motion: promised where it acts, and not where nothing hides."""

import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.evidence import demanded
from jaxbacklash.criticism.force_test import ForceTest
from jaxbacklash.criticism.screening import net_gain, screen

from .hidden import fitter, hidden, noisier

LINK = {"J2": 0.4, "k2": 13400.0, "c2": 1.4}


@pytest.mark.slow
def test_a_flexible_link_is_promised_under_noise_and_found_as_promised():
    record, rig, _, _ = hidden("flexible_link", "chirp", 3, **LINK)
    own = fitter(noisier(record, 10.0, 4), rig.inertia)
    alone = own.fit_model({})
    promised = next(c for c in screen(own, alone) if c.name == "flexible_link")
    assert net_gain(promised, own) > demanded(own)
    assert 0.0 < promised.share <= 1.0
    found = own.fit_model({"flexible_link": promised.effect}, alone)
    assert alone.criterion - found.criterion > 0.5 * net_gain(promised, own)
    assert found.value["flexible_link.J2"] == pytest.approx(LINK["J2"], rel=0.2)


@pytest.mark.slow
def test_nothing_is_promised_where_nothing_hides():
    record, rig, _, _ = hidden(None, "chirp", 5)
    own = fitter(record, rig.inertia)
    for candidate in screen(own, own.fit_model({})):
        assert net_gain(candidate, own) < demanded(own), candidate.name


def test_a_torque_against_what_is_missing_promises_nothing():
    record, rig, _, _ = hidden("gravity", "multisine", 4, 4.0, G=20.0)
    own = fitter(record, rig.inertia)
    test = ForceTest(own, own.fit_model({}))
    right, wrong = (test.best([jb.Gravity(size)], [])[0] for size in (15.0, -15.0))
    assert right > 100.0
    assert wrong == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["chirp", "multisine"])
def test_no_shape_promises_more_than_is_left(kind):
    """A parabola through two small shares may promise anything at thirty times them; there the answer is asked again."""
    record, rig, _, _ = hidden("coulomb_joint", kind, 5, Tc=4.5)
    own = fitter(record, rig.inertia)
    alone = own.fit_model({})
    test = ForceTest(own, alone)
    for shape in jb.FlexibleLink.guesses(alone.system, own.weak_form.motion):
        assert test.best([shape], [])[0] < alone.rest
