"""Moves from one model to its neighbours in the graph of models: add a law, drop one, put another in its place.

The graph follows from what laws declare about themselves: friction in the joint is one law at a time, and a law that contains a
simpler one takes its place. `evidence_search` says which moves are tried; `model_fitter` fits the models.
"""

from __future__ import annotations

from collections.abc import Iterable

from ..mechanics import AbstractEffect, canonical_name
from ..parameters import with_values
from .candidates import Candidate, rubs
from .fitted_model import FittedModel
from .model_fitter import ModelFitter


def give_way(fitter: ModelFitter, model: FittedModel, name: str) -> frozenset[str]:
    """Laws of a model in whose place a law comes: simpler ones that it contains, and friction in the joint if it is such."""
    laws = fitter.laws
    contained = set(fitter.contained(name)) & model.names
    rubbing = {n for n in model.names if rubs(laws[n])} if rubs(laws[name]) else set()
    return frozenset(contained | rubbing)


def add(fitter: ModelFitter, model: FittedModel, candidate: Candidate) -> FittedModel:
    """The model with one more law, from its predicted values; fitted once for each set of laws."""
    gone = give_way(fitter, model, candidate.name)
    effects = {n: e for n, e in fitter.effects(model).items() if n not in gone} | {candidate.name: candidate.effect}
    # A law that remembers was tuned together with the model's own parameters.
    joint = with_values(model.system, candidate.moved) if candidate.effect.states else model.system
    known = added(fitter, model, candidate)
    return known or in_other_forms(fitter, fitter.fit_model(effects, model, joint), [candidate.name])


def in_other_forms(fitter: ModelFitter, model: FittedModel, names: Iterable[str]) -> FittedModel:
    """The best of a model and of what it is with some of its laws in their other forms, one at a time: the same laws by name."""
    for name in names:
        for form in fitter.effects(model)[name].forms():
            model = fitter.fit_model({**fitter.effects(model), name: form}, model)
    return model


def added(fitter: ModelFitter, model: FittedModel, candidate: Candidate) -> FittedModel | None:
    """The model with one more law, if that has been fitted."""
    return fitter.fitted.get(model.names - give_way(fitter, model, candidate.name) | {candidate.name})


def drop(fitter: ModelFitter, model: FittedModel, name: str) -> FittedModel:
    """The model without one of its laws; fitted once for each set of laws."""
    effects = {n: e for n, e in fitter.effects(model).items() if n != name}
    return _known(fitter, effects) or fitter.fit_model(effects, model)


def simpler_instead(fitter: ModelFitter, model: FittedModel, name: str) -> list[FittedModel]:
    """The model with each simpler law that one of its laws contains or comes near to in that one's place, where it may act."""
    found = []
    for law in fitter.effects(model)[name].simpler():
        simpler = canonical_name(type(law))
        if simpler in fitter.laws and simpler not in model.names:
            effects = {n: e for n, e in fitter.effects(model).items() if n != name} | {simpler: law}
            found.append(_known(fitter, effects) or fitter.fit_model(effects, model))
    return found


def _known(fitter: ModelFitter, effects: dict[str, AbstractEffect]) -> FittedModel | None:
    return fitter.fitted.get(frozenset(effects))
