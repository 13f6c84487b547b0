"""Another path to a model, on free windows, where one trajectory does not follow what free windows leave.

Dry friction and the wrong law beside it can hold one trajectory where no step leads to the right one, and each addition is
then judged from there. Free windows tell less of small effects, but nothing holds them: what they name is tied at the end.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from .candidates import Candidate, may_join, rank
from .evidence import SURE, demanded, explained, gain
from .steps import Step
from .tried import follows
from .workbench import Trial

if TYPE_CHECKING:
    from .search import Search

TIED, LIKELY = 3, 3
"""Models that are tied at most, and candidates that are looked at in the place of an effect."""


def by_free_windows(search: Search, steps: list[Step], least: float) -> list[Step]:
    """The path on free windows by effects without a state of their own, if one trajectory follows it to a better model.

    Parameters
    ----------
    search : the record's search
    steps : a path whose last model is one trajectory
    least : share of the misfit above noise that an addition must take away, as in `Search.forward`
    """
    final = steps[-1].trial
    if not final.tied or not final.names or search.bench.outright or follows(final, search.loosened(final)):
        return steps
    base = search.loosened(steps[0].trial)
    with _apart(search):
        path = search.forward(base, [Step(base, None, (), ())], least)
        found = sorted(_around(search, path[-1].trial), key=lambda t: t.criterion)
    for free in [t for t in found if gain(found[0], t) > -2.0 * demanded(search.bench)][:TIED]:
        tied = search.settle(free)
        if tied.tied and explained(tied) and gain(final, tied) > demanded(search.bench):
            settled, dropped = search.prune(tied)
            added = next(iter(sorted(settled.names - steps[0].trial.names)), None)
            return search.forward(settled, [steps[0], Step(settled, added, dropped, ())], least)
    return steps


def without_soaking(search: Search, steps: list[Step], least: float) -> list[Step]:
    """The path trimmed and, where that has taken away a law with a state that soaked up what is missing, gone on with by effects
    without one, which had no turn beside it."""
    trimmed = search.trim(steps)
    soaked = any(search.bench.laws[s.added].states for s in steps[len(trimmed) :] if s.added)
    if not soaked or trimmed[-1].trial.tied or search.bench.outright:
        return trimmed
    with _apart(search):
        return search.trim(search.forward(trimmed[-1].trial, trimmed, least))


@contextmanager
def _apart(search: Search) -> Iterator[None]:
    """Windows are left free, and laws with states out of it."""
    search.apart = True
    try:
        yield
    finally:
        search.apart = False


def judged_loose(
    search: Search, current: Trial, tried: dict[str, Trial], ranking: tuple[Candidate, ...]
) -> tuple[Trial, dict[str, Trial]]:
    """The model of a stage and its candidates, with free windows where one trajectory has stuck on the way to a clear gain.

    Parameters
    ----------
    current, tried : the model, and those with another effect by its name
    ranking : of what the model lacks
    """
    if not current.tied or search.runs_through(current):
        return current, tried
    promised = {c.name for c in ranking if c.gain > SURE * demanded(search.bench)}
    parted = any(not t.tied and not search.ruled_out(current, t.names) for t in tried.values())
    lost = parted or any(t.cost > current.cost and n in promised for n, t in tried.items() if t.tied)
    # Free windows have starts to choose, which one trajectory has not: what they rule out is no match for it.
    tried = {n: t for n, t in tried.items() if t.tied}
    if not lost:
        return current, tried
    # The stage is judged on free windows, unless they show nothing, or what no trajectory follows, and another candidate went
    # all the way.
    loose = search.loosened(current)
    others = search.attempts(loose, ranking)
    shown = search.helps(loose, others) and not soaked_up(search, current, tried, loose, others)
    return (loose, others) if shown or not search.helps(current, tried) else (current, tried)


def soaked_up(search: Search, current: Trial, tried: dict[str, Trial], loose: Trial, others: dict[str, Trial]) -> bool:
    """Whether free windows are helped by laws with a state alone, whose trajectory misses more than that of the model without,
    while an effect without one helps that trajectory by more.

    Parameters
    ----------
    current, tried : one trajectory, and those with another effect by its name
    loose, others : the same with free windows
    """
    laws, enough = search.bench.laws, demanded(search.bench)
    helped = {n: gain(loose, t) for n, t in others.items() if gain(loose, t) > enough}
    lost = [laws[n].states and _misses_more(search.known.get((others[n].names, True)), current) for n in helped]
    along = max((gain(current, t) for n, t in tried.items() if not laws[n].states), default=0.0)
    return bool(helped) and all(lost) and along > max(enough, *helped.values())


def _misses_more(tied: Trial | None, current: Trial) -> bool:
    return tied is not None and tied.cost > current.cost


def _around(search: Search, trial: Trial) -> Iterator[Trial]:
    """A model of free windows, and those with another effect in the place of one of its own."""
    yield trial
    for name in sorted(trial.names):
        rest = search.without(trial, name)
        others = [c for c in rank(search.bench, rest, may_join(search.bench, rest)) if c.name not in trial.names]
        for candidate in others[:LIKELY]:
            search.progress(f"trying {candidate.name} in place of {name}", 0.65)
            yield search.add(rest, candidate)
