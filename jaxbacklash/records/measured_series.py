"""One measured channel at even times, from any table: less than a record, since no joint need be known."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from os import PathLike
from pathlib import Path

import numpy as np

from . import checks, time_axis
from .checks import listed, number, wrong
from .reader import _read_table
from .resample import resampled
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
        A .csv, .txt, .dat, .tsv, .npz or .mat file.
    channel : str, optional
        A channel (z, y, x, F, T) or the name of any column. Without it the first of z, y, T, x, F that the file has, or its
        only column beside t.
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
    columns, units, scales, where = columns or {}, units or {}, scales or {}, str(path)
    named = {columns.get(name, name) for name in ("t", *checks.CHANNELS, *([channel] if channel else []))}
    table = dict(_read_table(Path(path), named))
    for column in columns.values():
        if column not in table:
            raise wrong(where, f'no column "{column}", which --columns names', f"one of {listed(table)}")
    # A mapped channel goes by its channel's name; its column's own name leads to it too.
    known = {**table, **{name: table[column] for name, column in columns.items()}}
    name = channel or _usual(known, columns, where)
    if name not in known:
        raise wrong(where, f'no column "{name}", which --channel names', f"one of {listed(table)}")
    found = {name: checks.real_vector(known[name], name, where)}
    driven = next((one for one in ("x", "F") if one in known and one != name and columns.get(one, one) != name), None)
    if driven is not None:
        found[driven] = checks.real_vector(known[driven], driven, where)
    t = _times(known, rate, found[name].size, where)
    scaled = factors(units, scales, {**found, "t": t}, where)
    t = t * scaled.pop("t", 1.0)
    found = {one: values * scaled.get(one, 1.0) for one, values in found.items()}
    for one, values in found.items():
        checks.same_length(values, one, t, where)
        checks.finite(values, one, where)
    checks.long_enough(t, where)
    checks.finite(t, "t", where)
    time_axis.increasing(t, where)
    if resample is not None and resample is not False:
        t, found = resampled(t, found, None if resample is True else float(resample), where)
    t = time_axis.uniform(t, where)
    return MeasuredSeries(t, found[name], name, where, base_unit(units.get(name)), found[driven] if driven else None, driven)


def _usual(known: Mapping[str, np.ndarray], columns: Mapping[str, str], where: str) -> str:
    """The channel that is meant when none is named."""
    for name in USUAL:
        if name in known and (name in columns or name not in columns.values()):
            return name
    others = [name for name in known if name != "t" and name != columns.get("t")]
    if len(others) == 1:
        return others[0]
    raise wrong(where, f"the columns {listed(others)}", "one of them named with --channel NAME")


def _times(known: Mapping[str, np.ndarray], rate: float | None, samples: int, where: str) -> np.ndarray:
    if rate is not None:
        if not (np.isfinite(rate) and rate > 0.0):
            raise wrong("--rate", str(rate), "a positive number of samples per second")
        return np.arange(samples) / rate
    if "t" not in known:
        raise wrong(where, "no time column t", "one (--columns t=NAME), or the rate with --rate HZ")
    return checks.real_vector(known["t"], "t", where)
