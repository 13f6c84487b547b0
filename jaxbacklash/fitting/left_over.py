"""The noise that a fit leaves, where the samples alone could not tell it from the motion.

Before any model noise is what no smooth curve follows. A mass that white noise drives, or one that is sampled a few times a
period, has no smooth motion: the estimate is too large, and a right model misses by less than it. Then noise is what the model
leaves, the fit is made again with it, and where no model explains the record it is said to be open.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..one_encoder import one_side
from ..records import Record
from ..shooting.problem import Problem, Unknowns, changed
from ..shooting.windows import Layout, Windows
from ..signals import estimate_noise, rounding_noise
from .score import Score, begin_anew, score
from .settings import EXPLAINED, LAGS, LIKELY, NOISE_KNOWN, ROUNDS, SURE, WHITE
from .setup import first_guess

if TYPE_CHECKING:
    from .search import Found


def settle_noise(
    found: Found, layout: Layout, scored: Sequence[Score], at: Unknowns, records: Sequence[Record], group: int
) -> Settled:
    """A fit made anew, as long as it leaves less than the noise that it was made with; the same where it does not.

    Parameters
    ----------
    found : where the search ended
    layout : where each record sits among the windows, and its noise
    scored : the scores of the fit, one a record
    at : the windows' starts with which they were scored
    records : the records, which tell how finely their values were written
    group : shooting windows per score window
    """
    for _ in range(ROUNDS):
        factors = quieter(layout.noise, scored, records)
        if all(f == 1.0 for f in factors):
            break
        layout = replace(layout, noise=tuple(f * n for f, n in zip(factors, layout.noise)))
        problem = changed(found.problem, windows=_noisier(found.problem.windows, layout, factors))
        found = found.again(problem)
        # Windows begun from the data have come near their starts already, but where a side is not seen ever anew.
        begin = Unknowns(found.unknowns.theta, at.starts, at.coefficients)
        begin = begin_anew(problem, begin.theta) if one_side(problem.system) else begin
        scored, at = score(problem, begin, layout, group=group)
    return Settled(found, layout, tuple(scored))


@dataclass(frozen=True)
class Settled:
    """A fit with the noise that it leaves: ``found``, ``layout`` with that noise, and the scores in its units."""

    found: Found
    layout: Layout
    scored: tuple[Score, ...]


def quieter(noise: Sequence[float], scored: Sequence[Score], records: Sequence[Record]) -> list[float]:
    """By which factor the noise of each record is to be taken, 1 where a model leaves as much: not below what rounding has left.

    The one rule for all commands; ``scored`` is what the model misses by, in units of ``noise``.
    """
    factors = []
    for own, seen, record in zip(noise, scored, records):
        least = rounding_noise(record.channels[record.observed_name]) / own
        factor = max(seen.rms, least)
        limit = 1.0 - max(NOISE_KNOWN, LIKELY / np.sqrt(2.0 * record.samples))
        factors.append(float(factor) if np.isfinite(factor) and 0.0 < factor < limit else 1.0)
    return factors


def quieter_elsewhere(noise: float, factor: float, found: float) -> float:
    """By which factor the ``noise`` that another record's samples tell is to be taken.

    What made the estimate of the first record too large, by ``factor``, need not have been there: it is not taken for less than
    what was ``found`` there.
    """
    return float(np.clip(found / max(noise, 1e-300), factor, 1.0))


def predict(
    make: Callable[[Windows], Problem], prepared: tuple[Windows, Layout, int], record: Record,
    known: tuple[float, float] = (1.0, 0.0), *, may_explain: bool = True,
) -> tuple[Score, float]:  # fmt: skip
    """How a model with frozen parameters predicts a record of which nothing else is known, and the noise that is taken for it.

    Parameters
    ----------
    make : the problem of these windows, with the model's parameters
    prepared : the record's windows, where it sits among them, and how many make a score window
    record : the record
    known : what a fit to another record of the joint has told of the noise: by which factor it was below what the samples alone
        said, and its standard deviation
    may_explain : as `score` takes it
    """
    windows, layout, group = prepared

    def scored(factor: float) -> Score:
        problem = make(windows if factor == 1.0 else windows.noisier(factor))
        return score(problem, first_guess(problem), layout, group=group, may_explain=may_explain)[0][0]

    factor = quieter_elsewhere(layout.noise[0], *known)
    seen = scored(factor)
    if (less := quieter([factor * layout.noise[0]], [seen], [record])[0]) != 1.0:  # what a model predicts was no noise
        factor *= less
        seen = scored(factor)
    return seen, factor * layout.noise[0]


def why_open(record: Record, noise: float, scored: Score) -> dict[str, str]:
    """Why the noise of a record's channels is open after a fit, by channel; without those whose noise is known.

    Parameters
    ----------
    record : the record
    noise : standard deviation of the observed channel that the fit was made with, in the channel's unit
    scored : how the fit predicts the record, in units of that
    """
    found: dict[str, str] = {}
    rough = f"is not smooth at {record.rate_hz:.4g} Hz, so that its samples alone do not tell noise from motion"
    if "x" in record.channels and not estimate_noise(record.t, record.channels["x"]).told:
        found["x"] = f"x {rough}"
    name = record.observed_name
    if name == "T":
        return found
    alone = estimate_noise(record.t, record.channels[name])
    if alone.told and noise > (1.0 - 2.0 * NOISE_KNOWN) * alone.level:
        return found
    if scored.rms > EXPLAINED:
        found[name] = f"{name} {rough}, and the model does not explain them"
    elif not is_white(scored.residual):
        found[name] = f"what the model leaves of {name} is not white, so that part of it may be motion"
    return found


def is_white(residual: np.ndarray) -> bool:
    """Whether neighbouring residuals (N,) are not correlated."""
    energy = max(float(residual @ residual), 1e-300)
    lags = np.array([residual[k:] @ residual[:-k] for k in range(1, LAGS + 1)]) / energy
    return bool(np.all(np.abs(lags) < max(WHITE, SURE / np.sqrt(residual.size))))


def _noisier(windows: Windows, layout: Layout, factors: Sequence[float]) -> Windows:
    """The windows with the noise of each record a factor of its own as large."""
    weight = np.array(windows.weight)
    for first, count, factor in zip(layout.first, layout.windows, factors):
        weight[first : first + count + 1] /= factor
    return changed(windows, weight=weight, drop=np.asarray(windows.drop) / float(np.mean(factors)))
