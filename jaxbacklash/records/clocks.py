"""One clock for all channels: files that keep times for each channel, and rates that are known beside a column of times."""

from __future__ import annotations

import numpy as np

from jaxbacklash.errors import BadInput

from . import time_axis
from .checks import number, wrong
from .columns import Picked
from .findings.stamps import time_unit
from .header_units import split_unit
from .options import ReadOptions
from .stated_rate import counts_rows, gap_told, no_times, of_one_rate
from .table import Table
from .times import seconds
from .units import TIME, spelt


def times_of(table: Table, picked: Picked, options: ReadOptions, where: str) -> tuple[np.ndarray, list[str]]:
    """The times of the rows [s], shape (N,), and sentences on how they were read.

    Raises
    ------
    BadInput
        When the times are no times, or contradict the stated rate.
    """
    if "t" not in picked.channels:
        column = next(iter(picked.channels.values()))
        if options.rate is not None:
            return np.arange(column.values.size) / options.rate, []
        assert column.clock is not None
        return column.clock, []
    column = picked.channels["t"]
    if options.rate is not None and no_times(column, options.units.get("t")):
        unused = f'"{column.name}", in {column.unit}, is not used'
        even = np.arange(column.values.size) / options.rate
        return even, [f"the rows are taken to be even at {number(options.rate)} Hz; {unused}"]
    t, notes = clock_of(table, picked.numbers["t"], options.units.get("t"), where)
    if options.rate is None:
        return t, notes
    even = np.arange(t.size) / options.rate
    if counts_rows(column, options.units.get("t")):
        return even, [f'"{column.name}" counts the rows, which are taken to be even at {number(options.rate)} Hz']
    of_one_rate(t, options.rate, column, where)
    unused = f'the times of "{column.name}" are not used{gap_told(t)}'
    return even, [f"the rows are taken to be even at {number(options.rate)} Hz; {unused}"]


def clock_of(table: Table, index: int, unit: str | None, where: str) -> tuple[np.ndarray, list[str]]:
    """The times that a column holds [s] and a sentence on how they were read, if there is something to say."""
    column = table.columns[index]
    if column.values.dtype.kind == "U":
        t, note = seconds(column.values, column.unit, where, column.name)
        return t, [note] if note else []
    stated = unit or (spelt("t", column.unit) if column.unit else None)
    if column.unit and stated is None:
        known = column.values[np.isfinite(column.values)]
        asked = time_unit(known) if known.size > 1 else []
        meant = asked[0].remedy if asked else "--unit t=s"
        wanted = f"one of {', '.join(TIME)}: pass --rate HZ, the samples per second, or {meant} if that is its unit"
        raise wrong(f"{where}, column {column.name}", f'the unit "{column.unit}" for times', wanted)
    if stated is None:
        t, note = seconds(column.values, "", where, column.name)
        return t, [note] if note else []
    values = column.values
    # Long counts lose nothing when they are counted from the first.
    begin = float(values[0]) if values.size and abs(values[0]) > 1e6 * float(np.ptp(values) or 1.0) else 0.0
    notes = [] if unit or stated == "s" else [f'the times of "{column.name}" are read in {stated}, as the file states']
    return (values - begin) * TIME[stated], notes


def own_clock(table: Table, picked: Picked, channel: str, options: ReadOptions, where: str) -> tuple[np.ndarray, str] | None:
    """The times that belong to one channel alone and the name of their column, None where it has none of its own."""
    column = picked.channels[channel]
    if column.clock is not None:
        return column.clock, column.name
    if "t" not in picked.numbers:
        return None
    common = split_unit(picked.channels["t"].name)[0].lower()
    for n in range(picked.numbers[channel] - 1, -1, -1):
        if n == picked.numbers["t"]:
            return None
        other = table.columns[n]
        bare = split_unit(other.name)[0].lower()
        alike = bare == common or bare.startswith((f"{common}_", f"{common} ", "time"))
        if alike and n not in picked.numbers.values():
            # What is said of t holds for the others that state no unit of their own.
            unit = None if spelt("t", other.unit) else options.units.get("t")
            times, _ = clock_of(table, n, unit, where)
            if times.size and np.all(np.diff(times[np.isfinite(times)]) > 0):
                return times, f"#{n + 1} {other.name}"
    return None


def on_one_clock(
    table: Table, picked: Picked, t: np.ndarray, channels: dict[str, np.ndarray], options: ReadOptions, where: str
) -> tuple[dict[str, np.ndarray], list[str]]:
    """The channels at the times ``t``: as they are where their clocks agree, interpolated where `--resample` asks for it.

    Raises
    ------
    BadInput
        When clocks differ and nothing was said about it.
    """
    if options.rate is not None:
        return channels, []
    shared, notes = {}, []
    for name, values in channels.items():
        own = own_clock(table, picked, name, options, where)
        if own is None or own[0] is t:
            shared[name] = values
            continue
        times, source = own
        step = float(np.median(np.diff(t)))
        if times.size == t.size and np.nanmax(np.abs(times - t)) <= time_axis.HARMLESS * step:
            shared[name] = values
            if picked.channels[name].clock is None:  # a second column of times; formats with groups keep a clock for each channel
                notes.append(f"{name} has times of its own ({source}), the same as those of t")
            continue
        shared[name] = _moved(times, values, t, name, source, options, where)
        notes.append(f"{name} is brought from its own times ({source}) to those of t, which differ {_difference(times, t)}")
    return shared, notes


def _moved(
    times: np.ndarray, values: np.ndarray, t: np.ndarray, name: str, source: str, options: ReadOptions, where: str
) -> np.ndarray:
    if options.resample is None or options.resample is False:
        found = f"times of its own ({source}), which differ from those of t {_difference(times, t)}"
        wanted = "one clock: pass --resample to bring it to the times of t"
        raise BadInput(f"{where}, column {name}: found {found}, wanted {wanted}.", remedy="--resample")
    known = np.isfinite(times) & np.isfinite(values[: times.size])
    inside = (t >= times[known][0]) & (t <= times[known][-1])
    if np.count_nonzero(inside) < 2:
        found = f"times of its own ({source}) that do not overlap those of t"
        raise wrong(f"{where}, column {name}", found, "the same stretch of time")
    from scipy.interpolate import CubicSpline  # a sixth of a second to import, and few records need it

    moved = np.full(t.size, np.nan)
    moved[inside] = CubicSpline(times[known], values[: times.size][known])(t[inside])
    return moved


def _difference(times: np.ndarray, t: np.ndarray) -> str:
    """How two clocks differ, in words."""
    if times.size != t.size:
        return f"in number ({times.size} and {t.size})"
    apart = times - t
    drift = (apart[-1] - apart[0]) / max(float(t[-1] - t[0]), 1e-300)
    most = number(1e3 * float(np.nanmax(np.abs(apart))))
    return f"by up to {most} ms" + (f" and run apart by {1e6 * drift:.0f} ppm" if abs(drift) > 1e-6 else "")
