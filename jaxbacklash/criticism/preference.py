"""Which of several models that do about as well is kept."""

from __future__ import annotations

from collections.abc import Mapping

from .evidence import demanded, measures_only
from .workbench import Trial, Workbench

AHEAD = 2.0
"""A fall of the criterion by so much tells two models that are as complex, or what a search found before from what it has now."""


def doubt(bench: Workbench, *trials: Trial) -> float:
    """By how much a model with what only measures must be ahead of one with what acts: next to nothing, the two are as likely.

    The centre of a play and the zero of its sensor, say, cannot be told apart unless something else knows where the middle is.
    Corners of dry friction end one search a few units above another: there a lead has to be clear.
    """
    jagged = any(bench.laws[n].slides for t in trials for n in t.names)
    return demanded(bench) if jagged else AHEAD


def lead(bench: Workbench, other: Trial, final: Trial, name: str) -> float:
    """By how much another model must be better to replace the last one, where it has other effects in the place of ``name``.

    Clearly, where it contains the law whose place it takes. What is contained in it need only be no worse, and what acts no worse
    than what only measures, see `doubt`.
    """
    if other.names < final.names:
        return -demanded(bench)
    new = [bench.laws[n] for n in other.names - final.names]
    if measures_only(bench.laws[name]) and not any(measures_only(law) for law in new):
        return -AHEAD
    if all(name in law.absorbs for law in new):
        return demanded(bench)
    return doubt(bench, other, final) if all(measures_only(law) for law in new) else AHEAD


def simplest(bench: Workbench, tried: Mapping[str, Trial], slack: float, *, more: bool = False) -> str:
    """Name of the effect whose model does as well as any with the fewest parameters.

    Parameters
    ----------
    tried : models by the name of the effect that they add
    slack : what comes so near to the best criterion does as well
    more : there is more to come, which changes everything by such shares: what acts then goes before what measures
    """
    lowest = min(t.criterion for t in tried.values())
    level = {n: t for n, t in tried.items() if t.criterion - lowest < slack} or tried
    fewest = min(len(t.free) for t in level.values())
    level = {n: t for n, t in level.items() if len(t.free) == fewest}
    handicap = slack if more else doubt(bench, *level.values())
    return min(level, key=lambda n: level[n].criterion + handicap * measures_only(bench.laws[n]))


def advantage(bench: Workbench, other: Trial, kept: Trial) -> float:
    """By how much the criterion of another model is lower, each effect of either charged for having been chosen from many.

    A pair is chosen from far more than a single one, and has as many more chances to fit by accident (Chen and Chen, Biometrika
    95, 2008).
    """
    return kept.criterion - other.criterion + demanded(bench) * (len(kept.names) - len(other.names))
