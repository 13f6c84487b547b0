"""The search for the laws that a record needs beyond the joint: to the neighbour with the highest evidence, until none is better.

`run` is the algorithm: fit the joint alone, and go from model to model by `moves`. Additions are screened linearly (`screening`)
and the most promising are fitted; then each law is left out, then each is replaced. Every model is fitted by one continuation
(`model_fitter`) and judged by one criterion. What the record cannot tell from the model that is kept is in ``level``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from ..fitting.search import silent
from .candidates import Candidate
from .evidence import demanded, noise_too_large
from .fitted_model import FittedModel
from .model_fitter import ModelFitter
from .moves import add, contained_instead, drop
from .screening import screen, worth
from .steps import Step

MOST_FITTED = 3
"""Candidates beside one model that are fitted at most."""
CLEAR_SHARE = 0.1
"""Share of what a model leaves, in units of the criterion, that a law must take away if more is left."""
PROMISING = 0.25
"""Share of the most promising candidate's worth that earns a fit."""


class EvidenceSearch:
    """Finds the set of laws with the highest evidence.

    Parameters
    ----------
    fitter : of the record
    progress : told the stage in words and the share of the work done
    """

    def __init__(self, fitter: ModelFitter, progress: Callable[[str, float], None] = silent) -> None:
        self.bench, self.progress = fitter, progress
        self.path: list[Step] = []
        self.level: dict[tuple[str, ...], FittedModel] = {}
        self._screened: dict[tuple[frozenset[str], float], list[Candidate]] = {}

    def run(self) -> list[Step]:
        """The path from the joint alone to the model kept."""
        self.progress("fitting the joint alone", 0.1)
        model = self.bench.fit_model({})
        self.path = [Step(model, None, (), ())]
        while (better := self.better_neighbour(model)) is not None:
            model = better
        if noise_too_large(model) and (factor := self.bench.too_loud(model)) != 1.0:
            self.bench.quieter(factor)
            self.bench.fitted.clear()
            self._screened.clear()
            return self.run()
        self.level = self.as_likely(model)
        return self.path

    def better_neighbour(self, model: FittedModel) -> FittedModel | None:
        """The best model one move away, None where no move helps: additions first, then fewer laws, then other ones."""
        for neighbours, least in (
            (self.with_one_more, self.demand), (self.with_one_fewer, -self.demand), (self.with_another, self.demand),
        ):  # fmt: skip
            found = max(neighbours(model), key=lambda other: self.evidence(model, other), default=None)
            if found is not None and self.evidence(model, found) > least:
                self._step(model, found)
                return found
        return None

    @property
    def demand(self) -> float:
        """Fall of the criterion that a move must bring: as many laws as there are had their chance to fool it."""
        return demanded(self.bench)

    def evidence(self, model: FittedModel, other: FittedModel) -> float:
        """Evidence for ``other``: fall of the criterion, divided where what remains is larger than noise or correlated."""
        return (model.criterion - other.criterion) / other.deflation

    def with_one_more(self, model: FittedModel) -> list[FittedModel]:
        """The model with each of the most promising absent laws, where that leaves nothing or takes a clear share of the rest.

        What takes little and leaves much stands in for something else.
        """
        found = [add(self.bench, model, c) for c in self._promising(self.screened(model))]
        return [m for m in found if m.tied or model.criterion - m.criterion > CLEAR_SHARE * model.rest]

    def with_one_fewer(self, model: FittedModel) -> list[FittedModel]:
        """The model without each of its laws, and with the simpler ones that they contain in their place."""
        simpler = [other for name in sorted(model.names) for other in contained_instead(self.bench, model, name)]
        return simpler + [drop(self.bench, model, name) for name in sorted(model.names)]

    def with_another(self, model: FittedModel) -> list[FittedModel]:
        """The model with each of its laws replaced by the most promising others."""
        found = []
        for name in sorted(model.names):
            without = drop(self.bench, model, name)
            others = [c for c in self.screened(without) if c.name != name]
            found += [add(self.bench, without, c) for c in self._promising(others)]
        return found

    def screened(self, model: FittedModel) -> list[Candidate]:
        """`screen`, once for each fit."""
        key = model.names, model.criterion
        if key not in self._screened:
            self._screened[key] = screen(self.bench, model)
        return self._screened[key]

    def as_likely(self, model: FittedModel) -> dict[tuple[str, ...], FittedModel]:
        """Other models that the record cannot tell from the one kept, by their laws; none where that leaves something."""
        if not model.tied:
            return {}
        others = [m for m in self.bench.fitted.values() if m.names != model.names and m.tied]
        return {tuple(sorted(m.names)): m for m in others if self.evidence(model, m) > -self.demand}

    def _promising(self, candidates: Iterable[Candidate]) -> list[Candidate]:
        worths = [(worth(c, self.bench), c) for c in candidates]
        best = max((w for w, _ in worths), default=0.0)
        return [c for w, c in worths if w > max(self.demand, PROMISING * best)][:MOST_FITTED]

    def _step(self, model: FittedModel, found: FittedModel) -> None:
        ranking = tuple(self._screened.get((model.names, model.criterion), ()))
        fitted = {n: self.bench.fitted.get(model.names | {n}) for n in (c.name for c in ranking)}
        tried = {n: m for n, m in fitted.items() if m is not None}
        evidence = {n: self.evidence(model, m) for n, m in tried.items()}
        refits = {n: (model.inside, m.inside) for n, m in tried.items()}
        last = self.path[-1]
        self.path[-1] = Step(last.trial, last.added, last.dropped, ranking, evidence, refits)
        new = sorted(found.names - model.names)
        gone = tuple(sorted(model.names - found.names))
        self.progress(f"{' + '.join(sorted(found.names)) or 'the joint alone'} explains more", 0.5)
        self.path.append(Step(found, new[0] if new else None, gone, ()))
