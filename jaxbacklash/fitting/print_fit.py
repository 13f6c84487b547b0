"""A fit report that a person can read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np

from ..parameters import channel_unit
from .chance import beyond_chance
from .counts import few_counts
from .lengths import SCORE_WINDOW

if TYPE_CHECKING:
    from .estimates import Estimate
    from .fit import Fit
    from .score import Score


DOUBTED = "only if the model is right: it is not, see below"
"""What stands beside every interval of a fit that misses its record by more than chance."""


class Named(Protocol):
    """A cause of misfit, as `jaxbacklash.causes.Cause` tells it."""

    @property
    def sentence(self) -> str: ...
    @property
    def remedy(self) -> str: ...
    @property
    def undone(self) -> str: ...


def number(value: float, stderr: float | None) -> str:
    """A value with as many digits as its standard error allows (two of the error)."""
    if not stderr or not np.isfinite(stderr):
        return f"{value:.6g}"
    decimals = int(1 - np.floor(np.log10(stderr)))
    if decimals >= 0 and abs(value) < 1e7:
        return f"{value:.{decimals}f}"
    return f"{value:.6g}"


def line(estimate: Estimate, note: str = "") -> str:
    """One parameter in words: value, error, interval, or why there is none; a ``note`` stands beside an interval."""
    name = f"  {estimate.label:<24}"
    if estimate.value is None:
        return f"{name} {estimate.verdict}: {estimate.why}"
    value = number(estimate.value, estimate.stderr)
    unit = "" if estimate.unit == "1" else estimate.unit
    if estimate.stderr is None:
        return f"{name} {value} {unit}"
    share = f"{100 * estimate.stderr / abs(estimate.value):.2g} %" if estimate.value else ""
    text = f"{name} {value} +- {estimate.stderr:.2g} {unit}" + (f" ({share})" if share else "")
    if estimate.unit == "rad" and abs(estimate.value) < 1.0:
        text += f" = {np.degrees(estimate.value):.4g} deg"
    return f"{text}  [{note}]" if note else text


def doubt(fit: Fit) -> str:
    """What is to stand beside the intervals of a fit: nothing where it leaves only noise."""
    return DOUBTED if beyond_chance(fit) else ""


def text(fit: Fit, causes: Sequence[Named] = ()) -> str:
    """The whole report; ``causes`` in the record that explain a misfit are told after the verdict."""
    lines = []
    for number_of, (record, score, noise, moved) in enumerate(zip(fit.records, fit.scores, fit.noise, fit.input_noise)):
        lines.append(record.summary())
        driver = record.input_name or "x"
        unit = channel_unit(driver, translational=fit.translational)
        name = record.observed_name
        own = channel_unit(name, translational=fit.translational)
        beside = f", of {driver} {at_most(fit, driver, number_of)}{moved:.3g} {unit}" if moved else ""
        lines.append(f"  noise of {name} {at_most(fit, name, number_of)}{noise:.3g} {own}{beside}")
        lines.append(
            f"  prediction error over windows{_length(score)}: {score.rms:.3g} times the noise (median window {score.median:.3g})"
        )
    if fit.heldout is not None:
        lines.append(f"  on the held-out record: {fit.heldout.rms:.3g} times the noise (median {fit.heldout.median:.3g})")
    effects = ", ".join(sorted(fit.system.effects)) or "none"
    lines.append(f"model: {fit.model}; effects added: {effects}")
    if fit.per_inertia:
        lines.append("no inertia was given: stiffness, damping and torques are per unit inertia")
    note = doubt(fit)
    lines += [line(estimate, note) for estimate in fit.parameters.values()]
    lines += _correlations(fit)
    how = "tied into one trajectory" if fit.tied else "each on its own"
    lines.append(f"{fit.agreeing} of {fit.tried} starts reached this minimum; windows {how}; {fit.steps} steps")
    lines.append(verdict_text(fit, causes))
    return "\n".join(lines)


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
            f"The model explains the record to {worst.rms:.3g} times its noise (median window {worst.median:.2f}), but "
            "what is left is more than chance: intervals hold only if the model is right."
        )
    elif fit.adequate:
        sentence = f"The model explains the record to its noise (median window {worst.median:.2f} times the noise)."
    else:
        sentence = (
            f"The model misses something: the median window is off by {worst.median:.3g} times the noise, all windows by "
            f"{worst.rms:.3g}; intervals are widened by that misfit and hold only if the model is right."
        )
    sentence = f"{sentence} {causes_text(causes)}".rstrip()
    missing = [e for e in fit.parameters.values() if e.value is None]
    if missing:
        sentence += " Not found: " + "; ".join(f"{e.label or e.name} ({e.why})" for e in missing) + "."
    return f"{sentence} {few_counts(fit)}".rstrip()
