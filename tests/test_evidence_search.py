"""The search by evidence: what hides is named, what does not is not, and what is outside the catalogue leaves a torque out."""

from dataclasses import replace

import pytest

from jaxbacklash.criticism.evidence_search import EvidenceSearch
from jaxbacklash.criticism.model_fitter import ModelFitter
from jaxbacklash.fitting.setup import base_system

from .hidden import hidden


def searched(name, kind, seed, seconds=6.0, **values):
    """A finished search and the last model of its path, and the truth."""
    record, rig, effects, _ = hidden(name, kind, seed, seconds, **values)
    base, free, _ = base_system(record, "joint", rig.inertia)
    search = EvidenceSearch(ModelFitter(record, base, free, None))
    return search, search.run()[-1].model, rig, effects


@pytest.mark.slow
def test_nothing_is_added_where_nothing_hides():
    search, model, rig, _ = searched(None, "multisine", 3)
    assert not model.names
    assert model.tied
    assert not search.level
    assert model.value["backlash"] == pytest.approx(rig.backlash, rel=1e-3)


@pytest.mark.slow
def test_a_hidden_weight_is_named_at_its_size():
    search, model, _, effects = searched("gravity", "multisine", 4, G=20.0)
    assert model.names == {"gravity"}
    assert model.tied
    assert model.value["gravity.G"] == pytest.approx(effects["gravity"]["G"], rel=0.02)
    assert search.path[0].evidence["gravity"] > search.demand
    alone = search.fitter.fitted[frozenset()]
    assert max(c.gain for c in search.screened(alone)) <= alone.rest / alone.deflation
    # What takes little and leaves much stands in for something else, whether it comes beside a law or in the place of one.
    for names in (frozenset({"preload"}), frozenset()):
        for share, clear in ((0.05, False), (0.2, True)):
            better = replace(alone, names=names, log_evidence=alone.log_evidence + 0.5 * share * alone.rest)
            assert search.is_clear(alone, better) == clear
    assert search.is_clear(alone, model)
    assert search.is_clear(model, alone)  # fewer laws need bring nothing


@pytest.mark.slow
def test_a_fit_that_has_not_arrived_is_begun_again_from_a_model_that_contains_it():
    search, model, *_ = searched("gravity", "multisine", 4, G=20.0)
    fitter, gravity = search.fitter, search.fitter.effects(model)
    lost = fitter.fitted[model.names] = replace(model, log_evidence=model.log_evidence - 5e3, converged=False)
    assert fitter.fit_model(gravity) is lost
    larger = fitter.fit_model({**gravity, "preload": fitter.laws["preload"]()}, model)
    assert fitter.fit_model(gravity, larger).criterion == pytest.approx(model.criterion, abs=0.5)
    assert fitter.fitted[model.names].converged


@pytest.mark.slow
def test_dry_friction_is_followed_to_where_it_is_sharp():
    _, model, _, effects = searched("coulomb_joint", "multisine", 5, Tc=4.0)
    assert model.names == {"coulomb_joint"}
    assert model.tied
    assert model.value["coulomb_joint.Tc"] == pytest.approx(effects["coulomb_joint"]["Tc"], rel=0.02)


@pytest.mark.slow
def test_friction_that_gives_is_named():
    _, model, *_ = searched("dahl", "multisine", 6, 10.0, Fc=5.0, sigma=2000.0)
    assert model.names & {"dahl", "lugre", "bouc_wen"}
    assert model.tied


@pytest.mark.slow
def test_a_torque_outside_the_catalogue_is_left_out_and_said():
    _, model, *_ = searched("rumble", "multisine", 7, 10.0)
    assert not model.tied
