"""Does the link move against its base at all, before anything is fitted to that?

Two encoders on one shaft show the same motion, and their difference is noise, to which any model fits: with parameters of nine
digits. What a fine spline takes of a signal is compared with what it takes of noise (an F test), and the signal with the input
before it, which tells a small answer from none. Channels that do not answer by themselves are found when a file is read.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..errors import BadInput
from ..signals import choose_intervals, fit_spline, span
from .record import Record

CLEAR = 5.0
"""Standard errors by which a motion has to stand out of noise, or to go with its input."""
LATE = 64
"""Samples by which the answer may be late, at most, where it is compared with the input."""
COUNTS = 3
"""Values of a counted channel, at most, with which it may stand still: a count and what is beside it."""


def check_answers(records: Iterable[Record]) -> None:
    """Refuse records of two absolute motions in whose difference there is nothing but noise.

    Raises
    ------
    BadInput
        The relative motion does not stand out of its noise.
    """
    for record in records:
        if not {"x", "y"} <= set(record.channels):
            continue
        x, y = record.channels["x"], record.channels["y"]
        if answers(record.t, y - x, x):
            continue
        raise BadInput(
            f"{record.path or 'the record'}: y - x is noise of {float(np.std(y - x)):.2g} and nothing else over "
            f"{record.samples * record.dt:.3g} s, as of two encoders on one shaft, or a play that is never crossed; wanted a "
            "record in which the link moves against its base"
        )


def answers(t: np.ndarray, motion: np.ndarray, drive: np.ndarray | None = None) -> bool:
    """Whether a motion (N,) is more than noise: by its own smoothness, or since it goes with what drives it."""
    motion = motion - np.mean(motion)
    energy = float(motion @ motion)
    # Of a channel that is counted and stands still, noise turns over a count here and there.
    if not energy > 0.0 or (np.unique(motion).size <= COUNTS and drive is not None and not _goes_with(motion, drive)):
        return False
    window = span((t[-1] - t[0]) / (t.size - 1))
    for intervals in {1, choose_intervals(t, motion, window)}:
        fitted = fit_spline(t, motion, t[0], window / intervals)
        taken = fitted.coefficients.size
        left = t.size - taken
        if left < taken // 4 or left < 8:
            continue
        rest = float(np.sum((motion - fitted(t)) ** 2))
        ratio = (energy - rest) / taken / max(rest / left, 1e-300)
        if ratio > 1.0 + CLEAR * np.sqrt(2.0 / taken + 2.0 / left):
            return True
    return drive is not None and _goes_with(motion, drive)


def _goes_with(motion: np.ndarray, drive: np.ndarray) -> bool:
    """Whether a motion is correlated with its drive, up to some samples before: each change against each change."""
    one, other = np.diff(motion), np.diff(drive)
    one, other = one - np.mean(one), other - np.mean(other)
    size = float(np.linalg.norm(one) * np.linalg.norm(other))
    if not size > 0.0:
        return False
    most = min(LATE, one.size // 4)
    found = max(abs(float(one[k:] @ other[: other.size - k])) for k in range(most)) / size
    # A smooth drive makes neighbouring samples of the product alike: as many count as the noise of the motion has.
    return found > CLEAR / np.sqrt(one.size)
