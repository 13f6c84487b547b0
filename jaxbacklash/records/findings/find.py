"""Goes through the table of `rules`: everything odd in one record, as a list of `Finding`."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jaxbacklash.records.finding import Finding
from jaxbacklash.records.options import ReadOptions

from . import jumps
from .rules import silenced


def find(
    t: np.ndarray,
    channels: Mapping[str, np.ndarray],
    extras: Mapping[str, np.ndarray],
    options: ReadOptions,
    *,
    units_stated: frozenset[str] = frozenset(),
    rate_hz: float | None = None,
) -> list[Finding]:
    """Everything odd in the channels of a record.

    Parameters
    ----------
    t : array of shape (N,), s
    channels : mapping of arrays of shape (N,)
        "x", "y", "z" [rad or m], "F", "T" [N m or N], finite, in SI as far as the user stated units; already mended as asked.
    extras : mapping of arrays of shape (N,)
        Further columns by name; may hold text or NaN.
    options : ReadOptions
        What the user said. A flag given on purpose switches off its own check and no other, see `rules.RULES`.
    units_stated : frozenset of str
        Channels (and "t") whose unit the user or the file states.
    rate_hz : float, optional
        Samples per second; that of ``t`` where absent.

    Returns
    -------
    list of Finding
        Those that refuse or ask first. What the user has answered is not among them.
    """
    found = [*jumps.wraps(channels)]
    found = [one for one in found if not silenced(one.kind, one.channel, options, units_stated)]
    return sorted(found, key=lambda one: one.action == "warn")


def find_in_times(t: np.ndarray, options: ReadOptions, *, units_stated: frozenset[str] = frozenset()) -> list[Finding]:
    """Everything odd in the times of a record, before they are known to be even.

    Parameters
    ----------
    t : array of shape (N,), s as far as the unit is known; finite, in the order of the file
    options, units_stated
        As `find` takes them.

    Returns
    -------
    list of Finding
        About the channel "t".
    """
    return []
