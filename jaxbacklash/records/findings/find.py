"""Goes through the table of `rules`: everything odd in one record, as a list of `Finding`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

import numpy as np

from jaxbacklash.records.finding import WARN, Finding
from jaxbacklash.records.options import ReadOptions

from . import answers, drives, held_values, jumps, limits, mend, quantities, relations, spikes, stamps
from .channel import Channel, by_name
from .rules import silenced

Part = TypeVar("Part")

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
    looked_at = by_name({name: values for name, values in channels.items() if values.size >= SHORTEST})
    if not looked_at:
        return []
    found: list[Finding] = []
    # What one check finds would set off the next: a code stands out, a wrap shifts, and neither follows anything. So a channel is
    # looked at further once it is mended, and the whole record once no channel waits for an answer.
    for check in (jumps.known_wraps, spikes.codes, jumps.wraps, held_values.held_values, spikes.spikes):
        measured = {name: channel for name, channel in looked_at.items() if name != "command"}  # what was told may jump, and stay
        new = _open(check(_others(measured, found)), options, units_stated)
        looked_at = _mended(t, looked_at, new) if new else looked_at
        found += new
    channels = {name: channel.values for name, channel in looked_at.items()}
    new = _open(quantities.quantities(_others(channels, found), options, units_stated), options, units_stated)
    if any(one.kind == "degrees" for one in new):  # A size, which a gear or a sample never measured changes too.
        if _waiting(found):
            new = [one for one in new if one.kind != "degrees"]
        else:
            new = _open(relations.before_sizes(channels, extras), options, units_stated) or new
    found += new
    for whole in (
        lambda: limits.clipped(looked_at) or held_values.held_rows(looked_at) or jumps.shifts(t, looked_at),
        lambda: relations.relations(channels, extras) or drives.drives(t, channels, options),
        lambda: answers.answers(t, looked_at),
    ):
        if not _waiting(found):
            found += _open(whole(), options, units_stated)
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


def _others(channels: Mapping[str, Part], found: list[Finding]) -> dict[str, Part]:
    """The channels about which nothing is refused or asked yet."""
    waiting = _waiting(found)
    return {name: channel for name, channel in channels.items() if name not in waiting}


def _mended(t: np.ndarray, channels: Mapping[str, Channel], found: list[Finding]) -> dict[str, Channel]:
    """The channels without what the findings say is bridged; those that stay as they are keep what is known of them."""
    mended = mend.after(t, {name: channel.values for name, channel in channels.items()}, {}, found)[1]
    return {name: one if mended[name] is one.values else Channel(mended[name]) for name, one in channels.items()}


def _waiting(found: list[Finding]) -> set[str]:
    """The channels about which something is refused or asked."""
    return {one.channel for one in found if one.action != WARN}


def _open(found: list[Finding], options: ReadOptions, units_stated: frozenset[str]) -> list[Finding]:
    """Those that the user has not answered, warnings last."""
    found = [one for one in found if not silenced(one.kind, one.channel, options, units_stated)]
    return sorted(found, key=lambda one: one.action == WARN)
