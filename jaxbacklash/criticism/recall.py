"""A model that a search had found and left behind, where it ends with a worse one.

What a stage tries is judged from the model that it begins with. If that had stuck, it gets its turn again, and what was found in
the meantime may not be looked for from there: from another trajectory it looks as if it would bring nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .evidence import demanded, explained
from .preference import advantage
from .steps import Step, leading

if TYPE_CHECKING:
    from .search import Search


def recalled(search: Search, steps: list[Step], least: float) -> list[Step]:
    """The path to the best model known instead, if that has no more effects than the last and is clearly ahead.

    Parameters
    ----------
    search : the record's search
    steps : a path whose last model is one trajectory; any other is compared with nothing
    least : share of the misfit above noise that an addition must take away, as in `Search.forward`
    """
    final = steps[-1].trial
    if not final.tied or search.bench.outright:
        return steps
    known = [t for (names, tied), t in search.known.items() if tied and explained(t) and len(names) <= len(final.names)]
    best = min(known, key=lambda t: t.criterion, default=final)
    if advantage(search.bench, best, final) < demanded(search.bench):
        return steps
    settled, dropped = search.prune(best if best.done else search.finish(best))
    added = next(iter(sorted(settled.names - final.names)), None)
    if added is None:  # what is left without one of the effects was looked at on the way
        return steps
    return search.forward(settled, [*leading(steps, settled), Step(settled, added, dropped, ())], least)
