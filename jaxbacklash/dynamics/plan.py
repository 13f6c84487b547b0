"""How long to follow a motion and what to keep, and what following it gave."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..errors import BadInput

Array = Any

CHUNK = 10
"""Periods between two looks at the tangent vector: at an exponent of 0.5 per radian of the drive it has grown by e^31."""


@dataclass(frozen=True)
class Plan:
    """``periods`` of the drive in all, the first ``skip`` of them transient; the last ``samples`` are kept one by one."""

    periods: int = 400
    skip: int = 100
    samples: int = 32

    def __post_init__(self) -> None:
        if self.skip < 0 or self.periods - self.skip < 2 * CHUNK:
            raise BadInput(
                f"{self.periods} periods with {self.skip} skipped: wanted at least {2 * CHUNK} periods after the skipped ones"
            )
        if not 1 <= self.samples <= self.periods - self.skip:
            raise BadInput(f"{self.samples} samples: wanted 1 to {self.periods - self.skip}, the periods after the skipped ones")

    @property
    def stops(self) -> np.ndarray:
        """Times [periods] at which a run looks up: every chunk, the end of the transient, and each kept period."""
        kept = self.periods - self.samples
        early = np.arange(0, self.skip, CHUNK)
        middle = np.arange(self.skip, kept, CHUNK)
        return np.unique(np.concatenate([early, [self.skip], middle, np.arange(kept, self.periods + 1)])).astype(float)


class Followed(NamedTuple):
    """What is left of N motions, all as arrays over the cells on the last axis.

    ``lyapunov`` (N,) the largest exponent [1/time] and ``stderr`` its error bar; ``p``, ``v`` (samples, N) at the end of each
    kept period; ``unresolved`` (N,) True where the solver ran out of legs; ``last`` (2, N) the final state.
    """

    lyapunov: Array
    stderr: Array
    p: Array
    v: Array
    unresolved: Array
    last: Array
