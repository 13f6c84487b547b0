"""Odd things about the times of a record, before they are known to be even: bursts, repeats, lost rows, another unit."""

from __future__ import annotations

import numpy as np

from jaxbacklash.records.finding import ASK, REFUSE, Finding

from .local import listed_rows

SLOW = 0.05
"""Steps [s] from which on milliseconds are thought of: 20 samples a second show few joints."""
SHORTEST = 0.5
"""Seconds that a record lasts at least (`checks.MIN_SECONDS`): what would be shorter as milliseconds is not in those."""
SLOWEST = 60.0
"""Steps [s] that no record of a joint has, however long it lasts."""
BURST = 3.0
"""Mean steps that a gap between bursts is at least."""
TINY, MANY = 0.3, 0.2
"""Share of the mean step that a step within a burst stays under, and share of such steps that makes bursts."""
FEW = 10
"""Steps back, of as many usual steps each, up to which a file holds several recordings one after another."""
AGAIN = ", as where one recording follows another in a file"
ODD = 20
"""Steps of another length from which on rounding explains them, where all times stay within one unit of a straight line: as many
lost rows would have led away from it."""


def stamps(t: np.ndarray) -> list[Finding]:
    """What is odd in the times (N,), in s as far as their unit is known."""
    if t.size < 8 or not np.isfinite(t).all():
        return []
    steps = np.diff(t)
    if not steps.any():
        what = f"repeats at row 2 and is {t[0]:.9g} in every row; if the samples are even, pass --rate HZ, the samples per second"
        return [Finding("bursts", REFUSE, "t", what)]
    back = np.flatnonzero(steps < 0)
    if back.size:
        row = int(back[0])
        more = f", and {back.size - 1} more such rows" if back.size > 1 else ""
        what = f"goes back from {t[row]:.9g} s at row {row + 1} to {t[row + 1]:.9g} s at row {row + 2}{more}"
        if back.size > MANY * steps.size:  # --rate would take them in the order of the file
            return [Finding("backwards", REFUSE, "t", f"{what}: the rows are not in the order of time; sort them by time")]
        again = back.size <= FEW and bool(np.all(steps[back] < -FEW * np.median(np.abs(steps))))
        remedy = f"--to {t[row]:.9g}" if again else f"--rate {_round(t):.6g}"
        return [Finding("backwards", REFUSE, "t", f"{what}{AGAIN if again else ''}", remedy, (row,))]
    # The unit first: the rate of bursts is as wrong as the unit is.
    return [*time_unit(t), *_bursts(t, steps)]


def rate_of(t: np.ndarray) -> float:
    """Samples per second, by an honest count.

    The usual step is no measure where times are rounded: at 800 Hz and stamps to a millisecond most steps are 1 ms, and 1000 Hz
    is wrong by a quarter. Nor is the mean one where rows are missing. Rounding keeps all times within a unit of a straight line,
    whose slope is then the rate; so does a line through bursts; else it is the mean of the steps that are near the usual one.

    Parameters
    ----------
    t : array of shape (N,), s; may repeat, N >= 3

    Returns
    -------
    float
        In Hz; infinite where no time passes.

    Examples
    --------
    >>> round(rate_of(np.round(np.arange(1000) / 800.0, 3)), 1)
    800.0
    """
    t = np.sort(t)
    steps = np.diff(t)
    mean = float(np.mean(steps))
    if mean == 0.0:
        return np.inf
    slope, off = _line(t)
    usual = float(np.median(steps))
    unit = float(steps.max() - steps.min())
    odd = np.count_nonzero(np.abs(steps - usual) > unit / 4)
    in_bursts = np.count_nonzero(steps < TINY * mean) > MANY * steps.size
    if in_bursts or (odd >= ODD and off <= 0.55 * unit):
        return 1.0 / slope
    near = steps[(steps > usual / 2) & (steps < 1.5 * usual)]
    return 1.0 / float(np.mean(near))


def packet(t: np.ndarray) -> float:
    """How long samples that share a stamp, or come in a burst, last [s]: by so much a record's first and last time may be off.

    Parameters
    ----------
    t : array of shape (N,), s, N >= 2

    Returns
    -------
    float
        0 where every sample has a time of its own.
    """
    steps = np.diff(t)
    tiny = steps < TINY * float(np.mean(steps))
    return float(np.median(steps[~tiny])) if np.count_nonzero(tiny) > MANY * steps.size else 0.0


def _line(t: np.ndarray) -> tuple[float, float]:
    """Slope of the straight line through times by row, and how far they are off it at most."""
    rows = np.arange(t.size) - (t.size - 1) / 2
    since = t - t[0]
    slope = float(np.sum(rows * since) / np.sum(rows * rows))
    error = since - slope * rows
    return slope, float(error.max() - error.min()) / 2


def _round(t: np.ndarray) -> float:
    """The rate of uneven stamps as a person would set it: the roundest one that they leave open."""
    rate = rate_of(t)
    if not np.isfinite(rate) or t[-1] <= t[0]:
        return 1.0 / max(float(np.median(np.abs(np.diff(t)))), 1e-300)
    leeway = 2 * _line(np.sort(t))[1] / (t.max() - t.min())
    for digits in (1, 2, 3):
        rounded = float(f"{rate:.{digits - 1}e}")
        if abs(rounded / rate - 1.0) < leeway:
            return rounded
    return rate


def _bursts(t: np.ndarray, steps: np.ndarray) -> list[Finding]:
    """Stamps given when a packet arrived, not when its samples were taken; and times that repeat."""
    mean = float(np.mean(steps))
    same = np.flatnonzero(steps == 0)
    in_packets = np.count_nonzero(steps < TINY * mean) > MANY * steps.size
    if not same.size and not in_packets:
        return []
    rate = _round(t)
    gaps = np.flatnonzero(steps > BURST * mean)
    if in_packets and gaps.size >= 4:
        each = int(np.median(np.diff(gaps)))
        what = f"comes in bursts of about {each} rows, as packets arrive; if the samples are even, {rate:.6g} Hz fits them"
    elif not same.size:
        return []
    else:
        what = f"repeats at {listed_rows(same + 1)}; if the samples are even, {rate:.6g} Hz fits them"
    if t.size < SHORTEST * rate:
        lasts = f"lasts {t.size / rate:.3g} s in all, less than any record, so that its unit may be another"
        what = f"{what.partition(';')[0]} and {lasts}"
        return [Finding("bursts", ASK, "t", what, "--unit t=s", tuple((same + 1).tolist()), rate)]
    return [Finding("bursts", ASK, "t", what, f"--rate {rate:.6g}", tuple((same + 1).tolist()), rate)]


def time_unit(t: np.ndarray) -> list[Finding]:
    """Milliseconds, microseconds or nanoseconds where seconds are wanted: asked wherever the record could be either."""
    steps = np.diff(t)
    if steps.max() < SLOW:
        return []
    # Within a packet most steps are far shorter than a sample.
    step = float(np.mean(steps)) if packet(t) else float(np.median(steps))
    if step < SLOW:
        return []
    name, short, factor = next(
        unit for unit in (("milliseconds", "ms", 1e-3), ("microseconds", "us", 1e-6), ("nanoseconds", "ns", 1e-9))
        if step * unit[2] < SLOW or unit[1] == "ns"
    )  # fmt: skip
    if t.size * step * factor < SHORTEST * (1 - 1e-9) and step < SLOWEST:
        return []
    what = f"has a step of {step:.6g}, which looks like {name} ({1 / (step * factor):.6g} Hz) unless the record is that slow"
    return [Finding("time-unit", ASK, "t", what, f"--unit t={short}", size=factor, otherwise="--unit t=s")]
