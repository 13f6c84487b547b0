"""From the columns of a file to the channels of a record."""

import difflib
from collections.abc import Iterable, Mapping

import numpy as np

from .checks import CHANNELS, WANTED_CHANNELS, listed, wrong


def wanted_columns(mapping: Mapping[str, str]) -> set[str]:
    """Names of the columns that become channels if the file has them; the others need not hold numbers."""
    return {mapping.get(name, name) for name in ("t", *CHANNELS)}


def pick(
    table: Mapping[str, np.ndarray], mapping: Mapping[str, str], where: str
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Sort columns into channels and extras.

    Parameters
    ----------
    table : mapping of arrays
        The columns of the file, by name.
    mapping : mapping of str
        Column names by channel, from `--columns`. A channel not mapped is the column of its own name, unless that one
        was mapped to another channel.
    where : str
        The file, for the sentence.

    Returns
    -------
    channels, extras : dict of arrays
        `channels` has "t". A column whose name is that of a channel taken from elsewhere becomes "NAME (unmapped)".

    Raises
    ------
    BadInput
        When a mapped column, the time or every motion is missing; says what was found and suggests near names.
    """
    channels = {}
    for name in ("t", *CHANNELS):
        column = mapping.get(name, name)
        if column in table and (name in mapping or column not in mapping.values()):
            channels[name] = table[column]
        elif name in mapping:
            near = _near(column, table)
            hint = f" (did you mean {near}?)" if near else ""
            raise wrong(where, f'no column "{column}", which --columns names', f"one of {listed(table)}{hint}")
    taken = set(mapping.values()) | (set(channels) - set(mapping))
    if "t" not in channels:
        raise wrong(where, f"the columns {listed(table)}", f"a time column t{_advice('t', table, taken)}")
    if len(channels) == 1 and len(table) > 1:
        others = [name for name in table if name not in taken]
        raise wrong(where, f"t and the columns {listed(others)}", f"{WANTED_CHANNELS}{_advice('z', table, taken)}")
    extras = {
        f"{column} (unmapped)" if column in ("t", *CHANNELS) else column: values
        for column, values in table.items()
        if column not in taken
    }
    return channels, extras


def _advice(channel: str, table: Iterable[str], taken: set[str]) -> str:
    """The end of a sentence: how to name the column that holds a channel."""
    near = _near(channel, [name for name in table if name not in taken])
    example = f"{channel}={near}" if near else f"{channel}=NAME"
    return f"; say which column it is with --columns {example}{'' if near is None else ' or the like'}"


def _near(wanted: str, names: Iterable[str]) -> str | None:
    """The name most like the one wanted, if any is; for a channel's one letter, a name that begins with it."""
    lower = {name.lower(): name for name in names}
    close = difflib.get_close_matches(wanted.lower(), lower, n=1)
    if close:
        return lower[close[0]]
    if len(wanted) == 1:
        return next((name for low, name in lower.items() if low.startswith(wanted.lower())), None)
    return None
