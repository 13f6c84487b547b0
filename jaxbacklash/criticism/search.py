"""The search for the set of effects that explains a record: add, check what became needless, swap, and know when to stop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ..fitting.fit import silent
from ..mechanics import AbstractEffect
from .candidates import Candidate, rank
from .workbench import Trial, Workbench, adequate

MOST_EFFECTS = 5
"""A model with more effects than this is no explanation any more."""
TRIED = 4
"""Candidates that are really refitted at every stage."""
NOISE_FLOOR = 1.03
"""Root of the reduced chi-square of a tied fit up to which what is left counts as noise."""
WHOLE = 200
"""Linearisations allowed to a model that is kept."""


@dataclass(frozen=True)
class Step:
    """One model kept on the way: ``trial``, the effect ``added`` (None for the base), those ``dropped``, ``ranking`` of what was
    absent, and ``evidence`` of the candidates that were really refitted, by name."""

    trial: Trial
    added: str | None
    dropped: tuple[str, ...]
    ranking: tuple[Candidate, ...]
    evidence: dict[str, float] = field(default_factory=dict)


def demanded(bench: Workbench) -> float:
    """The fall of the criterion that an addition must bring: as many candidates as there are had their chance to fool us."""
    return 2.0 * float(np.log(max(len(bench.laws), 2)))


def gain(before: Trial, after: Trial) -> float:
    """Evidence for ``after``: fall of the criterion, scaled down where what remains is larger than noise or correlated."""
    return (before.criterion - after.criterion) / (max(1.0, after.misfit**2) * after.correlation)


def explained(trial: Trial) -> bool:
    """Whether a model leaves nothing but noise, as far as the noise is known."""
    return trial.tied and trial.misfit < NOISE_FLOOR


class Search:
    """Keeps every model that was fitted, so that none is fitted twice."""

    def __init__(self, bench: Workbench, progress: Callable[[str, float], None] = silent) -> None:
        self.bench, self.progress = bench, progress
        self.known: dict[tuple[frozenset[str], bool], Trial] = {}

    def settle(self, trial: Trial) -> Trial:
        """The trial finished, and its windows tied where it is good enough for that."""
        if not trial.done:
            trial = self._keep(self.bench.fit(self.bench.effects(trial), trial, tied=trial.tied, patience=WHOLE))
        if trial.tied or not adequate(trial):
            return trial
        tied = self.bench.fit(self.bench.effects(trial), trial, tied=True, patience=WHOLE)
        return self._keep(tied) if adequate(tied) else trial

    def base(self) -> Trial:
        """The joint alone."""
        self.progress("fitting the joint alone", 0.1)
        return self.settle(self._keep(self.bench.fit({}, patience=WHOLE)))

    def add(self, before: Trial, effect: Candidate) -> Trial:
        """The model with one more effect, fitted as the model before was: tied or free."""
        key = (before.names | {effect.name}, before.tied)
        if key not in self.known:
            effects = {**self.bench.effects(before), effect.name: effect.effect}
            self._keep(self.bench.fit(effects, before, tied=before.tied))
        return self.known[key]

    def without(self, before: Trial, name: str) -> Trial:
        """The model without one of its effects."""
        key = (before.names - {name}, before.tied)
        if key not in self.known:
            effects = {n: e for n, e in self.bench.effects(before).items() if n != name}
            self._keep(self.bench.fit(effects, before, tied=before.tied))
        return self.known[key]

    def run(self) -> list[Step]:
        """The whole search: the path from the joint alone to the model kept."""
        base = self.base()
        steps = self.forward(base, [Step(base, None, (), ())])
        final = steps[-1].trial
        if final.tied and final.misfit < 0.97:
            # A noise estimate cannot be right that exceeds what a model leaves: corners were taken for noise.
            self.bench.quieter(final.misfit)
            self.known.clear()
            return self.run()
        if not explained(final):
            steps = self.with_hidden(steps)
        return steps

    def with_hidden(self, steps: list[Step]) -> list[Step]:
        """Another path, by a law with internal states, if it ends better than the one without."""
        base, final = steps[0].trial, steps[-1].trial
        starts = [base] if not final.names else [base, final]
        tried = [t for t in (self.hidden(s) for s in starts) if t is not None]
        if not tried:
            return steps
        free = final if not final.tied else self.known.get((final.names, False), final)
        best = min(tried, key=lambda t: t.criterion)
        if gain(free, best) < demanded(self.bench):
            return steps
        best, dropped = self.prune(self.settle(best))
        added = next((n for n in best.names if self.bench.laws[n].states), None)
        first = Step(base, None, (), steps[0].ranking, steps[0].evidence)
        return self.forward(best, [first, Step(best, added, dropped, ())])

    def forward(self, start: Trial, steps: list[Step]) -> list[Step]:
        """Add effects one by one, dropping those that become needless, until nothing helps any more."""
        current, steps = start, list(steps)
        while len(current.names) < MOST_EFFECTS:
            self.progress("judging absent effects" if not current.names else f"with {', '.join(sorted(current.names))}", 0.3)
            ranking = rank(self.bench, current)
            steps[-1] = Step(steps[-1].trial, steps[-1].added, steps[-1].dropped, tuple(ranking), {})
            tried = {c.name: self.add(current, c) for c in self._worth(current, ranking)}
            evidence = {n: gain(current, t) for n, t in tried.items()}
            steps[-1] = Step(steps[-1].trial, steps[-1].added, steps[-1].dropped, tuple(ranking), evidence)
            if not tried:
                break
            name = min(tried, key=lambda n: tried[n].criterion)
            if evidence[name] < demanded(self.bench):
                break
            current, dropped = self.prune(self.settle(tried[name]), spare=name)
            steps.append(Step(current, name, dropped, ()))
        return steps

    def prune(self, trial: Trial, spare: str | None = None) -> tuple[Trial, tuple[str, ...]]:
        """The model without the effects it no longer needs."""
        dropped: list[str] = []
        while True:
            losses = {n: gain(self.without(trial, n), trial) for n in trial.names if n != spare}
            needless = [n for n, loss in losses.items() if loss < demanded(self.bench)]
            if not needless:
                return trial, tuple(dropped)
            name = min(needless, key=lambda n: losses[n])
            trial = self.settle(self.without(trial, name))
            dropped.append(name)

    def hidden(self, start: Trial) -> Trial | None:
        """The best model with a law that has internal states beside those of ``start``, if it is worth it."""
        best: Trial | None = None
        for name in (n for n, law in self.bench.laws.items() if law.states and n not in start.names):
            self.progress(f"trying {name}", 0.6)
            for effect in self.bench.quick.choose(start.system, start.free, self.bench.laws[name].guesses(start.system), keep=2):
                effects: dict[str, AbstractEffect] = {**self.bench.effects(start), name: effect}
                trial = self._keep(self.bench.fit(effects, start, tied=False))
                if best is None or trial.criterion < best.criterion:
                    best = trial
        return best

    def _worth(self, current: Trial, ranking: list[Candidate]) -> list[Candidate]:
        scale = max(1.0, current.misfit**2)
        telling = [c for c in ranking if c.gain / scale > 0.5 * demanded(self.bench)]
        return telling[:TRIED]

    def _keep(self, trial: Trial) -> Trial:
        key = (trial.names, trial.tied)
        if key not in self.known or trial.criterion < self.known[key].criterion:
            self.known[key] = trial
        return self.known[key]

