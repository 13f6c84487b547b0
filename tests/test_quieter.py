"""Noise that a model shows to be smaller than estimated, and what that says of another record of the same joint."""

import pytest

from jaxbacklash.criticism.refine import _Judge
from jaxbacklash.fitting.left_over import quieter_elsewhere
from tests.hidden import fitter, hidden


@pytest.mark.parametrize(
    ("factor", "here", "there", "taken"),
    [
        (0.72, 1.0, 1.39, 0.72),  # too large by as much in both
        (0.72, 1.0, 1.0, 1.0),  # right from the beginning
        (0.72, 1.0, 0.9, 1.0),  # quieter than this one by itself
        (0.72, 1.0, 3.0, 0.72),  # noisier, but no further from its estimate than was seen here
        (0.72, 1.0, 1.2, 1.0 / 1.2),
        (1.0, 1.0, 1.4, 1.0),  # nothing was found to be too large
    ],
)
def test_another_records_noise_is_taken_for_less_only_as_far_as_this_ones(factor, here, there, taken):
    assert quieter_elsewhere(there, factor, here) == pytest.approx(taken, rel=0.01)


def test_a_held_out_record_whose_noise_was_right_is_predicted_to_it():
    record, rig, _, _ = hidden(None, "multisine", 7, seconds=8.0)
    heldout, other, _, _ = hidden(None, "chirp", 7, seconds=8.0)
    assert rig == other
    own = fitter(record, rig.inertia, beside=heldout)
    own.quieter(1.25)  # as if corners had been taken for noise
    own.noise_factor = 1.0
    assert own.fit_model({}).misfit < 0.97  # so that a search would take it back
    own.quieter(0.8)
    fit = _Judge(own, heldout, "joint", False, False, None)(own.fit_model({}))
    assert fit.score.median == pytest.approx(1.0, abs=0.05)
    assert fit.heldout is not None
    assert fit.heldout.median == pytest.approx(1.0, abs=0.05)
