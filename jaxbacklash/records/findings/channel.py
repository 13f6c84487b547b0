"""One channel as the checks see it: what several of them need of it is worked out once, when the first asks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeVar

import numpy as np

from jaxbacklash.once import once
from jaxbacklash.side_by_side import side_by_side

from .local import EVERY, MEDIAN, RANKS, SHARE, SURPRISE_OF_NOISE, common_step, level, surprise, within

POSITIONS = ("x", "y", "z", "motor", "link")
"""Channels of things that have mass, and so neither jump nor stand out for a single sample; forces may."""

LONG = 200_000
"""Samples from which on a channel is worth a core of its own."""

Found = TypeVar("Found")


class Channel:
    """The values of one channel and what checks ask of them.

    Parameters
    ----------
    values : array of shape (N,)
        Finite, at even steps of time, N >= 5, in any unit; that of all that is worked out of them. They must not change.

    Examples
    --------
    >>> Channel(np.array([0.0, 0.5, 0.5, 1.5, 3.0, 2.0])).quantum
    0.5
    """

    def __init__(self, values: np.ndarray):
        self.values = values

    @property
    def size(self) -> int:
        """N."""
        return self.values.size

    @once
    def low(self) -> float:
        """The smallest value."""
        return float(self.values.min())

    @once
    def high(self) -> float:
        """The largest value."""
        return float(self.values.max())

    @property
    def span(self) -> float:
        """From the smallest value to the largest."""
        return self.high - self.low

    @once
    def steps(self) -> np.ndarray:
        """From each value to the next, shape (N - 1,)."""
        return np.diff(self.values)

    @once
    def longest(self) -> float:
        """The size of the largest step."""
        return max(float(self.steps.max()), -float(self.steps.min()))

    @once
    def rests(self) -> np.ndarray:
        """Whether the next value is the same, shape (N - 1,)."""
        return self.steps == 0.0

    @once
    def repeats(self) -> int:
        """How many values are the same as the one before."""
        return int(np.count_nonzero(self.rests))

    @once
    def surprises(self) -> np.ndarray:
        """What `local.surprise` gives, shape (N,)."""
        return surprise(self.values)

    @once
    def noise(self) -> float:
        """Standard deviation of the noise, see `local.level`."""
        return level(self.surprises)

    @once
    def largest_surprise(self) -> float:
        """The size of the largest surprise."""
        return max(float(self.surprises.max()), -float(self.surprises.min()))

    def is_quieter(self, limit: float) -> bool:
        """Whether `noise` is less than ``limit``."""
        some = self.surprises[:: max(1, self.size // EVERY)]
        less = 2 * within(some, limit * MEDIAN * SURPRISE_OF_NOISE)
        # Where that is so of more than half of them, it is so of their median, which takes ten times as long to find.
        return less > some.size or (less == some.size and self.noise < limit)

    def standing_out(self, times: float) -> np.ndarray:
        """Rows (from 0) whose surprise is more than ``times`` the standard deviation of the noise's own."""
        if not self.is_quieter(self.largest_surprise / (times * SURPRISE_OF_NOISE)):
            return np.zeros(0, dtype=int)
        return np.flatnonzero(np.abs(self.surprises) > times * SURPRISE_OF_NOISE * self.noise)

    @property
    def rounding(self) -> float:
        """What a step of nothing may come to in double precision."""
        return 1e-12 * max(abs(self.high), abs(self.low))

    @once
    def _moved(self) -> np.ndarray:
        """Sizes of the first steps that are more than the rounding of the values, in the order of the rows."""
        steps = np.abs(self.steps[: EVERY - 1])
        return steps[steps > self.rounding]

    @once
    def count(self) -> float | None:
        """The step of which its smaller steps are multiples; None where they are multiples of none."""
        return common_step(self._moved)

    @once
    def quantum(self) -> float:
        """What it is counted in.

        Where there is no `count`, nothing is counted that matters: the smallest step, or a thousandth of the usual one. For a
        constant 0.
        """
        if self.count is not None:
            return self.count
        steps = self._moved
        return min(1e-3 * float(np.median(steps)), float(steps.min())) if steps.size else 0.0

    def is_finer(self, limit: float) -> bool:
        """Whether `quantum` is less than ``limit``."""
        steps = self.steps[: EVERY - 1]
        # One of the smallest steps is taken: where more are below the limit, it need not be known.
        small = within(steps, limit) - within(steps, self.rounding)
        return small > max(RANKS[-1], steps.size // SHARE) or bool(self.quantum < limit)


def by_name(channels: Mapping[str, np.ndarray]) -> dict[str, Channel]:
    """Arrays of shape (N,) by name as channels."""
    return {name: Channel(values) for name, values in channels.items()}


def positions(channels: Mapping[str, Channel]) -> dict[str, Channel]:
    """The channels that are `POSITIONS`, in their order."""
    return {name: channels[name] for name in POSITIONS if name in channels}


def each(work: Callable[[Channel], Found], channels: Mapping[str, Channel]) -> dict[str, Found]:
    """What ``work`` finds in each channel; in long ones side by side."""
    longest = max((channel.size for channel in channels.values()), default=0)
    found = side_by_side(work, channels.values()) if longest > LONG else map(work, channels.values())
    return dict(zip(channels, found, strict=True))
