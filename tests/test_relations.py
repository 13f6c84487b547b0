"""How x and y relate, a gear or a sign, is asked before the size of y - x is judged, by a number that makes sense of teeth."""

import importlib.util

import numpy as np
import pytest

from jaxbacklash.records.findings import find, mend
from jaxbacklash.records.options import ReadOptions
from jaxbacklash.records.remedies import applied
from tests.spoilt import NOISE, good, some

needs_numba = pytest.mark.skipif(importlib.util.find_spec("numba") is None, reason="the generator needs numba")
NOTHING_SAID = ReadOptions()


def findings(t, x, y, options=NOTHING_SAID):
    """What is found in a record t, x, y that is mended as the options say."""
    t, channels, extras = mend.before(t, {"x": x, "y": y}, {}, options)
    return find(t, channels, extras, options)


@needs_numba
@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize(
    ("of_x", "of_y", "kind"), [(50.0, 1.0, "gear"), (1.0, -1.0, "sign"), (-2.5, 1.0, "gear")], ids=["gear", "sign", "both"]
)
def test_how_channels_relate_is_asked_before_their_size_is_judged(of_x, of_y, kind, seed):
    """A motion of 1.5 rad that a gear or a sign makes so large is in no degrees; one in degrees is asked about thereafter."""
    record = good(seed, observed="y")
    t, x, y = record["t"], of_x * record["x"], of_y * record["y"]
    size = 1.5 / np.max(np.abs(y - x))
    for larger, then in ((size, []), (np.rad2deg(50.0 * size), ["degrees"])):
        found = findings(t, larger * x, larger * y)
        assert [one.kind for one in found] == [kind]
        options = applied(NOTHING_SAID, found[0].remedy)
        assert kind == "sign" or options.ratio == pytest.approx(of_x, rel=0.12)  # play hides the rest in slow motion
        assert [one.kind for one in findings(t, larger * x, larger * y, options)] == then


@pytest.mark.parametrize(
    ("measured", "offered"), [(49.75, 50.0), (-9.93, -10.0), (2.51, 2.5), (1.335, 4 / 3), (10.6, 10.5), (0.4, 0.4)]
)
def test_the_ratio_offered_is_the_simplest_near_the_measured_one(measured, offered):
    t, y = following()
    gear = next(one for one in findings(t, measured * y, y) if one.kind == "gear")
    assert applied(NOTHING_SAID, gear.remedy).ratio == pytest.approx(offered, rel=1e-3)
    assert "to within 2 %" in gear.found


def test_degrees_wait_until_samples_that_were_never_measured_are_answered():
    """A base of 10 rad may be behind a gear, which a link with failed reads does not show yet."""
    t, y = following()
    failed = y.copy()
    failed[some(np.random.default_rng(0), {"t": t}, 12)] = -9999.0
    assert {one.kind for one in findings(t, 100.0 * y, failed)} == {"sentinel"}
    found = findings(t, 100.0 * y, failed, ReadOptions(despike=frozenset("y")))
    assert [(one.kind, one.remedy) for one in found] == [("gear", "--ratio 100")]


def following():
    """Times and a link that follows its base exactly, in three sines with noise."""
    t = np.arange(4000) / 500.0
    y = 0.05 * np.sin(9.0 * t) + 0.03 * np.sin(14.0 * t) + 0.02 * np.sin(25.0 * t)
    return t, y + np.random.default_rng(2).normal(0.0, NOISE, t.size)
