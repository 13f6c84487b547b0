"""A fit whose windows do not join gives no interval, however little each window misses."""

import pytest

import jaxbacklash as jb
from jaxbacklash.fitting.result import doubt, verdict_text

from .hidden import hidden, noisier


@pytest.mark.parametrize(("name", "seed"), [(None, 0), (None, 3), ("gravity", 1), ("gravity", 7)])
def test_gravity_below_the_noise_takes_the_intervals_away(name, seed):
    """Each window is missed by little more than the noise, and the play is off by many of its standard errors."""
    record, rig, _, _ = hidden(name, "chirp", seed, 8.0)
    fit = jb.fit(noisier(record, 10.0, seed), inertia=rig.inertia, starts=1)
    assert fit.score.rms < 1.2
    assert fit.adequate == fit.tied == (name is None)
    assert bool(doubt(fit)) == (name is not None)
    assert ("do not join" in verdict_text(fit)) == (name is not None)
