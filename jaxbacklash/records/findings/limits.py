"""Channels at the end of what a sensor or an amplifier can show."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jaxbacklash.records.finding import WARN, Finding

from .channel import Channel
from .local import runs

CLIPPED_RUN = 5
"""Equal values at the limit that make a run."""
CLIPPED_RUNS = 3
"""Such runs that make a limit: one may be a rest, and a coarse encoder's crest is met again by few."""
STRAIGHT_ON = 0.5
"""Share of the runs of a force at its limit that it reaches and leaves by steps short beside its range: a force that is
switched between two values gets there in one step, and means it."""


def clipped(channels: Mapping[str, Channel]) -> list[Finding]:
    """Sensors at their stop, and forces that were limited."""
    # A torque that stays at its limit is what the motor put out, and a command is what was told.
    return [one for name, channel in channels.items() if name not in ("torque", "command") for one in _clipped(channel, name)]


def _clipped(channel: Channel, name: str) -> list[Finding]:
    """A sensor at its stop returns one value for as long as the motion is beyond it, again and again.

    A coarse encoder also repeats its largest count at each crest, but no oftener than a few times the count next to it.
    """
    values = channel.values
    for limit, word in ((channel.high, "largest"), (channel.low, "smallest")):
        at_limit = values == limit
        if np.count_nonzero(at_limit) < CLIPPED_RUN * CLIPPED_RUNS:
            continue
        first, lengths = runs(at_limit)
        long = lengths >= CLIPPED_RUN
        if np.count_nonzero(long) < CLIPPED_RUNS:
            continue
        if name == "F" and not _grown_into(values, first[long], lengths[long]):
            continue
        inside = values[~at_limit]
        count = np.min(np.abs(inside - limit), initial=np.inf)
        beside = np.count_nonzero(np.abs(inside - limit) <= 1.5 * count)
        if np.count_nonzero(at_limit) > 5 * beside:
            what = (
                f"the {word} value {limit:.6g} comes {np.count_nonzero(at_limit)} times, up to {lengths.max()} in a row, first "
                f"at row {first[long][0] + 1}; the {'force' if name in 'FT' else 'sensor'} looks clipped, and what lies beyond "
                "its range is lost"
            )
            return [Finding("clipped", WARN, name, what, rows=(int(first[long][0]),))]
    return []


def _grown_into(values: np.ndarray, first: np.ndarray, length: np.ndarray) -> bool:
    """Whether a force comes to its limit by small steps, as one that was cut off there does."""
    inner = (first >= 1) & (first + length < values.size)
    if not inner.any():
        return False
    limit, range_ = values[first[0]], values.max() - values.min()
    steps = np.abs(np.stack([values[first[inner] - 1], values[(first + length)[inner]]]) - limit)
    return float(np.mean(steps < range_ / 4)) > STRAIGHT_ON
