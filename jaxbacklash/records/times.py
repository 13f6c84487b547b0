"""A column of times of any writing as seconds from its own first sample, with a sentence on how it was read.

Stamps of text are the matter of `stamps`. Here are numbers too large or too fine to be seconds of a record: time since 1970
in s, ms, us or ns, days of spreadsheets and of MATLAB, ticks of Windows. All others are returned untouched, bit for bit:
milliseconds and the like, which look like seconds, are the matter of `units` and of `time_axis.in_seconds`.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from .checks import number, wrong
from .stamps import read_stamps

_DAY = 86400.0


@dataclasses.dataclass(frozen=True)
class Count:
    """A way to count time whose numbers cannot be mistaken: they lie between ``low`` and ``high``, the years 2001 to 2039.

    ``per_second`` counts make a second; ``origin`` is where they begin, ``called`` how a sentence names them.
    """

    low: float
    high: float
    per_second: float
    origin: str
    called: str


COUNTS = (
    Count(0.98e9, 2.2e9, 1.0, "1970-01-01", "seconds since 1970"),
    Count(3.06e9, 4.4e9, 1.0, "1904-01-01", "seconds since 1904, as LabVIEW counts them"),
    Count(0.98e12, 2.2e12, 1e3, "1970-01-01", "milliseconds since 1970"),
    Count(0.98e15, 2.2e15, 1e6, "1970-01-01", "microseconds since 1970"),
    Count(0.98e18, 2.2e18, 1e9, "1970-01-01", "nanoseconds since 1970"),
    Count(6.31e17, 6.45e17, 1e7, "0001-01-01", "ticks of 100 ns since the year 1, as .NET counts them"),
    Count(1.26e17, 1.39e17, 1e7, "1601-01-01", "ticks of 100 ns since 1601, as Windows counts them"),
)
DAYS = (
    Count(36892.0, 51138.0, 1 / _DAY, "1899-12-30", "days since 1899-12-30, as spreadsheets store moments"),
    Count(730852.0, 745098.0, 1 / _DAY, "-001-12-31", "days since the year 0, as MATLAB stores moments"),
)

LONGEST_STEP_S = 10.0
"""Counts whose usual step would be longer than this are something else: a counter of microseconds passes 1e9 too."""

SHORTEST_DAYS = 1e-4
"""Days whose usual step is larger (9 s) are no days: a record in seconds may begin at 40000 s."""

MOST_DECIMALS_OF_A_DAY = 12
"""Decimals of a day (0.1 us) that are looked for: double precision keeps 11 of a spreadsheet's days."""

FINEST_FRACTION = 1e-6
"""A step finer than this, between times within one day, is of fractions of a day: in seconds it would be over 1 MHz."""


def seconds(values: np.ndarray, unit: str, where: str, name: str) -> tuple[np.ndarray, str]:
    """Times as seconds from the first of them.

    Parameters
    ----------
    values : array of shape (N,)
        Numbers, or text.
    unit : str
        As the file states it; a unit stated keeps numbers from being taken for days.
    where, name : str
        The file and the column, for sentences.

    Returns
    -------
    t : array of shape (N,), s
        From the first sample, NaN where there is none; or ``values`` untouched, in its own unit, where the sentence is empty.
    sentence : str
        How it was read, without a full stop; empty where numbers were left as they are.

    Raises
    ------
    BadInput
        Text that is no time, by row; dates whose day and month could be either and matter.

    Examples
    --------
    >>> seconds(np.array(["23:59:59.9", "00:00:00.1"]), "", "rec.csv", "clock")[0]
    array([0. , 0.2])
    """
    values = np.asarray(values)
    if values.dtype.kind in "UST":
        return _of_text(values.astype(str), unit, where, name)
    known = values
    if values.dtype.kind == "f" and not (finite := np.isfinite(values)).all():
        known = values[finite]
    if known.size < 2:
        return values, ""
    count = _count(known, unit)
    if count is None:
        return values, ""
    return _counted(values, count, name)


def join_date_time(dates: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Dates and times of two columns as one column of stamps, for `seconds`.

    Parameters
    ----------
    dates : array of shape (N,)
        Text ("12.11.2025"), or numbers such as 20251112.
    times : array of shape (N,)
        Text ("10:03:29.002").

    Returns
    -------
    array of shape (N,), text
    """
    dates, times = np.asarray(dates), np.asarray(times)
    if dates.dtype.kind in "fiu":
        dates = np.array(["" if not np.isfinite(date) else f"{date:.0f}" for date in dates.tolist()])
    return np.char.add(np.char.add(dates.astype(str), " "), times.astype(str))


def _count(known: np.ndarray, unit: str) -> Count | None:
    """What numbers count, by their size and step; None where they may be seconds of a record."""
    low, high = known.min(), known.max()
    if not any(count.low <= low and high <= count.high for count in (*COUNTS, *DAYS)) and not 0.0 < low <= high <= 1.0:
        return None
    step = float(np.median(np.abs(np.diff(known))))
    for count in COUNTS:
        if count.low <= low and high <= count.high and step / count.per_second <= LONGEST_STEP_S:
            return count
    if unit:
        return None
    for count in DAYS:
        if (
            count.low <= low
            and high <= count.high
            and step <= SHORTEST_DAYS
            and (count is DAYS[1] or step < 10 * FINEST_FRACTION)
        ):
            return count
    if low > 0.0 and high <= 1.0 and 0.0 < step < FINEST_FRACTION:
        return Count(0.0, 1.0, 1 / _DAY, "", "fractions of a day")
    return None


def _counted(values: np.ndarray, count: Count, name: str) -> tuple[np.ndarray, str]:
    """Counts as seconds from the first, and the sentence."""
    first = values[np.isfinite(values)][0] if values.dtype.kind == "f" else values[0]
    exact = values.dtype.kind in "iu"
    since = values - first
    if not exact and count.per_second == 1.0:
        since = _decimal(values, float(first))
    elif not exact and count.per_second < 1.0:
        since = _decimal_days(values, float(first))
    t = since / count.per_second
    sentence = f'the times of "{name}" are read as {count.called}'
    if count.origin:
        sentence += f", from {_moment(first, count)} on"
    grain = 0.0 if exact else float(np.spacing(float(first))) / count.per_second
    finite = t[np.isfinite(t)]
    step = float(np.median(np.diff(finite)))
    if grain > 1e-3 * abs(step):
        sentence += (
            f"; numbers of that size are kept to {number(1e6 * grain)} us, {number(100 * grain / step)} % of a step"
            if step
            else ""
        )
    return t, sentence + _repeats(finite)


def _decimal(values: np.ndarray, first: float) -> np.ndarray:
    """Differences from the first, without the binary rounding of numbers that were written with few decimals."""
    for digits in (0, 3, 6):
        rounded = np.round(values, digits)
        known = np.isfinite(values)
        if np.all(np.abs(rounded - values)[known] <= np.spacing(np.abs(first))):
            whole, scale = np.floor(first), 10**digits
            return (np.rint((values - whole) * scale) - np.rint((first - whole) * scale)) / scale
    return values - first


def _decimal_days(values: np.ndarray, first: float) -> np.ndarray:
    """The same for days, of which a step is so small a part that their binary rounding makes even times look uneven."""
    whole = np.floor(first)
    known = np.isfinite(values)
    for digits in range(4, MOST_DECIMALS_OF_A_DAY + 1):
        scale = 10.0**digits
        if 1.0 / scale <= np.spacing(first):
            break
        counts = np.rint((values - whole) * scale)
        if np.array_equal((whole + counts / scale)[known], values[known]):
            return (counts - np.rint((first - whole) * scale)) / scale
    return values - first


def _moment(first, count: Count) -> str:
    """When the first sample was, for a person."""
    whole = int(first // count.per_second) if count.per_second >= 1 else round(float(first) * _DAY)
    return str(np.datetime64(count.origin, "s") + np.timedelta64(whole, "s")).replace("T", " ")


def _repeats(t: np.ndarray) -> str:
    """The end of a sentence where many samples bear one stamp; empty where they do not."""
    steps = np.diff(t)
    same = np.count_nonzero(steps == 0)
    if steps.size < 4 or same < steps.size / 5:
        return ""
    coarse = float(np.min(steps[steps > 0])) if np.any(steps > 0) else 0.0
    changes = np.flatnonzero(steps != 0)
    each = float(np.median(np.diff(changes))) if changes.size > 2 else float(t.size)
    known = f"--rate {number(each / coarse)}" if coarse > 0 and changes.size > 2 else "--rate HZ"
    return f"; about {number(each)} samples share each stamp, so give the rate ({known} if they are evenly spaced)"


def _of_text(values: np.ndarray, unit: str, where: str, name: str) -> tuple[np.ndarray, str]:
    """Stamps, or whole numbers too long for double precision, kept as text."""
    values = np.char.strip(values)
    filled = values[values != ""]
    # Counts up to 9e18, as far as 64 bits go.
    fits = filled.size == values.size > 0 and filled[0].isdigit() and len(filled[0]) < 19 + (filled[0] < "9")
    if fits and np.all(np.char.isdigit(filled)):
        counts = values.astype(np.int64)
        count = _count(counts, unit)
        if count is not None:
            return _counted(counts, count, name)
    nanoseconds, known, how, first = read_stamps(values, where, name)
    if not np.any(known):
        raise wrong(f"{where}, column {name}", "no time in any row", "times")
    begin = nanoseconds[np.argmax(known)]
    # Whole nanoseconds below 2^53 (104 days) divide to the nearest number.
    t = np.where(known, (nanoseconds - begin) / 1e9, np.nan)
    sentence = f'the times of "{name}" are read as {how}, from {first} on'
    return t, sentence + _repeats(t[known])
