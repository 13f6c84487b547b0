"""Laws that promise more together than any does alone: found where two hide, and not where one does."""

import numpy as np
import pytest

from jaxbacklash.criticism.candidates import form_gain, score_test, stepwise_selection
from jaxbacklash.criticism.screening import net_gain
from jaxbacklash.effects.damping import ContactDamping
from jaxbacklash.effects.loads import Gravity

from .hidden import fitter, hidden, noisier

pytestmark = pytest.mark.slow


def promising(own, model):
    found = [c for c in score_test(own, model, list(own.static)) if net_gain(c, own) > 0.0]
    return sorted(found, key=lambda c: -net_gain(c, own))


def test_two_small_effects_that_show_beside_one_another_are_named():
    """A law that remembers promised more than either; what was begun with it led nowhere."""
    pytest.importorskip("numba", reason="the generator needs numba")
    from benchmarks.effect_recovery import make_case

    case = make_case(42, 10.0, 20.0)
    own = fitter(case.record, case.rig.inertia, window=None)
    alone = own.fit_model({})
    chosen, promised = stepwise_selection(own, alone, promising(own, alone))
    assert {c.name for c in chosen} == set(case.hidden)
    assert promised > 2.0 * max(net_gain(c, own) for c in promising(own, alone))
    found = own.fit_model({c.name: c.effect for c in chosen}, alone)
    assert found.misfit < 1.01
    assert found.value["coulomb_ground.Tc"] == pytest.approx(case.values["coulomb_ground"]["Tc"], rel=0.05)


@pytest.mark.parametrize("name", ["gravity", "preload", "coulomb_joint"])
def test_where_one_effect_hides_no_set_is_proposed(name):
    record, rig, _, _ = hidden(name, "chirp", 3)
    own = fitter(noisier(record, 10.0, 4), rig.inertia)
    alone = own.fit_model({})
    assert stepwise_selection(own, alone, promising(own, alone)) == ([], 0.0)


@pytest.mark.parametrize("angle", [0.0, 0.6])
def test_a_form_with_an_angle_is_promised_something_where_the_zero_is_off_the_vertical(angle):
    record, rig, _, _ = hidden("gravity", "chirp", 3, G=40.0, phi0=angle)
    own = fitter(record, rig.inertia)
    model = own.fit_model({"gravity": Gravity(35.0)})
    gain = form_gain(own, model, "gravity", Gravity(35.0, 0.01))
    assert gain > 100.0 if angle else gain < 20.0
    damped = own.fit_model({"contact_damping": ContactDamping(2.0)})
    assert form_gain(own, damped, "contact_damping", ContactDamping(2.0, 0.0)) == np.inf
