"""Chaotic, regular, stochastic, or undecided: what the witnesses say together."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .drift import Drift
from .driven import Driven
from .exponent import Exponent
from .stretching import Stretching
from .surrogates import SurrogateTest
from .zero_one import ZeroOne

SIGNIFICANT = 0.05
STEADY = 0.3  # share of neighbours from the same tenth of the record; 0.1 is a steady motion
GROWS = 10.0  # a difference must grow by e to this over the record, or its growth cannot be told from none
STAYS = 0.5  # K below which the 0-1 test says regular
DENIES = 0.2  # K below which it does so against a growth that was measured: a short series with a strong rhythm lies between
REGULAR_DRIFT = 0.05  # exponents below this per swing are none
# Below either, chaos may go unseen: with 10 % noise the surrogates were rejected in 2 to 8 of 8 series of 300 and 500 samples of
# Lorenz, Rossler and Duffing (6 to 11 swings), in all of 120 with 1000 samples and 19 swings or more (benchmarks.chaos_power).
POWER_SAMPLES, POWER_SWINGS = 1000, 20


@dataclass(frozen=True)
class Verdict:
    """``word``: "chaotic", "regular", "stochastic" or "undecided"; ``text``: why, in a sentence or two."""

    word: str
    text: str


def judge(
    exponent: Exponent | None, surrogates: SurrogateTest, curve: Stretching, walk: ZeroOne, samples: int, period: float,
    company: float, drift: Drift | None = None,
) -> Verdict:  # fmt: skip
    """Weigh the witnesses.

    A drift comes first: where the level wanders or steps nothing is decided, and where the size of the motion changes it is not
    called chaotic.

    Chaotic needs all of: the series predicts itself, and better than its surrogates do (p at most 0.05); the exponent's whole
    interval by the scatter of the series lies above zero, so far that a difference grows by e^10 over the record; the 0-1 test
    does not deny it, with a K below 0.2; and the motion is steady, with nearest states from all over the record. Regular: no
    exponent above zero, and neighbours stay neighbours or the 0-1 test says regular. Stochastic: not predictable, or no more so
    than linear noise is, in a series of at least 1000 samples and 20 swings: in a shorter one the surrogates often miss chaos.
    Anything else is undecided.

    Parameters
    ----------
    exponent : of the raw series, per sample
    surrogates, curve, walk : the other witnesses
    samples : of the series
    period : samples of a swing
    company : share of nearest neighbours from the same tenth of the record, see `stationarity.kept_company`
    drift : what `drift.find_drift` found, if it was asked
    """
    if drift is not None and drift.forbids:
        return Verdict("undecided", f"Undecided because of drift. {drift.text}.")
    word, text = _weigh(exponent, surrogates, curve, walk, samples, period, company, drift)
    if drift is not None and drift.text:
        text += f" {drift.text}."
    return Verdict(word, text)


def _weigh(
    exponent: Exponent | None, surrogates: SurrogateTest, curve: Stretching, walk: ZeroOne, samples: int, period: float,
    company: float, drift: Drift | None,
) -> tuple[str, str]:  # fmt: skip
    """Word and sentence for a series whose level is steady."""
    if exponent is None:
        return ("undecided", "The series is too short for a local map of its motion.")
    low, high = exponent.scatter
    nonlinear = surrogates.p_value <= SIGNIFICANT
    told = f"p = {surrogates.p_value:.3g} against {surrogates.count} {surrogates.kind.upper()} surrogates"
    grows = low > 0.0 and low * samples > GROWS
    flat = exponent.value * period < REGULAR_DRIFT or low <= 0.0
    if exponent.predicts and nonlinear and grows:
        if company > STEADY:
            return (
                "undecided",
                f"The motion changes its nature over the record: {100 * company:.0f} % of nearest states come from the same "
                "tenth of it, as in a sweep. Take a stretch over which the drive is steady.",
            )
        if drift is not None and drift.kind == "size":
            return (
                "undecided",
                "Small differences seem to grow, but undecided because of drift: take a stretch over which the motion is steady.",
            )
        if walk.k < DENIES:
            return (
                "undecided",
                f"Small differences seem to grow, but the 0-1 test finds regular motion (K = {walk.k:.2f}); a longer record may "
                "tell.",
            )
        return (
            "chaotic",
            f"The series predicts itself better than linear noise would ({told}), and small differences grow exponentially: the "
            f"largest exponent lies above zero by more than the series scatters.",
        )
    if exponent.predicts and flat and (curve.stays_near or walk.k < STAYS):
        seen = f"the 0-1 test finds no wandering (K = {walk.k:.2f})"
        seen = "neighbouring states stay neighbours" if curve.stays_near else seen
        return ("regular", f"Small differences do not grow: {seen}, and the largest exponent is not above zero.")
    short = samples < POWER_SAMPLES or samples < POWER_SWINGS * period
    if short and not (exponent.predicts and nonlinear):
        seen = told if exponent.predicts else f"the best prediction misses by {exponent.error:.2f} of the signal's own spread"
        return (
            "undecided",
            f"Nothing tells the series from linear noise ({seen}), but in {samples} samples over {samples / period:.0f} swings "
            f"chaos may go unseen too: only from {POWER_SAMPLES} samples and {POWER_SWINGS} swings on would that mean noise.",
        )
    if not exponent.predicts:
        return (
            "stochastic",
            f"Near states have unlike futures: the best prediction one delay ahead misses by {exponent.error:.2f} of the "
            "signal's own spread.",
        )
    if not nonlinear:
        return ("stochastic", f"Linear noise seen through a static curve explains the series ({told}).")
    if high <= 0.0 or flat:
        return (
            "undecided",
            f"There is nonlinear structure ({told}) but no growth of small differences; a regular motion shaken by noise would "
            "look like this.",
        )
    return ("undecided", "Small differences may grow, but too little for this record to tell; a longer one may.")


def judge_driven(found: Driven, dt: float, drive: str) -> Verdict:
    """The verdict on a motion whose drive was measured and need not repeat: chaotic where two motions under it part, regular
    where they meet; undecided where the interval holds zero or a difference changes by less than e^10 over the record.

    Parameters
    ----------
    found : with an exponent
    dt : time between samples [s]
    drive : what it is called, such as "base motion"
    """
    assert found.value is not None
    assert found.stderr is not None
    seconds, rate = found.samples * dt, abs(found.value) / dt
    same = f"Two links that start apart under the same {drive}"
    fact = f"by a factor of e every {1.0 / max(rate, 1e-300):.2g} s over these {seconds:.3g} s"
    only = f"The exponent is conditional on this {drive}: under another it would differ."
    if found.word == "separate":
        return Verdict("chaotic", f"{same} separate, {fact}. {only}")
    if found.word == "meet":
        return Verdict("regular", f"{same} come together, {fact}. {only}")
    return Verdict(
        "undecided",
        f"{same} neither clearly separate nor clearly come together: over these {seconds:.3g} s a difference becomes "
        f"{_times(found.value * found.samples)} as large, {_times((found.value - found.stderr) * found.samples)} to "
        f"{_times((found.value + found.stderr) * found.samples)} within one standard error. {only}",
    )


def _times(exponent: float) -> str:
    """A factor of growth in words: ``0.01 times``, or ``e^40 times`` where nobody could read the number."""
    return f"{math.exp(exponent):.2g} times" if abs(exponent) < 9.0 else f"e^{exponent:.0f} times"
