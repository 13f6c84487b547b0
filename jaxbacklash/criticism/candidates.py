r"""Which absent effects would lower the misfit: a score test of all of them at their null values, from one set of sensitivities.

With the information S and the score g of all columns, the joint's and the candidate's, windows marginalised, adding the
candidate is predicted to lower twice the cost by :math:`g^T S^{-1} g` more than the joint alone would. Parameters that
shape a law but do not act at its null value are scanned over the law's own guesses; strengths that physics bounds on one
side count on that side only.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..fitting.continuation import tied
from ..mechanics import AbstractEffect
from ..parameters import free_specs, specs, with_values
from ..regression.spectrum import read_off
from .fitted_model import FittedModel
from .model_builder import ModelBuilder, strengths, width


@dataclass(frozen=True)
class Candidate:
    """An absent effect: ``effect`` at its predicted values, ``gain`` the predicted fall of twice the cost, ``share`` of what the
    model leaves that this takes away, 0 to 1, ``moved`` predicted values of the model's free parameters."""

    name: str
    effect: AbstractEffect
    gain: float
    share: float
    moved: dict[str, float]

    @property
    def parameters(self) -> int:
        """How many of its parameters are free."""
        return len(free_specs(self.effect))


def score_test(builder: ModelBuilder, model: FittedModel, names: Iterable[str]) -> list[Candidate]:
    """Absent effects judged with the ties at which a model was fitted, in the order of ``names``.

    Parameters
    ----------
    builder : of the record
    model : a fitted model
    names : absent effects without internal states

    Returns
    -------
    list of Candidate
        Their gains are divided by ``model.deflation``.
    """
    shapes = {n: shaped(builder, model, n) for n in names}
    return [c for group in _groups(builder, model, shapes) for c in _score(builder, model, shapes, group)]


def share_of_rest(model: FittedModel, gain: float) -> float:
    """Share of what a model leaves that a predicted fall of twice the cost takes away, 0 to 1."""
    return float(np.clip(gain / max(model.rest, 1e-300), 0.0, 1.0))


def rubs(law: type[AbstractEffect]) -> bool:
    """Whether a law is friction in the joint, dry or one that gives."""
    return bool(law.states and law.family) or (law.slides and law.port == "joint" and not law.beside)


def shaped(builder: ModelBuilder, model: FittedModel, name: str) -> AbstractEffect:
    """The law at its null strength, at the likeliest of the shapes it may have."""
    law, form = builder.laws[name], builder.weak_form
    if law.wave is None or form.blind:
        guesses = law.guesses(model.system, form.motion)
    else:
        guesses = [read_off(form, model.system, model.free, law)]
        if specs(guesses[0])[law.wave.phase].usual is not None:
            guesses = [law(**{law.wave.strength: 1.0}), *guesses]
    return null(builder.weak_form.choose(model.system, model.free, guesses)[0])


def null(effect: AbstractEffect) -> AbstractEffect:
    """The law at its null strength, its shape as it is."""
    described = specs(effect)
    return with_values(effect, {n: float(described[n].null or 0.0) for n in strengths(effect)})


def _groups(builder: ModelBuilder, model: FittedModel, shapes: dict[str, AbstractEffect]) -> list[list[str]]:
    """The candidates in groups that fit beside the model's own parameters into one set of columns."""
    room = width(len(model.free) + max((len(strengths(e)) for e in shapes.values()), default=0)) - len(model.free)
    groups: list[list[str]] = []
    taken = room
    for name, effect in shapes.items():
        columns = len(strengths(effect))
        if taken + columns > room:
            groups.append([])
            taken = 0
        groups[-1].append(name)
        taken += columns
    return groups


def _score(builder: ModelBuilder, model: FittedModel, shapes: dict[str, AbstractEffect], group: list[str]) -> list[Candidate]:
    """Candidates at these shapes from one set of sensitivities."""
    columns = [(name, n) for name in group for n in strengths(shapes[name])]
    problem, _ = builder.problem(
        builder.effects(model), model.system, extra=[f"{name}.{n}" for name, n in columns], shapes=shapes
    )
    information, score, scales = builder.sensitivities(tied(problem, model.tie), model.unknowns)
    q, present = len(model.free), model.value
    found = []
    for name in group:
        index = [*range(q), *(q + j for j, (other, _) in enumerate(columns) if other == name)]
        step, gain = _gain(information[np.ix_(index, index)], score[index], q)
        step = step * scales[index]
        described = specs(shapes[name])
        moved = {n: described[n].null + size for n, size in zip(strengths(shapes[name]), step[q:])}
        if not all(described[n].lower <= v <= described[n].upper for n, v in moved.items()):
            moved = {n: float(np.clip(v, described[n].lower, described[n].upper)) for n, v in moved.items()}
            gain = 0.0
        joint = {n: present[n] + float(size) for n, size in zip(model.free, step)}
        effect = with_values(shapes[name], moved)
        found.append(Candidate(name, effect, gain / model.deflation, share_of_rest(model, gain), joint))
    return found


def _gain(information: np.ndarray, score: np.ndarray, q: int) -> tuple[np.ndarray, float]:
    """Step of all columns, and the fall of twice the cost beyond what the first ``q`` bring by themselves."""
    if not (np.all(np.isfinite(information)) and np.all(np.isfinite(score))):
        return np.zeros(score.size), 0.0  # a trajectory that runs away with it promises nothing
    scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
    scaled, score = information / np.outer(scale, scale), score / scale
    step = np.linalg.pinv(scaled, rcond=1e-10, hermitian=True) @ score
    without = np.linalg.pinv(scaled[:q, :q], rcond=1e-10, hermitian=True) @ score[:q]
    return step / scale, float(score @ step - score[:q] @ without)
