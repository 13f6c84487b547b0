"""Samples that were never measured: codes for a failed reading, and single samples far from what the motion allows."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jaxbacklash.records.finding import ASK, WARN, Finding

from .channel import POSITIONS, Channel, each, positions
from .local import SURPRISE_OF_NOISE, around, bridge, listed_rows, runs

CLEAR = 20.0
"""Times what is usual around it that a spike is at least. The corner that an impact leaves in a position looks like a spike to 86
percent; this far above noise the other 14 tell them apart."""
FAR_OUT = 2.0
"""Ranges of all other samples by which a code such as -9999 lies beyond them."""
TOGETHER, LONGEST = 4, 40
"""Samples that may stand out near one another, and rows over which they may."""
ADJACENT = 5.0
"""Times as clear that samples next to one another must be."""
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


def codes(channels: Mapping[str, Channel]) -> list[Finding]:
    """Codes for failed readings, in every channel."""
    found = []
    for name, (rows, what) in each(code_rows, channels).items():
        if rows.size:
            what = f"hold{'s' if rows.size == 1 else ''} {what}"
            found.append(_bridged_or_asked("sentinel", name, channels[name].size, rows, what))
    return found


def spikes(channels: Mapping[str, Channel]) -> list[Finding]:
    """Single samples that stand out, in x, y and z."""
    found = []
    for name, rows in each(spike_rows, positions(channels)).items():
        if rows.size:
            what = f"stand{'s' if rows.size == 1 else ''} out alone from the motion around"
            found.append(_bridged_or_asked("spike", name, channels[name].size, rows, what))
    return found


def _bridged_or_asked(kind: str, name: str, size: int, rows: np.ndarray, what: str) -> Finding:
    """A finding that bridges few of the ``size`` samples of a position, and asks where they are many or a force's."""
    every = tuple(rows.tolist())
    if name in POSITIONS and rows.size <= max(3, FEW * size):
        what = f"{listed_rows(rows)} {what}; bridged by the samples around"
        return Finding(kind, WARN, name, what, rows=every, bridged=every)
    return Finding(kind, ASK, name, f"{listed_rows(rows)} {what}", f"--despike {name}", every)


def bad_rows(channel: Channel) -> np.ndarray:
    """Rows (from 0) that `--despike` replaces: codes, and spikes among what is left."""
    rows = code_rows(channel)[0]
    return np.union1d(rows, spike_rows(Channel(bridge(channel.values, rows)) if rows.size else channel))


def code_rows(channel: Channel) -> tuple[np.ndarray, str]:
    """Rows of a value that stands for none: far beyond all others, or 0 between samples that are not near it."""
    values = channel.values
    rows, first = _NONE, 0.0
    good = np.ones(values.size, dtype=bool)
    for _ in range(3 if _reaches_out(channel) else 0):  # -9999 and 9999 may both be there
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
    return _zeros(channel), "exactly 0 between samples far from it: a reading that failed"


def _reaches_out(channel: Channel) -> bool:
    """Whether the largest or the smallest value may be a code.

    A quick look that misses none: some of the samples between them span no more than all of them do.
    """
    some = channel.values[:: max(1, channel.size // 256)]
    high, low = channel.high, channel.low
    some = some[(some < high) & (some > low)]
    if not some.size:
        return True
    top, bottom = some.max(), some.min()
    return bool(max(high - top, bottom - low) > FAR_OUT * (top - bottom))


def _zeros(channel: Channel) -> np.ndarray:
    """Rows of exactly 0 that their neighbours contradict; all such rows where a finely read channel has three of them."""
    values = channel.values
    zero = values == 0.0
    count = np.count_nonzero(zero)
    if not 0 < count < MOST * values.size:
        return _NONE
    first, length = runs(zero)
    last = first + length - 1
    inside = (first >= 4) & (last < values.size - 4)
    first, last = first[inside], last[inside]
    before, after = values[first - 1], values[last + 1]
    same_side = before * after > 0
    if not same_side.any():  # the channel passes 0
        return _NONE
    steps = np.abs(np.diff(bridge(values, np.flatnonzero(zero))))
    near = np.arange(2, BESIDE)
    usual = np.maximum(
        np.max(steps[np.maximum(first[:, None] - near, 0)], axis=1),
        np.max(steps[np.minimum(last[:, None] + near - 1, steps.size - 1)], axis=1),
    )
    usual = np.maximum(usual, np.abs(after - before) / (last - first + 2))
    nearest = np.minimum(np.abs(before), np.abs(after))
    off = same_side & (nearest > 2 * usual)
    if not off.any():
        return _NONE
    off &= nearest > 2 * channel.quantum
    # A coarse encoder's noise is counts to and fro, and rests in between.
    sure = off & (nearest > FROM_ZERO * np.maximum(usual, channel.quantum))
    # So finely read that hardly a crossing of zero hits it: then zeros that are not near it, and few others, are failed readings.
    hits = np.count_nonzero(values[1:] * values[:-1] < 0) * channel.quantum / max(float(np.median(steps)), 1e-300)
    if np.count_nonzero(off) >= 3 and hits < 0.1 * np.count_nonzero(off):
        sure = np.ones(first.size, dtype=bool)
    return np.concatenate([_NONE, *(np.arange(a, b + 1) for a, b in zip(first[sure], last[sure], strict=True))])


def spike_rows(channel: Channel) -> np.ndarray:
    """Rows (from 0) of samples that stand out of the motion, alone or a few near one another."""
    rows = channel.standing_out(0.4 * CLEAR)
    if not rows.size:
        return _NONE
    r = channel.surprises
    floor = max(channel.noise * SURPRISE_OF_NOISE, 0.3 * channel.quantum)
    size = np.abs(r)
    rows = rows[size[rows] > 0.4 * CLEAR * floor]
    rows = rows[(rows >= 4) & (rows < channel.size - 4)]
    if not rows.size or rows.size > 5 * MOST * channel.size:
        return _NONE
    usual = np.maximum(around(size, rows), floor)
    # At least the middle of a spike, six parts of nine of all that it leaves, is as clear as that.
    rows = rows[size[rows] > 0.6 * CLEAR * usual]
    if not rows.size:
        return _NONE
    found = [_spikes_of(r, cluster, floor) for cluster in np.split(rows, np.flatnonzero(np.diff(rows) > 4) + 1)]
    every = np.concatenate([_NONE, *found])
    return every if every.size <= MOST * channel.size else _NONE


def _spikes_of(r: np.ndarray, cluster: np.ndarray, floor: float) -> np.ndarray:
    """The fewest samples of a cluster of surprises that, being off, explain all of it; none where a few do not."""
    low, high = int(cluster[0]) - 2, int(cluster[-1]) + 3
    if high - low > LONGEST:
        return _NONE
    seen = r[low:high]
    # The surprises that each sample of the stretch would leave, if it were off by 1.
    inner = np.arange(2, seen.size - 2)
    left_by = np.zeros((seen.size, inner.size))
    for column, row in enumerate(inner):
        left_by[row - 2 : row + 3, column] = _SPIKE
    usual = max(float(around(np.abs(r), np.array([low + 2, high - 3]), share=0.75).max()), floor)
    chosen: list[int] = []
    left, sizes = seen, np.zeros(0)
    while len(chosen) < min(TOGETHER, inner.size):
        chosen.append(int(np.argmax(np.abs(left_by.T @ left))))
        sizes = np.linalg.lstsq(left_by[:, chosen], seen, rcond=None)[0]
        left = seen - left_by[:, chosen] @ sizes
        if np.sqrt(np.mean(left**2)) < 1.8 * usual + 0.02 * float(np.max(np.abs(sizes))):
            break
    else:
        return _NONE
    # Several next to one another may bend to whatever shape; then they must be clearer.
    clear = CLEAR if np.min(np.diff(np.sort(chosen)), initial=9) > 2 else ADJACENT * CLEAR
    return np.sort(inner[chosen]) + low if float(np.min(np.abs(sizes))) > clear * usual else _NONE


_SPIKE = np.array([1.0, -4.0, 6.0, -4.0, 1.0]) / 6.0
