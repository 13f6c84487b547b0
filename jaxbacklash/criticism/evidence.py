"""What counts as evidence: for an effect, for a model, for there being nothing left to find."""

from __future__ import annotations

import math

import numpy as np

from ..fitting.estimates import MOST_UNCERTAIN
from ..mechanics import AbstractEffect
from ..parameters import Spec, specs, values
from .workbench import Trial, Workbench, strengths

NOISE_FLOOR = 1.03
"""Root of the reduced chi-square up to which what is left counts as noise, since the noise itself is estimated."""
AS_WELL = 0.98
"""Share of the best candidate's gain that counts as doing as well: then the simpler law is taken."""
SURE = 4.0
"""A gain of so many times what is demanded is no accident: a fit that does not show it has stuck, an effect that has it acts."""
NEAR_NOISE, SIGMAS, CHANCE = 1.01, 3.0, 2.0
"""Root of the reduced chi-square up to which what is left counts as noise, since the noise itself is estimated; how many standard
deviations of that root may come on top for a verdict (in 80 records of right models it did not exceed 1.013); and how many as
long as there is more to add, when a small misfit that something else makes is still to be told from chance."""
LITTLE, MUCH, MOST = 0.1, 0.25, 0.5
"""Share of the excess that an addition must take away where a rest stays unexplained: at least; as long as laws with
internal states have not been tried; and if it is an effect of the measuring chain."""


def demanded(bench: Workbench) -> float:
    """The fall of the criterion that an addition must bring: as many candidates as there are had their chance to fool us."""
    return 2.0 * float(np.log(max(len(bench.laws), 2)))


def gain(before: Trial, after: Trial) -> float:
    """Evidence for ``after``: fall of the criterion, scaled down where what remains is larger than noise or correlated."""
    return (before.criterion - after.criterion) / (max(1.0, after.misfit**2) * after.correlation)


def explained(trial: Trial) -> bool:
    """Whether a model leaves nothing but noise, as far as the noise is known."""
    return trial.misfit < NOISE_FLOOR


def noise_too_large(trial: Trial) -> bool:
    """Whether a model in one piece leaves less than the noise was taken for, which then may be wrong, as where corners were
    taken for noise. By how much, if so, `jaxbacklash.fitting.left_over.quieter` tells."""
    return trial.tied and trial.misfit < 1.0


def excess(trial: Trial) -> float:
    """By how much the reduced chi-square exceeds that of noise."""
    return max(trial.misfit**2 - 1.0, 0.0)


def most_of_noise(trial: Trial, sigmas: float = SIGMAS) -> float:
    r"""The largest root of the reduced chi-square that noise may leave: its standard deviation is :math:`1/\sqrt{2\nu}`, with
    :math:`\nu` degrees of freedom."""
    freedom = 2.0 * trial.cost / trial.misfit**2
    return NEAR_NOISE + sigmas / math.sqrt(2.0 * max(freedom, 1.0))


def leaves_a_rest(trial: Trial) -> bool:
    """Whether a model leaves clearly more than noise."""
    return trial.misfit > most_of_noise(trial, CHANCE)


def measures_only(law: type[AbstractEffect]) -> bool:
    """True for what happens in the measuring chain, which exerts no torque and leaves the play alone."""
    return law.torque is AbstractEffect.torque and law.reshape is AbstractEffect.reshape


def standard_errors(trial: Trial) -> np.ndarray:
    """Of all columns, those that only pad included; wider where a rest remains that is no noise."""
    size = np.sqrt(np.maximum(np.diag(trial.schur), 1e-300))
    # What only a sum determines must come out uncertain, not as a pseudo-inverse has it.
    inverse = np.linalg.inv(trial.schur / np.outer(size, size) + 1e-12 * np.eye(size.size))
    errors = np.sqrt(np.maximum(np.diag(inverse), 1e-300)) / size * trial.scales
    return np.asarray(errors * np.sqrt(max(1.0, trial.misfit**2) * trial.correlation))


def shapeless(trial: Trial, name: str, slowest: float = 0.0) -> bool:
    """Whether a shape of an effect is not determined: at its bound, uncertain by more than half of its value, or a speed below
    the ``slowest`` [rad/s] that the record tells from rest.

    What such a law adds to a simpler one that it contains acts where the record shows nothing. Near rest it acts on the noise: a
    link that sticks tightly lets the base motion follow its own noise more freely, which looks like evidence.
    """
    errors, found = standard_errors(trial), values(trial.system.effects[name])
    return at_a_bound(trial, name) or any(
        (s.unit == "rad/s" and found[n] < slowest) or errors[trial.free.index(f"{name}.{n}")] > MOST_UNCERTAIN * abs(found[n])
        for n, s in _shapes(trial, name).items()
    )


def acts_anyway(bench: Workbench, simpler: Trial, richer: Trial, name: str) -> bool:
    """Whether a law whose shape is not determined explains so much more than one it contains that it is no accident.

    Where the link rests for long no such lead says anything, see `shapeless`.
    """
    return gain(simpler, richer) > SURE * demanded(bench) and not bench.rests(bench.laws[name].port)


def at_a_bound(trial: Trial, name: str) -> bool:
    """Whether a shape of an effect stands at the end of its range, where the law may be another's limit."""
    found = values(trial.system.effects[name])
    return any(_end(found[n], s) is not None for n, s in _shapes(trial, name).items())


def at_a_limit(trial: Trial, name: str) -> bool:
    """Whether a strength of an effect would have to leave the range that physics allows."""
    found, described = values(trial.system.effects[name]), specs(trial.system.effects[name])
    own = [n for n in strengths(trial.system.effects[name]) if f"{name}.{n}" in trial.free]
    return any(_end(found[n], described[n]) not in (None, described[n].null) for n in own)


def _end(value: float, spec: Spec) -> float | None:
    """The end of its range at which a parameter stands; None inside."""
    return next((e for e in (spec.lower, spec.upper) if np.isfinite(e) and abs(value - e) <= 1e-6 * abs(e)), None)


def _shapes(trial: Trial, name: str) -> dict[str, Spec]:
    """The free shape parameters of an effect: those that have no null value."""
    described = specs(trial.system.effects[name])
    return {n: s for n, s in described.items() if s.null is None and not s.fixed and f"{name}.{n}" in trial.free}


def significance(trial: Trial, name: str) -> float:
    """How many standard errors the strongest strength of an effect of the model stands from its null value."""
    errors = standard_errors(trial)
    described = specs(trial.system.effects[name])
    found = [
        abs(trial.value[full] - (described[n].null or 0.0)) / max(errors[trial.free.index(full)], 1e-300)
        for n in strengths(trial.system.effects[name]) if (full := f"{name}.{n}") in trial.free
    ]  # fmt: skip
    return float(max(found, default=0.0))


def claim(trial: Trial, name: str) -> float:
    """What leaving an effect out should cost in units of twice the cost, as far as the fit's own information tells (Wald 1943).

    The strengths go to their null values, the shapes with them; all else moves to make up for it.
    """
    described, effect = specs(trial.system.effects[name]), values(trial.system.effects[name])
    own = [n for n in strengths(trial.system.effects[name]) if f"{name}.{n}" in trial.free]
    away = [trial.free.index(f"{name}.{n}") for n in own]
    rest = [k for k, full in enumerate(trial.free) if full.partition(".")[0] != name]
    step = np.array([effect[n] - (described[n].null or 0.0) for n in own]) / trial.scales[away]
    cross = trial.schur[np.ix_(rest, away)]
    held = trial.schur[np.ix_(away, away)] - cross.T @ np.linalg.pinv(trial.schur[np.ix_(rest, rest)], hermitian=True) @ cross
    return float(step @ held @ step) / (max(1.0, trial.misfit**2) * trial.correlation)


def led_on(bench: Workbench, before: Trial, after: Trial, name: str) -> bool:
    """Whether an effect only led a stuck search on: the fall that it brought is none of its own.

    Dry friction's corners make the cost of one trajectory jagged, and some searches are not at their end: any other direction
    may pass them.
    """
    if not (before.tied and after.tied and after.names == before.names | {name}):
        return False
    stuck = not before.done or any(bench.laws[n].slides for n in before.names)
    return stuck and explained(before) and claim(after, name) < demanded(bench)


def worth(bench: Workbench, before: Trial, after: Trial, name: str) -> float:
    """Evidence for an effect that is added: no more than its own claim where it only led a stuck search on."""
    evidence = gain(before, after)
    return min(evidence, claim(after, name)) if led_on(bench, before, after, name) else evidence
