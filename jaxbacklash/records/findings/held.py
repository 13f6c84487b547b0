"""Samples that repeat the one before: a channel refreshed more seldom than it is written, single stale samples, whole rows."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jaxbacklash.records.finding import ASK, WARN, Finding

from .local import listed_rows, quantum, runs

HELD_ROWS = 4
"""Equal rows from which on they count as filled with the last one, where they end in a jump."""
REGULAR = 0.8
"""Share of the runs of equal values that have one length, where a channel is refreshed every k-th sample."""
LIVELY = 6.0
"""Counts by which the samples around a stale one differ at least: an encoder that moves by less may well repeat itself."""
FEW_STALE = 3
"""Stale samples by which counting alone could explain twice as many as there are; fewer are not spoken of."""


def held(channels: Mapping[str, np.ndarray]) -> list[Finding]:
    """Channels that hold their value."""
    rows = _held_rows(list(channels.values()))
    if rows:
        return rows
    found = []
    for name, values in channels.items():
        every = refreshed_every(values)
        if every > 1:
            what = f"has a new value every {every} rows only and holds it in between, rows 1 to {every} first"
            found.append(Finding("held", ASK, name, what, f"--despike {name}", size=float(every)))
            continue
        stale = stale_rows(values)
        if stale.size:
            what = f"{listed_rows(stale)} repeat{'s' if stale.size == 1 else ''} the value before while the motion goes on"
            few = stale.size <= max(3, 1e-3 * values.size)
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


def refreshed_every(values: np.ndarray) -> int:
    """k where a channel has a new value every k-th row only and keeps it in between; 1 where it has one in every row."""
    changes = np.flatnonzero(np.diff(values))
    if changes.size < 16 or changes.size > 0.6 * values.size:
        return 1
    lengths = np.diff(changes)
    every = int(np.median(lengths))
    if every < 2 or np.count_nonzero(lengths % every == 0) < REGULAR * lengths.size:
        return 1
    # A coarse encoder at a steady speed also counts regularly, but by single counts.
    steps = np.abs(np.diff(values[changes]))
    return every if np.median(steps) > LIVELY / 2 * quantum(values) else 1


def stale_rows(values: np.ndarray) -> np.ndarray:
    """Rows (from 0) that repeat the value before though the channel moves by many counts there."""
    none = np.zeros(0, dtype=int)
    still = np.flatnonzero(np.diff(values) == 0.0) + 1
    if not still.size or still.size > 0.9 * values.size:
        return none
    count = quantum(values)
    every = refreshed_every(values)
    if every > 1:
        return still
    if still.size > 0.2 * values.size:
        return none
    inside = still[(still >= 3) & (still < values.size - 2)]
    first, length = runs(np.isin(np.arange(values.size), inside))
    first, length = first[length <= HELD_ROWS], length[length <= HELD_ROWS]
    last = np.minimum(first + length, values.size - 2)
    # The motion before and after goes the same way, by many counts a sample, and makes good what was missed.
    before, after = values[first - 1] - values[first - 3], values[last + 1] - values[last]
    catch_up = np.abs(values[last] - values[first - 1])
    usual = np.minimum(np.abs(before) / 2, np.abs(after))
    moving = (np.sign(before) == np.sign(after)) & (np.sign(values[last] - values[first - 1]) == np.sign(after))
    lively = moving & (usual > LIVELY * count) & (catch_up > 1.5 * usual)
    first, length = first[lively], length[lively]
    rows = np.concatenate([none, *(np.arange(a, a + n) for a, n in zip(first, length, strict=True))])
    by_chance = _repeats_by_chance(values, count)
    return rows if rows.size >= FEW_STALE + 2 * by_chance else none


def _repeats_by_chance(values: np.ndarray, count: float) -> float:
    """Repeats that rounding makes among lively steps: about half as many as there are steps of just so many counts."""
    return float(np.count_nonzero(np.abs(np.abs(np.diff(values, 1)) - LIVELY * count) < 0.5 * count)) / 2.0


def _held_rows(columns: list[np.ndarray]) -> list[Finding]:
    """Samples lost and filled with the last one: all channels stand still together, then jump by more than one step."""
    still = np.all([np.diff(values) == 0 for values in columns], axis=0)
    ends = np.flatnonzero(still[:-1] & ~still[1:])
    if not ends.size:
        return []
    lengths = runs(still)[1][: ends.size] + 1
    jumps = np.zeros(ends.size, dtype=bool)
    for values in columns:
        steps = np.abs(np.diff(values))
        moved = steps[steps > 0]
        if moved.size:
            # An encoder at a turning point also stands still, but leaves it by one count.
            jumps |= steps[ends + 1] > 3 * np.median(moved)
    rows = np.flatnonzero(jumps & (lengths >= HELD_ROWS))
    if not rows.size:
        return []
    first = ends[rows[0]] - lengths[rows[0]] + 2
    what = (
        f"{rows.size} stretches of up to {lengths[rows].max()} equal rows end in a jump, the first at row {first + 1}; "
        "samples look lost and filled with the last value"
    )
    return [Finding("held rows", WARN, "", what, rows=(int(first),))]
