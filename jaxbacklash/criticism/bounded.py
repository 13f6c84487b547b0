"""A search that ends: with the path it has come by when it has made as many fits as one may make."""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING

from .steps import Step
from .workbench import ExhaustedError

if TYPE_CHECKING:
    from .evidence_search import EvidenceSearch
    from .search import Search


def bounded(search: Search | EvidenceSearch) -> list[Step]:
    """The path of a search, whole or as far as it came; then a warning says so.

    Parameters
    ----------
    search : that has not been run
    """
    try:
        return search.run()
    except ExhaustedError:
        if not search.path:
            raise
    bench = search.bench
    said = f"the search was ended after {bench.fits} fits: another effect may do as well or better"
    bench.most = math.inf  # what is still to be told of the model kept takes a few more
    bench.cut(bench.ties)
    warnings.warn(said, stacklevel=3)
    return search.path
