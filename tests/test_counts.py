"""An encoder whose counts are coarse beside the play is told of, and no other."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.fitting.counts import count_of, few_counts
from jaxbacklash.records.findings.wide_play import wide_play

from .independent.generator import measure, simulate_truth
from .independent.rigs import Rig, make_excitation

RIG = Rig(3.0, 0.025, 3.0 * (2.0 * np.pi * 10.0) ** 2, 2.0 * 0.05 * 3.0 * 2.0 * np.pi * 10.0)


def measured(count, noise=1e-4, digits=None):
    """A chirp of 8 s at 500 Hz, read in counts of ``count`` after that noise."""
    pytest.importorskip("numba", reason="the generator needs numba")
    rng = np.random.default_rng(7)
    truth = simulate_truth(RIG, {}, make_excitation(rng, "chirp", 8.0), 500.0, 8.0)
    seen = measure(truth, rng, noise, noise, count)
    channels = {n: seen[n] if digits is None else np.round(seen[n], digits) for n in "xz"}
    return jb.Record(seen["t"], channels)


@pytest.mark.parametrize("count", [2e-4, 1.7e-3, 5e-3])
@pytest.mark.parametrize("digits", [None, 7])
def test_the_count_is_read_off_the_readings(count, digits):
    for values in measured(count, digits=digits).channels.values():
        assert count_of(values) == pytest.approx(count, rel=2e-3)


def test_what_is_not_counted_has_no_count():
    assert count_of(measured(None).channels["z"]) is None
    assert count_of(measured(None, digits=7).channels["z"]) is None
    assert count_of(np.zeros(1000)) is None
    assert count_of(np.repeat(np.random.default_rng(3).normal(size=50), 20)) is None  # few values, of no one count


def fitted(record, noise):
    play = SimpleNamespace(value=RIG.backlash)
    system = SimpleNamespace(observed="z")
    return SimpleNamespace(records=(record,), noise=(noise,), parameters={"backlash": play}, system=system, translational=False)


@pytest.mark.parametrize(
    ("count", "noise", "told"),
    [(5e-3, 1e-3, True), (2e-4, 3e-5, False), (5e-3, 5e-3, False), (None, 1e-3, False)],
    ids=["five counts", "a hundred", "scattered by noise", "no counts"],
)
def test_a_play_of_few_counts_is_told_of(count, noise, told):
    added = 0.0 if count is None else np.sqrt(max(noise**2 - count**2 / 12.0, 0.0))
    sentence = few_counts(fitted(measured(count, max(added, 1e-5)), max(noise, 0.3 * (count or 0.0))))
    assert ("only 5 counts of 0.005 rad in which z is read" in sentence) == told
    assert told or not sentence


def test_no_play_and_a_play_that_was_not_found_are_no_counts():
    found = fitted(measured(5e-3), 1.5e-3)
    assert few_counts(found)
    assert not few_counts(SimpleNamespace(**{**vars(found), "parameters": {}}))
    found.parameters["backlash"].value = None
    assert not few_counts(found)


TOLD = "counts of 0.005 rad in which z is read"


def test_fit_says_so():
    fit = jb.fit(measured(5e-3, noise=5e-4), inertia=RIG.inertia, starts=1)
    assert TOLD in str(fit)
    assert TOLD not in str(replace(fit, noise=(5e-3,)))


@pytest.mark.slow
def test_refine_says_so():
    assert TOLD in jb.refine(measured(5e-3, noise=5e-4), inertia=RIG.inertia).verdict.text


def test_a_play_that_was_read_in_degrees_is_told_of():
    record = SimpleNamespace(channels={"x": None, "y": None})
    one = SimpleNamespace(records=(record,), parameters={"backlash": SimpleNamespace(value=1.27)}, translational=False)
    assert "72.8 degrees is wide for a loose joint" in wide_play(one)
    assert "--unit x=deg,y=deg" in wide_play(one)
    narrow, unknown = ({"backlash": SimpleNamespace(value=value)} for value in (0.1, None))
    for changed in ({"parameters": narrow}, {"parameters": unknown}, {"parameters": {}}, {"translational": True}):
        assert wide_play(SimpleNamespace(**{**vars(one), **changed})) == ""
