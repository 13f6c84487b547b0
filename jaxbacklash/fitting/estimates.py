"""What is known about a parameter after the fit: value, standard error, interval, and in words whether it was found."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any

import numpy as np

from ..parameters import per_kt, specs, unit_text, values
from ..quasistatic import slow_reading, why_not
from ..records import Record
from ..regression.force_loop import NOTHING
from ..system import System
from .hard import contact_samples, most_play, reach_of_sampling
from .score import Score
from .settings import CONFIDENCE, CORRELATED, MOST_UNCERTAIN, ONE_WITH, SHORTEST, SURE
from .stick_slip import correlation

FOUND, ONE_SIDED, UNDETERMINED = "found", "one-sided", "not determined"


def two_sided(confidence: float) -> float:
    """Standard deviations within which a normal number lies with a probability ``confidence``."""
    return NormalDist().inv_cdf(0.5 * (1.0 + confidence))


NORMAL_95, BELOW_95 = two_sided(CONFIDENCE), NormalDist().inv_cdf(CONFIDENCE)
BOUNDED = ("damping", "backlash")
"""Parameters that may be zero, of which an upper bound is worth telling where they are not determined."""


@dataclass(frozen=True)
class Estimate:
    """One parameter. ``value`` and the rest are None when it was not determined; ``why`` says why."""

    name: str
    value: float | None
    stderr: float | None
    unit: str
    verdict: str = FOUND
    why: str = ""
    label: str = ""
    profile95: tuple[float, float] | None = None

    @property
    def ci95(self) -> tuple[float, float] | None:
        """95 % interval: from the profile likelihood where it was asked for, else value -+ 1.96 standard errors."""
        if self.profile95 is not None:
            return self.profile95
        if self.value is None or self.stderr is None:
            return None
        return self.value - NORMAL_95 * self.stderr, self.value + NORMAL_95 * self.stderr

    def as_json(self) -> dict[str, Any]:
        interval = self.ci95
        found: dict[str, Any] = {
            "value": self.value,
            "stderr": self.stderr,
            "ci95": None if interval is None else list(interval),
            "unit": self.unit,
            "verdict": self.verdict,
        }
        if self.why:
            found["why"] = self.why
        return found


def number(value: float, stderr: float | None) -> str:
    """A value with as many digits as its standard error allows (two of the error)."""
    if not stderr or not np.isfinite(stderr):
        return f"{value:.6g}"
    decimals = int(1 - np.floor(np.log10(stderr)))
    if decimals >= 0 and abs(value) < 1e7:
        return f"{value:.{decimals}f}"
    return f"{value:.6g}"


def line(estimate: Estimate, note: str = "") -> str:
    """One parameter in words: value and standard error, or why there is none; a ``note`` stands beside an error."""
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


def inflation(misfit: float, score: Score, *, tied: bool, one_run: bool = False) -> float:
    """By how much variances exceed what the noise alone makes of them, at least 1: the one way to an interval of every command.

    Parameters
    ----------
    misfit : root of the reduced chi-square where the fit has ended
    score : of the windows that are quoted: where the windows of a fit do not join, they show what each hides by its own start
    tied : whether the fit is one trajectory, of which the misfit tells all
    one_run : whether the trajectory is a run whose starts nothing moves, as of a link that friction holds: what it misses by
        then is correlated over many samples, and so many count for one
    """
    if not tied:
        return max(1.0, score.rms**2)
    correlated = one_run and misfit >= CORRELATED
    return max(1.0, misfit**2) * (correlation(score.residual, np.ones(score.residual.size)) if correlated else 1.0)


@dataclass(frozen=True)
class Contacts:
    """How often the record meets the edges of the play: shares of samples above and below, and the largest |z| [rad]."""

    above: float
    below: float
    reach: float


def contacts(record: Record, low: float, high: float) -> Contacts:
    """Share of samples beyond each edge of the play, by the measured z (or y at a base at rest), or by a transmitted force."""
    moved = record.channels
    if record.kind == "transmitted":
        level = NOTHING * float(np.max(np.abs(moved["T"])))
        share = [float(np.mean(sign * moved["T"] > level)) for sign in (1.0, -1.0)]
        return Contacts(share[0], share[1], 0.5 * float(np.ptp(moved["x"])))
    z = record.relative
    assert z is not None
    return Contacts(float(np.mean(z > high)), float(np.mean(z < low)), float(np.max(np.abs(z))))


def judge(
    system: System,
    free: Sequence[str],
    stderr: dict[str, float],
    records: Sequence[Record],
    *,
    per_inertia: bool,
    translational: bool,
    covariance: np.ndarray | None = None,
    explained: bool = True,
    stiffest: Collection[str] = (),
) -> dict[str, Estimate]:
    """Estimates with verdicts.

    A stiffness that does not stand clear of its error, or a play that no sample leaves, was not determined; a play met on
    one side only is one-sided: the record tells where that edge is, not how far away the other one lies. Of two parameters
    whose errors are one, by the ``covariance`` (q, q) in the order of ``free``, neither was. Of a model that leaves more than
    noise (not ``explained``) no bound is told, as that would hold only if the model were right. Of the ``stiffest``, stiffnesses
    that ended where a step of the integration follows no further, only that is told.
    """
    described, present = specs(system), values(system)
    length = "m" if translational else "rad"
    found: dict[str, Estimate] = {}
    partners = {} if covariance is None else _inseparable(free, covariance)
    reasons = _joint_reasons(system, stderr, records, length) if system.has_play else {}
    if contact_samples(system, records[0].dt) < SHORTEST and system.observed != "T" and "stiffness" not in reasons:
        least = reach_of_sampling(system, records[0].dt)
        of_what = unit_text("N m/rad", translational=translational, per_inertia=per_inertia)
        reasons["stiffness"] = (
            UNDETERMINED,
            (f"contacts last less than {SHORTEST:g} samples: it is above {least:.3g} {of_what}, and the sampling shows no more"),
        )
    for name in free:
        spec, error = described[name], stderr[name]
        unit = unit_text(spec.unit, translational=translational, per_inertia=per_inertia)
        unit = per_kt(unit) if records[0].per_kt else unit
        value = present[name]
        verdict, why = reasons.get(name, (FOUND, ""))
        if verdict == FOUND and name in stiffest:
            verdict, why = UNDETERMINED, f"it is {value:.3g} {unit} or above, and the integration's step follows no more"
        elif verdict == FOUND and not np.isfinite(error):
            verdict, why = UNDETERMINED, "this record does not change with it"
        elif verdict == FOUND and (spec.positive or name in BOUNDED) and error > MOST_UNCERTAIN * abs(value):
            verdict, why = UNDETERMINED, "its standard error exceeds half of its value"
            if name in BOUNDED and explained:
                why += f": below {value + BELOW_95 * error:.2g} {unit} (95 %)"
        elif verdict == FOUND and name in partners:
            verdict, why = UNDETERMINED, f"the record tells it only together with {partners[name]}: their errors are one"
        hidden = verdict != FOUND
        finite = np.isfinite(error) and not hidden
        found[name] = Estimate(name, None if hidden else value, error if finite else None, unit, verdict, why, spec.label or name)
    return found


def _inseparable(free: Sequence[str], covariance: np.ndarray) -> dict[str, str]:
    """Parameters whose error is one with that of another, and the other."""
    deviation = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    found: dict[str, str] = {}
    for i, one in enumerate(free):
        for j, other in enumerate(free[:i]):
            size = deviation[i] * deviation[j]
            if np.isfinite(size) and size > 0.0 and abs(covariance[i, j]) > ONE_WITH * size:
                found.setdefault(one, other)
                found.setdefault(other, one)
    return found


def _joint_reasons(
    system: System, stderr: dict[str, float], records: Sequence[Record], length: str
) -> dict[str, tuple[str, str]]:
    low, high = (float(e) for e in system.edges(0.0))
    assert system.contact is not None
    stiffness = float(system.contact.stiffness)
    if all(r.relative is None and r.kind == "drive" for r in records):
        clear = stiffness > SURE * stderr.get("stiffness", 0.0) and np.isfinite(stderr.get("stiffness", 0.0))
        shown = f"the {records[0].input_name} does not show a contact"
        why = f"{shown}: its stiffness is not clear of zero by {SURE:g} standard errors"
        return {} if clear else {name: (UNDETERMINED, why) for name in ("backlash", "stiffness")}
    touch = [contacts(r, low, high) for r in records]
    above, below = max(c.above for c in touch), max(c.below for c in touch)
    reach = max(c.reach for c in touch)
    weak = stiffness < SURE * stderr.get("stiffness", 0.0) or not np.isfinite(stderr.get("stiffness", 0.0))
    if weak and all(r.kind == "transmitted" for r in records):
        # What only contact can carry was measured: where the joint met both edges, the play is judged by its own error.
        met = "" if min(above, below) > 0.0 else " on one side only"
        why = f"contact shows{met}, but its standard error exceeds a fifth of its value"
        return {name: (UNDETERMINED, why) for name in (("stiffness", "backlash") if met else ("stiffness",))}
    if weak or (above == 0.0 and below == 0.0):
        slow = slow_reading(records[0]) if len(records) == 1 else None
        if slow is not None:
            why = why_not(slow)
            return {"backlash": (UNDETERMINED, why), "stiffness": (UNDETERMINED, why)}
        why = f"z never leaves the play: |z| stays below {reach:.4g} {length} and no contact shows"
        if above > 0.0 or below > 0.0:
            why = (
                f"z leaves the fitted play of {high - low:.3g} {length} (|z| up to {reach:.4g} {length}), but the contact "
                f"stiffness is not clear of zero by {SURE:g} standard errors"
            )
        lost = max(most_play(r) for r in records)
        range_of_z = f"; the lost motion, over which z ranges, is {lost:.3g} {length}" if system.observed != "T" else ""
        return {"backlash": (UNDETERMINED, why + range_of_z), "stiffness": (UNDETERMINED, why)}
    few = 2.0 / min(r.samples for r in records)
    if above <= few or below <= few:
        side, edge = ("upper", high) if above > below else ("lower", low)
        why = (
            f"only the {side} edge is met, at z = {edge:.5g} {length}; the record does not show where the other edge "
            "lies, so the total play is open"
        )
        return {"backlash": (ONE_SIDED, why)}
    return {}
