"""The last model's search arrives, or is gone on with."""

from dataclasses import replace

import pytest

from jaxbacklash.criticism.arriving import arrived
from jaxbacklash.criticism.search import Search, Step

from .number_models import Model
from .test_search_steps import Bench

FINAL = Model(frozenset({"lugre"}), cost=4253.0, done=False)


def last(monkeypatch, final, finished, anew):
    """The path's last model, and how many searches that took."""
    search, searches = Search(Bench()), []
    search.keep(final)
    monkeypatch.setattr(search, "finish", lambda trial: searches.append(1) or replace(final, cost=finished))
    monkeypatch.setattr(search, "begun_again", lambda trial: searches.append(1) or replace(final, cost=anew, done=True))
    base = Step(Model(frozenset(), cost=1e4), None, (), ())
    steps = [base, Step(final, "lugre", (), (), evidence={"lugre": 6459.0})]
    path = arrived(search, steps)
    assert len(path) == len(steps)
    assert (path[-1].added, path[-1].evidence) == ("lugre", {"lugre": 6459.0})
    if path is not steps:
        assert search.known[final.names, True] is path[-1].trial
    return path[-1].trial.cost, len(searches)


@pytest.mark.parametrize(
    ("finished", "anew", "cost"),
    [(4221.0, 4193.0, 4193.0), (4193.0, 4300.0, 4193.0), (4253.0, 9000.0, 4253.0), (4252.5, 4253.0, 4253.0)],
)
def test_a_search_that_has_not_arrived_goes_on_by_the_better_of_two_ways(monkeypatch, finished, anew, cost):
    """LuGre's friction with drag ended at 4253 by its patience, and its play five standard errors from the truth's: 4193."""
    assert last(monkeypatch, FINAL, finished, anew) == (cost, 2)


@pytest.mark.parametrize("final", [replace(FINAL, done=True), replace(FINAL, tied=False)], ids=["arrived", "windows apart"])
def test_what_has_arrived_or_is_no_trajectory_stays(monkeypatch, final):
    assert last(monkeypatch, final, 1.0, 1.0) == (4253.0, 0)
