"""Moves from one model to its neighbours in the graph of models: add a law, drop one, put another in its place.

The graph follows from what laws declare about themselves: friction in the joint is one law at a time, and a law that contains a
simpler one takes its place. `evidence_search` says which moves are tried; `model_fitter` fits the models.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..mechanics import AbstractEffect, canonical_name
from ..parameters import with_values
from ..system import System
from .candidates import Candidate, form_gain, rubs
from .fitted_model import FittedModel
from .model_fitter import ModelFitter


@dataclass(frozen=True)
class Neighbour:
    """A model one move away from another, not yet fitted.

    ``effects`` by canonical name, at the values to start from; ``joint``, a system with the joint's values to start from, None
    for those of the model that it is a neighbour of; ``near``, another fitted model of the same laws to start from, which is kept
    where it is the better one; ``begun`` how far states of laws that ring are from rest at the first sample.
    """

    effects: dict[str, AbstractEffect]
    joint: System | None = None
    near: FittedModel | None = None
    begun: dict[str, np.ndarray] = field(default_factory=dict)

    @property
    def names(self) -> frozenset[str]:
        """The names of its laws."""
        return frozenset(self.effects)


def give_way(fitter: ModelFitter, model: FittedModel, name: str) -> frozenset[str]:
    """Laws of a model in whose place a law comes: simpler ones that it contains, and friction in the joint if it is such."""
    laws = fitter.laws
    contained = set(fitter.contained(name)) & model.names
    rubbing = {n for n in model.names if rubs(laws[n])} if rubs(laws[name]) else set()
    return frozenset(contained | rubbing)


def with_law(fitter: ModelFitter, model: FittedModel, candidate: Candidate) -> Neighbour:
    """The model with one more law, from its predicted values."""
    gone = give_way(fitter, model, candidate.name)
    effects = {n: e for n, e in fitter.effects(model).items() if n not in gone} | {candidate.name: candidate.effect}
    # A law that remembers was tuned together with the model's own parameters.
    joint = with_values(model.system, candidate.moved) if candidate.effect.states else None
    return Neighbour(effects, joint, begun={} if candidate.begun is None else {candidate.name: candidate.begun})


def with_laws(fitter: ModelFitter, model: FittedModel, candidates: Sequence[Candidate]) -> Neighbour:
    """The model with several more laws that remember nothing, from their values beside one another."""
    gone = frozenset().union(*(give_way(fitter, model, c.name) for c in candidates))
    kept = {n: e for n, e in fitter.effects(model).items() if n not in gone}
    return Neighbour(kept | {c.name: c.effect for c in candidates})


def with_others_of(fitter: ModelFitter, model: FittedModel, neighbour: Neighbour) -> Neighbour:
    """A neighbour whose laws that are the model's too start as they are there: what they are without a law that another one takes
    the place of may be far off."""
    if neighbour.near is not None:
        return neighbour
    return replace(
        neighbour, effects=neighbour.effects | {n: e for n, e in fitter.effects(model).items() if n in neighbour.names}
    )


def in_other_forms(fitter: ModelFitter, model: FittedModel, name: str) -> Iterator[Neighbour]:
    """A fitted model with one of its laws in each of its other forms that may do as well: the same laws by name."""
    for form in fitter.effects(model)[name].forms():
        if not form_gain(fitter, model, name, form) > 0.0:
            continue
        yield Neighbour({**fitter.effects(model), name: form}, near=model)


def without_law(fitter: ModelFitter, model: FittedModel, name: str) -> Neighbour:
    """The model without one of its laws."""
    return Neighbour({n: e for n, e in fitter.effects(model).items() if n != name})


def with_simpler_law(fitter: ModelFitter, model: FittedModel, name: str) -> Iterator[Neighbour]:
    """The model with each simpler law that one of its laws contains or comes near to in that one's place, where it may act."""
    for law in fitter.effects(model)[name].simpler():
        simpler = canonical_name(type(law))
        if simpler in fitter.laws and simpler not in model.names:
            yield Neighbour({n: e for n, e in fitter.effects(model).items() if n != name} | {simpler: law})
