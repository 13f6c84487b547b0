"""The search for the laws that a record needs beyond the joint: to the neighbour with the highest evidence, until none is better.

`run` is the algorithm: fit the joint alone, and go from model to model by `moves`. Additions are screened linearly (`screening`)
and the most promising are fitted; then each law is left out, then each is replaced. Every model is fitted by one continuation
(`model_fitter`) and judged by one criterion. What the record cannot tell from the model that is kept is in ``level``.
"""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import replace

from ..fitting.search import silent
from ..fitting.settings import CLEAR_SHARE, CLOSE, MOST_FITTED, MOST_LAWS, PROMISING, SCATTER, SHARP, SURE, TIGHTEST
from .candidates import Candidate, share_of_rest, stepwise_selection
from .evidence import demanded, leaves_noise, most_of_noise, noise_too_large
from .fitted_model import FittedModel
from .force_test import compiling_aside
from .model_fitter import ExhaustedError, ModelFitter
from .moves import Neighbour, in_other_forms, with_law, with_laws, with_others_of, with_simpler_law, without_law
from .screening import net_gain, screen
from .steps import SearchStep


class EvidenceSearch:
    """Finds the set of laws with the highest evidence.

    Parameters
    ----------
    fitter : of the record
    progress : told the stage in words and the share of the work done
    """

    def __init__(self, fitter: ModelFitter, progress: Callable[[str, float], None] = silent) -> None:
        self.fitter, self.progress = fitter, progress
        self.path: list[SearchStep] = []
        self.level: dict[tuple[str, ...], FittedModel] = {}
        self._screened: dict[tuple[frozenset[str], float], list[Candidate]] = {}
        self._formed: set[tuple[str, frozenset[str], float]] = set()

    def run(self) -> list[SearchStep]:
        """The path from the joint alone to the model kept."""
        self.progress("fitting the joint alone", 0.1)
        with compiling_aside(self.fitter):
            model = self.fitter.fit_model({})
        self.path = [SearchStep(model, None, (), ())]
        try:
            while (better := self.better_neighbour(model)) is not None:
                model = better
        except ExhaustedError:
            self._end_early()
            model = self.path[-1].model
            while (better := self._best(self.one_law_fewer, -self.demand, model)) is not None:  # no law stays untried
                model = better
        budget, self.fitter.budget = self.fitter.budget, math.inf  # what is still to be told of the model kept takes a few more
        self._note_ranking()
        model = self.fitter.sharpened(model)
        for name in sorted(model.names):
            for neighbour in self._in_other_forms(model, name):
                model = self._fitted(neighbour, model)
        self.path[-1] = replace(self.path[-1], model=model)
        if noise_too_large(model) and (factor := self.fitter.too_loud(model)) != 1.0:
            self.fitter.quieter(factor)
            self._screened.clear()
            self.fitter.budget = budget
            return self.run()
        self.level = self.as_likely(model)
        return self.path

    def _end_early(self) -> None:
        self.fitter.budget = math.inf
        said = f"the search was ended after {self.fitter.fits} fits: another effect may do as well or better"
        warnings.warn(said, stacklevel=3)

    def better_neighbour(self, model: FittedModel) -> FittedModel | None:
        """The best model one move away, None where no move helps: additions first, then fewer laws, then other ones, then another
        model and one law, then two other laws at once."""
        for move, least in (
            (self.more_laws, self.demand), (self.one_law_fewer, -self.demand), (self.another_law, self.demand),
            (self.rivals_and_one, self.demand), (self.two_other_laws, self.demand),
        ):  # fmt: skip
            if (found := self._best(move, least, model)) is not None:
                return found
        return None

    def _best(self, move: Callable[[FittedModel], Iterator[Neighbour]], least: float, model: FittedModel) -> FittedModel | None:
        """The best model that a kind of move leads to, if it has more evidence than ``least`` and is clear: the move is made."""
        found: FittedModel | None = None
        for neighbour in move(model):
            fitted = self._fitted(neighbour, model)
            found = fitted if found is None else self.likelier(model, found, fitted)
        if found is None or not self.evidence(model, found) > least or not self.is_clear(model, found):
            return None
        self._step(model, found)
        return found

    def is_clear(self, model: FittedModel, found: FittedModel) -> bool:
        """Whether a model with as many laws or more leaves noise, or takes a clear share of what the one before left: laws that
        take little and leave much stand in for something else."""
        fewer = len(found.names) < len(model.names)
        return fewer or leaves_noise(found) or model.criterion - found.criterion > CLEAR_SHARE * model.rest

    def _fitted(self, neighbour: Neighbour, model: FittedModel) -> FittedModel:
        near = neighbour.near
        return self.fitter.fit_model(
            neighbour.effects, near or model, neighbour.joint, again=near is not None, begun=neighbour.begun
        )

    @property
    def demand(self) -> float:
        """Fall of the criterion that a move must bring: as many laws as there are had their chance to fool it."""
        return demanded(self.fitter)

    def evidence(self, model: FittedModel, other: FittedModel) -> float:
        """Evidence for ``other``: fall of the criterion, divided where what remains is larger than noise or correlated.

        Where dry friction is in either, none has ties tighter than those up to which a fit with dry friction is sure to arrive.
        """
        most = SHARP if self.slides(model, other) else TIGHTEST
        fall = model.criterion_at(min(model.tie, most)) - other.criterion_at(min(other.tie, most))
        return fall / other.deflation

    def likelier(self, model: FittedModel, found: FittedModel, other: FittedModel) -> FittedModel:
        """The likelier of two neighbours of a model."""
        close = abs(self.evidence(found, other)) < SCATTER < self.evidence(model, other) + 2.0 * SCATTER
        ahead, behind = (other, found) if self.evidence(found, other) > 0.0 else (found, other)
        if close and self.slides(found, other):
            # Corners of dry friction scatter where fits end: the one behind is begun once more from where the other one ended,
            # and that one from there if it has fallen behind.
            behind = self.fitter.fit_model(self.fitter.effects(behind), ahead, again=True)
            if self.evidence(ahead, behind) > 0.0:
                ahead = self.fitter.fit_model(self.fitter.effects(ahead), behind, again=True)
        return behind if self.evidence(ahead, behind) > 0.0 else ahead

    def slides(self, *models: FittedModel) -> bool:
        """Whether dry friction is in any of some models."""
        return any(self.fitter.laws[n].slides for model in models for n in model.names)

    def more_laws(self, model: FittedModel) -> Iterator[Neighbour]:
        """The model with laws that promise more together than any alone, and with each of the most promising absent ones."""
        if len(model.names) >= MOST_LAWS:
            return
        screened, enough = self.screened(model), 0.0
        chosen, promised = self._together(model, screened)
        if chosen:
            yield (neighbour := with_laws(self.fitter, model, chosen))
            if leaves_noise(self.fitter.fitted[neighbour.names]):
                enough = promised
        yield from self._with_each(model, screened, enough=enough)

    def _together(self, model: FittedModel, screened: list[Candidate]) -> tuple[list[Candidate], float]:
        """The laws that promise more together than any of them alone, and what, if there are such: a small one may show beside
        another."""
        among = [c for c in screened if c.name in self.fitter.static and net_gain(c, self.fitter) > self.demand]
        if len(among) < 2 or self.fitter.grips(model.names):
            return [], 0.0
        chosen, promised = stepwise_selection(self.fitter, model, among)
        return (chosen, promised) if len(chosen) <= MOST_LAWS - len(model.names) else ([], 0.0)

    def one_law_fewer(self, model: FittedModel) -> Iterator[Neighbour]:
        """The model without each of its laws, and with the simpler ones that they contain in their place."""
        for name in sorted(model.names):
            yield from with_simpler_law(self.fitter, model, name)
        for name in sorted(model.names):
            yield without_law(self.fitter, model, name)

    def another_law(self, model: FittedModel) -> Iterator[Neighbour]:
        """The model with each of its laws replaced by the most promising others, and by all promising ones related to it."""
        for name in sorted(model.names):
            # Fitted when it was looked at whether fewer laws do.
            without = self.fitter.fitted[model.names - {name}]
            screened = self.screened(without)
            enough = max((net_gain(c, self.fitter) for c in screened if c.name == name), default=0.0)
            others = self._with_each(without, screened, self._related(name), enough if leaves_noise(model) else 0.0)
            yield from (with_others_of(self.fitter, model, n) for n in others if n.names != model.names)

    def rivals_and_one(self, model: FittedModel) -> Iterator[Neighbour]:
        """The best other models whose misfit noise may be, each with the law that promises most beside it, if that makes it
        likelier than the model kept: the search came past them where another law promised a little more."""
        others = [m for m in self.fitter.fitted.values() if m.misfit < most_of_noise(m) and len(m.names) < MOST_LAWS]
        others = [m for m in others if not (m.names <= model.names or m.names >= model.names)]
        for rival in sorted(others, key=lambda m: m.criterion)[:MOST_FITTED]:
            best = next(iter(self.screened(rival)), None)
            if best is None or net_gain(best, self.fitter) < self.demand - self.evidence(model, rival):
                continue
            neighbour = with_law(self.fitter, rival, best)
            yield neighbour if neighbour.near is not None else replace(neighbour, joint=neighbour.joint or rival.system)

    def two_other_laws(self, model: FittedModel) -> Iterator[Neighbour]:
        """The model with two of its laws replaced at once, where it was found that the record cannot tell either replacement from
        the law that it replaces."""
        for one, other in itertools.combinations(self.as_likely(model).values(), 2):
            gone = model.names - one.names, model.names - other.names
            came = one.names - model.names, other.names - model.names
            if all((*gone, *came)) and not gone[0] & gone[1] and not came[0] & came[1]:
                effects = self.fitter.effects(one) | self.fitter.effects(other) | self.fitter.effects(model)
                yield Neighbour({n: effects[n] for n in model.names - gone[0] - gone[1] | came[0] | came[1]})

    def _in_other_forms(self, model: FittedModel, name: str) -> Iterator[Neighbour]:
        """A fitted model with one of its laws in each of its other forms, unless that was looked at."""
        if (name, model.names, model.criterion) not in self._formed:
            yield from in_other_forms(self.fitter, model, name)
            self._formed.add((name, model.names, self.fitter.fitted[model.names].criterion))

    def _with_each(
        self, model: FittedModel, candidates: list[Candidate], related: frozenset[str] = frozenset(), enough: float = 0.0
    ) -> Iterator[Neighbour]:
        """The model with each of the most promising candidates in turn, and with all that were fitted before; of each family with
        one candidate, and with all that are ``related``.

        One that promises clearly less than one that leaves nothing is not fitted, unless it is related to it: a linear promise
        hardly tells such apart. That one may be known, and ``enough`` what it promised.
        """
        beside = {c.name: with_law(self.fitter, model, c) for c in candidates}
        yield from (n for n in beside.values() if n.names in self.fitter.fitted)
        for candidate in self._promising(model, candidates, beside, related):
            if enough > 0.0 and net_gain(candidate, self.fitter) < CLOSE * enough and candidate.name not in related:
                continue
            yield beside[candidate.name]
            fitted = self.fitter.fitted[beside[candidate.name].names]
            yield from self._in_other_forms(fitted, candidate.name)
            fitted = self.fitter.fitted[fitted.names]
            if leaves_noise(fitted) and self.evidence(model, fitted) > self.demand:
                enough = max(enough, net_gain(candidate, self.fitter))

    def screened(self, model: FittedModel) -> list[Candidate]:
        """`screen`, once for each fit."""
        key = model.names, model.criterion
        if key not in self._screened:
            self._screened[key] = screen(self.fitter, model)
        return self._screened[key]

    def as_likely(self, model: FittedModel) -> dict[tuple[str, ...], FittedModel]:
        """Other models that the record cannot tell from the one kept, by their laws; none where that leaves something."""
        if not leaves_noise(model):
            return {}
        others = [m for m in self.fitter.fitted.values() if m.names != model.names and leaves_noise(m)]
        return {tuple(sorted(m.names)): m for m in others if self.evidence(model, m) > -self.demand}

    def _promising(
        self, model: FittedModel, candidates: list[Candidate], beside: dict[str, Neighbour], related: frozenset[str]
    ) -> list[Candidate]:
        """Candidates not fitted yet that promise a share of what the best does; what has not kept its promise is left out."""
        known = {c.name: self.fitter.fitted.get(beside[c.name].names) for c in candidates}
        asked = [c for c in candidates if (m := known[c.name]) is None or self.evidence(model, m) > self.demand]
        least = max(self.demand, PROMISING * max((net_gain(c, self.fitter) for c in asked), default=0.0))
        untried = [c for c in asked if known[c.name] is None]
        new = [c for c in untried if net_gain(c, self.fitter) >= least]
        # A law that rings moves the resonance by more than a linear promise tells: where nothing else promises anything, it is
        # fitted as soon as what it promises is no accident.
        new = new or [c for c in untried if c.effect.rings and c.gain > SURE**2]
        # Of laws that records often cannot tell apart the most promising goes first.
        first = {self._family(c.name): c for c in reversed(new)}
        kept = [c for c in new if c.name in related or first[self._family(c.name)] is c]
        return kept[:MOST_FITTED]

    def _related(self, name: str) -> frozenset[str]:
        """Laws of the same family, and those that contain this one."""
        laws = self.fitter.laws
        return frozenset(n for n in laws if self._family(n) == self._family(name) or name in self.fitter.contained(n))

    def _family(self, name: str) -> str:
        return self.fitter.laws[name].family or name

    def _step(self, model: FittedModel, found: FittedModel) -> None:
        """Note a move; of several laws that came together, one after another, the one first that explains more without them."""
        self._note_ranking()
        self.progress(f"{' + '.join(sorted(found.names)) or 'the joint alone'} explains more", 0.5)
        budget, self.fitter.budget = self.fitter.budget, math.inf  # what has been found is told whole
        while len(new := sorted(found.names - model.names)) > 1:
            effects = self.fitter.effects(found)
            kept = {n: e for n, e in self.fitter.effects(model).items() if n in found.names}
            near = found if model.names - found.names else model
            beside = [self.fitter.fit_model({**kept, name: effects[name]}, near) for name in new]
            best = min(range(len(new)), key=lambda k: beside[k].criterion)
            self.path.append(SearchStep(beside[best], new[best], tuple(sorted(model.names - found.names)), ()))
            model = beside[best]
        self.fitter.budget = budget
        gone = tuple(sorted(model.names - found.names))
        self.path.append(SearchStep(found, new[0] if new else None, gone, ()))

    def _note_ranking(self) -> None:
        """Write into the last step what its model was found to lack, and what the fits of that said."""
        last = self.path[-1]
        model = last.model
        ranking = tuple(self._screened.get((model.names, model.criterion), ()))
        fitted = {n: self.fitter.fitted.get(model.names | {n}) for n in (c.name for c in ranking)}
        tried = {n: m for n, m in fitted.items() if m is not None}
        evidence = {n: self.evidence(model, m) for n, m in tried.items()}
        refits = {n: share_of_rest(model, model.rest - m.rest) for n, m in tried.items()}
        self.path[-1] = SearchStep(model, last.added, last.dropped, ranking, evidence, refits)
