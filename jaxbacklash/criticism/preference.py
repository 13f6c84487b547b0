"""Which of several models that do about as well is kept."""

from __future__ import annotations

from collections.abc import Mapping

from .evidence import demanded, measures_only
from .workbench import Trial, Workbench

AHEAD = 2.0
"""A fall of the criterion by so much tells two models that are as complex, or what a search found before from what it has now."""


def lead(bench: Workbench, other: Trial, final: Trial, name: str) -> float:
    """By how much another model must be better to replace the last one, where it has other effects in the place of ``name``.

    Clearly, where it contains the law whose place it takes. What is contained in it need only be no worse, and what acts no worse
    than what only measures.
    """
    if other.names < final.names:
        return -demanded(bench)
    new = [bench.laws[n] for n in other.names - final.names]
    if measures_only(bench.laws[name]) and not any(measures_only(law) for law in new):
        return -AHEAD
    return demanded(bench) if all(name in law.absorbs for law in new) else AHEAD


def simplest(bench: Workbench, tried: Mapping[str, Trial], slack: float, *, doubt: float = AHEAD) -> str:
    """Name of the effect whose model does as well as any with the fewest parameters.

    Parameters
    ----------
    tried : models by the name of the effect that they add
    slack : what comes so near to the best criterion does as well
    doubt : by how much one that only measures must be ahead of one that acts, of those with as many parameters. The centre of a
        play and the zero of its sensor, say, cannot be told apart unless something else knows where the middle is
    """
    lowest = min(t.criterion for t in tried.values())
    level = {n: t for n, t in tried.items() if t.criterion - lowest < slack} or tried
    fewest = min(len(t.free) for t in level.values())
    doubtful = {n: t.criterion + doubt * measures_only(bench.laws[n]) for n, t in level.items() if len(t.free) == fewest}
    return min(doubtful, key=doubtful.__getitem__)


def advantage(bench: Workbench, other: Trial, kept: Trial) -> float:
    """By how much the criterion of another model is lower, each effect of either charged for having been chosen from many.

    A pair is chosen from far more than a single one, and has as many more chances to fit by accident (Chen and Chen, Biometrika
    95, 2008).
    """
    return kept.criterion - other.criterion + demanded(bench) * (len(kept.names) - len(other.names))
