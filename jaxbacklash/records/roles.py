"""Which column may hold which channel: a proposal for a person to check, never taken without being asked for.

`columns.pick` puts it into its refusals and `look` into the command to go on with.
"""

from __future__ import annotations

import contextlib
import shlex

import numpy as np

from .header_units import split_unit
from .table import Column, Table
from .units import spelt

NAMES: dict[str, tuple[str, ...]] = {
    "t": (
        "t", "time", "timestamp", "time stamp", "elapsed", "zeit", "temps", "tiempo", "seconds", "sec", "datetime", "clock",
        "stamp",
    ),
    "x": ("x", "base", "input", "motor", "drive", "shaker", "platform", "phi", "enc1", "encoder1", "ch1", "channel 1", "ai0"),
    "z": ("z", "relative", "rel", "difference", "diff", "play", "ch2", "channel 2", "enc2", "encoder2", "ai1"),
    "y": ("y", "link", "output", "load", "arm", "absolute", "abs", "theta", "position", "pos", "angle"),
    "F": ("F", "force", "torque", "load cell"),
    "T": ("T", "transmitted"),
}  # fmt: skip
"""Names by channel, the likelier first; compared in lower case without what is in brackets. "F" and "T" stand for themselves."""

QUANTITIES = frozenset(("position", "pos", "angle", "data", "value", "values"))
"""Last parts of names in groups that say what is measured and not of what."""

FOLLOWS = 0.7
"""Correlation with x above which a motion is that of the link against the ground (y) rather than against the base (z)."""

MOSTLY = 0.9
"""Share of a column's cells above which it is one of numbers in which words stand, such as "ERR" where a sensor failed."""
FIRST_CELLS = 50


def numeric(column: Column) -> bool:
    """Whether a column holds numbers that change."""
    values = column.values
    if values.dtype.kind != "f":
        return False
    known = values[np.isfinite(values)]
    return known.size > 1 and bool(known.min() < known.max())


def numbers_but_for_a_word(column: Column) -> np.ndarray | None:
    """The values (N,) of a column that is text for the sake of a few cells, NaN in their place; None for any other column.

    Such a column stays text, and is refused by the row and word that made it so: here it only is a column that moves.
    """
    values = column.values
    if values.dtype.kind != "U" or not values.size:
        return None
    known = np.full(values.size, np.nan)
    for row, cell in enumerate(values.tolist()):
        with contextlib.suppress(ValueError):
            known[row] = float(cell.replace(",", "."))
        if row == FIRST_CELLS and np.isfinite(known).sum() <= MOSTLY * row:
            return None  # words from the beginning; all of a long column need not be looked at
    share = np.isfinite(known).mean()
    return known if MOSTLY < share < 1.0 else None


def holds_numbers(column: Column) -> bool:
    """Whether a column holds numbers that change, but for a word or two."""
    known = numbers_but_for_a_word(column)
    return numeric(column if known is None else Column(column.name, known))


def _likeness(channel: str, column: Column) -> int:
    """How well a column's name fits a channel: 3 the same, 2 a usual name, 1 begins with one, 0 not at all."""
    *groups, own = column.name.split("/")
    bare, unit = split_unit(own)
    if groups and bare.lower() in QUANTITIES:
        bare = groups[-1]  # robots write "joint_states/elbow/position"
    unit = column.unit or unit
    if unit and spelt(channel, unit) is None:
        return 0  # a force in kip is no motion
    if bare == channel:
        return 3
    if bare.startswith(f"{channel}_"):
        return 1
    lower = " ".join(bare.lower().replace("_", " ").split())
    if lower in NAMES[channel][1:]:
        return 2
    words = [name for name in NAMES[channel][1:] if len(name) > 2]
    return 1 if any(lower.startswith(word) or lower.endswith(word) for word in words) else 0


def _is_time(column: Column) -> bool:
    """Whether the values of a column of numbers only grow; whole numbers too long for double precision are kept as text."""
    values = column.values
    if values.dtype.kind == "U":
        return _grows(values)
    return values.dtype.kind == "f" and values.size > 2 and bool(np.all(np.diff(values[np.isfinite(values)]) > 0))


def _grows(values: np.ndarray) -> bool:
    """Whether texts are whole numbers that only grow."""
    if values.size < 3 or not values[0].strip().isdigit():
        return False
    try:
        return bool(np.all(np.diff(values.astype(np.int64)) > 0))
    except (ValueError, OverflowError):
        return False


def guess_roles(table: Table) -> dict[str, int]:
    """Numbers of the columns (from 0) that may hold t and the channels of one experiment.

    Names decide first. Where they do not say what moves, the columns of numbers that change are taken in their order: the first
    as x, the second as y where it follows x and as z where it does not.

    Examples
    --------
    >>> import numpy as np
    >>> from jaxbacklash.records.table import Column, Table
    >>> time = Column("Time [s]", np.arange(9.0), "s")
    >>> base, link = Column("Base", np.sin(time.values)), Column("Rel", np.cos(3 * time.values))
    >>> guess_roles(Table((time, base, link), "csv"))
    {'t': 0, 'x': 1, 'z': 2}
    """
    found: dict[str, int] = {}
    for level in (3, 2, 1):
        for channel in NAMES:
            for number, column in enumerate(table.columns):
                if channel in found or number in found.values() or _likeness(channel, column) != level:
                    continue
                if channel == "t" or holds_numbers(column):
                    found[channel] = number
    if "t" not in found:
        times = [number for number, column in enumerate(table.columns) if number not in found.values() and _is_time(column)]
        found |= {"t": times[0]} if times else {}
    moves = {channel for channel in found if channel in ("z", "y")}
    if not moves and {"x", "F"} <= set(found):
        found["T"] = found.pop("F")  # beside the base's motion alone a force is the one that the joint transmits
    rest = [
        n for n, column in enumerate(table.columns) if n not in found.values() and holds_numbers(column) and not _is_time(column)
    ]
    if not moves and "T" not in found and rest:
        if "x" not in found and "F" not in found and len(rest) > 1:
            found["x"] = rest.pop(0)
        found[_motion(table, found, rest[0])] = rest[0]
    elif moves and "x" not in found and "F" not in found and rest:
        found["x"] = rest[0]
    return dict(sorted(found.items(), key=lambda item: list(NAMES).index(item[0])))


def _floats(column: Column) -> np.ndarray:
    known = numbers_but_for_a_word(column)
    return column.values if known is None else known


def _motion(table: Table, found: dict[str, int], number: int) -> str:
    """Whether a motion looks like y or like z beside x."""
    if "x" not in found:
        return "y" if "F" in found else "z"
    x, motion = (_floats(table.columns[n]) for n in (found["x"], number))
    if x.size != motion.size:
        return "z"
    both = np.isfinite(x) & np.isfinite(motion)
    spread = np.std(x[both]) * np.std(motion[both]) if both.any() else 0.0
    together = np.mean((x[both] - x[both].mean()) * (motion[both] - motion[both].mean())) / spread if spread else 0.0
    return "y" if abs(together) > FOLLOWS else "z"


def spec_of(table: Table, number: int) -> str:
    """How `--columns` names a column: by its name, in quotes where that holds a comma; by number where that cannot be written."""
    name = table.columns[number].name
    unwritable = name.startswith("#") or not name.isprintable() or any(mark in name for mark in "\"'=`!\\")
    if unwritable or table.names.count(name) > 1 or name == f"column {number + 1}":
        return f"#{number + 1}"
    return f'"{name}"' if "," in name else name


def columns_option(table: Table, roles: dict[str, int]) -> str:
    """The option that says which column is which, quoted for a shell; empty where every channel's column has its name.

    Examples
    --------
    >>> import numpy as np
    >>> from jaxbacklash.records.table import Column, Table
    >>> columns_option(Table((Column("Time, s", np.arange(3.0)), Column("x", np.arange(3.0))), "csv"), {"t": 0, "x": 1})
    '--columns \\'t="Time, s"\\''
    """
    told = {channel: spec_of(table, number) for channel, number in roles.items()}
    bare = [split_unit(name)[0] for name in table.names]
    own = {channel for channel, number in roles.items() if bare[number] == channel and bare.count(channel) == 1}
    needed = [f"{channel}={spec}" for channel, spec in told.items() if channel not in own]
    return f"--columns {shlex.quote(','.join(needed))}" if needed else ""
