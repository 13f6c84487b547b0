"""One measured channel at even times, from any table: less than a record, since no joint need be known."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Mapping
from os import PathLike
from pathlib import Path

import numpy as np

from . import checks, time_axis
from .checks import listed, number, wrong
from .clocks import times_of
from .columns import Picked, column_number, own_number
from .conversion import numbers_of, stated_units
from .files import read_table
from .findings.mend import before
from .options import ReadOptions
from .resample import resampled
from .roles import guess_roles
from .table import Table
from .units import base_unit, factors

USUAL = ("z", "y", "T", "x", "F")
"""Channels looked for, in this order, when none is named."""


@dataclasses.dataclass(frozen=True, eq=False)
class MeasuredSeries:
    """A channel that was measured.

    ``t`` [s] and ``values`` (N,); ``name`` and ``unit`` of the channel, ``path`` of the file; ``drive`` (N,), the input channel
    beside it, with ``drive_name``, or None.
    """

    t: np.ndarray
    values: np.ndarray
    name: str
    path: str
    unit: str = ""
    drive: np.ndarray | None = None
    drive_name: str | None = None

    @property
    def dt(self) -> float:
        """Time between samples [s]."""
        return float((self.t[-1] - self.t[0]) / (self.t.size - 1))

    def summary(self) -> str:
        """One line for a person."""
        beside = f", driven by {self.drive_name}" if self.drive_name else ""
        return (
            f"{self.path}: channel {self.name}{beside}, {self.t.size} samples at {number(1.0 / self.dt)} Hz, "
            f"{number(self.t.size * self.dt)} s"
        )


def read_series(
    path: str | PathLike[str],
    channel: str | None = None,
    *,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    scales: Mapping[str, float] | None = None,
    resample: bool | float | None = None,
    rate: float | None = None,
) -> MeasuredSeries:
    """Read one channel of a table with even times; any quantity, any unit.

    Parameters
    ----------
    path : str or path
        As `read_record` takes it.
    channel : str, optional
        A channel (z, y, x, F, T), the name of any column, or "#3" for the third. Without it the first of z, y, T, x, F that the
        file has, or its only column beside t.
    columns, units, scales, resample
        As `read_record` takes them.
    rate : float, optional
        Samples per second of a file without a time column, Hz.

    Returns
    -------
    MeasuredSeries

    Raises
    ------
    BadInput
        There is no such file or column, or the times are not even.
    """
    options = ReadOptions(columns or {}, units or {}, scales or {}, resample, rate)
    return series_of(read_table(Path(path), options), channel, options, str(path))


def series_of(table: Table, channel: str | None, options: ReadOptions, where: str) -> MeasuredSeries:
    """One channel of a table; see `read_series`."""
    if options.rate is not None and not (np.isfinite(options.rate) and options.rate > 0.0):
        raise wrong("--rate", str(options.rate), "a positive number of samples per second")
    known = {name: column_number(table, spec, where) for name, spec in options.columns.items()}
    for name in ("t", *checks.CHANNELS):
        own = own_number(table, name, known)
        if name not in known and own is not None:
            known[name] = own
    name, index = _wanted(table, channel, known, where)
    if index == known.get("t"):
        times = f"the times, {table.columns[index].name}, as the channel to judge"
        raise wrong(where, times, "a measured channel (--channel NAME)")
    driven = next((one for one in ("x", "F") if one in known and known[one] != index), None)
    numbers = {name: index} | ({driven: known[driven]} if driven else {})
    if "t" in known:
        numbers["t"] = known["t"]
    elif options.rate is None:
        raise wrong(where, "no time column t", f"one (--columns t=NAME), or the rate with --rate {_stated(table)}")
    picked = Picked({one: table.columns[number] for one, number in numbers.items()}, numbers, {}, ())
    t, found, unit, notes = _in_units(table, picked, name, options, where)
    for note in (*table.notes, *notes):
        warnings.warn(f"{where}: {note}", UserWarning, stacklevel=3)
    for one, values in found.items():
        checks.same_length(values, one, t, where)
    for one, values in {"t": t, **found}.items():
        checks.finite(values, one, where, table.place)
        checks.of_computable_size(values, one, where, checks.LARGEST_SERIES)
    t, found, _ = before(t, found, {}, options)
    checks.long_enough(t, where)
    time_axis.increasing(t, where)
    if options.resample:
        t, found = resampled(t, found, None if options.resample is True else float(options.resample), where)
    t = time_axis.uniform(t, where)
    return MeasuredSeries(t, found[name], name, where, unit, found[driven] if driven else None, driven)


def _wanted(table: Table, channel: str | None, known: Mapping[str, int], where: str) -> tuple[str, int]:
    """The channel that is meant and the number of its column."""
    if channel is not None:
        if channel in known:
            return channel, known[channel]
        try:
            return channel, column_number(table, channel, where)
        except checks.BadInput as why:
            raise checks.BadInput(str(why).replace("--columns names", "--channel names", 1)) from None
    for name in USUAL:
        if name in known:
            return name, known[name]
    time = known.get("t", guess_roles(table).get("t") if len(table.columns) > 1 else None)
    others = [number for number in range(len(table.columns)) if number != time]
    if len(others) == 1:
        return table.names[others[0]], others[0]
    raise wrong(where, f"the columns {listed(table.names[n] for n in others)}", "one of them named with --channel NAME")


def _in_units(
    table: Table, picked: Picked, name: str, options: ReadOptions, where: str
) -> tuple[np.ndarray, dict[str, np.ndarray], str, list[str]]:
    """Times and channels in the units that were stated for known channels; any other column stays in its own."""
    t, notes = times_of(table, picked, options, where)
    found = {one: numbers_of(table, column, one, where) for one, column in picked.channels.items() if one != "t"}
    absent = [one for one in (*options.units, *options.scales) if one not in picked.channels]
    if absent:
        raise wrong(where, f"no channel {absent[0]}, which --unit or --scale names", f"one of {listed(picked.channels)}")
    joint = {one: column for one, column in picked.channels.items() if one in checks.CHANNELS}
    units, told = stated_units(Picked(joint, {}, {}, ()), options, where)
    units = {one: unit for one, unit in units.items() if one in found}
    scales = {one: scale for one, scale in options.scales.items() if one in found}
    for one, factor in factors(units, scales, found, where).items():
        found[one] = found[one] * factor
    return t, found, base_unit(units.get(name)) or ("" if name in units else picked.channels[name].unit), [*notes, *told]


def _stated(table: Table) -> str:
    return f"{table.rate_hz:.9g}, which the file states" if table.rate_hz else "HZ"
