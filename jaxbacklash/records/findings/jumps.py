"""Jumps of a position that no mass makes: an encoder that begins anew after a full turn."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jaxbacklash.records.finding import REFUSE, Finding

POSITIONS = ("x", "y", "z")
TURNS = {2 * np.pi: "2 pi", np.pi: "pi", 360.0: "360", 180.0: "180"}
"""Where angles begin anew, in rad and degrees."""
CLEAR = 20.0
"""Times the usual step around it that a jump is at least."""
MATCH = 2e-3
"""Share of a turn by which a jump, less the motion around it, may miss it: noise and what the motion curves by."""


def wraps(channels: Mapping[str, np.ndarray]) -> list[Finding]:
    """Jumps by a full turn, in x, y and z."""
    found = []
    for name in POSITIONS:
        if name in channels and (jumped := turn_of(channels[name])):
            turn, rows = jumped
            called = TURNS.get(turn, f"{turn:.6g}")
            more = f" and {rows.size - 1} more" if rows.size > 1 else ""
            what = f"jumps by {called} between rows {rows[0] + 1} and {rows[0] + 2}{more}, as an encoder that begins anew does"
            found.append(Finding("wrap", REFUSE, name, what, f"--unwrap {name}", tuple(rows.tolist()), turn))
    return found


def jumps_of(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows (of the sample before) and sizes of the steps that are far larger than those around them.

    A size is free of the motion around it: the mean of the steps before and after is taken off.
    """
    steps = np.diff(values)
    if steps.size < 8:
        return np.zeros(0, dtype=int), np.zeros(0)
    size = np.abs(steps)
    # Only the largest can be jumps; a hundred times the usual step costs nothing to look at.
    rows = np.flatnonzero(size > np.maximum(0.1 * (values.max() - values.min()), CLEAR * np.median(size)))
    if not rows.size or rows.size > steps.size / 10:
        return np.zeros(0, dtype=int), np.zeros(0)
    jump = np.zeros(steps.size, dtype=bool)
    jump[rows] = True
    calm = np.flatnonzero(~jump)
    at = np.searchsorted(calm, rows)
    before, after = steps[calm[np.maximum(at - 1, 0)]], steps[calm[np.minimum(at, calm.size - 1)]]
    sizes = steps[rows] - (before + after) / 2
    clear = np.abs(sizes) > CLEAR * np.maximum(np.abs(before), np.abs(after))
    return rows[clear], sizes[clear]


def turn_of(values: np.ndarray) -> tuple[float, np.ndarray] | None:
    """The turn by which a position jumps, in its own unit, and the rows before the jumps; None where it does not."""
    rows, sizes = jumps_of(values)
    if not rows.size:
        return None
    turns = list(TURNS)
    if np.array_equal(values, np.round(values)):
        turns += [2.0**n for n in range(8, 33)]
    for turn in turns:
        fits = np.abs(np.abs(sizes) - turn) < MATCH * turn
        if fits.any():
            return turn, rows[fits]
    return None
