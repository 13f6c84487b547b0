"""Odd things about the times of a record, before they are known to be even: bursts, repeats, lost rows, another unit."""

from __future__ import annotations

import numpy as np

from jaxbacklash.records.finding import ASK, REFUSE, Finding

from .local import listed_rows

SLOW = 0.05
"""Steps [s] from which on milliseconds are thought of: 20 samples a second show few joints."""
SHORTEST = 0.5
"""Seconds that a record lasts at least (`checks.MIN_SECONDS`): what would be shorter as milliseconds is not in those."""
BURST = 3.0
"""Usual steps that a gap between bursts is at least."""


def stamps(t: np.ndarray) -> list[Finding]:
    """What is odd in the times."""
    if t.size < 8:
        return []
    steps = np.diff(t)
    back = np.flatnonzero(steps < 0)
    if back.size:
        row = int(back[0])
        more = f", and {back.size - 1} more such rows" if back.size > 1 else ""
        what = f"goes back from {t[row]:.9g} s at row {row + 1} to {t[row + 1]:.9g} s at row {row + 2}{more}"
        return [Finding("backwards", REFUSE, "t", what, f"--rate {rate_of(t):.6g}", (row,))]
    return [*_bursts(t, steps), *_unit(t, steps)]


def rate_of(t: np.ndarray) -> float:
    """Samples per second by the honest count: of all rows over all time, gaps left out.

    The usual step is no measure where times are rounded: at 800 Hz and stamps to a millisecond most steps are 1 ms, and 1000 Hz
    is wrong by a quarter. A gap is a step that is longer by more than the rounding and than all steps but a few.

    Parameters
    ----------
    t : array of shape (N,), s; may repeat, N >= 2

    Returns
    -------
    float
        In Hz; infinite where no time passes.
    """
    steps = np.diff(np.sort(t))
    mean = float(np.mean(steps))
    gaps = steps > max(BURST * mean, 5 * float(np.quantile(steps, 0.95)))
    used = float(np.sum(steps[~gaps]))
    return float(np.count_nonzero(~gaps) / used) if used > 0 else np.inf


def _bursts(t: np.ndarray, steps: np.ndarray) -> list[Finding]:
    """Stamps given when a packet arrived, not when its samples were taken; and times that repeat."""
    rate = rate_of(t)
    same = np.flatnonzero(steps == 0)
    if not same.size:
        usual, mean = float(np.median(steps)), float(np.mean(steps))
        # Most steps tiny, all time in a few: rows come in packets.
        if usual > 0.3 * mean or np.count_nonzero(steps > BURST * mean) < 4:
            return []
    long = np.flatnonzero(steps > BURST * max(float(np.median(steps)), float(np.mean(steps)) / BURST))
    if long.size >= 4 and np.median(np.diff(long)) >= 2:
        each = int(np.median(np.diff(long)))
        what = f"comes in bursts of about {each} rows, as packets arrive; if the samples are even, {rate:.6g} Hz fits all of them"
    else:
        what = f"repeats at {listed_rows(same + 1)}; if the samples are even, {rate:.6g} Hz fits all of them"
    return [Finding("bursts", ASK, "t", what, f"--rate {rate:.6g}", tuple(same.tolist()), rate)]


def _unit(t: np.ndarray, steps: np.ndarray) -> list[Finding]:
    """Milliseconds, microseconds or nanoseconds where seconds are wanted: asked wherever the record could be either."""
    step = float(np.median(steps))
    if step < SLOW:
        return []
    name, short, factor = next(
        unit for unit in (("milliseconds", "ms", 1e-3), ("microseconds", "us", 1e-6), ("nanoseconds", "ns", 1e-9))
        if step * unit[2] < SLOW or unit[1] == "ns"
    )  # fmt: skip
    if (t[-1] - t[0]) * factor < SHORTEST * (1 - 1 / t.size) and step < 60.0:
        return []
    what = f"has a step of {step:.6g}, which looks like {name} ({1 / (step * factor):.6g} Hz) unless the record is that slow"
    return [Finding("time unit", ASK, "t", what, f"--unit t={short} (t=s if it truly is in seconds)", size=factor)]
