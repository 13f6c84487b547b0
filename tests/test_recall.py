"""Models that a search has found and left behind, on models that are only numbers."""

import pytest

from jaxbacklash.criticism.recall import recalled
from jaxbacklash.criticism.search import Search, Step

from .number_models import Model
from .test_search_steps import Bench


def ended(monkeypatch, *known, final):
    """Names of the model that a path ends with, and those that a model was gone on with from."""
    search, went_on = Search(Bench()), []
    for trial in (*known, final):
        search.keep(trial)
    monkeypatch.setattr(search, "prune", lambda trial, **_: (trial, ()))

    def forward(start, steps, least):
        went_on.append(start.names)
        return steps

    monkeypatch.setattr(search, "forward", forward)
    base = Model(frozenset(), cost=1e3)
    path = recalled(search, [Step(base, None, (), ()), Step(final, "stribeck", (), ())], 0.25)
    return path[-1].trial.names, went_on


@pytest.mark.parametrize(
    ("names", "cost", "tied", "misfit", "back"),
    [
        ({"dahl"}, 60.0, True, 1.0, True),
        ({"dahl"}, 99.9, True, 1.0, False),  # not clearly better
        ({"dahl"}, 60.0, False, 1.0, False),  # windows apart have their starts to choose
        ({"dahl"}, 60.0, True, 1.3, False),  # it does not explain the record
        ({"dahl", "gravity"}, 60.0, True, 1.0, False),  # what is one effect larger was judged as an addition
    ],
)
def test_what_was_found_before_a_stuck_model_got_its_turn_again_is_not_lost(monkeypatch, names, cost, tied, misfit, back):
    """Dahl's friction was left at 18882 and the search went on with Stribeck's, which had stuck until then, at 18943."""
    final = Model(frozenset({"stribeck"}), cost=100.0)
    found = Model(frozenset(names), cost=cost, tied=tied, misfit=misfit)
    kept, went_on = ended(monkeypatch, found, final=final)
    assert (kept, went_on) == ((frozenset(names), [frozenset(names)]) if back else (final.names, []))
