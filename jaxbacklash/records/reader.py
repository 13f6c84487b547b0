"""Read a record from a file: table, channels, units, one even clock, and what was found odd on the way.

The order matters. Turns are unwrapped and spikes taken out before anything is interpolated; what is missing is bridged before
channels are compared; and the findings come last, of the rows as they were measured.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Collection, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from jaxbacklash.errors import BadInput

from . import checks, time_axis
from .bridge import bridged
from .checks import PUSHES, number, wrong
from .clocks import on_one_clock, times_of
from .columns import Picked, pick
from .conversion import in_si
from .driven import as_torque
from .files import read_table
from .finding import ASK, REFUSE, Finding
from .findings import find, find_in_times
from .findings.channel import Channel
from .findings.held_values import refreshed_every
from .findings.mend import after, before
from .options import ReadOptions
from .record import Record
from .resample import no_long_gap, resampled
from .rows_used import RowsUsed
from .table import Table
from .tells import tells
from .undriven import undriven


def read_record(
    path: str | PathLike[str],
    *,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    scales: Mapping[str, float] | None = None,
    resample: bool | float | None = None,
    rate: float | None = None,
    skip: int = 0,
    decimal: str | None = None,
    unwrap: Collection[str] = (),
    ratio: float | None = None,
    sign: Collection[str] = (),
    despike: Collection[str] = (),
    start: float | None = None,
    stop: float | None = None,
    accept: Collection[str] = (),
    kt: float | None = None,
) -> Record:
    """Read a record.

    Parameters
    ----------
    path : str or path
        A text table, or a file of any format that `records.formats` knows.
    columns : mapping of str, optional
        Columns by channel: a name as in the file or "#3" for the third; a channel not named is the column of its own name.
    units : mapping of str, optional
        Units of channels that are not in s, rad (or m), N m (or N); converted. They override those that the file states.
    scales : mapping of float, optional
        Factors of channels.
    resample : bool or float, optional
        True makes uneven times even, at the median rate, and bridges short runs of missing values; a number is the rate
        wanted, Hz.
    rate : float, optional
        Samples per second, Hz, of a file without times or with times that only tell when rows were written.
    skip : int
        Lines at the beginning of a text file to pass over.
    decimal : str, optional
        The decimal mark of a text file that can be read both ways.
    unwrap, sign, despike : collections of str
        Channels whose jumps by a turn are undone, that were measured the other way round, whose spikes are taken out.
    ratio : float, optional
        Turns of x, or of the motor of a drive, for a turn of the link.
    start, stop : float, optional
        Only the samples between these times are used, s.
    accept : collection of str
        Kinds of finding (`findings.rules.RULES`) that are right as they are.
    kt : float, optional
        Torque of the motor of a drive for an ampere, N m/A, where its current was measured.

    Returns
    -------
    Record
        Warns (UserWarning) where the record is odd but usable; its `findings` hold what was found.

    Raises
    ------
    BadInput
        When there is no such file, it cannot be read, or what it holds cannot be used.

    Examples
    --------
    >>> import jaxbacklash as jb
    >>> record = jb.read_record("run1.csv", columns={"x": "enc1", "z": "#4"}, units={"x": "deg"})  # doctest: +SKIP
    """
    options = ReadOptions(
        columns or {}, units or {}, scales or {}, resample, rate, skip, frozenset(unwrap), ratio, frozenset(sign),
        frozenset(despike), decimal, start, stop, frozenset(accept), kt,
    )  # fmt: skip
    return record_of(read_table(Path(path), options), options, str(path))


def record_of(table: Table, options: ReadOptions, where: str) -> Record:
    """The record that a table holds; see `read_record`."""
    _check(options)
    clocked = any(column.clock is not None for column in table.columns)
    picked = pick(table, options.columns, where, timed=options.rate is None and not clocked)
    _named(picked, options, where)
    channels, notes = in_si(table, picked, options, where)
    t, told = times_of(table, picked, options, where)
    _whole(t, channels, table, where, options)
    channels, compared = on_one_clock(table, picked, t, channels, options, where)
    channels, driven = as_torque(channels, options, where)
    for note in (*table.notes, *picked.notes, *notes, *told, *compared, *driven):
        warnings.warn(f"{where}: {note}", UserWarning, stacklevel=3)
    extras = {name: values for name, values in picked.extras.items() if values.shape == t.shape}
    used = RowsUsed(table)
    if compared:
        t, channels, extras, used = _only(_covered(t, channels), t, channels, extras, used)
    t, channels, extras, used = _only(_between(t, options, where), t, channels, extras, used)
    # What is missing can be bridged only over times that go on: those are judged first.
    for name, values in ({"t": t} if options.resample else {"t": t, **channels}).items():
        checks.finite(values, name, where, used.place)
    stated = frozenset(options.units) | {name for name, column in picked.channels.items() if column.unit}
    findings = used.said(find_in_times(t, options, units_stated=stated))
    _refuse(findings, where)
    try:
        _without_gaps(t, options, where)
    except BadInput as why:
        raise BadInput(used.told(str(why)), remedy=why.remedy) from None
    if options.resample:
        channels = bridged(t, channels, used, where)
        for name, values in channels.items():
            checks.finite(values, name, where, used.place)
    whole, held = t, channels
    t, channels, extras = before(t, channels, extras, options)
    used = _thinned(whole, held, t, options, used, where)
    findings += used.said(find(t, channels, extras, options, units_stated=stated, rate_hz=options.rate))
    _refuse(findings, where)
    for finding in findings:
        warnings.warn(finding.sentence(where), UserWarning, stacklevel=3)
    t, channels, extras = after(t, channels, extras, findings)
    if options.resample:
        t, channels, extras = _even(t, channels, extras, options, where)
    gear: dict[str, Any] = {"ratio": options.ratio or 1.0, "per_kt": "current" in picked.channels and options.kt is None}
    gear = gear if {"torque", "command"} & set(channels) else {}
    record = Record(t, channels, where, extras, _confirmed(picked, options), tuple(findings), **gear)
    undriven(record, table, picked, options)
    for sentence in tells(channels):
        warnings.warn(f"{where}: {sentence}", UserWarning, stacklevel=3)
    return record


def _check(options: ReadOptions) -> None:
    """Refuse numbers that cannot be meant, and channels that no record has."""
    for option, value in (("--rate", options.rate), ("--ratio", options.ratio), ("--kt", options.kt)):
        if value is not None and not (math.isfinite(value) and value != 0.0 and (value > 0.0 or option == "--ratio")):
            raise wrong(option, f"{value:g}", "a positive number")
    if options.skip < 0:
        raise wrong("--skip", str(options.skip), "a number of lines, zero or more")
    if options.decimal not in (None, ".", ","):
        raise wrong("--decimal", f'"{options.decimal}"', '"." or ","')


def _named(picked: Picked, options: ReadOptions, where: str) -> None:
    """Refuse options that name a channel which the record does not have."""
    for option, named in (("--sign", options.sign), ("--unwrap", options.unwrap), ("--despike", options.despike)):
        absent = sorted(named - set(picked.channels))
        if absent:
            raise wrong(where, f"no channel {absent[0]}, which {option} names", f"one of {checks.listed(picked.channels)}")
    if options.ratio is not None and not {"x", "motor", *PUSHES} & set(picked.channels):
        raise wrong(where, "no channel x, of which --ratio gives the turns", f"one beside {checks.listed(picked.channels)}")
    if options.kt is not None and "current" not in picked.channels:
        raise wrong(where, "no current, for which --kt gives the torque", f"one beside {checks.listed(picked.channels)}")
    if options.ratio is not None and options.ratio < 0.0 and "x" not in picked.channels:
        raise wrong("--ratio", f"{options.ratio:g}", "a positive number, and --sign link where it turns back")


def _whole(t: np.ndarray, channels: dict[str, np.ndarray], table: Table, where: str, options: ReadOptions) -> None:
    """Refuse times that are missing, and channels that have not a value for each time and no clock of their own."""
    if options.rate is None:
        checks.finite(t, "t", where, table.place)
    clocked = any(column.clock is not None for column in table.columns)
    for name, values in channels.items():
        if not clocked:
            checks.same_length(values, name, t, where)


def _only(rows: slice, t, channels, extras, used: RowsUsed):
    """The columns at some rows that follow each other, and which rows of the file these are."""
    first = rows.start or 0
    return t[rows], {n: v[rows] for n, v in channels.items()}, {n: v[rows] for n, v in extras.items()}, used.further(first)


def _covered(t: np.ndarray, channels: Mapping[str, np.ndarray]) -> slice:
    """The rows from the first to the last for which every channel has a value: clocks need not begin or end together."""
    known = np.all([np.isfinite(values) for values in channels.values()], axis=0)
    if known.size != t.size or not known.any():
        return slice(None)
    return slice(int(np.argmax(known)), t.size - int(np.argmax(known[::-1])))


def _thinned(whole: np.ndarray, channels, t: np.ndarray, options: ReadOptions, used: RowsUsed, where: str) -> RowsUsed:
    """Which rows are left of those at the times ``whole``, with a warning where `--despike` left out all that hold a value."""
    if t.size == whole.size:
        return used
    first, second = np.searchsorted(whole, t[:2])
    every = int(second - first)
    name = next(name for name in sorted(options.despike & set(channels)) if refreshed_every(Channel(channels[name])) > 1)
    rate = number((t.size - 1) / (t[-1] - t[0]))
    what = f"has a new value every {every} rows: only those {t.size} rows are used, at {rate} Hz"
    warnings.warn(f"{where}, column {name}: {what}.", UserWarning, stacklevel=4)
    return used.further(int(first), every)


def _between(t: np.ndarray, options: ReadOptions, where: str) -> slice:
    """The rows from `start` to `stop`."""
    if options.start is None and options.stop is None:
        return slice(None)
    low = -math.inf if options.start is None else options.start
    high = math.inf if options.stop is None else options.stop
    first = int(np.argmax(t >= low)) if np.any(t >= low) else t.size
    # A second recording behind the first begins with early times again.
    ends = np.flatnonzero((t[first:] > high) | np.append(False, np.diff(t[first:]) < 0.0) & (options.stop is not None))
    rows = slice(first, first + int(ends[0]) if ends.size else t.size)
    if not t[rows].size:
        found = f"no samples from {low:g} s to {high:g} s"
        raise wrong(where, found, f"a part of {t[0]:.6g} s to {t[-1]:.6g} s for --from and --to")
    return rows


def _refuse(findings: list[Finding], where: str) -> None:
    """Raise the first finding that refuses the record or asks about it."""
    for finding in findings:
        if finding.action in (REFUSE, ASK):
            raise BadInput(finding.sentence(where), remedy=finding.remedy if finding.remedy.startswith("--") else "")


def _without_gaps(t: np.ndarray, options: ReadOptions, where: str) -> None:
    """Refuse rows that were lost before channels are looked at: what moves on over a gap looks like counts that were lost."""
    if t.size < 3:
        return  # too short for any record, which says so itself
    time_axis.increasing(t, where)
    if not options.resample:
        time_axis.uniform(t, where)
    elif time_axis.uniform_grid(t) is None:
        no_long_gap(t, where)


def _even(t, channels, extras, options: ReadOptions, where: str):
    """The record's columns on an even grid."""
    checks.long_enough(t, where)
    # `True` is a number too, 1 Hz; as a rate it means the median one.
    rate = None if options.resample is True else options.resample
    every = channels | {f"extra {name}": values for name, values in extras.items()}
    t, every = resampled(t, every, rate, where)
    return t, {name: every[name] for name in channels}, {name: every[f"extra {name}"] for name in extras}


def _confirmed(picked: Picked, options: ReadOptions) -> frozenset[str]:
    """Channels whose unit is sure: stated by the user, or times that came with a unit or as stamps."""
    confirmed = frozenset(options.units)
    if options.rate is not None or "t" not in picked.channels:
        return confirmed | {"t"}
    column = picked.channels["t"]
    return confirmed | {"t"} if column.unit or column.values.dtype.kind == "U" else confirmed
