"""The last model's search, gone on with where it has ended before it arrived.

Along the curved valley of a law that remembers a search may run out of patience within the noise, where nothing calls for more;
at a corner of dry friction it may stop there. The model is right then and its numbers are not: they stand further from the best
than their intervals say.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from .steps import Step
from .tried import LOOSER

if TYPE_CHECKING:
    from .search import Search


def arrived(search: Search, steps: list[Step]) -> list[Step]:
    """The path with its last model where its search arrives, from its own windows or from its parameters and the data.

    Dry friction beside other effects came to its windows from those of a model without some of them, and may be held where it was
    held there: it is begun anew even where its search has ended. A model is asked once.
    """
    final = steps[-1].trial
    dry, several = search.dry(final), len(final.names) > 1
    if not final.tied or (final.done and not (dry and several)) or search.bench.outright or final is search.gone_on:
        return steps
    search.gone_on = final
    ways = [search.finish(final)]
    if several or not dry:
        ways.append(search.begun_again(final))
    found = search.keep(min(ways, key=lambda way: way.cost))
    if not final.cost - found.cost > LOOSER:
        return steps
    return [*steps[:-1], replace(steps[-1], trial=found)]
