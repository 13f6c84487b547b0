r"""Which absent effects would lower the misfit: a score test of all of them at their null values, from one set of sensitivities.

With the information S and the score g of all columns, the joint's and the candidate's, windows marginalised, adding the
candidate is predicted to lower twice the cost by :math:`g^T S^{-1} g` more than the joint alone would. Parameters that
shape a law but do not act at its null value are scanned over the law's own guesses; strengths that physics bounds on one
side count on that side only. The same sensitivities tell which laws promise more together than any does alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ..fitting.continuation import tied
from ..fitting.settings import MEASURING, PROMISING
from ..fitting.stick_slip import sticks_and_slips
from ..mechanics import AbstractEffect
from ..parameters import free_specs, specs, with_values
from ..regression.spectrum import lines, read_off
from ..shooting.problem import Problem, Unknowns
from ..shooting.score_columns import TOGETHER, information_beside, torque_scores
from .evidence import measures_only
from .fitted_model import FittedModel
from .model_builder import ModelBuilder, strengths, width
from .perturbed import as_it_ended, panel_edges


@dataclass(frozen=True)
class Candidate:
    """An absent effect: ``effect`` at its predicted values, ``gain`` the predicted fall of twice the cost, ``share`` of what the
    model leaves that this takes away, 0 to 1, ``moved`` predicted values of the model's free parameters, ``begun`` (S,) how far
    its states are from rest at the first sample, for a law that rings."""

    name: str
    effect: AbstractEffect
    gain: float
    share: float
    moved: dict[str, float]
    begun: np.ndarray | None = None

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
    found: dict[str, Candidate] = {}
    shapes = [(n, effect) for n in names for effect in shaped(builder, model, n)]
    each = float(np.log(builder.record.samples))
    for group in _groups(model, shapes):
        score = _Score(builder, model, group)
        for one in (score.promise([name])[0] for name in group):
            known = found.get(one.name)
            if known is None or one.gain - each * one.parameters > known.gain - each * known.parameters:
                found[one.name] = one
    return list(found.values())


def share_of_rest(model: FittedModel, gain: float) -> float:
    """Share of what a model leaves that a predicted fall of twice the cost takes away, 0 to 1."""
    return float(np.clip(gain / max(model.rest, 1e-300), 0.0, 1.0))


def rubs(law: type[AbstractEffect]) -> bool:
    """Whether a law is friction in the joint, dry or one that gives."""
    return bool((law.states and law.family) or (law.slides and law.port == "joint" and not law.beside))


def shaped(builder: ModelBuilder, model: FittedModel, name: str) -> list[AbstractEffect]:
    """The law at its null strength, at the likeliest of the shapes it may have; at a phase that most rigs have too."""
    law, form = builder.laws[name], builder.form_of(name)
    if law.wave is not None and law.wave.over == "t" and (sine := likeliest_sine(builder, model)) is not None:
        return [null(law(**{law.wave.phase: sine.phase, str(law.wave.frequency): sine.frequency}))]
    if law.wave is None or law.wave.over == "t" or form.blind:
        guesses = law.guesses(model.system, form.motion)
        return [null(form.choose(model.system, model.free, guesses)[0])]
    found = read_off(form, model.system, model.free, law)
    usual = specs(found)[law.wave.phase].usual is not None
    return [null(law()), null(found)] if usual else [null(found)]


@dataclass(frozen=True)
class Sine:
    """A torque A sin(omega t + phi) on the link: ``amplitude`` [N m], angular ``frequency`` [rad/s], ``phase`` [rad]; ``gain``,
    the fall of twice the cost that it promises, and how many frequencies were ``tried``."""

    amplitude: float
    frequency: float
    phase: float
    gain: float
    tried: int


def likeliest_sine(builder: ModelBuilder, model: FittedModel) -> Sine | None:
    """The sine over time that a fitted model asks for most: of the highest lines in the scores of a torque along its trajectory
    the one with the highest score test; None where nothing stands out, or where dry friction holds a link that is not seen."""
    problem, unknowns = as_it_ended(builder, model)
    if sticks_and_slips(problem.system):
        return None
    times, scores = torque_scores(problem, unknowns)
    found = lines(times, scores, TOGETHER // 2) if np.all(np.isfinite(scores)) else []
    if not found:
        return None
    edges = panel_edges(builder)
    torques = np.stack([wave(omega * edges) for omega in found for wave in (np.sin, np.cos)])
    sizes, gains = zip(*column_gains(problem, unknowns, len(model.free), torques, each=2))
    best = int(np.argmax(gains))
    (sine, cosine), omega = sizes[best], found[best]
    return Sine(float(np.hypot(sine, cosine)), omega, float(np.arctan2(cosine, sine)), gains[best], scores.size)


def column_gains(
    problem: Problem, unknowns: Unknowns, own: int, torques: np.ndarray, shown: np.ndarray | None = None, each: int = 1
) -> list[tuple[np.ndarray, float]]:
    """What torques on the link bring beside a problem's ``own`` parameters, by the score test of ``each`` so many together.

    Parameters
    ----------
    problem, unknowns : where a fit ended
    own : its free parameters, the first ones
    torques : (K, W, P + 1) at panel edges [N m]
    shown : (K, W, M C) what the measured channels show more with each; default nothing

    Returns
    -------
    list of (each,) and float
        Their sizes, and the fall of twice the cost that they promise together.
    """
    shown = np.zeros((len(torques), *np.shape(problem.windows.measured))) if shown is None else shown
    found, step = [], TOGETHER // each * each
    for part in (slice(begin, begin + step) for begin in range(0, len(torques), step)):
        information, score = information_beside(problem, unknowns, torques[part], shown[part])
        for column in range(len(score) - len(torques[part]), len(score), each):
            index = [*range(own), *range(column, column + each)]
            sizes, gain = predicted_gain(information[np.ix_(index, index)], score[index], own)
            found.append((sizes[own:], gain))
    return found


def null(effect: AbstractEffect) -> AbstractEffect:
    """The law at its null strength, its shape as it is."""
    described = specs(effect)
    return with_values(effect, {n: float(described[n].null or 0.0) for n in strengths(effect)})


def _groups(model: FittedModel, shapes: list[tuple[str, AbstractEffect]]) -> list[dict[str, AbstractEffect]]:
    """The candidates in groups that fit beside the model's own parameters into one set of columns, one shape of a law in each."""
    room = _room(model, shapes)
    groups: list[dict[str, AbstractEffect]] = []
    for name, effect in shapes:
        taken = [sum(len(strengths(e)) for e in group.values()) for group in groups]
        free = (g for g, t in zip(groups, taken) if name not in g and t + len(strengths(effect)) <= room)
        group = next(free, None)
        if group is None:
            groups.append(group := {})
        group[name] = effect
    return groups


def stepwise_selection(
    builder: ModelBuilder, model: FittedModel, candidates: Sequence[Candidate]
) -> tuple[list[Candidate], float]:
    """Candidates that promise more together than any does alone, by the score test of several at once: chosen one after another,
    then those left out again that the others make up for (Efroymson 1960).

    Parameters
    ----------
    builder : of the record
    model : a fitted model
    candidates : laws without internal states from `score_test`, the most promising first; friction in the joint and a family
        are chosen once

    Returns
    -------
    list of Candidate, float
        At least two, each at its values beside the others, and the fall of the criterion that they promise together; none where
        no second one brings `PROMISING` of what the first does.
    """
    room = _room(model, [(c.name, null(c.effect)) for c in candidates])
    shapes: dict[str, AbstractEffect] = {}
    for one in candidates:
        if sum(len(strengths(e)) for e in (*shapes.values(), one.effect)) <= room:
            shapes[one.name] = null(one.effect)
    score, laws = _Score(builder, model, shapes), builder.laws
    each = {c.name: float(np.log(builder.record.samples)) * c.parameters for c in candidates}
    each = {n: cost + MEASURING * measures_only(laws[n]) for n, cost in each.items()}  # as in the criterion

    def net(names: list[str]) -> float:
        return (score.promise(names)[0].gain - sum(each[n] for n in names)) if names else 0.0

    chosen: list[str] = []
    least = 0.0
    while left := [n for n in shapes if n not in chosen and not any(_exclude(laws[n], laws[c]) for c in chosen)]:
        brings = {n: net([*chosen, n]) - net(chosen) for n in left}
        best = max(left, key=lambda n: brings[n])
        if brings[best] <= least:
            break
        chosen.append(best)
        least = max(least, PROMISING * net(chosen[:1]))
    while len(chosen) > 1:
        costs = {n: net(chosen) - net([c for c in chosen if c != n]) for n in chosen}
        least_needed = min(chosen, key=lambda n: costs[n])
        if costs[least_needed] > least:
            return score.promise(chosen), net(chosen)
        chosen.remove(least_needed)
    return [], 0.0


def form_gain(builder: ModelBuilder, model: FittedModel, name: str, form: AbstractEffect) -> float:
    """The fall of the criterion that another form of one of a model's laws promises by the parameters that it frees, by their
    score test where the law holds them; infinite of a form that frees none, which only a fit can tell."""
    law = model.system.effects[name]
    freed = [n for n in free_specs(form) if n not in free_specs(law)]
    if not freed:
        return np.inf
    problem, _ = builder.problem(builder.effects(model), model.system, extra=[f"{name}.{n}" for n in freed])
    information, score, _ = builder.sensitivities(tied(problem, model.tie), model.unknowns)
    q = len(model.free)
    gain = predicted_gain(information[: q + len(freed), : q + len(freed)], score[: q + len(freed)], q)[1]
    return gain / model.deflation - len(freed) * float(np.log(builder.record.samples))


def _exclude(law: type[AbstractEffect], other: type[AbstractEffect]) -> bool:
    """Whether a model holds one of two laws at a time."""
    return (rubs(law) and rubs(other)) or (bool(law.family) and law.family == other.family)


def _room(model: FittedModel, shapes: list[tuple[str, AbstractEffect]]) -> int:
    """How many columns of candidates fit beside the model's own parameters into one set."""
    return width(len(model.free) + max((len(strengths(e)) for _, e in shapes), default=0)) - len(model.free)


class _Score:
    """The score test of some candidates at these shapes, from one set of sensitivities."""

    def __init__(self, builder: ModelBuilder, model: FittedModel, shapes: dict[str, AbstractEffect]) -> None:
        self.model, self.shapes = model, shapes
        self.columns = [(name, n) for name, effect in shapes.items() for n in strengths(effect)]
        problem, _ = builder.problem(
            builder.effects(model), model.system, extra=[f"{name}.{n}" for name, n in self.columns], shapes=shapes
        )
        self.told = builder.sensitivities(tied(problem, model.tie), model.unknowns)

    def promise(self, names: Sequence[str]) -> list[Candidate]:
        """Candidates at their values beside one another, each with the gain of all of them together."""
        information, score, scales = self.told
        q, present = len(self.model.free), self.model.value
        index = [*range(q), *(q + j for j, (other, _) in enumerate(self.columns) if other in names)]
        step, gain = predicted_gain(information[np.ix_(index, index)], score[index], q)
        step = step * scales[index]
        own = dict(zip([column for column in self.columns if column[0] in names], step[q:]))
        joint = {n: present[n] + float(size) for n, size in zip(self.model.free, step)}
        effects = []
        for name in names:
            described = specs(self.shapes[name])
            moved = {n: described[n].null + own[name, n] for n in strengths(self.shapes[name])}
            if not all(described[n].lower <= v <= described[n].upper for n, v in moved.items()):
                moved = {n: float(np.clip(v, described[n].lower, described[n].upper)) for n, v in moved.items()}
                gain = 0.0
            effects.append(with_values(self.shapes[name], moved))
        share = share_of_rest(self.model, gain)
        return [Candidate(n, e, gain / self.model.deflation, share, joint) for n, e in zip(names, effects)]


def predicted_gain(information: np.ndarray, score: np.ndarray, q: int) -> tuple[np.ndarray, float]:
    """Step of all columns, and the fall of twice the cost beyond what the first ``q`` bring by themselves."""
    if not (np.all(np.isfinite(information)) and np.all(np.isfinite(score))):
        return np.zeros(score.size), 0.0  # a trajectory that runs away with it promises nothing
    scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
    scaled, score = information / np.outer(scale, scale), score / scale
    step = np.linalg.pinv(scaled, rcond=1e-10, hermitian=True) @ score
    without = np.linalg.pinv(scaled[:q, :q], rcond=1e-10, hermitian=True) @ score[:q]
    return step / scale, max(float(score @ step - score[:q] @ without), 0.0)  # below zero by rounding alone
