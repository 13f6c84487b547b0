"""MATLAB files: which version a file is, and from its nested values to columns.

Version 5 comes through SciPy (`mat5`), version 7.3, which is HDF5, through h5py (`mat73`); both return the same tree of
structs, arrays and objects, which is walked here.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..checks import wrong
from ..table import Table
from . import mat5, mat73
from .arrays import MAX_CHANNELS, Columns, named_matrix, tidy
from .guard import guarded
from .mat_objects import with_objects
from .mat_tree import MAX_DEPTH, Instance, Measured, Tree, Unread

HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
MATLAB_HEADER_BYTES = 512


def read(path: Path) -> Table:
    """The columns of a MATLAB file.

    Parameters
    ----------
    path : Path

    Returns
    -------
    Table
        Fields of structs count as columns under the shortest of their names that is not ambiguous: "x", "data.x",
        "runs(2).data.x"; the full name may be asked for too.

    Raises
    ------
    BadInput
        When the file is damaged or no MATLAB file, when a library is missing, or when it holds nothing but values of classes
        that no library reads; the sentence then has the line of MATLAB that exports them.
    """
    with open(path, "rb") as file:
        head = file.read(MATLAB_HEADER_BYTES + len(HDF5_SIGNATURE))
    # MATLAB puts its own text before the HDF5 part; other programs often do not.
    newer = head.startswith(HDF5_SIGNATURE) or head.endswith(HDF5_SIGNATURE)
    with guarded(path, "a file that is damaged or no MATLAB file", "a .mat file of version 5 or 7.3"):
        tree = mat73.read_tree(path) if newer else mat5.read_tree(path)
        tree, missing = with_objects(tree, path, newer)
        return _table(tree, path, "mat 7.3" if newer else "mat", missing)


def _table(tree: Tree, path: Path, kind: str, missing: bool) -> Table:
    """The tree's leaves as columns; ``missing`` where a library would read more of them."""
    leaves: list[tuple[str, Any, str]] = []
    for name, value in tree.items():
        _walk(name, value, leaves, 0)
    columns = Columns()
    short = _short_names([name for name, _, _ in leaves])
    labels = [label for _, _, label in leaves if label]
    units = {short[name]: value.unit for name, value, _ in leaves if isinstance(value, Measured)}
    arrays = {short[name]: value.values if isinstance(value, Measured) else value for name, value, _ in leaves}
    named = named_matrix({name: value for name, value in arrays.items() if isinstance(value, np.ndarray)}, str(path))
    for name, value, label in leaves:
        shown = short[name]
        if isinstance(value, Instance):
            columns.left_out[shown] = f"a value of MATLAB's class {value.kind}"
            columns.notes.append(f"{shown} is a value of MATLAB's class {value.kind}, {way_out(name, value.kind, path, missing)}")
        elif isinstance(value, Unread | str):
            columns.left_out[shown] = value.found if isinstance(value, Unread) else "text"
        elif shown in named:
            called = label if labels.count(label) == 1 and label not in short.values() else shown
            columns.add(called, named.pop(shown), units.get(shown, ""), {name, shown} - {called})
    for name, values in named.items():
        columns.add(name, values)
    if not columns.columns and columns.notes:
        name, instance = next((name, value) for name, value, _ in leaves if isinstance(value, Instance))
        found = f"nothing but values of MATLAB's class {instance.kind}"
        raise wrong(str(path), found, way_out(name, instance.kind, path, missing))
    return columns.table(kind)


def _walk(name: str, value: Any, leaves: list[tuple[str, Any, str]], depth: int) -> None:
    """Collect the leaves below a value: name, array (or what stands instead), and the label of a signal."""
    if depth > MAX_DEPTH:
        leaves.append((name, Unread("values nested deeper than any record is"), ""))
    elif isinstance(value, dict):
        signals = value.get("signals")
        if "time" in value and isinstance(signals, dict | list):
            _walk(f"{name}.time", value["time"], leaves, depth + 1)
            _walk_signals(f"{name}.signals", signals if isinstance(signals, list) else [signals], leaves)
            return
        for field, each in value.items():
            _walk(f"{name}.{field}", each, leaves, depth + 1)
    elif isinstance(value, list):
        if value and all(isinstance(each, str) for each in value):  # a cell of names is one array of text
            leaves.append((name, np.array(value), ""))
            return
        if len(value) > MAX_CHANNELS:
            leaves.append((name, Unread(f"an array of {len(value)} structs or cells"), ""))
            return
        for number, each in enumerate(value, start=1):
            _walk(f"{name}({number})", each, leaves, depth + 1)
    else:
        leaves.append((name, value, ""))


def _walk_signals(name: str, signals: list, leaves: list[tuple[str, Any, str]]) -> None:
    """Simulink's structure with time: signals(k).values with signals(k).label, samples along the first axis of a matrix or,
    for signals that are matrices themselves, along the last."""
    for number, each in enumerate(signals, start=1):
        place = f"{name}({number})" if len(signals) > 1 else name
        if not isinstance(each, dict) or not isinstance(each.get("values"), np.ndarray):
            leaves.append((place, Unread("a signal without values"), ""))
            continue
        values = each["values"]
        if values.ndim > 2:
            values = values.reshape(-1, values.shape[-1])
        label = each.get("label")
        leaves.append((f"{place}.values", values, tidy(label) if isinstance(label, str) else ""))


def _short_names(names: list[str]) -> dict[str, str]:
    """Each name without the struct it stands in, where that is not ambiguous; with the outermost struct's name otherwise."""
    short: dict[str, str] = {}
    levels = {name: [name.split(".", depth)[-1] for depth in range(name.count(".") + 1)] for name in names}
    for name, ways in levels.items():
        # Only the outermost struct is a matter of packing; names further in ("signals.values") say what a value is.
        way = ways[min(1, len(ways) - 1)]
        alone = sum(way in (other[0], other[min(1, len(other) - 1)]) for other in levels.values()) == 1
        short[name] = way if alone else name
    return short


def way_out(name: str, kind: str, path: Path, missing: bool = False) -> str:
    """How to get a value of a MATLAB class into a file that can be read: the line of MATLAB that exports it; or, where only the
    library is ``missing`` that reads such values, the library."""
    if missing and kind in ("table", "timetable", "string", "datetime", "duration", "categorical"):
        return 'mat-io to read it: pip install "jaxbacklash[io]"'
    name = "ans" if name == mat5.OPAQUE_NAME else name
    target = f"{path.stem}.csv".replace("'", "''")
    timetable = f"writetimetable(extractTimetable({name}), '{target}')"
    lines = {
        "table": f"writetable({name}, '{target}')",
        "timetable": f"writetimetable({name}, '{target}')",
        "timeseries": f"writematrix([{name}.Time, squeeze({name}.Data)], '{target}')",
        "Simulink.SimulationData.Dataset": timetable,
        "Simulink.SimulationData.Signal": timetable,
        "Simulink.SimulationOutput": timetable,
    }
    plain = f"s = struct({name}); save('{path.stem}_plain.mat', '-struct', 's', '-v7')"
    return f"a file that MATLAB writes with: {lines.get(kind, plain)}"
