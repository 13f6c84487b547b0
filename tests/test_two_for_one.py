"""When a law in the place of another is given a second one beside it, on models that are only numbers."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

from jaxbacklash.criticism import two_for_one as module
from jaxbacklash.criticism.two_for_one import two_for_one

from .number_models import Model

SAMPLES = 1000
PRICE = math.log(SAMPLES)


FINAL = Model(frozenset({"ripple"}), 470.0, free=tuple("bkcANp"))
ONE = Model(frozenset({"preload"}), 680.0, free=tuple("bkcT"))
BOTH = Model(frozenset({"preload", "gain"}), 450.0, free=tuple("bkcTg"))


def candidate(name="gain", gain=500.0, parameters=1):
    return SimpleNamespace(name=name, gain=gain, parameters=parameters)


def asked(monkeypatch, *ranking, both=BOTH):
    """A search that ranks so, and the candidates that it was told to add."""
    added = []
    monkeypatch.setattr(module, "rank", lambda bench, trial, names: list(ranking))
    monkeypatch.setattr(module, "may_join", lambda bench, trial: ["gain"])
    bench = SimpleNamespace(record=SimpleNamespace(samples=SAMPLES), laws=dict.fromkeys(range(20)))
    add = lambda before, one: added.append(one.name) or both  # noqa: E731
    return SimpleNamespace(bench=bench, progress=lambda what, share: None, add=add), added


def test_what_is_missed_again_comes_in_beside_it(monkeypatch):
    search, added = asked(monkeypatch, candidate("ripple", 900.0, 3), candidate("drag", 300.0), candidate())
    assert two_for_one(search, FINAL, ONE) is BOTH
    assert added == ["gain"]


def test_what_brings_nothing_is_left_out_again(monkeypatch):
    search, _ = asked(monkeypatch, candidate(), both=replace(BOTH, cost=674.5))
    assert two_for_one(search, FINAL, ONE) is ONE


@pytest.mark.parametrize(
    "other",
    [
        replace(ONE, misfit=1.2), replace(ONE, tied=False), replace(ONE, cost=479.5), replace(ONE, free=FINAL.free),
    ],
    ids=["it leaves more than noise", "it is not one trajectory", "it is ahead already", "it is no simpler"],
)  # fmt: skip
def test_it_is_not_asked(monkeypatch, other):
    search, added = asked(monkeypatch, candidate())
    assert two_for_one(search, FINAL, other) is other
    assert not added


@pytest.mark.parametrize("second", [candidate(gain=400.0 + PRICE - 1.0), candidate(gain=900.0, parameters=3)])
def test_what_cannot_put_it_ahead_or_is_too_rich_is_not_tried(monkeypatch, second):
    search, added = asked(monkeypatch, second)
    assert two_for_one(search, FINAL, ONE) is ONE
    assert not added
