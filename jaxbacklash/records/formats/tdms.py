"""TDMS files, which LabVIEW and other programs of National Instruments write, through npTDMS."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..table import Table
from .arrays import seconds, stated_rate
from .clocks import group_columns, is_time, with_common_time
from .guard import bounded, guarded, library


def read(path: Path) -> Table:
    """The channels of a TDMS file.

    Parameters
    ----------
    path : Path

    Returns
    -------
    Table
        Columns "group/channel" with the unit that the file states; times from the increment that a waveform carries, counted
        from the earliest start of all.

    Raises
    ------
    BadInput
        npTDMS is missing, or the file is damaged.
    """
    nptdms = library("nptdms", "nptdms", path, "a TDMS file")
    notes: list[str] = []
    left_out: dict[str, str] = {}
    with (
        guarded(path, "a file that is damaged or no TDMS file", "a complete .tdms file; copy it again"),
        nptdms.TdmsFile.open(path) as file,
    ):
        channels = [channel for group in file.groups() for channel in group.channels()]
        bounded(8 * sum(len(channel) for channel in channels), str(path))
        if file.file_status.incomplete_final_segment:
            notes.append("the file ends before the data that it announces: it was cut off, or the program that wrote it stopped")
        starts = [start for start in map(_start, channels) if start is not None]
        earliest = min(starts) if starts else None
        timed = any(is_time(channel.name) for channel in channels)
        found, clocks = [], {}
        for channel in channels:
            values, unit = channel[:], _unit(channel)
            if values.dtype.kind == "M":
                (values, note), unit = seconds(values), "s"
                notes.append(f"column {channel.group_name}/{channel.name} {note}")
            if values.dtype.kind == "O":
                values = np.array([str(one) for one in values])
            if values.size < 2:
                left_out[f"{channel.group_name}/{channel.name}"] = "an empty channel" if not values.size else "a single value"
                continue
            key = None if timed else _clock_key(channel, earliest)
            if key is not None and key not in clocks:
                first, step, samples = key
                clocks[key] = first + step * np.arange(samples)
            found.append((channel.group_name, channel.name, values, unit, None if key is None else clocks[key]))
        version = str(file.tdms_version)
        stated = None if timed else _stated_rate([file, *file.groups()])
    columns, rate = with_common_time(group_columns(found))
    return Table(columns, "tdms", {"version": version}, tuple(notes), rate or stated, left_out=left_out)


def _stated_rate(items: list) -> float | None:
    """The rate that a property of the file or of a group states."""
    for item in items:
        for name, value in item.properties.items():
            if isinstance(value, float | int) and (rate := stated_rate(str(name), float(value))):
                return rate
    return None


def _unit(channel: Any) -> str:
    return str(channel.properties.get("unit_string") or channel.properties.get("NI_UnitDescription") or "")


def _start(channel: Any) -> np.datetime64 | None:
    """When the waveform begins, where the file says so; LabVIEW writes 1904 for "not known"."""
    start = channel.properties.get("wf_start_time")
    known = isinstance(start, np.datetime64) and start > np.datetime64("1970-01-01")
    return start if known and "wf_increment" in channel.properties else None


def _clock_key(channel: Any, earliest: np.datetime64 | None) -> tuple[float, float, int] | None:
    """First time, step and number of samples of a channel [s]; None where the file does not say."""
    step = channel.properties.get("wf_increment")
    if not isinstance(step, float | int) or not np.isfinite(step) or step <= 0:
        return None
    offset = channel.properties.get("wf_start_offset", 0.0)
    first = float(offset) if isinstance(offset, float | int) and np.isfinite(offset) else 0.0
    start = _start(channel)
    if start is not None and earliest is not None:
        first += float((start - earliest) / np.timedelta64(1, "ns")) * 1e-9
    return first, float(step), len(channel)
