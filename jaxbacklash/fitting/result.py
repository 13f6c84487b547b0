"""What a fit found, and how a person reads it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from ..frames import dataframe, known
from ..parameters import channel_unit
from ..records import Record
from ..records.findings.wide_play import wide_play
from ..regression.equation_error import Start
from ..shooting.lengths import SCORE_WINDOW
from ..shooting.problem import Problem, Unknowns
from ..showing import Shown
from ..system import System
from .chance import beyond_chance, explains, joined, near_noise
from .counts import few_counts
from .estimates import Estimate, line
from .score import Score, error_in_words

WITHOUT_KT = "no --kt was given: inertias, stiffness, damping and torques are per N m/A of the motor"
"""What is said of a drive whose current stands for its torque."""
DOUBTED = "only if the model is right: it is not, see the verdict"
"""What stands beside every standard error of a fit that misses its record by more than chance, in place of an interval."""


class Named(Protocol):
    """A cause of misfit, as `jaxbacklash.causes.Cause` tells it."""

    @property
    def sentence(self) -> str: ...
    @property
    def remedy(self) -> str: ...
    @property
    def undone(self) -> str: ...


@dataclass(frozen=True)
class Fit(Shown):
    """A fitted model. Prints itself; in a notebook it shows a table and its picture (`jaxbacklash.plot.fit`).

    ``noise_alone``, per record, is what its samples alone told of the noise, before there was a model.

    Attributes: ``system`` with the fitted values; ``parameters`` the free ones, by name; ``scores`` one per record;
    ``heldout`` the score of a held-out record; ``noise`` and ``input_noise`` per record; ``covariance`` (q, q) in the order of
    ``free``; ``agreeing`` of ``tried`` starts reached the best minimum, none were tried where a search had a model to begin from;
    ``steps`` taken from there; ``tied`` True when the windows were tied; ``cost`` half the sum of squares; ``start`` the
    equation-error estimate it began from; ``seconds`` by stage;
    ``noise_open`` per record, by channel, why its noise is an upper bound; without the channels whose noise is known.
    """

    system: System
    free: tuple[str, ...]
    parameters: dict[str, Estimate]
    scores: tuple[Score, ...]
    heldout: Score | None
    records: tuple[Record, ...]
    noise: tuple[float, ...]
    input_noise: tuple[float, ...]
    covariance: np.ndarray
    agreeing: int
    tried: int
    tied: bool
    cost: float
    steps: int
    start: Start | None
    model: str
    per_inertia: bool
    translational: bool
    seconds: dict[str, float] = field(default_factory=dict)
    problem: Problem | None = field(default=None, repr=False)
    unknowns: Unknowns | None = field(default=None, repr=False)
    noise_open: tuple[dict[str, str], ...] = ()
    noise_alone: tuple[float, ...] = ()

    @property
    def known_noise(self) -> tuple[float, float]:
        """What the fit tells of the noise in other records of its joint: by which factor it is below what the samples of the
        first record alone said, and its standard deviation."""
        return (self.noise[0] / self.noise_alone[0] if self.noise_alone else 1.0), self.noise[0]

    @property
    def score(self) -> Score:
        """The score of the first record."""
        return self.scores[0]

    @property
    def adequate(self) -> bool:
        """True when what the model leaves is noise: the median window within a tenth of it, all windows within three tenths, and
        the windows join into one motion."""
        return near_noise(self.scores) and joined(self.tied, self.system)

    def __str__(self) -> str:
        return text(self)

    def to_dataframe(self) -> Any:
        """The parameters as a `pandas.DataFrame`, a row each: ``value``, ``stderr``, ``low`` and ``high`` of the 95 % interval in
        ``unit``, ``verdict`` and ``why``. NaN where there is no number; no interval where it would hold only if the model were
        right.

        Examples
        --------
        >>> record, heldout = jb.demo_records()
        >>> fit = jb.fit(record.between(0.0, 2.0), inertia=3.16, starts=1)
        >>> frame = fit.to_dataframe()
        >>> list(frame.index), frame.loc["backlash", "unit"]
        (['backlash', 'stiffness', 'damping'], 'rad')
        """
        found, open_ = self.parameters.values(), doubt(self)
        ends = [None if open_ else one.ci95 for one in found]
        return dataframe(
            {
                "parameter": list(self.parameters), "value": known([one.value for one in found]),
                "stderr": known([one.stderr for one in found]), "low": known([None if e is None else e[0] for e in ends]),
                "high": known([None if e is None else e[1] for e in ends]), "unit": [one.unit for one in found],
                "verdict": [one.verdict for one in found], "why": [one.why for one in found],
            },
            "parameter", rms_over_noise=self.score.rms, model=self.model, effects=sorted(self.system.effects),
        )  # fmt: skip

    def to_dataset(self, record: int = 0) -> Any:
        """One of its records with the prediction as an `xarray.Dataset`, see `Score.to_dataset`."""
        of = self.records[record]
        unit = channel_unit(of.observed_name, translational=self.translational)
        return self.scores[record].to_dataset(unit).assign_attrs(record=of.path, noise=self.noise[record])


def doubt(fit: Fit) -> str:
    """What is to stand beside the standard errors of a fit in place of intervals: nothing where it leaves only noise."""
    return "" if explains(fit.scores, fit.system) and joined(fit.tied, fit.system) else DOUBTED


def text(fit: Fit, causes: Sequence[Named] = ()) -> str:
    """The whole report; ``causes`` in the record that explain a misfit are told after the verdict."""
    lines = []
    for number_of, (record, score, noise, moved) in enumerate(zip(fit.records, fit.scores, fit.noise, fit.input_noise)):
        lines.append(record.summary())
        driver = record.input_name or "x"
        unit = "A" if record.per_kt else channel_unit(driver, translational=fit.translational)
        name = record.observed_name
        own = channel_unit(name, translational=fit.translational)
        beside = f", of {driver} {at_most(fit, driver, number_of)}{moved:.3g} {unit}" if moved else ""
        lines.append(f"  noise of {name} {at_most(fit, name, number_of)}{noise:.3g} {own}{beside}")
        lines.append(
            f"  prediction error over windows{_length(score)}: {error_in_words(score)} (median window {score.median:.3g})"
        )
    if fit.heldout is not None:
        lines.append(f"  on the held-out record: {error_in_words(fit.heldout)} (median {fit.heldout.median:.3g})")
    effects = ", ".join(sorted(fit.system.effects)) or "none"
    lines.append(f"model: {fit.model}; effects added: {effects}")
    if fit.per_inertia:
        lines.append(without_inertia(fit))
    if fit.records[0].per_kt:
        lines.append(WITHOUT_KT)
    note = doubt(fit)
    lines += [line(estimate, note) for estimate in fit.parameters.values()]
    lines += _correlations(fit)
    how = "join into one continuous motion" if fit.tied else "do not join, as where a torque is left out"
    if fit.tried:
        lines.append(f"{fit.agreeing} of {fit.tried} starts reached this minimum, after {fit.steps} steps; the windows {how}")
    else:
        lines.append(f"begun where the search stood, {fit.steps} steps from there; the windows {how}")
    lines.append(verdict_text(fit, causes))
    return "\n".join(lines)


def without_inertia(fit: Fit) -> str:
    """What is said where nothing in the record tells the size of torques."""
    whose = "" if fit.system.motor is None else " of the motor, whose torque was not measured"
    return f"no inertia was given: stiffness, damping and torques are per unit inertia{whose}"


def at_most(fit: Fit, channel: str, record: int = 0) -> str:
    """The words before the noise of a channel that is an upper bound, with the reason; nothing where it is known."""
    why = fit.noise_open[record].get(channel, "") if fit.noise_open else ""
    return f"open ({why}): at most " if why else ""


def _length(score: Score) -> str:
    """How long the windows are, where they are not as long as usual."""
    return "" if abs(score.length - SCORE_WINDOW) < 0.05 * SCORE_WINDOW else f" of {score.length:.3g} s"


def _correlations(fit: Fit) -> list[str]:
    deviation = np.sqrt(np.diag(fit.covariance))
    lines = []
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = fit.covariance / np.outer(deviation, deviation)
    for i in range(len(fit.free)):
        for j in range(i):
            if np.isfinite(correlation[i, j]) and abs(correlation[i, j]) > 0.9:
                lines.append(f"  correlation of {fit.free[j]} and {fit.free[i]}: {correlation[i, j]:+.3f}")
    return lines


def causes_text(causes: Sequence[Named]) -> str:
    """The causes found in the record, each with what to type."""
    said = []
    for cause in causes:
        after = [f"Pass {cause.remedy}." if cause.remedy.startswith("--") else f"{cause.remedy}."] if cause.remedy else []
        after += [f"{cause.undone}."] if cause.undone else []
        said.append(" ".join([f"A cause lies in the record: {cause.sentence}.", *after]))
    return " ".join(said)


def verdict_text(fit: Fit, causes: Sequence[Named] = ()) -> str:
    """A few sentences: does the model explain the record, which cause in the record does, and what could not be found?"""
    worst = max(fit.scores, key=lambda score: score.median)
    beyond = beyond_chance(fit)
    if fit.adequate and beyond:
        sentence = (
            f"The model explains the record to {error_in_words(worst)} (median window {worst.median:.2f}), but "
            "what is left is more than chance: standard errors hold only if the model is right, and no intervals are given."
        )
    elif fit.adequate:
        sentence = f"The model explains the record to its noise: {error_in_words(worst)}, median window {worst.median:.2f}."
    elif near_noise(fit.scores):
        sentence = (
            f"The model misses something: each window, begun anew, is missed by {error_in_words(worst)} (median window "
            f"{worst.median:.2f}), but the windows do not join into one motion, so a torque is left out; standard errors "
            "hold only if the model is right, and no intervals are given."
        )
    else:
        sentence = (
            f"The model misses something: its error is {error_in_words(worst)}, in the median window {worst.median:.3g} times; "
            "standard errors are widened by that misfit and hold only if the model is right, and no intervals are given."
        )
    sentence = f"{sentence} {causes_text(causes)}".rstrip()
    missing = [e for e in fit.parameters.values() if e.value is None]
    if missing:
        sentence += " Not found: " + "; ".join(f"{e.label or e.name} ({e.why})" for e in missing) + "."
    return " ".join(part for part in (sentence, few_counts(fit), wide_play(fit)) if part)
