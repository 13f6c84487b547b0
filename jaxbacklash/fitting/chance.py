"""Whether a fit misses its record by more than chance: by the windows' own degrees of freedom, not by a fixed ratio.

The sum of squares of a window in which only noise is left follows a chi-square distribution. A right model has windows beyond its
far end now and then, no more; a wrong one has many, or all of them are a little larger than they should be.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from ..signals import chi_square
from .settings import BEYOND, EXPLAINED, FEW, NEARLY, NOISE_KNOWN, RARE, SURE

if TYPE_CHECKING:
    from .score import Score


class Scored(Protocol):
    """A fit, as far as its scores go."""

    @property
    def scores(self) -> Sequence[Score]: ...
    @property
    def system(self) -> Any: ...


def beyond_chance(fit: Scored) -> bool:
    """Whether any record of a fit is missed by more than noise explains."""
    return missed(fit.scores, fit.system)


def missed(scores: Sequence[Score], system: Any) -> bool:
    """The same of the scores that a system has on its records."""
    return any(misses(score, 2 if system is None else len(system.state_names)) for score in scores)


def near_noise(scores: Sequence[Score]) -> bool:
    """Whether the median window of every score is near the noise, and all its windows together within three tenths of it."""
    return all(s.median < NEARLY and s.rms < EXPLAINED for s in scores)


def explains(scores: Sequence[Score], system: Any) -> bool:
    """Whether a system leaves only noise of its records, near it and within chance: intervals hold where it does."""
    return near_noise(scores) and not missed(scores, system)


def joined(tied: bool, system: Any) -> bool:
    """Whether the windows of a fit join into one motion, as far as corners of dry friction let them: ``tied`` where they do.

    Where they do not, the record's evidence is for a torque that the model leaves out, though each window, begun anew, may miss
    little: on records of 8 s in which gravity hid below the noise, the play was off by 2 to 9 standard errors.
    """
    return tied or any(effect.slides for effect in system.effects.values())


def misses(score: Score, states: int) -> bool:
    """The same of one record; ``states`` (2 for position and speed) begin every window anew and take so much of its freedom."""
    ratio = np.asarray(score.window_rms, dtype=float)
    ratio = ratio[np.isfinite(ratio)]
    if ratio.size == 0:
        return False
    freedom = max(score.t.size / max(np.asarray(score.window_rms).size, 1) - states, 1.0)
    own = ratio / (1.0 + NOISE_KNOWN)
    # The median of K normal values of standard deviation s has one of sqrt(pi/2) s / sqrt(K), and s is 1 / sqrt(2 freedom).
    spread = np.sqrt(0.5 * np.pi / (2.0 * freedom * ratio.size))
    limit = np.sqrt(chi_square(freedom, RARE) / freedom)
    beyond = int(np.sum(own > limit))
    return bool(np.median(own) > 1.0 + SURE * spread or beyond > max(FEW, BEYOND * ratio.size))
