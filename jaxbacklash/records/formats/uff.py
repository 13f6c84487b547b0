"""Universal files (.uff, .unv) of modal analysis: time responses in data sets 58 and 58b, through pyuff."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from ..checks import wrong
from ..table import Column, Table
from .arrays import tidy
from .clocks import seconds_factor, with_common_time
from .guard import bounded, guarded, library

TIME_RESPONSE, TIME_AXIS = 1, 17
"""Function type and abscissa's data type of a measured course in time."""
UNKNOWN = 0
DIRECTIONS = {0: "", 1: "+X", 2: "+Y", 3: "+Z", 4: "+RX", 5: "+RY", 6: "+RZ"}
START = re.compile(rb"    -1 *\r?\n +\d+b?[ \r\n]")
END = re.compile(rb"    -1 *(?:\r?\n|$)")
"""The lines that begin and end a data set; pyuff passes over a set that has no end."""


def read(path: Path) -> Table:
    """The time responses of a universal file.

    Parameters
    ----------
    path : Path

    Returns
    -------
    Table
        A column for each data set of type 58 or 58b that is a time response, called by its label, by its description or by
        its node and direction, whichever tells them apart; spectra and the rest are left out by name.

    Raises
    ------
    BadInput
        pyuff is missing, the file is damaged or cut off, or holds no time response.
    """
    pyuff = library("pyuff", "pyuff", path, "a universal file (UFF)")
    left_out: dict[str, str] = {}
    sets: list[dict] = []
    with guarded(path, "a file that is damaged or no universal file", "a complete .uff file; copy it again"):
        data = path.read_bytes()
        starts = list(START.finditer(data))
        if not starts:
            raise wrong(str(path), "no data set between lines of -1", "a universal file (UFF)")
        if not END.search(data, starts[-1].end()):
            raise wrong(str(path), "a last data set without the line of -1 that ends it", "a complete .uff file; copy it again")
        file = pyuff.UFF(str(path))
        types = [int(one) for one in file.get_set_types()]
        for number, kind in enumerate(types):
            if kind != 58:
                left_out[f"data set {number + 1}"] = f"of type {kind}, no measured function"
                continue
            head = file.read_sets(number, header_only=True)
            bounded(16 * int(head["num_pts"]), f"{path}, data set {number + 1}")
            if int(head["num_pts"]) > path.stat().st_size:
                found = f"{head['num_pts']} values announced in data set {number + 1}"
                raise wrong(str(path), found, "as many as the file holds")
            one = file.read_sets(number)
            values = np.asarray(one["data"])
            if values.size < int(one["num_pts"]):
                found = f"{values.size} of {one['num_pts']} values in data set {number + 1}"
                raise wrong(str(path), found, "a complete .uff file; copy it again")
            if _is_course(one, values):
                sets.append(one)
            else:
                left_out[f"data set {number + 1}"] = f"a function of type {one['func_type']} that is no course in time"
        columns, rate = with_common_time(_columns(sets))
    if not columns:
        raise wrong(str(path), "no data set 58 with a time response", "measured courses in time")
    return Table(columns, "uff", {"data sets": str(len(types))}, (), rate, left_out=left_out)


def _is_course(one: dict, values: np.ndarray) -> bool:
    """Whether a data set is a course in time: real, and of that type or of an unknown type over an axis of time."""
    kind, axis = int(one["func_type"]), int(one.get("abscissa_spec_data_type", UNKNOWN))
    return not np.iscomplexobj(values) and (kind == TIME_RESPONSE or (kind == UNKNOWN and axis == TIME_AXIS))


def _columns(sets: list[dict]) -> list[Column]:
    """Names, units and times."""
    columns = []
    for one, name in zip(sets, _names(sets), strict=True):
        # Line ends after binary values may be read as one more.
        samples = int(one["num_pts"])
        values = np.asarray(one["data"], dtype=np.float64)[:samples]
        if int(one["abscissa_spacing"]):
            # The library computes even times in single precision where the file is of that kind.
            clock = float(one["abscissa_min"]) + float(one["abscissa_inc"]) * np.arange(samples)
        else:
            clock = np.asarray(one["x"], dtype=np.float64)[:samples]
        factor = seconds_factor(_label(one, "abscissa_axis_units_lab")) or 1.0
        columns.append(Column(name, values, _label(one, "ordinate_axis_units_lab"), clock * factor))
    return columns


def _names(sets: list[dict]) -> list[str]:
    """What tells the data sets apart: the axis label, the description, else node and direction with a number."""
    for key in ("ordinate_axis_lab", "id1"):
        names = [_label(one, key) for one in sets]
        if all(names) and len(set(names)) == len(names):
            return names
    names = [f"node {one['rsp_node']} {DIRECTIONS.get(abs(int(one['rsp_dir'])), '')}".strip() for one in sets]
    names = [name.replace("+", "-") if int(one["rsp_dir"]) < 0 else name for name, one in zip(names, sets, strict=True)]
    return names if len(set(names)) == len(names) else [f"{name} ({number})" for number, name in enumerate(names, start=1)]


def _label(one: dict, key: str) -> str:
    """A label, empty where the file says that it has none."""
    label: Any = one.get(key, "")
    text = tidy(str(label))
    return "" if text.upper() in ("NONE", "") else text
