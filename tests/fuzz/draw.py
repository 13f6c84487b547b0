"""Drawing cases: kinds by their weights, every case from a generator of its own."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.fuzz import archives, laws, models, options, records, stores, surroundings
from tests.fuzz.case import KINDS, Case, Kind

DOORS = (archives, laws, models, options, records, stores, surroundings)


def plan(count: int = 500, seed: int = 0) -> list[Kind]:
    """The kind of each case: every kind at least once in 200 cases or more, else by its weight."""
    rng = np.random.default_rng(seed)
    weights = np.array([each.weight for each in KINDS])
    first = list(range(len(KINDS))) if count >= 200 else []
    rest = rng.choice(len(KINDS), count - len(first), p=weights / weights.sum())
    return [KINDS[place] for place in rng.permutation([*first, *rest])]


def case_of(each: Kind, index: int, seed: int, folder: Path) -> Case:
    """The case at a place of a plan, its files written into a folder."""
    return each.draw(np.random.default_rng([seed, index]), folder)
