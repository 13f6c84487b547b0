"""A rate that is stated beside a column of times: whether the two agree, and what is said where they do not."""

from __future__ import annotations

import numpy as np

from . import time_axis
from .checks import number, wrong
from .findings.stamps import packet
from .table import Column
from .units import TIME, spelt

SAME_RATE = 0.01
"""Relative difference of a stated rate from that of the stamps below which bursts and repeated stamps may explain it."""


def no_times(column: Column, unit: str | None) -> bool:
    """Whether numbers bear a unit of something else than time: a count of samples does no harm where the rate is known."""
    return bool(column.unit) and column.values.dtype.kind != "U" and unit is None and spelt("t", column.unit) is None


def counts_rows(column: Column, unit: str | None) -> bool:
    """Whether numbers without a unit go up by one from row to row."""
    return not (unit or column.unit) and column.values.dtype.kind in "fiu" and bool(np.all(np.diff(column.values) == 1))


def of_one_rate(t: np.ndarray, rate: float, column: Column, where: str) -> None:
    """Refuse times (N,) [s] that contradict the stated rate [Hz]: offers their unit where that alone explains it."""
    span = float(t[-1] - t[0]) if t.size else 0.0
    if not (np.isfinite(span) and span > 0.0):
        return
    known = (t.size - 1) / span
    if abs(known / rate - 1.0) <= SAME_RATE or abs(known / rate - 1.0) <= packet(t) / span:
        return
    place, found = f"{where}, column {column.name}", f"{number(known)} samples per second by its times, and --rate {number(rate)}"
    unit = _unit_meant(column, span * known / rate)
    if unit:
        wanted = f"one rate: pass --unit t={unit} if its times are in {unit}, or leave --rate out"
        raise wrong(place, found, wanted, f"--unit t={unit}")
    raise wrong(place, found, f"one rate: leave --rate out, or pass --rate {known:.6g}")


def _unit_meant(column: Column, span: float) -> str:
    """The unit in which the numbers of a column last ``span`` [s]; empty where none is."""
    if column.values.dtype.kind not in "fiu":
        return ""
    numbers = float(column.values[-1]) - float(column.values[0])
    return next((unit for unit, factor in TIME.items() if abs(numbers * factor / span - 1.0) <= SAME_RATE), "")


def gap_told(t: np.ndarray) -> str:
    """The end of a sentence on times (N,) [s] that are not used though they show rows that were lost; empty where they do not."""
    steps = np.diff(t)
    if t.size < 3 or not (steps > 0).all() or packet(t) or time_axis.uniform_grid(t) is not None:
        return ""
    wide = np.flatnonzero(steps >= time_axis.GAP * np.median(steps))
    if not 0 < wide.size <= steps.size / 20:
        return ""
    row = int(wide[0])
    more = f" and {wide.size - 1} more like it" if wide.size > 1 else ""
    found = f"a gap of {number(steps[row])} s between rows {row + 1} and {row + 2}{more}"
    return f", though they show {found}: where rows were lost, leave --rate out and pass --resample"
