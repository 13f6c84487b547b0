"""Repairs of a channel: those that the user asks for by a flag, before `find`, and those that a warning of `find` announces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jaxbacklash.records.finding import Finding

from . import jumps


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
        found = jumps.turn_of(values)
        if found is None:
            return values
        turn = found[0]
    return np.unwrap(values, period=turn)


def bridge(values: np.ndarray, rows: Sequence[int] | np.ndarray) -> np.ndarray:
    """Values whose samples at ``rows`` (from 0) are replaced by a cubic through the two good ones on either side."""
    rows = np.unique(np.asarray(rows, dtype=int))
    good = np.ones(values.size, dtype=bool)
    good[rows] = False
    kept = np.flatnonzero(good)
    out = values.copy()
    if kept.size < 4 or not rows.size:
        return out
    first = np.clip(np.searchsorted(kept, rows) - 2, 0, kept.size - 4)
    knots = kept[first[:, None] + np.arange(4)]
    # Lagrange's form of the cubic through four points, for all rows at once.
    total = np.zeros(rows.size)
    for i in range(4):
        term = values[knots[:, i]]
        for j in range(4):
            if j != i:
                term = term * (rows - knots[:, j]) / (knots[:, i] - knots[:, j])
        total += term
    out[rows] = total
    return out


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
