"""Another path, where the last model's law stands at the end of the shapes it may have.

There it imitates: a ripple of the lowest order passes for a load and the weight of the link together. From such a law no search
comes back, for what it stands in for is two or three effects, none of which brings anything beside it, nor does as well alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .evidence import MUCH, at_a_bound, demanded, explained, gain
from .steps import Step

if TYPE_CHECKING:
    from .search import Search
    from .workbench import Trial


def within_bounds(search: Search, steps: list[Step]) -> list[Step]:
    """The path with the next best addition in place of the one whose law has ended at a bound, where that ends clearly better."""
    final = steps[-1].trial
    if not final.tied or search.bench.outright:
        return steps
    for name in sorted(final.names):
        if search.bench.laws[name].states or not at_a_bound(final, name):
            continue
        came = next((k for k, step in enumerate(steps) if k and step.added == name), None)
        if came is None or not (others := _others(search, steps[came - 1], name)):
            continue
        search.progress(f"looking for what {name} stands in for", 0.7)
        other = search.best(steps[came - 1].trial, others, MUCH)
        begun = Step(search.settle(others[other]), other, (), ())
        path = search.trim(search.forward(begun.trial, [*steps[:came], begun], MUCH))
        last = path[-1].trial
        if last.tied and explained(last) and gain(final, last) > demanded(search.bench):
            return path
    return steps


def _others(search: Search, before: Step, name: str) -> dict[str, Trial]:
    """What else helped where a law was added; its simpler and richer relatives have had their turn already."""
    laws, trial = search.bench.laws, before.trial
    apart = [n for n in before.evidence if n != name and n not in laws[name].absorbs and name not in laws[n].absorbs]
    known = {n: search.known.get((trial.names | {n}, trial.tied)) for n in apart}
    return {n: t for n, t in known.items() if t is not None and gain(trial, t) > demanded(search.bench)}
