"""Whether and from when on the observed channel answers: noise alone, a link held first, a drive not named, stale first rows."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jaxbacklash.records.finding import ASK, REFUSE, WARN, Finding

from .channel import Channel
from .local import EVERY, SURPRISE_OF_NOISE

LEVELS = 3
"""Values up to which a channel is below its own resolution."""
LAGS = 64
"""Lags over which a channel without an answer is white."""
WHITE = 5.0
"""Standard errors of a correlation of white noise that its largest stays under; one of 64 exceeds 4 in one record of 250."""
HELD = 32
"""Rows at the beginning from which on a standstill is spoken of."""
LET_GO = 0.05
"""Share of the way from where a link is held to its rest beyond which it is let go."""
FAR = 40.0
"""Times the noise that it is held off its rest at least."""
PARTS, PLACES = 6, ("first", "second", "third", "fourth", "fifth", "last")
"""Parts of a record of a link alone whose motion is compared, and how they are called."""
GROWN, SWINGS = 1.5, 4
"""Times the motion of an earlier part by which a later one exceeds it where something drives the link, and passages of its middle
that each of them shows: less than two swings may be any part of one."""
LASTS = 0.5
"""Share of its largest motion that such a link has left at the end: what was struck, or beats with another part, dies away."""
CORNER = 1.5
"""Times the sharpest corner anywhere else that the end of stale first rows is at least: they end at full speed in one sample."""
FIRST = 12
"""First rows that may be stale: what a buffer or a delay fills."""


def answers(t: np.ndarray, channels: Mapping[str, Channel]) -> list[Finding]:
    """What the observed channel (z, y or T, link or motor of a drive) lacks."""
    name = next((one for one in ("z", "y", "T", "link", "motor") if one in channels), None)
    if name is None:
        return []
    channel = channels[name]
    drive = next((one for one in ("x", "F", "torque", "command") if one in channels), None)
    found = _nothing(channel, name, drive)
    if found:
        return found
    if drive is None:
        return _held_first(t, channel, name) or _driven(channel, name)
    return _stale_first(channel, name) if name != "T" else []


def _nothing(channel: Channel, name: str, drive: str | None) -> list[Finding]:
    """A channel of noise alone, or of two or three counts."""
    span, values = channel.span, channel.values
    if span == 0.0:
        return []  # `checks.moving` says so
    moved = f" while {drive} moves" if drive else ""
    if not channel.is_finer(span / LEVELS) and span < (LEVELS - 0.5) * channel.quantum:
        count = channel.quantum
        what = f"takes {round(span / count) + 1} values only{moved}: its answer is below its resolution of {count:.3g}"
        return [Finding("no-answer", REFUSE, name, what)]
    some = values[:EVERY] - np.mean(values[:EVERY])
    power = float(np.einsum("i,i", some, some))
    if power == 0.0:
        return []
    for lag in range(1, min(LAGS, some.size // 4)):
        # Not by BLAS, whose threads take longer to begin than this takes.
        if abs(float(np.einsum("i,i", some[lag:], some[:-lag]))) > WHITE * power / np.sqrt(some.size):
            return []
    what = f"shows white noise of {np.std(values):.3g} and nothing else{moved}: there is no answer to fit"
    return [Finding("no-answer", REFUSE, name, what)]


def _held_first(t: np.ndarray, channel: Channel, name: str) -> list[Finding]:
    """A free decay whose link was held at first: it stays off its rest for longer than it then takes to swing back.

    A hand does not hold still to the noise, so what counts as held is a twentieth of the way to rest. A link that is let go in
    the first row is there for a quarter of the time that it takes to swing back.
    """
    values = channel.values
    rest = float(np.mean(values[-max(HELD, values.size // 10) :]))
    base = float(np.median(values[:HELD]))
    way = abs(base - rest)
    noise = channel.noise
    left = np.flatnonzero(np.abs(values - base) > LET_GO * way)
    back = np.flatnonzero((values - rest) * (base - rest) < 0)
    if way < FAR * noise or not (left.size and back.size) or not HELD <= left[0] < back[0]:
        return []
    swing = int(back[0] - left[0])
    if left[0] < swing:
        return []
    # Back from there to where it is still where it was just before; the first rows of the fall may go with them.
    before = values[max(left[0] - 2 * swing, 0) : left[0] - swing // 2]
    still = np.abs(values[: left[0]] - np.median(before)) <= 4 * max(float(np.std(before)), noise)
    release = int(np.flatnonzero(still)[-1]) + 1 if still.any() else int(left[0])
    what = (
        f"stays at {base:.4g} up to row {release} ({t[release - 1]:.6g} s) before it swings: the link was held, and "
        "those rows are left out (--from 0 keeps them)"
    )
    return [Finding("held-first", WARN, name, what, rows=(0, release - 1), size=float(t[release - 1]), left_out=release)]


def _driven(channel: Channel, name: str) -> list[Finding]:
    """A motion that grows where nothing is said to drive it: what a passive joint does alone dies away."""
    parts = np.array_split(channel.values, PARTS)
    sizes = [float(np.std(part)) for part in parts]
    most = int(np.argmax(sizes))
    least = int(np.argmin(sizes[: most + 1]))
    swings = min(np.count_nonzero(np.diff(parts[n] > np.mean(parts[n]))) for n in (least, most))
    grows = sizes[most] > max(GROWN * sizes[least], FAR * channel.noise) and swings >= SWINGS
    if not grows or sizes[-1] < LASTS * sizes[most]:
        return []
    what = (
        f"stands alone and is read as a free decay, but grows from {sizes[least]:.3g} rms in the {PLACES[least]} sixth to "
        f"{sizes[most]:.3g} in the {PLACES[most]}; name what drives it (--columns x=NAME the base, F=NAME a force), or keep the "
        "part that dies away (--from, --to)"
    )
    return [Finding("driven", ASK, name, what, size=sizes[most] / max(sizes[least], 1e-300))]


def _stale_first(channel: Channel, name: str) -> list[Finding]:
    """First rows that repeat one value, until the channel goes on at full speed."""
    values, surprises = channel.values, channel.surprises
    if values.size < 4 * FIRST:
        return []
    start = channel if channel.size <= EVERY else Channel(values[:EVERY])
    moved = np.abs(values[: FIRST + 2] - values[0])
    if start.is_quieter(moved[1] / 5) and channel.is_finer(moved[1] / 1.5):
        return []  # at speed from the first row on
    noise = max(start.noise, 0.3 * channel.quantum)
    still = moved < 5 * noise
    if still.all():
        return []
    last = int(np.argmin(still)) - 1  # the last row that is still
    if not 1 <= last <= FIRST:
        return []
    here = float(np.max(np.abs(surprises[max(last - 1, 2) : last + 3])))
    # The first samples, where they have as sharp a corner, save going through all.
    for some in (surprises[:EVERY], surprises):
        elsewhere = float(np.max(np.abs(some[last + 6 :])))
        if here < CORNER * max(elsewhere, SURPRISE_OF_NOISE * noise):
            return []
    what = f"repeats its first value up to row {last + 1} and then goes on at full speed; those rows are stale and left out"
    return [Finding("stale-first", WARN, name, what, rows=tuple(range(last + 1)), left_out=last + 1)]
