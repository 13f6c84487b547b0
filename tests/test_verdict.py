"""What the last word says of a record whose windows do not all end at the noise."""

from types import SimpleNamespace

import pytest

from jaxbacklash.criticism.verdict import judge_rest


def fit(rms, median):
    return SimpleNamespace(score=SimpleNamespace(rms=rms, median=median))


@pytest.mark.parametrize("names", [(), ("gravity",)])
@pytest.mark.parametrize(("rms", "few"), [(1.02, False), (1.22, True)])
def test_a_complete_model_that_misses_in_a_few_windows_says_so(names, rms, few):
    final = SimpleNamespace(names=frozenset(names), misfit=1.01)
    verdict = judge_rest(final, [fit(30.0, 20.0), fit(rms, 1.01)])
    assert verdict.complete
    assert f"{rms:.3g} times the noise" in verdict.text
    assert ("in a few windows (the median window is off by 1.01 times the noise)" in verdict.text) == few
    assert all(name in verdict.text for name in names)
    assert verdict.text.endswith(".")
