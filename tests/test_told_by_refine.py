"""What a fit that `refine` has made says of where it came from, and what its seed does: nothing."""

import json

import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.model_fitter import ModelFitter
from jaxbacklash.criticism.refine import _Judge
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.report.result import stage

from .test_cli import call as call  # the fixture that runs the command line
from .test_fit import joint, measured


@pytest.fixture(scope="module")
def record():
    return measured(joint(), [0.05, 0.02, 0.01], duration=4.0)


def test_a_refined_fit_says_what_it_began_from_and_its_steps(record):
    base, free, start = base_system(record, "joint", 3.16)
    fitter = ModelFitter(record, base, free, 0.2)
    model = fitter.fit_model({})
    fit = _Judge(fitter, None, "joint", False, False, start)(model)
    assert fit.steps == model.steps > 0
    assert fit.tried == fit.agreeing == 0
    text = str(fit)
    assert "starts reached" not in text
    assert "begun where the search stood" in text
    assert f"{model.steps} steps from there" in text


def test_the_help_of_refine_says_that_its_seed_does_nothing(call):
    code, out, err = call("refine", "--help")
    assert code == 0, err
    words = " ".join("".join(c if c.isalnum() or c in "-.," else " " for c in out).split())
    assert "draws nothing at random" in words


@pytest.mark.slow
def test_the_seed_of_refine_changes_nothing(record):
    one, other = (jb.refine(record, inertia=3.16, seed=seed) for seed in (0, 20251))
    assert json.dumps([stage(s.fit) for s in one.stages]) == json.dumps([stage(s.fit) for s in other.stages])
    assert one.verdict == other.verdict
