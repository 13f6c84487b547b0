r"""Which absent effects would lower the misfit: a score test of all of them at their null values, from one set of sensitivities.

With the information S and the score g of all columns, the joint's and the candidate's, windows marginalised, adding the
candidate is predicted to lower twice the cost by :math:`g^T S^{-1} g` more than the joint alone would. Parameters that
shape a law but do not act at its null value are scanned over the law's own guesses; strengths that physics bounds on one
side count on that side only.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import equinox as eqx
import numpy as np

from ..fitting.search import TIES
from ..mechanics import AbstractEffect
from ..parameters import free_specs, specs, values, with_values
from .workbench import Trial, Workbench, strengths, width


@dataclass(frozen=True)
class Candidate:
    """An absent effect: ``effect`` at its predicted values, ``gain`` the predicted fall of twice the cost, ``predicted`` the
    misfit after adding it in units of the noise, ``moved`` predicted values of the model's free parameters."""

    name: str
    effect: AbstractEffect
    gain: float
    predicted: float
    moved: dict[str, float]

    @property
    def parameters(self) -> int:
        """How many of its parameters are free."""
        return len(free_specs(self.effect))


def rank(bench: Workbench, trial: Trial, names: Iterable[str] | None = None) -> list[Candidate]:
    """All absent effects, the most telling first.

    Parameters
    ----------
    bench : the compiled models of a record
    trial : a fitted model
    names : the effects to judge; default every absent one without internal states
    """
    absent = [n for n in (bench.static if names is None else names) if n not in trial.names]
    shapes = {n: shaped(bench, trial, n) for n in absent}
    found = [c for group in _groups(bench, trial, shapes) for c in _score(bench, trial, shapes, group)]
    return sorted(found, key=lambda c: -c.gain)


def score_test(
    bench: Workbench, trial: Trial, names: Iterable[str], *, tie: float, deflation: float = 1.0
) -> list[Candidate]:
    """`rank` at the ties with which a model was fitted; gains are divided by ``deflation``."""
    shapes = {n: shaped(bench, trial, n) for n in names}
    found = [c for group in _groups(bench, trial, shapes) for c in _score(bench, trial, shapes, group, tie=tie)]
    return [replace(c, gain=c.gain / deflation) for c in found]


def reshaped(bench: Workbench, trial: Trial, name: str) -> Candidate:
    """A law in place of a simpler one that it contains, at the shape that the trajectory, not the quick look, finds likeliest."""
    guesses = [null(guess) for guess in bench.laws[name].guesses(trial.system, bench.quick.motion)]
    return max((_score(bench, trial, {name: guess}, [name], instead=True)[0] for guess in guesses), key=lambda c: c.gain)


def may_join(bench: Workbench, trial: Trial) -> list[str]:
    """Absent effects without internal states that a search adds: joint friction is one law, a richer one replaces it."""
    rubbing = {n for n in trial.names if rubs(bench.laws[n])}
    absent = [(n, law) for n, law in bench.static.items() if n not in trial.names]
    return [n for n, law in absent if not rubs(law) or rubbing <= set(law.absorbs)]


def rubs(law: type[AbstractEffect]) -> bool:
    """Whether a law is friction in the joint, dry or one that gives."""
    return bool(law.states and law.family) or (law.slides and law.port == "joint")


def shaped(bench: Workbench, trial: Trial, name: str) -> AbstractEffect:
    """The law at its null strength, at the likeliest of the shapes it may have."""
    guesses = bench.laws[name].guesses(trial.system, bench.quick.motion)
    return null(bench.quick.choose(trial.system, trial.free, guesses)[0])


def null(effect: AbstractEffect) -> AbstractEffect:
    """The law at its null strength, its shape as it is."""
    described = specs(effect)
    return with_values(effect, {n: float(described[n].null or 0.0) for n in strengths(effect)})


def contained(bench: Workbench, trial: Trial, law: type[AbstractEffect]) -> dict[str, float]:
    """Strengths, by their parameters, of the simpler laws in a model that a law contains."""
    present = bench.effects(trial)
    return {f"{name}.{n}": values(present[name])[n] for name in law.absorbs if name in present for n in strengths(present[name])}


def _groups(bench: Workbench, trial: Trial, shapes: dict[str, AbstractEffect]) -> list[list[str]]:
    """The candidates in groups that fit beside the model's own parameters into one set of columns."""
    room = width(len(trial.free) + max((len(strengths(e)) for e in shapes.values()), default=0)) - len(trial.free)
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


def _score(
    bench: Workbench, trial: Trial, shapes: dict[str, AbstractEffect], group: list[str], *, instead: bool = False,
    tie: float | None = None,
) -> list[Candidate]:  # fmt: skip
    """Candidates at these shapes from one set of sensitivities, beside a model or ``instead`` of what they contain of it: then
    their strengths are what they add to that."""
    columns = [(name, n) for name in group for n in strengths(shapes[name])]
    problem, _ = bench.problem(
        bench.effects(trial), trial.system, extra=[f"{name}.{n}" for name, n in columns], shapes=shapes
    )
    tie = (TIES[0][-1] if trial.tied else 0.0) if tie is None else tie
    problem = eqx.tree_at(lambda p: p.tie, problem, np.asarray(tie))
    schur, pull, cost, scales = bench.look(problem, trial.unknowns)
    q, present = len(trial.free), trial.value
    found = []
    for name in group:
        held = contained(bench, trial, bench.laws[name]) if instead else {}
        had = max(map(abs, held.values()), default=0.0)
        kept = [i for i, n in enumerate(trial.free) if n not in held]
        own = [q + j for j, (other, _) in enumerate(columns) if other == name]
        index = [*kept, *own]
        step, gain = _gain(schur[np.ix_(index, index)], pull[index], len(kept))
        step = step * scales[index]
        described = specs(shapes[name])
        moved = {n: described[n].null + size for n, size in zip(strengths(shapes[name]), step[len(kept) :])}
        if not all(described[n].lower <= v + had <= described[n].upper for n, v in moved.items()):
            moved = {n: float(np.clip(v, described[n].lower - had, described[n].upper - had)) for n, v in moved.items()}
            gain = 0.0
        left = max(2.0 * cost - gain, 0.0)
        predicted = trial.misfit * np.sqrt(left / max(2.0 * cost, 1e-300))
        joint = {n: present[n] + float(size) for n, size in zip((trial.free[i] for i in kept), step)}
        found.append(Candidate(name, with_values(shapes[name], moved), gain, float(predicted), joint))
    return found


def _gain(schur: np.ndarray, pull: np.ndarray, q: int) -> tuple[np.ndarray, float]:
    if not (np.all(np.isfinite(schur)) and np.all(np.isfinite(pull))):
        return np.zeros(pull.size), 0.0  # a trajectory that runs away with it promises nothing
    scale = np.sqrt(np.maximum(np.diag(schur), 1e-300))
    scaled, score = schur / np.outer(scale, scale), pull / scale
    step = np.linalg.pinv(scaled, rcond=1e-10, hermitian=True) @ score
    without = np.linalg.pinv(scaled[:q, :q], rcond=1e-10, hermitian=True) @ score[:q]
    return step / scale, float(score @ step - score[:q] @ without)
