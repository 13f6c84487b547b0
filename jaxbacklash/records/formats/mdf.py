"""Measurement data files of the vehicle industry (.mf4, .mdf: ASAM MDF versions 3 and 4) through asammdf."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..table import Table
from .apart import read_apart
from .clocks import group_columns, with_common_time
from .guard import bounded, guarded, library, needed

KIND, WANTED = "a file that is damaged or no MDF file", "a complete .mf4 file; copy it again"


def read(path: Path) -> Table:
    """The channels of a measurement data file, read in a process of its own: damage may end that process.

    Parameters
    ----------
    path : Path

    Returns
    -------
    Table
        Columns "group/channel" with unit; the master channel of a group is the clock of its channels, and becomes a column "t"
        where all groups share it.

    Raises
    ------
    BadInput
        asammdf is missing, or the file is damaged.
    """
    needed("asammdf", "asammdf", path, "an MDF measurement file")
    return read_apart("mdf", path, KIND, WANTED)


def read_here(path: Path) -> Table:
    """What `read` returns, read in this process."""
    asammdf = library("asammdf", "asammdf", path, "an MDF measurement file")
    found: list[tuple[str, str, np.ndarray, str, np.ndarray | None]] = []
    left_out: dict[str, str] = {}
    with (
        guarded(path, KIND, WANTED),
        asammdf.MDF(path) as file,
    ):
        groups = file.groups
        claimed = sum(8 * int(one.channel_group.cycles_nr) * max(len(one.channels), 1) for one in groups)
        bounded(claimed, str(path))
        for number, group in enumerate(groups):
            name = _group_name(group, number) if len(groups) > 1 else ""
            for index, channel in enumerate(group.channels):
                if file.masters_db.get(number) == index:
                    continue
                signal = file.get(group=number, index=index)
                _take(signal, name, str(channel.name), found, left_out)
        version = str(file.version)
    columns, rate = with_common_time(group_columns(found))
    return Table(columns, "mdf", {"version": version}, (), rate, left_out=left_out)


def _group_name(group: Any, number: int) -> str:
    """What the group is called in the file: where it comes from, else its number."""
    head = group.channel_group
    source = getattr(head, "acq_name", None) or getattr(getattr(head, "acq_source", None), "name", None)
    return str(source or f"group {number + 1}")


def _take(signal: Any, group: str, name: str, found: list, left_out: dict[str, str]) -> None:
    """One channel, as a column or among what is left out."""
    full = f"{group}/{name}" if group else name
    values = np.asarray(signal.samples)
    if values.dtype.names or values.ndim != 1:
        left_out[full] = f"an array of shape {values.shape}"
    elif values.size < 2:
        left_out[full] = "an empty channel" if not values.size else "a single value"
    elif values.dtype.kind not in "fiubSU":
        left_out[full] = "no numbers"
    else:
        if values.dtype.kind == "S":
            values = np.char.decode(values, "latin-1")
        found.append((group, name, values, str(signal.unit or ""), np.ascontiguousarray(signal.timestamps, dtype=np.float64)))
