"""Goes through the table of `rules`: everything odd in one record, as a list of `Finding`."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jaxbacklash.records.finding import WARN, Finding
from jaxbacklash.records.options import ReadOptions

from . import answers, held, jumps, limits, quantities, relations, spikes, stamps
from .rules import silenced

SHORTEST = 64
"""Samples from which noise and motion can be told apart, see `checks.MIN_SAMPLES`."""


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
    channels = {name: values for name, values in channels.items() if values.size >= SHORTEST}
    if not channels:
        return []
    found = [
        *quantities.quantities(channels, options),
        *jumps.wraps(channels),
        *spikes.spikes(channels),
        *held.held(channels),
        *limits.clipped(channels),
        *answers.answers(t, channels),
    ]
    # What has jumped shifts too, and neither follows anything.
    if not any(one.kind in ("wrap", "sentinel", "spike", "held", "stale") for one in found):
        found += jumps.shifts(channels)
    if all(one.action == WARN for one in found):
        found += relations.relations(channels, extras)
    return _open(found, options, units_stated)


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
    return _open(stamps.stamps(t), options, units_stated)


def _open(found: list[Finding], options: ReadOptions, units_stated: frozenset[str]) -> list[Finding]:
    """Those that the user has not answered, warnings last."""
    found = [one for one in found if not silenced(one.kind, one.channel, options, units_stated)]
    return sorted(found, key=lambda one: one.action == WARN)
