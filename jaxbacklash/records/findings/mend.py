"""Repairs of a channel: those that the user asks for by a flag, before `find`, and those that a warning of `find` announces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jaxbacklash.records.finding import Finding
from jaxbacklash.records.options import ReadOptions

from . import held_values, jumps, spikes
from .channel import Channel
from .local import bridge


def unwrap(values: np.ndarray, turn: float | None = None) -> np.ndarray:
    """A position without its jumps by a full turn.

    Parameters
    ----------
    values : array of shape (N,)
    turn : float, optional
        The turn in the unit of the values; without it the turn by which they jump.

    Returns
    -------
    array of shape (N,)
        The values themselves where there is no jump.

    Examples
    --------
    >>> unwrap(np.array([3.0, 3.1, -3.08, -2.98]), 2 * np.pi).round(2)
    array([3.  , 3.1 , 3.2 , 3.3 ])
    """
    if turn is None:
        found = jumps.turn_of(Channel(values))
        if found is None:
            return values
        turn = found[0]
    return np.unwrap(values, period=turn)


def unshift(values: np.ndarray) -> np.ndarray:
    """A position (N,) without its lasting shifts: what comes after a loss of counts is moved back by it."""
    for row, size in zip(*jumps.shifts_of(Channel(values)), strict=True):
        values = np.concatenate([values[: row + 1], values[row + 1 :] - size])
    return values


def despiked(values: np.ndarray) -> np.ndarray:
    """A channel (N,) whose samples that were never measured (`bad_rows`, `stale_rows`) are bridged by the others."""
    channel = Channel(values)
    rows = np.union1d(spikes.bad_rows(channel), held_values.stale_rows(channel))
    return bridge(values, rows) if rows.size else values


def fresh(values: np.ndarray) -> slice:
    """The rows at which a channel (N,) that is refreshed every k-th row has a new value; all rows where k is 1."""
    every = held_values.refreshed_every(Channel(values))
    if every == 1:
        return slice(None)
    changes = np.flatnonzero(np.diff(values)) + 1
    return slice(int(np.bincount(changes % every).argmax()), None, every)


def _from_rest(channels: dict[str, np.ndarray], turned: dict[str, float]) -> dict[str, np.ndarray]:
    """Unwrapped positions, counted from where the base begins; ``turned`` holds the turn of each.

    An encoder that begins anew amid the motion has its zero half a turn from it: not where the joint rests. Where the record
    begins is the better zero, for gravity and what else depends on the place. Of y less x, and of z, only whole turns are taken:
    their zero is the middle of the play.
    """
    channels = dict(channels)
    base = "x" if "x" in channels else "y"
    if base in turned:
        begin = float(channels[base][0])
        channels |= {name: channels[name] - begin for name in ("x", "y") if name in channels}
    for name in turned.keys() - {base}:
        apart = channels[name] - channels["x"] if name == "y" else channels[name]
        channels[name] = channels[name] - turned[name] * np.round(np.median(apart) / turned[name])
    return channels


def before(
    t: np.ndarray, channels: dict[str, np.ndarray], extras: dict[str, np.ndarray], options: ReadOptions
) -> tuple[np.ndarray, dict[str, np.ndarray], dict[str, np.ndarray]]:
    """A record's columns with all that the user asked to be mended: sign, ratio, unwrap, despike.

    Parameters
    ----------
    t : array of shape (N,)
    channels, extras : dict of arrays of shape (N,)
        The channels finite and in SI.
    options : ReadOptions
        Its `sign`, `ratio`, `unwrap` and `despike`.

    Returns
    -------
    t, channels, extras
        Of shape (M,). Positions that jumped by a turn count from where the record begins. Where a channel of `despike` has a new
        value every k-th row only, those rows are kept, M = N / k: what stands between them would bring noise that is not
        independent from sample to sample, and make every interval too narrow.
    """
    mended = dict(channels)
    turned = {}
    for name, values in channels.items():
        if name in options.sign:
            values = -values
        if name == "x" and options.ratio is not None:
            values = values / options.ratio
        if name in options.despike and held_values.refreshed_every(Channel(values)) == 1:
            values = despiked(values)
        if name in options.unwrap:
            jumped = jumps.turn_of(Channel(values))
            if jumped is not None:
                turned[name] = jumped[0]
                values = unwrap(values, jumped[0])
            values = unshift(values)
        mended[name] = values
    mended = _from_rest(mended, turned)
    for name in sorted(options.despike & mended.keys()):
        rows = fresh(mended[name])
        if rows != slice(None):
            t, extras = t[rows], {each: values[rows] for each, values in extras.items()}
            mended = {each: values[rows] for each, values in mended.items()}
            mended[name] = despiked(mended[name])
    return t, mended, extras


def after(
    t: np.ndarray, channels: dict[str, np.ndarray], extras: dict[str, np.ndarray], findings: Sequence[Finding]
) -> tuple[np.ndarray, dict[str, np.ndarray], dict[str, np.ndarray]]:
    """A record's columns without what the findings say is bridged or left out.

    Parameters
    ----------
    t : array of shape (N,)
    channels, extras : dict of arrays of shape (N,)
    findings : sequence of Finding

    Returns
    -------
    t, channels, extras
        Of shape (M,), M <= N.
    """
    for one in findings:
        if one.bridged and one.channel in channels:
            channels = channels | {one.channel: bridge(channels[one.channel], one.bridged)}
    first = max((one.left_out for one in findings), default=0)
    if not first:
        return t, channels, extras
    return t[first:], {name: v[first:] for name, v in channels.items()}, {name: v[first:] for name, v in extras.items()}
