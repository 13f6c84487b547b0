"""One time column where all channels share a clock; a clock for each where they do not."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable

import numpy as np

from ..header_units import split_unit
from ..table import Column
from ..units import TIME
from .arrays import tidy, with_bare_names

TIME_NAMES = frozenset(("t", "time", "timestamp", "timestamps", "zeit", "temps", "tiempo", "tempo"))
"""Bare names of channels that hold times themselves (lower case)."""


def with_common_time(columns: Iterable[Column]) -> tuple[tuple[Column, ...], float | None]:
    """Columns whose clocks are all the same lose them and get a column "t" [s] before them.

    Parameters
    ----------
    columns : iterable of Column
        With or without clocks.

    Returns
    -------
    columns : tuple of Column
        Unchanged where the clocks differ, where one column has none or where a column of times stands among them.
    rate_hz : float or None
        Samples per second, where there is one clock and its steps are even.
    """
    columns = tuple(columns)
    clocks = [column.clock for column in columns]
    first = clocks[0] if clocks else None
    if first is None or not all(clock is first or _same(clock, first) for clock in clocks):
        return columns, None
    plain = tuple(dataclasses.replace(column, clock=None) for column in columns)
    rate = even_rate(first)
    if any(is_time(column.name) for column in columns):
        return plain, rate
    return (Column("t", first, "s"), *plain), rate


def _same(one: np.ndarray | None, other: np.ndarray) -> bool:
    return one is not None and one.shape == other.shape and bool(np.array_equal(one, other))


def even_rate(clock: np.ndarray) -> float | None:
    """Samples per second of even times [s]; None for uneven ones."""
    if clock.size < 2:
        return None
    steps = np.diff(clock)
    step = (clock[-1] - clock[0]) / (clock.size - 1)
    # Times carry the rounding of their last digit; an increment is stored exactly.
    return float(1.0 / step) if step > 0 and np.all(np.abs(steps - step) <= 1e-6 * step) else None


def is_time(name: str) -> bool:
    """Whether the last part of a name is that of a time column: "Log/Time [s]"."""
    bare = name.rpartition("/")[2].lower()
    return bare.split("[")[0].split("(")[0].strip() in TIME_NAMES


def seconds_factor(unit: str) -> float | None:
    """Seconds in a unit of time as a file spells it ("ms", "Sec", "Seconds"); None for what is no unit of time."""
    plain = unit.strip().strip("[]()").lower().replace("µ", "u").replace("μ", "u")
    words = {"sec": "s", "secs": "s", "second": "s", "seconds": "s", "msec": "ms", "milliseconds": "ms", "microseconds": "us"}
    return TIME.get(words.get(plain, plain))


def group_columns(channels: Iterable[tuple[str, str, np.ndarray, str, np.ndarray | None]]) -> list[Column]:
    """Columns of channels in groups, called "group/channel"; a channel may be asked for by its own name where no other has it.

    Parameters
    ----------
    channels : iterable of (group, name, values, unit, clock)
        ``group`` may be empty.
    """
    columns = []
    for group, name, values, unit, clock in channels:
        name = tidy(name) or "unnamed"
        full = f"{tidy(group)}/{name}" if group else name
        columns.append(Column(full, _numbers(values), tidy(unit) or split_unit(name)[1], clock))
    return list(with_bare_names(columns))


def _numbers(values: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(values, dtype=np.float64) if values.dtype.kind in "fiub" else values
