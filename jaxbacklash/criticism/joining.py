"""Windows that a model explains only apart, joined to one trajectory by what else acts.

Every free window has a start to choose, and takes up there what a weak effect would bring. Noise may then hide an effect
without which no trajectory follows the record: it brings next to nothing on free windows, and with it they are one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from .evidence import explained
from .steps import Step
from .unseen import LIKELY, MOST_EFFECTS, TRIED
from .workbench import Trial, adequate

if TYPE_CHECKING:
    from .search import Search


def one_piece(search: Search, steps: list[Step], least: float) -> list[Step]:
    """The path with the addition that leads to one trajectory of windows that its last model explains only apart.

    What joined them need not stay: without it they may be one trajectory as well, which only was not found before.

    Parameters
    ----------
    search : the record's search
    steps : a path with the ranking of what its last model lacks
    least : share of the misfit above noise that an addition must take away, as in `Search.forward`
    """
    last = steps[-1].trial
    if last.tied or not explained(last) or len(last.names) >= MOST_EFFECTS or search.bench.outright:
        return steps
    for free in _likely(search, steps[-1]):
        if (free.names, True) in search.known:
            continue
        search.progress(f"joining {', '.join(sorted(free.names))}", 0.6)
        tied = search.settle(free)
        if not tied.tied or not adequate(tied):
            continue
        settled, dropped = search.prune(tied)
        added = next(iter(sorted(settled.names - last.names)), None)
        if added:
            path = [*steps, Step(settled, added, dropped, ())]
        else:
            gone = sorted(last.names - settled.names)
            path = [*steps[:-1], replace(steps[-1], trial=settled, dropped=(*steps[-1].dropped, *gone))]
        path = search.forward(settled, path, least)
        if path[-1].trial.tied and explained(path[-1].trial):
            return path
    return steps


def _likely(search: Search, step: Step) -> Iterator[Trial]:
    """Models of free windows with one effect more: those that were fitted, then others that promise anything."""
    names = sorted(step.evidence, key=step.evidence.__getitem__, reverse=True)[:LIKELY]
    fitted = [search.known.get((step.trial.names | {name}, False)) for name in names]
    yield from (trial for trial in fitted if trial is not None)
    for candidate in step.ranking[:TRIED]:
        if candidate.gain > 0.0:
            yield search.add(step.trial, candidate)
