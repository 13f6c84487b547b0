"""How the user wants a file read: one object for the command line, Python and `look` alike."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping


@dataclasses.dataclass(frozen=True)
class ReadOptions:
    """What was said about a file. A flag given on purpose switches off the check that asked for it, and no other.

    Parameters
    ----------
    columns : mapping of str
        Columns by channel: a name as in the file, "#3" for the third, "group/channel" where channels come in groups.
    units : mapping of str
        Units of channels; they override those that the file states. See `units.UNITS`.
    scales : mapping of float
        Factors of channels.
    resample : bool or float or None
        True brings uneven times to an even grid at the record's own rate, and bridges short runs of NaN and lost rows; a
        number is the rate wanted [Hz].
    rate : float or None
        Samples per second of a file without a time column, or with times that cannot be used [Hz].
    skip : int
        Lines at the beginning of a text file to pass over.
    unwrap : frozenset of str
        Channels whose jumps by a full turn (2 pi, 360 degrees, 2^n counts) are undone.
    ratio : float or None
        Turns of x, or of the motor of a drive, for a turn of the link: x is divided by it.
    kt : float or None
        Torque of the motor for an ampere [N m/A], where its current was measured.
    sign : frozenset of str
        Channels measured the other way round: turned.
    despike : frozenset of str
        Channels whose samples that were never measured are bridged by the others: spikes, codes such as 0 or -9999, repeats of
        the sample before. Where a channel has a new value every k-th row only, those rows of the record are kept.
    decimal : str or None
        The decimal mark of a text file, "." or ",", where the file can be read both ways.
    start, stop : float or None
        Only the samples between these times of the file are used [s].
    accept : frozenset of str
        Kinds of finding that the user has looked at and believes right as they are: rows of `findings.rules.RULES`.
    """

    columns: Mapping[str, str] = dataclasses.field(default_factory=dict)
    units: Mapping[str, str] = dataclasses.field(default_factory=dict)
    scales: Mapping[str, float] = dataclasses.field(default_factory=dict)
    resample: bool | float | None = None
    rate: float | None = None
    skip: int = 0
    unwrap: frozenset[str] = frozenset()
    ratio: float | None = None
    sign: frozenset[str] = frozenset()
    despike: frozenset[str] = frozenset()
    decimal: str | None = None
    start: float | None = None
    stop: float | None = None
    accept: frozenset[str] = frozenset()
    kt: float | None = None
