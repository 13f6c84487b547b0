"""Samples that were never measured: codes for a failed reading, and single samples far from what the motion allows."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jaxbacklash.records.finding import ASK, WARN, Finding

from .local import POSITIONS, SURPRISE_OF_NOISE, around, bridge, level, listed_rows, quantum, runs, surprise

CLEAR = 20.0
"""Times what is usual around it that a spike is at least. The corner that an impact leaves in a position looks like a spike to 86
percent; this far above noise the other 14 tell them apart."""
FAR_OUT = 2.0
"""Ranges of all other samples by which a code such as -9999 lies beyond them."""
FROM_ZERO = 8.0
"""Times the steps around it by which the samples before and after a failed reading written as 0 are off zero."""
BESIDE = 9
"""Rows to either side in which the steps beside a 0 are looked at."""
FEW = 1e-3
"""Share of the samples up to which they are bridged with a warning, without being asked; three always are. What so few samples
lose is nothing beside the noise of the others."""
MOST = 0.05
"""Share of the samples beyond which they are no exceptions: how the channel moves."""


_NONE = np.zeros(0, dtype=int)


def codes(channels: Mapping[str, np.ndarray]) -> list[Finding]:
    """Codes for failed readings, in every channel."""
    found = []
    for name, values in channels.items():
        rows, what = code_rows(values)
        if rows.size:
            found.append(_bridged_or_asked("sentinel", name, values, rows, f"hold{'s' if rows.size == 1 else ''} {what}"))
    return found


def spikes(channels: Mapping[str, np.ndarray]) -> list[Finding]:
    """Single samples that stand out, in x, y and z."""
    found = []
    for name in POSITIONS:
        rows = spike_rows(channels[name]) if name in channels else _NONE
        if rows.size:
            what = f"stand{'s' if rows.size == 1 else ''} out alone from the motion around"
            found.append(_bridged_or_asked("spike", name, channels[name], rows, what))
    return found


def _bridged_or_asked(kind: str, name: str, values: np.ndarray, rows: np.ndarray, what: str) -> Finding:
    """A finding that bridges few samples of a position, and asks where they are many or a force's."""
    every = tuple(rows.tolist())
    if name in POSITIONS and rows.size <= max(3, FEW * values.size):
        what = f"{listed_rows(rows)} {what}; bridged by the samples around"
        return Finding(kind, WARN, name, what, rows=every, bridged=every)
    return Finding(kind, ASK, name, f"{listed_rows(rows)} {what}", f"--despike {name}", every)


def bad_rows(values: np.ndarray) -> np.ndarray:
    """Rows (from 0) that `--despike` replaces: codes, and spikes among what is left."""
    rows = code_rows(values)[0]
    return np.union1d(rows, spike_rows(bridge(values, rows)))


def code_rows(values: np.ndarray) -> tuple[np.ndarray, str]:
    """Rows of a value that stands for none: far beyond all others, or 0 between samples that are not near it."""
    rows, first = _NONE, 0.0
    good = np.ones(values.size, dtype=bool)
    for _ in range(3):  # -9999 and 9999 may both be there
        kept = values[good]
        for code, rest in ((kept.max(), kept[kept < kept.max()]), (kept.min(), kept[kept > kept.min()])):
            if rest.size < (1.0 - MOST) * values.size:
                continue
            span = rest.max() - rest.min()
            if min(abs(code - rest.max()), abs(code - rest.min())) > FAR_OUT * span > 0:
                new = np.flatnonzero(good & (values == code))
                # One value far out is a spike, unless it is so far that no sensor's range holds both.
                if new.size > 1 or abs(code) > 50 * max(abs(rest.max()), abs(rest.min())):
                    rows, first = np.union1d(rows, new), first if rows.size else code
                    good[new] = False
                    break
        else:
            break
    if rows.size:
        return rows, f"{first:.6g}, far beyond all others: a reading that failed"
    return _zeros(values), "exactly 0 between samples far from it: a reading that failed"


def _zeros(values: np.ndarray) -> np.ndarray:
    """Rows of exactly 0 that their neighbours contradict; all such rows, once three are sure."""
    zero = values == 0.0
    count = np.count_nonzero(zero)
    if not 0 < count < MOST * values.size:
        return _NONE
    first, length = runs(zero)
    last = first + length - 1
    inside = (first >= 4) & (last < values.size - 4)
    first, last = first[inside], last[inside]
    if not first.size:
        return _NONE
    before, after = values[first - 1], values[last + 1]
    steps = np.abs(np.diff(values))
    near = np.arange(2, BESIDE)
    usual = np.maximum(
        np.max(steps[np.maximum(first[:, None] - near, 0)], axis=1),
        np.max(steps[np.minimum(last[:, None] + near - 1, steps.size - 1)], axis=1),
    )
    usual = np.maximum(usual, np.abs(after - before) / (last - first + 2))
    nearest = np.minimum(np.abs(before), np.abs(after))
    # A coarse encoder's noise is counts to and fro, and rests in between.
    sure = (before * after > 0) & (nearest > FROM_ZERO * np.maximum(usual, quantum(values)))
    if np.count_nonzero(sure) < 3:
        rows = [np.arange(a, b + 1) for a, b in zip(first[sure], last[sure], strict=True)]
        return np.concatenate([_NONE, *rows])
    off = np.abs(before + after) / 2 > 2 * usual
    return np.concatenate([_NONE, *(np.arange(a, b + 1) for a, b in zip(first[sure | off], last[sure | off], strict=True))])


def spike_rows(values: np.ndarray) -> np.ndarray:
    """Rows of single samples that stand out, up to three in a row."""
    found = _NONE
    r = surprise(values)
    floor = max(level(r) * SURPRISE_OF_NOISE, 0.3 * quantum(values))
    for _ in range(3):  # spikes close together hide one another
        rows = np.flatnonzero(np.abs(r) > 0.5 * CLEAR * floor)
        if not rows.size or rows.size > MOST * 5 * values.size:
            break
        new = _single(r, rows, floor)
        if not new.size:
            break
        found = np.union1d(found, new)
        r = surprise(bridge(values, found))
    return found if found.size <= MOST * values.size else _NONE


_SPIKE = np.array([1.0, -4.0, 6.0, -4.0, 1.0]) / 6.0


def _single(r: np.ndarray, rows: np.ndarray, floor: float) -> np.ndarray:
    """The rows at which the surprises are those of one sample that is off, and of nothing else."""
    rows = rows[(rows >= 4) & (rows < r.size - 4)]
    if not rows.size:
        return _NONE
    usual = np.maximum(around(np.abs(r), rows), floor)
    seen = r[rows[:, None] + np.arange(-2, 3)]
    size = seen @ _SPIKE / (_SPIKE @ _SPIKE)
    left = np.sqrt(np.mean((seen - size[:, None] * _SPIKE) ** 2, axis=1))
    return rows[(np.abs(size) > CLEAR * usual) & (left < 1.8 * usual + 0.02 * np.abs(size))]
