"""From the columns of a file to the channels of a record.

A column becomes a channel where it has the channel's name ("x", or "x [deg]" with its unit; "time" for t), or where `--columns`
says so. Nothing else is guessed at: what `roles` proposes stands in the refusal, ready to paste.
"""

from __future__ import annotations

import dataclasses
import difflib
from collections.abc import Mapping

import numpy as np

from jaxbacklash.errors import BadInput

from .checks import CHANNELS, OF_A_DRIVE, PUSHES, WANTED_CHANNELS, listed, wrong
from .header_units import split_unit
from .roles import columns_option, guess_roles, spec_of
from .table import Column, Table


@dataclasses.dataclass(frozen=True, eq=False)
class Picked:
    """Columns by channel (with "t" where the file has times), all other columns, and sentences on what was taken for what."""

    channels: dict[str, Column]
    numbers: dict[str, int]
    extras: dict[str, np.ndarray]
    notes: tuple[str, ...]


def pick(table: Table, mapping: Mapping[str, str], where: str, *, timed: bool = True) -> Picked:
    """Sort columns into channels and extras.

    Parameters
    ----------
    table : Table
    mapping : mapping of str
        Columns by channel, from `--columns`: a name, or "#3" for the third. A channel not mapped is the column of its own name,
        unless that one was mapped to another channel.
    where : str
        The file, for the sentence.
    timed : bool
        Whether a column of times is wanted; not where the rate is known.

    Raises
    ------
    BadInput
        When a mapped column, the time or every motion is missing; says which columns it may be, ready to paste.
    """
    numbers = {channel: column_number(table, spec, where) for channel, spec in mapping.items()}
    _apart(table, mapping, numbers, where)
    for channel in ("t", *CHANNELS):
        found = own_number(table, channel, numbers)
        if channel not in numbers and found is not None:
            numbers[channel] = found
    numbers = _of_a_drive(table, numbers, where)
    _complete(table, numbers, where, timed)
    channels = {channel: table.columns[number] for channel, number in numbers.items()}
    extras = {
        f"{column.name} (unmapped)" if column.name in ("t", *CHANNELS, *OF_A_DRIVE) else column.name: column.values
        for number, column in reversed(list(enumerate(table.columns)))
        if number not in numbers.values() and not _empty(column)
    }
    return Picked(channels, numbers, dict(reversed(extras.items())), _notes(table, mapping, numbers))


def _of_a_drive(table: Table, numbers: Mapping[str, int], where: str) -> dict[str, int]:
    """The columns of a drive by their own names, where no other experiment is there; motor and link alone are x and y.

    Raises
    ------
    BadInput
        Channels of a drive beside those of another experiment.
    """
    drives = {channel: number for channel, number in numbers.items() if channel in OF_A_DRIVE}
    others = sorted(set(numbers) & set(CHANNELS))
    if drives and others:
        raise wrong(where, f"{next(iter(drives))} beside {others[0]}", f"{WANTED_CHANNELS}, not two experiments in one")
    if others:
        return dict(numbers)
    for channel in OF_A_DRIVE:
        found = own_number(table, channel, {**numbers, **drives})
        if channel not in drives and found is not None:
            drives[channel] = found
    pushed = sorted(set(PUSHES) & set(drives), key=lambda one: (one not in numbers, PUSHES.index(one)))[:1]  # mapped ones first
    drives = {channel: number for channel, number in drives.items() if channel not in PUSHES or channel in pushed}
    if pushed == ["command"] and "link" in drives and "motor" not in drives:
        raise wrong(where, "command and link", "command with motor, whose error the servo acts on, and link beside it or not")
    if not pushed and {"motor", "link"} <= set(drives):
        drives = {"x": drives["motor"], "y": drives["link"]}
    elif not (pushed and {"motor", "link"} & set(drives)):
        return dict(numbers)
    return {**{channel: number for channel, number in numbers.items() if channel == "t"}, **drives}


def column_number(table: Table, spec: str, where: str) -> int:
    """The number (from 0) of the column that ``spec`` names.

    Raises
    ------
    BadInput
        When there is no such column; suggests near names.
    """
    names = table.names
    if spec in names:
        return names.index(spec)
    if spec.startswith("#") and spec[1:].isdecimal():
        number = int(spec[1:])
        if not 1 <= number <= len(names):
            raise wrong(where, f"no column {spec}, which --columns names", f"one of #1 to #{len(names)} ({listed(names)})")
        return number - 1
    ends = [number for number, name in enumerate(names) if spec in (split_unit(name)[0], name.rpartition("/")[2])]
    ends = [number for number, column in enumerate(table.columns) if spec in column.aliases] or ends
    if len(ends) == 1:
        return ends[0]
    if spec in table.left_out:
        option = columns_option(table, guess_roles(table))
        way_out = f", as with {option}" if option else ""
        sentence = f"{where}, column {spec}: found {table.left_out[spec]}, wanted one number for each sample{way_out}."
        raise BadInput(sentence, remedy=option)
    near = _near(spec, names)
    hint = f" (did you mean {spec_of(table, names.index(near))}?)" if near else ""
    numbered = ", ".join(f"#{number} {name}" for number, name in enumerate(names[:12], 1))
    more = f" and {len(names) - 12} more" if len(names) > 12 else ""
    quoting = "; a name with a comma is written in quotes, as in 't=\"Time, s\"'" if any("," in name for name in names) else ""
    raise wrong(where, f'no column "{spec}", which --columns names', f"one of {numbered or 'nothing'}{more}{hint}{quoting}")


def _apart(table: Table, mapping: Mapping[str, str], numbers: Mapping[str, int], where: str) -> None:
    """Refuse one column for two channels; where its name stands more than once, each channel may have one of these."""
    for channel, number in numbers.items():
        same = [other for other, its in numbers.items() if its == number]
        if len(same) == 1:
            continue
        name = table.columns[number].name
        found = f'the column "{mapping[channel]}" for {same[0]} and for {same[1]}'
        alike = [n for n, other in enumerate(table.names) if other == name]
        if len(alike) < len(same):
            raise wrong(where, found, "one channel for it")
        option = columns_option(table, {**numbers, **dict(zip(same, alike, strict=False))})
        raise BadInput(f'{where}: found {found}, wanted each once; "{name}" stands {len(alike)} times: {option}.', remedy=option)


def _empty(column: Column) -> bool:
    """Whether a column has no value at all, like the one that a separator at the end of each line makes."""
    return column.values.dtype.kind == "f" and bool(np.isnan(column.values).all())


def own_number(table: Table, channel: str, taken: Mapping[str, int]) -> int | None:
    """The column of a channel's name; else the one with that name and a unit beside it, or, for t, the word "time"."""
    plain = next((n for n, name in enumerate(table.names) if name == channel and n not in taken.values()), None)
    if plain is not None:
        return plain
    open_ = {n: split_unit(name)[0] for n, name in enumerate(table.names) if n not in taken.values()}
    like = [n for n, bare in open_.items() if bare == channel]
    if channel == "t" and not like:
        like = [n for n, bare in open_.items() if bare.lower() == "time"]
    return like[0] if len(like) == 1 else None


def _complete(table: Table, numbers: Mapping[str, int], where: str, timed: bool) -> None:
    """Refuse a table without times or without a motion, with the option that may be what is wanted."""
    moves = {"z", "y", "motor", "link"} & set(numbers) or {"x", "T"} <= set(numbers)
    if ("t" in numbers or not timed) and moves:
        return
    unused = next((name for name in ("t", *CHANNELS) if name in table.left_out and name not in numbers), None)
    if unused is not None:
        raise wrong(f"{where}, column {unused}", table.left_out[unused], "one number for each sample")
    named = f"the columns {listed(table.names)}"
    if all(name == f"column {number}" for number, name in enumerate(table.names, 1)):
        named += " (by number, for want of a header)"
    missing = "a time column t" if timed and "t" not in numbers else f"{WANTED_CHANNELS} beside it"
    roles = guess_roles(table)
    option = columns_option(table, roles)
    if timed and "t" not in numbers and "t" not in roles:
        stated = f"{table.rate_hz:.9g}" if table.rate_hz else "HZ"
        known = ", which the file states" if table.rate_hz else ", the samples per second"
        option = f"{option} --rate {stated}".strip()
        sentence = f"{where}: found {named}, wanted {missing}, or the rate with --rate {stated}{known}."
        raise BadInput(sentence, remedy=_told(option))
    if not {"z", "y"} & set(roles) and not {"x", "T"} <= set(roles):
        raise wrong(where, named, f"{missing}; say which column is which with --columns CHANNEL=NAME")
    raise BadInput(f"{where}: found {named}, wanted {missing}; if it is so say {option}.", remedy=option)


def _told(option: str) -> str:
    """An option as a remedy, unless something is left open in it."""
    return "" if "HZ" in option else option


def _notes(table: Table, mapping: Mapping[str, str], numbers: Mapping[str, int]) -> tuple[str, ...]:
    """What is said of times by another name, and of a name that stands twice."""
    notes = []
    for channel, number in numbers.items():
        name = table.columns[number].name
        if channel == "t" and channel not in mapping and split_unit(name)[0] != "t":
            notes.append(f'"{name}" is taken as t')
        others = [n for n, other in enumerate(table.names) if other == name and n != number]
        if others:
            rest = " and ".join(f"#{n + 1}" for n in others)
            notes.append(f'the name "{name}" stands more than once: column #{number + 1} is taken as {channel}, not {rest}')
    return tuple(notes)


def _near(wanted: str, names: list[str]) -> str | None:
    """The name most like the one wanted, if any is; for a channel's one letter, a name that begins with it."""
    lower = {name.lower(): name for name in reversed(names)}
    close = difflib.get_close_matches(wanted.lower(), lower, n=1)
    if close:
        return lower[close[0]]
    if len(wanted) == 1:
        return next((name for low, name in lower.items() if low.startswith(wanted.lower())), None)
    return None
