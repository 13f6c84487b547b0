"""A richer law at another shape, where the search has ended with a simpler one that it contains.

Dry friction holds a trajectory where it began: a law that was begun at a shape that explains nothing stays there,
looks like the simpler one, and is reduced to it. The trajectory that is left tells at which shape the richer law would act.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .candidates import Candidate, reshaped
from .evidence import demanded, explained, gain, shapeless
from .steps import Step

if TYPE_CHECKING:
    from .search import Search
    from .workbench import Trial


def reshaped_at_last(search: Search, steps: list[Step]) -> list[Step]:
    """The path with a richer law in the place of one of its last model's, if that is clearly better and its shape determined.

    It is begun at the shape that the model's own trajectory asks for, if it promises as much evidence there as an addition must
    bring. Its parameters count only against what it has brought: a promise is linear, and a shape that moves brings more.
    """
    bench, final = search.bench, steps[-1].trial
    if not final.tied or not explained(final) or bench.outright:
        return steps
    for simpler in sorted(final.names):
        for name in (n for n, law in bench.static.items() if simpler in law.absorbs and n not in final.names):
            search.progress(f"trying {name} in place of {simpler}", 0.7)
            asked = reshaped(bench, final, name)
            if asked.gain < demanded(bench):
                continue
            richer = _begun(search, final, asked)
            if gain(final, richer) > demanded(bench) and not shapeless(richer, name, bench.slowest):
                settled, dropped = search.prune(search.keep(richer), spare=name)
                return [*steps, Step(settled, name, (simpler, *dropped), ())]
    return steps


def _begun(search: Search, final: Trial, asked: Candidate) -> Trial:
    """The richer model fitted from there, and its search given its turn again where it has begun to be better."""
    found = search.finish(search.bench.fit(search.with_one_more(final, asked), final, tied=True))
    return search.softly(found) if found.cost < final.cost else found
