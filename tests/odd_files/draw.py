"""Drawing odd files: every kind in several variants, and two kinds at once in a third of the files."""

from __future__ import annotations

import numpy as np

from tests.odd_files import channel_kinds, format_kinds, text_kinds, time_kinds
from tests.odd_files.draft import Draft, good_draft
from tests.odd_files.good import measured
from tests.odd_files.kinds import KINDS, Kind

MODULES = (text_kinds, time_kinds, channel_kinds, format_kinds)
STEMS = ("run1", "run 1", "messung_04", "log-2024-03-05", "o'hara", "rig (2)", "a&b")
"""Names of files as people give them; what is pasted into a shell must bear all of them."""


def plan(count: int = 150, seed: int = 0) -> list[list[Kind]]:
    """Which kinds each of ``count`` files is of; nothing is simulated yet."""
    names, plans = sorted(KINDS), []
    for index in range(count):
        first = KINDS[names[index % len(names)]]
        kinds = [first]
        if (index + index // len(names)) % 3 == 2:
            fits = [each for each in KINDS.values() if _together(first, each)]
            kinds.append(fits[int(np.random.default_rng([seed, index, 1]).integers(len(fits)))])
        plans.append(kinds)
    return plans


def draft_of(kinds: list[Kind], index: int, seed: int = 0) -> Draft:
    """The draft of one place in a plan; it has its own generator, so that it does not depend on those before it."""
    return dressed(kinds, np.random.default_rng([seed, index]))


def dressed(kinds: list[Kind], rng: np.random.Generator) -> Draft:
    """A good record made odd in these ways, one after the other."""
    need = max(kinds, key=lambda each: (each.rate != 500.0) + (each.offset != 0.0))
    draft = good_draft(measured(rng, need.rate, need.offset))
    draft.stem = STEMS[int(rng.integers(len(STEMS)))]
    # What is wrong with the values comes first: how they are written follows from them.
    for each in sorted(kinds, key=_stage):
        each.dress(draft, rng)
        draft.kinds.insert(0, each.name)
    return draft


def _stage(each: Kind) -> int:
    """0 for what is wrong with values, 2 for units, in which all columns are written, and 1 for the rest."""
    order = ("x z", "x", "x z time")
    if " ".join(sorted(each.touches)) in (" ".join(sorted(part.split())) for part in order):
        return 0
    return 2 if {"x", "z", "units"} <= each.touches else 1


def _together(one: Kind, other: Kind) -> bool:
    """Whether both can be had by one file: they change different things, and not both its record."""
    needs = {(each.rate, each.offset) for each in (one, other)} - {(500.0, 0.0)}
    return len(needs) < 2 and not one.touches & other.touches and not (_stage(one) == 0 and _stage(other) == 0)
