"""Columns as numbers in SI and radians: by the units that the user states, else by those that the file states."""

from __future__ import annotations

import numpy as np

from jaxbacklash.errors import BadInput

from . import checks
from .checks import listed, number, wrong
from .columns import Picked
from .options import ReadOptions
from .table import Column, Table
from .units import UNITS, factors, spelt

NO_UNITS = ("", "-", "1", "none", "n/a", "a.u.", "au", "arb", "arb. unit")
"""What files write where a column has no unit."""


def numbers_of(table: Table, column: Column, channel: str, where: str) -> np.ndarray:
    """The values of a column as float64, shape (N,).

    Raises
    ------
    BadInput
        When it is text: names the first cell that is no number.
    """
    if column.values.dtype.kind == "U":
        wrong_cells = ((row, cell) for row, cell in enumerate(column.values) if not _is_number(cell))
        row, cell = next(wrong_cells, (None, ""))
        if row is None:
            return column.values.astype(float)
        found = f'"{cell[:40]}"' if cell else "an empty cell"
        wanted = "a number, or an empty cell where none was measured, which --resample bridges"
        raise wrong(f"{where} {table.place(row)}, column {column.name}", found, wanted)
    return checks.real_vector(column.values, column.name or channel, where)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def stated_units(picked: Picked, options: ReadOptions, where: str) -> tuple[dict[str, str], list[str]]:
    """Units by channel, from `--unit` or else from the file, and sentences on what the file said.

    Raises
    ------
    BadInput
        When the file states a unit that no channel of this kind can have, or one that `--scale` may mean to replace.
    """
    units, notes = dict(options.units), []
    for channel, column in picked.channels.items():
        stated = column.unit.strip()
        if channel == "t" or channel in options.units or stated.lower() in NO_UNITS:
            continue
        known = spelt(channel, stated)
        if known is None:
            if channel in options.scales:
                continue
            units_known = listed(UNITS[channel], limit=99)
            wanted = f"one of {units_known}: say --unit {channel}=UNIT, or --scale {channel}=FACTOR to SI"
            raise wrong(f"{where}, column {column.name}", f'the unit "{stated}"', wanted)
        factor = UNITS[channel][known]
        if channel in options.scales and factor != 1.0:
            base = next(unit for unit in UNITS[channel] if UNITS[channel][unit] == 1.0)
            found = f"the unit {known} in the file and --scale {channel}={number(options.scales[channel])}"
            wanted = f"--unit {channel}={known} if the factor comes on top of that, --unit {channel}={base} if it stands for it"
            raise wrong(f"{where}, column {column.name}", found, wanted)
        units[channel] = known
        if factor != 1.0:
            notes.append(f'"{column.name}" is read in {known}, as the file states, for {channel}')
    return units, notes


def in_si(table: Table, picked: Picked, options: ReadOptions, where: str) -> tuple[dict[str, np.ndarray], list[str]]:
    """The channels but t in SI and radians, and sentences on how they were converted.

    Raises
    ------
    BadInput
        When a column is no column of numbers, or units contradict each other.
    """
    units, notes = stated_units(picked, options, where)
    found = {name: numbers_of(table, column, name, where) for name, column in picked.channels.items() if name != "t"}
    absent = [name for name in (*units, *options.scales) if name not in picked.channels]
    if absent and not (absent == ["t"] and options.rate is not None):
        option = "--unit" if absent[0] in units else "--scale"
        raise wrong(where, f"no channel {absent[0]}, which {option} names", f"one of {listed(picked.channels)}")
    motions = [name for name in found if name in ("x", "z", "y")]
    told = {name: unit for name, unit in units.items() if name in motions and name not in options.units}
    silent = [name for name in motions if name not in units and name not in options.scales]
    if told and silent:
        _one_kind(told, silent, where)
    kept = {name: unit for name, unit in units.items() if name in found}
    scales = {name: scale for name, scale in options.scales.items() if name in found}
    for name, factor in factors(kept, scales, found, where).items():
        found[name] = found[name] * factor
    return found, notes


def _one_kind(stated: dict[str, str], silent: list[str], where: str) -> None:
    """Refuse degrees that the file states beside a motion of no unit: is the other one meant too?"""
    other = next(iter(stated.values()))
    if UNITS["x"][other] == 1.0:
        return
    option = "--unit " + ",".join(f"{name}={other}" for name in silent)
    found = f"{next(iter(stated))} in {other} and no unit for {silent[0]}"
    raise BadInput(f"{where}: found {found}, wanted both stated: {option}, or --unit {silent[0]}=rad.", remedy=option)
