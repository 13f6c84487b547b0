"""Two effects in the place of one that stands in for both.

A law with several parameters, a slow ripple of the torque say, may do the work of two simpler ones so well that neither is missed
beside it, and that neither does as well alone. Replaced by one of them, it is missed again, and the other is what fills the gap.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .candidates import may_join, rank
from .evidence import demanded, explained
from .workbench import Trial

if TYPE_CHECKING:
    from .search import Search


def two_for_one(search: Search, final: Trial, other: Trial) -> Trial:
    """A model that has a simpler law in the place of one of the last model's, with the addition that it promises most, if that
    may put it ahead; otherwise as it is.

    Asked is only what leaves hardly more than noise, and has fewer parameters than the last model: with one effect more it is
    no richer than that.
    """
    room = len(final.free) - len(other.free)
    if room < 1 or not other.tied or not explained(other) or other.criterion < final.criterion:
        return other
    price = math.log(max(search.bench.record.samples, 2))
    worse = other.criterion - final.criterion
    ranking = rank(search.bench, other, may_join(search.bench, other))
    fit = (c for c in ranking if c.name not in final.names and c.parameters <= room)
    second = next((c for c in fit if c.gain - c.parameters * price > worse), None)
    if second is None:
        return other
    search.progress(f"trying {second.name} beside {', '.join(sorted(other.names))}", 0.8)
    both = search.add(other, second)
    return both if other.criterion - both.criterion > demanded(search.bench) else other
