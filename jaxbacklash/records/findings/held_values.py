"""Samples that repeat the one before: a channel refreshed more seldom than it is written, single stale samples, whole rows."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jaxbacklash.records.finding import ASK, WARN, Finding

from .channel import Channel, each
from .local import EVERY, MEDIAN, RANKS, SURPRISE_OF_NOISE, common_step, listed_rows, runs

HELD_ROWS = 4
"""Equal rows from which on they count as filled with the last one, where they end in a jump."""
REGULAR = 0.8
"""Share of the runs of equal values that have one length, where a channel is refreshed every k-th sample."""
LIVELY = 6.0
"""Counts by which the samples around a stale one differ at least: an encoder that moves by less may well repeat itself."""
FEW_STALE = 3
"""Stale samples that are not spoken of: fewer do no harm that can be told from chance."""
BY_CHANCE = 3.0
"""Times the repeats that counting brings by chance that there are at least."""
FINE, BLOCK = 0.2, 32
"""Share of the noise below which a count is fine, and samples of a stretch in which the noise is looked at."""
GROUPS, FEWEST, SOME = 64, 1000, 16
"""Groups of steps between samples of like size at most, steps in a group at least, and those other than 0 that tell
its count: a file with a fixed number of digits is written ten times more coarsely from one power of ten to the next."""
MOST = 0.2
"""Share of the samples up to which they are called stale; beyond it the channel is coarse or at rest."""


def held_values(channels: Mapping[str, Channel]) -> list[Finding]:
    """Channels that hold their value; of a force that is how amplifiers put it out."""
    channels = {name: channel for name, channel in channels.items() if name != "F"}
    found = []
    for name, (every, stale) in each(_refreshed_and_stale, channels).items():
        if every > 1:
            what = f"has a new value every {every} rows only and holds it in between"
            found.append(Finding("held", ASK, name, what, f"--despike {name}", size=float(every)))
            continue
        if stale.size:
            # Whole rows that stand still for longer are said by `held_rows`.
            stale = np.setdiff1d(stale, _still_together(channels))
        if stale.size >= FEW_STALE:
            what = f"{listed_rows(stale)} repeat{'s' if stale.size == 1 else ''} the value before while the motion goes on"
            few = stale.size <= max(3, 1e-3 * channels[name].size)
            rest = "; bridged by the samples around" if few else ""
            found.append(
                Finding(
                    "stale",
                    WARN if few else ASK,
                    name,
                    f"{what}{rest}",
                    "" if few else f"--despike {name}",
                    tuple(stale.tolist()),
                    bridged=tuple(stale.tolist()) if few else (),
                )
            )
    return found


def _still_together(channels: Mapping[str, Channel]) -> np.ndarray:
    """Rows of long stretches in which several channels all repeat the value before."""
    if len(channels) < 2:
        return np.zeros(0, dtype=int)
    first, length = runs(np.logical_and.reduce([channel.rests for channel in channels.values()]))
    rows = [np.arange(a + 1, a + n + 1) for a, n in zip(first, length, strict=True) if n >= HELD_ROWS - 1]
    return np.concatenate([np.zeros(0, dtype=int), *rows])


def _refreshed_and_stale(channel: Channel) -> tuple[int, np.ndarray]:
    every = refreshed_every(channel)
    return every, stale_rows(channel, every)


def refreshed_every(channel: Channel) -> int:
    """k where a channel has a new value every k-th row only and keeps it in between; 1 where it has one in every row."""
    values = channel.values
    if not 16 <= channel.steps.size - channel.repeats <= 0.6 * values.size:
        return 1
    changes = np.flatnonzero(channel.steps)
    lengths = np.diff(changes)
    every = int(np.median(lengths))
    if every < 2 or np.count_nonzero(lengths % every == 0) < REGULAR * lengths.size:
        return 1
    # A coarse encoder at a steady speed also counts regularly, but by single counts.
    steps = np.abs(np.diff(values[changes]))
    return every if np.median(steps) > LIVELY / 2 * channel.quantum else 1


def stale_rows(channel: Channel, every: int | None = None) -> np.ndarray:
    """Rows (from 0) that repeat the value before though the channel is too finely read, or moves too fast, for that by chance.

    ``every`` is what `refreshed_every` gives for the channel, where that is known.
    """
    none = np.zeros(0, dtype=int)
    if channel.repeats < FEW_STALE:
        return none
    values, rests = channel.values, channel.rests
    # Longer runs are a rest, or what `held_rows` speaks of.
    length = runs(rests)[1]
    still = np.flatnonzero(rests)[np.repeat(length < HELD_ROWS, length)] + 1
    if still.size < FEW_STALE or still.size > MOST * values.size or (every or refreshed_every(channel)) > 1:
        return none
    # Whatever the count turns out to be, it is not less than the quantum: so most channels need not be sorted by size.
    overtaken = _overtaken(values, rests, channel.quantum).size >= FEW_STALE
    if not overtaken and still.size < FEW_STALE + BY_CHANCE * _at_least(channel):
        return none
    coarsest, repeats = _by_size(channel)
    count = max(channel.quantum, coarsest)
    size = np.abs(channel.steps)
    single = (size > 0.5 * count) & (size < 1.5 * count)
    repeats = max(repeats, np.count_nonzero(single) / 2)
    # Where noise is many counts even at the quietest, repeats are by chance half as many as steps of a single count to and fro.
    if count < FINE * _quietest(channel) and still.size >= FEW_STALE + BY_CHANCE * repeats:
        # A limit that is met again and again is another finding, see `limits`.
        return still[(values[still] < channel.high) & (values[still] > channel.low)]
    rows = _overtaken(values, rests, count) if overtaken else none
    if rows.size < FEW_STALE:
        return none
    # Samples that move by a single count amid fast motion are as rare as those that do not move at all, but for stale ones.
    expected = _overtaken(values, single, count).size / 2
    return rows if rows.size >= FEW_STALE + BY_CHANCE * expected else none


def _at_least(channel: Channel) -> float:
    """The fewest repeats that counting brings by chance, whatever count `_by_size` would find: half as many as steps near it.

    That count is a step of the channel and not smaller than its quantum, and in some group hardly any step is smaller than it.
    Near it are at least the steps in its own half of an octave and in the half below.
    """
    if channel.count is None:
        return 0.0
    steps = np.abs(channel.steps)
    # The first 13 bits of a number in double precision are its sign, its octave and the half of that.
    half = np.append(steps[steps > 0.0], channel.count).view(np.int64) >> 51
    first = int(half.min())
    found = np.bincount(half - first)
    found[half[-1] - first] -= 1
    near = found + np.append(0, found[:-1])
    not_smaller = np.cumsum(found[::-1])[::-1]
    may_be = (found > 0) & (not_smaller >= min(FEWEST, steps.size) - channel.repeats - RANKS[-1])
    may_be[: half[-1] - first] = False
    return float(near[may_be].min()) / 2 if may_be.any() else 0.0


def _by_size(channel: Channel) -> tuple[float, float]:
    """The coarsest count of any group of samples of like size, and the repeats that counting brings by chance in all of them.

    Zero where the steps are multiples of none: then too few of them are small for a repeat by chance.
    """
    steps, before, after = np.abs(channel.steps), channel.values[:-1], channel.values[1:]
    if steps.size > EVERY:
        # Of a long record the smallest steps: only these tell what it is counted in.
        some = steps[:: max(1, steps.size // EVERY)]
        rows = np.flatnonzero(steps <= np.quantile(some, EVERY / steps.size))
        steps, before, after = steps[rows], before[rows], after[rows]
    size = np.maximum(np.abs(before), np.abs(after))
    coarsest, repeats = 0.0, 0.0
    for group in np.array_split(np.argsort(size), min(max(steps.size // FEWEST, 1), GROUPS)):
        found = steps[group]
        found = found[found > 1e-12 * size[group[-1]]]
        count = common_step(found)
        if count is not None and found.size > SOME:
            coarsest = max(coarsest, count)
            # Steps of a single count to and fro are twice as many as those of none.
            repeats += np.count_nonzero(found < 1.5 * count) / 2
    return coarsest, repeats


def _quietest(channel: Channel) -> float:
    """The noise of a channel where it moves least: the lowest tenth of its stretches."""
    blocks = channel.surprises[: channel.size // BLOCK * BLOCK].reshape(-1, BLOCK)
    blocks = np.abs(blocks[:: max(1, channel.size // EVERY), 2:-2])
    return float(np.quantile(np.median(blocks, axis=1), 0.1)) / (MEDIAN * SURPRISE_OF_NOISE)


def _overtaken(values: np.ndarray, small: np.ndarray, count: float) -> np.ndarray:
    """Rows after small steps (N - 1,) around which the motion goes on one way by many counts a sample, and catches up."""
    first, length = runs(small)
    ok = (first >= 2) & (first + length < values.size - 3) & (length <= HELD_ROWS)
    first, length = first[ok], length[ok]
    last = first + length
    before, after = (values[first] - values[first - 2]) / 2, (values[last + 3] - values[last + 1]) / 2
    here = values[last + 1] - values[last]
    usual = np.minimum(np.abs(before), np.abs(after))
    onward = (np.sign(before) == np.sign(after)) & (np.sign(here) == np.sign(after))
    found = onward & (usual > LIVELY * count) & (np.abs(here) > 1.5 * usual)
    first, length = first[found], length[found]
    return np.repeat(first + 1 + length - np.cumsum(length), length) + np.arange(length.sum())


def held_rows(channels: Mapping[str, Channel]) -> list[Finding]:
    """Samples lost and filled with the last one: all channels stand still together, then jump by more than one step."""
    still = np.logical_and.reduce([channel.rests for channel in channels.values()])
    first, lengths = runs(still)
    long = (lengths + 1 >= HELD_ROWS) & (first + lengths < still.size)
    if not long.any():
        return []
    first, lengths = first[long], lengths[long]
    jumps = np.zeros(first.size, dtype=bool)
    for channel in channels.values():
        steps = np.abs(channel.steps)
        moved = steps[steps > 0]
        if moved.size:
            # An encoder at a turning point also stands still, but leaves it by one count.
            jumps |= steps[first + lengths] > 3 * np.median(moved)
    if not jumps.any():
        return []
    first, lengths = first[jumps], lengths[jumps]
    what = (
        f"{first.size} stretches of up to {lengths.max() + 1} equal rows end in a jump, the first at row {first[0] + 1}; "
        "samples look lost and filled with the last value"
    )
    return [Finding("held-rows", WARN, "", what, rows=(int(first[0]),))]
