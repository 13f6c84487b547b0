"""An effect that does nothing but bring on a search that had stuck."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from .evidence import significance
from .steps import Step
from .tried import LOOSER

if TYPE_CHECKING:
    from .search import Search


def without_what_brought_on(search: Search, steps: list[Step], least: float, clear: float) -> list[Step]:
    """The path without an effect that does nothing in its last model, where without it less is now left than when its turn came.

    The starts of windows may lie on the wrong side of a play: one more law, whatever it is, can get them across. What it was
    then credited with is nothing of its own; the search goes on from the model without it.

    Parameters
    ----------
    steps : path that `Search.forward` has found
    least : as `Search.forward` takes it
    clear : standard errors from zero at which an effect of the last model is not looked at
    """
    final = steps[-1].trial
    for name in sorted(final.names, key=lambda n: significance(final, n)):
        if significance(final, name) >= clear:
            break
        at = next((k for k, s in enumerate(steps) if s.trial.names == final.names - {name}), None)
        if at is None:
            continue
        simpler = search.without(final, name)
        if steps[at].trial.cost - simpler.cost > LOOSER:
            begun = replace(steps[at], trial=simpler, ranking=(), evidence={}, refits={})
            return without_what_brought_on(search, search.forward(simpler, [*steps[:at], begun], least), least, clear)
    return steps
