"""The ranking of absent effects as a person reads it: the error with each added, and how strongly the record speaks for it."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp
import numpy as np

from ..fitting import Fit, Score
from ..fitting.setup import make_problem
from ..frames import dataframe
from ..mechanics import AbstractEffect
from ..parameters import free_specs, specs, values
from ..precision import require_double_precision
from ..shooting.problem import Unknowns
from ..showing import Shown
from ..system import System
from .candidates import Candidate, share_of_rest
from .evidence import correlation_length, gain
from .laws_for import laws_for
from .model_fitter import ModelFitter
from .screening import screen
from .steps import Stage


@dataclass(frozen=True)
class Ranked:
    """An absent effect.

    Attributes: ``name``; ``effect`` at its predicted (if ``refitted``, its ranked) values; ``predicted_rms_over_noise`` the
    prediction error with it by the sensitivities, ``refitted_rms_over_noise`` by a refit, NaN without; ``evidence`` the fall of
    the information criterion, more is better and below 0 speaks against it, found by a refit where ``refitted`` is True and
    predicted otherwise; ``why`` in words; ``moved`` values of the model's own parameters that would go with it.
    """

    name: str
    effect: AbstractEffect
    predicted_rms_over_noise: float
    evidence: float
    refitted: bool
    why: str
    moved: dict[str, float]
    refitted_rms_over_noise: float = float("nan")

    @property
    def rms_over_noise(self) -> float:
        """The prediction error with it, as well as it is known."""
        known = self.refitted_rms_over_noise
        return known if np.isfinite(known) else self.predicted_rms_over_noise

    def __str__(self) -> str:
        known = values(self.effect)
        told = [f"{n} = {known[n]:.3g} {'' if s.unit == '1' else s.unit}".rstrip() for n, s in specs(self.effect).items()]
        return f"{self.name}: {', '.join(told)}"


@dataclass(frozen=True)
class Ranking(Shown):
    """Absent effects, best first; ``current`` rms over noise of the model as it is.

    Prints itself; in a notebook it shows a table and its picture (`jaxbacklash.plot.ranking`).
    """

    entries: tuple[Ranked, ...]
    current: float

    def __iter__(self) -> Iterator[Ranked]:
        return iter(self.entries)

    def __len__(self) -> int:
        return len(self.entries)

    def __getitem__(self, index: int) -> Ranked:
        return self.entries[index]

    def __str__(self) -> str:
        return "\n".join(table(self))

    def to_dataframe(self) -> Any:
        """The ranking as a `pandas.DataFrame`, a row for each ``effect``: ``rms_over_noise`` with it added, as well as that is
        known, ``evidence``, ``refitted`` where a refit has told both, and ``why`` there is no number.
        """
        return dataframe(
            {
                "effect": [one.name for one in self], "rms_over_noise": [one.rms_over_noise for one in self],
                "evidence": [one.evidence for one in self], "refitted": [one.refitted for one in self],
                "why": [one.why for one in self],
            },
            "effect", current=self.current,
        )  # fmt: skip


def table(ranking: Ranking, most: int = 10) -> list[str]:
    """Lines of the ranking's best."""
    lines = [
        f"  {'effect':<22} {'rms/noise with it':>18} {'evidence':>10}  (above 10, odds of 150 to 1: strong; below 0: against)"
    ]
    for entry in ranking.entries[:most]:
        how = "refitted" if entry.refitted else "predicted"
        lines.append(f"  {entry.name:<22} {entry.rms_over_noise:>18.3g} {entry.evidence:>10.0f}  {how}")
    return lines


def rank_effects(fit: Fit, *, window: float | None = None) -> Ranking:
    """Every effect of the catalogue that a fitted model lacks, judged at the first of its records, best first.

    Parameters
    ----------
    fit : a fit
    window : length of the windows whose error is quoted, as in the fit [s]

    Returns
    -------
    `Ranking`: prints itself; iterates over the absent effects, best first, each with ``name``, ``rms_over_noise`` and
    ``evidence``

    Raises
    ------
    RuntimeError
        JAX is in single precision.

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> fit = jb.fit(record.between(0.0, 6.0), inertia=3.16, starts=1)
    >>> jb.rank_effects(fit)[0].name
    'gravity'
    """
    require_double_precision("rank_effects")
    full = fit.system
    bare = System(full.inertia, full.contact, full.damper, {}, full.observed, motor=full.motor)
    own = tuple(name for name in fit.free if name.partition(".")[0] not in full.effects)
    fitter = ModelFitter(fit.records[0], bare, own, window)
    fitter.take_laws(laws_for(bare, translational=fit.translational))
    model = fitter.fit_model(dict(full.effects))
    floating = not fitter.grips(model.names)
    ranking = {c.name: c for c in reversed(screen(fitter, model, barred=fitter.outright))}
    evidence, refits = {}, {}
    # Sensitivities at a link that floats say nothing of one that is held: friction that holds it is really fitted.
    for name in fitter.outright if floating else ():
        after = fitter.fit_model({**fitter.effects(model), name: fitter.laws[name]()}, model)
        if np.isfinite(after.cost):
            fall = model.criterion - after.criterion
            moved = {n: v for n, v in after.value.items() if n in model.free}
            refits[name] = share_of_rest(model, model.rest - after.rest)
            ranking[name] = Candidate(name, after.system.effects[name], fall, refits[name], moved)
            evidence[name] = gain(model, after)
    return judged(fit.score, tuple(ranking.values()), evidence, refits)


def of_stage(stage: Stage, following: Stage | None = None) -> Ranking:
    """The ranking at a stage of the loop; ``following`` is the stage that came of it, None for the last."""
    found = judged(stage.fit.score, stage.ranking, stage.evidence, stage.refits)
    chosen = None if following is None else following.added
    if chosen is None or following is None:
        return found
    known = {entry.name: entry for entry in found}
    if chosen not in known and chosen in following.fit.system.effects:
        # A law with states of its own has no sensitivity at its null value: it was fitted outright.
        after = following.fit
        effect = after.system.effects[chosen]
        known[chosen] = Ranked(
            chosen, effect, after.score.rms, _measured(stage.fit.score, after.score, effect), True,
            "has a state of its own, so it was fitted outright", {},
        )  # fmt: skip
    if chosen in known:
        first = dataclasses.replace(known.pop(chosen), why="added at the next stage")
        if following.fit.system.effects.keys() == {*stage.fit.system.effects, chosen}:
            first = dataclasses.replace(first, refitted=True, refitted_rms_over_noise=following.fit.score.rms)
        return Ranking((first, *known.values()), found.current)
    return found


def judged(
    score: Score, ranking: Sequence[Candidate], evidence: Mapping[str, float] | None = None,
    refits: Mapping[str, float] | None = None,
) -> Ranking:  # fmt: skip
    """Candidates in units a person knows.

    Parameters
    ----------
    score : of the model as it is
    ranking : from `screening.screen`
    evidence : of those that were really fitted, by name
    refits : of those, by name, the share of what the model leaves that each took away
    """
    evidence, refits = evidence or {}, refits or {}
    sample = np.log(score.residual.size)
    entries = []
    best = {c.name: c for c in sorted(ranking, key=lambda c: c.gain)}  # one law may be there at two shapes
    for c in best.values():
        refitted = c.name in evidence
        why = "refitted" if refitted else "predicted from sensitivities, not refitted"
        if not refitted and c.gain <= 0.0:
            why = "its strength would have to leave the range that physics allows"
        told = float(evidence.get(c.name, c.gain - c.parameters * sample))
        known = rms_without(score.rms, refits[c.name]) if c.name in refits else float("nan")
        predicted = rms_without(score.rms, c.share)
        entries.append(Ranked(c.name, c.effect, predicted, told, refitted, why, dict(c.moved), known))
    return Ranking(tuple(sorted(entries, key=lambda e: -e.evidence)), score.rms)


def rms_without(rms: float, share: float) -> float:
    """The error over noise once a share (0 to 1) of its excess over noise is removed."""
    return float(np.sqrt(1.0 + (1.0 - share) * (rms**2 - 1.0))) if rms > 1.0 else rms


def correlation(score: Score) -> float:
    """How many neighbouring samples of a residual count for one, inside half a score window; 1 for noise."""
    times = score.window_times
    length = score.residual.size
    if len(times) > 1:
        length = max(8, round(0.5 * float(times[1] - times[0]) / float(score.t[1] - score.t[0])))
    rows = score.residual[: score.residual.size // length * length].reshape(-1, length)
    return correlation_length(rows)


def _measured(before: Score, after: Score, effect: AbstractEffect) -> float:
    """Evidence for an effect from the prediction errors without and with it."""
    rows = after.residual.size
    fall = rows * (before.rms**2 - after.rms**2) - len(free_specs(effect)) * np.log(rows)
    return float(fall / (max(1.0, after.rms**2) * correlation(after)))


def plain(fit: Fit) -> Fit:
    """A stage's fit without the absent laws that the loop carries along at their null values, for `where_it_fails`."""
    if fit.problem is None or fit.unknowns is None:
        return fit
    problem = make_problem(fit.system, fit.problem.windows, fit.free, tie=float(fit.problem.tie))
    unknowns = Unknowns(jnp.zeros(len(fit.free)), fit.unknowns.starts, fit.unknowns.coefficients)
    return dataclasses.replace(fit, problem=problem, unknowns=unknowns)
