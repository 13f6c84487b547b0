"""Jumps of a position that no mass makes: an encoder that begins anew after a full turn, or has lost counts for good."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jaxbacklash.records.finding import ASK, REFUSE, Finding

from .channel import Channel, each, positions
from .local import SURPRISE_OF_NOISE, around

TURNS = {2 * np.pi: "2 pi", np.pi: "pi", 360.0: "360", 180.0: "180"}
"""Where angles begin anew, in rad and degrees."""
COUNTS = range(8, 33)
"""Bits of counters that overflow."""
KNOWN, UNKNOWN = 4.0, 20.0
"""Times the steps beside it that a jump is at least, of a known turn, whose size is evidence in itself, and of another."""
MATCH = 2e-3
"""Share of a turn by which a jump, less the motion around it, may miss it: noise and what the motion curves by."""
WHOLE = 1e-3
"""Counts by which a scaled position may miss whole ones: the digits of a scale of six digits over a thousand counts."""
AGAIN = 3
"""Jumps of one size, which is the whole range of the channel, that make it a turn though it is no known one."""
SHIFT = 20.0
"""Times the noise and the liveliness of the motion around it that a lasting shift is at least."""
ROWS_LOST = 3.0
"""Steps of the motion around it that a shift is at least."""
GAP = 1.5
"""Usual steps of time over which a position may well have moved on."""
LIVELY = 5.0
"""Times its noise by which another channel moves in a sample, where it is to tell lost counts from lost rows."""
SHIFTS = 5
"""More shifts than this are how the thing moves: a stepper, a base moved by a staircase."""


def known_wraps(channels: Mapping[str, Channel]) -> list[Finding]:
    """Jumps by a turn that is known by its size, in x, y and z."""
    return wraps(channels, known=True)


def wraps(channels: Mapping[str, Channel], known: bool = False) -> list[Finding]:
    """Jumps by any turn, or by those ``known``, in x, y and z."""
    found = []
    for name, jumped in each(lambda channel: turn_of(channel, known), positions(channels)).items():
        if jumped:
            turn, rows = jumped
            called = TURNS.get(turn, f"{turn:.6g}")
            more = f" and {rows.size - 1} more" if rows.size > 1 else ""
            what = f"jumps by {called} between rows {rows[0] + 1} and {rows[0] + 2}{more}, as an encoder that begins anew does"
            found.append(Finding("wrap", REFUSE, name, what, f"--unwrap {name}", tuple(rows.tolist()), turn))
    return found


def turn_of(channel: Channel, known: bool = False) -> tuple[float, np.ndarray] | None:
    """The turn by which a position jumps, in its own unit, and the rows before the jumps; None where it does not."""
    span = channel.span
    if channel.longest <= 0.4 * span:
        return None
    steps = channel.steps
    rows = np.flatnonzero(np.abs(steps) > 0.4 * span)
    if rows.size > steps.size / 2:
        return None
    jumping = np.zeros(steps.size, dtype=bool)
    jumping[rows] = True
    calm = np.flatnonzero(~jumping)
    at = np.searchsorted(calm, rows)
    before, after = steps[calm[np.maximum(at - 1, 0)]], steps[calm[np.minimum(at, calm.size - 1)]]
    sizes = np.abs(steps[rows] - (before + after) / 2)
    beside = np.maximum(np.abs(before), np.abs(after))
    turns = list(TURNS)
    count = _count(channel.values[:4096])
    turns += [count * 2.0**bits for bits in COUNTS if count]
    clear = sizes > KNOWN * beside
    for turn in turns:
        fits = clear & (np.abs(sizes - turn) < MATCH * turn + np.abs(after - before))
        if fits.any():
            return turn, rows[fits]
    if known or rows.size > steps.size / 10:
        return None
    # Counts in some unit, or turns: the jump is as large as the range, since one ends where the other begins.
    clear = (sizes > UNKNOWN * beside) & (sizes > 0.97 * span)
    turn = float(np.median(sizes[clear])) if clear.any() else 0.0
    same = clear & (np.abs(sizes - turn) < MATCH * turn + np.abs(after - before))
    # Moving on before and after, the other way than it jumps: not the steps of a base that rests between them.
    onward = np.sign(before + after) == -np.sign(steps[rows])
    return (turn, rows[same]) if np.count_nonzero(same & onward) >= AGAIN and same.all() else None


def _count(values: np.ndarray) -> float:
    """The size of one count of a position that was measured in whole counts and perhaps scaled since; 0 where it was not."""
    if np.array_equal(values, np.round(values)):
        return 1.0
    one = Channel(values).quantum
    counts = values / one if one else values
    return one if one and np.abs(counts - np.round(counts)).max() < WHOLE else 0.0


def shifts_of(channel: Channel) -> tuple[np.ndarray, np.ndarray]:
    """Rows (of the last sample before) and sizes of lasting shifts of a position that moves on as before."""
    none = np.zeros(0, dtype=int), np.zeros(0)
    rows = channel.standing_out(0.5 * SHIFT)
    if not rows.size:
        return none
    values, r = channel.values, channel.surprises
    floor = max(channel.noise * SURPRISE_OF_NOISE, 0.3 * channel.quantum)
    rows = rows[np.abs(r[rows]) > 0.5 * SHIFT * floor]
    if not rows.size or rows.size > 50 * SHIFTS:
        return none
    rows = np.unique(np.concatenate([rows - 1, rows]))
    rows = rows[(rows >= 3) & (rows < values.size - 5)]
    if not rows.size:
        return none
    pattern = np.array([0.0, 1.0, -3.0, 3.0, -1.0, 0.0]) / 6.0
    seen = r[rows[:, None] + np.arange(-2, 4)]
    sizes = seen @ pattern / (pattern @ pattern)
    left = np.sqrt(np.mean((seen - sizes[:, None] * pattern) ** 2, axis=1))
    usual_here = np.maximum(around(np.abs(r), rows), floor)
    clear = (np.abs(sizes) > SHIFT * usual_here) & (left < 1.8 * usual_here + 0.02 * np.abs(sizes))
    # Two samples held one after another look like a shift, but they repeat a value.
    steps = np.diff(values[rows[:, None] + np.arange(-1, 3)], axis=1)
    clear &= np.all(steps != 0.0, axis=1)
    rows, sizes = rows[clear], sizes[clear]
    return (rows, sizes) if rows.size <= SHIFTS else none


def _not_lost_rows(channels: Mapping[str, Channel], name: str, row: int, size: float) -> bool:
    """Whether a shift is none that a few rows make which were not written: too large, or another channel moves and has it not."""
    steps = np.abs(channels[name].steps[row - 1 : row + 2])
    moves = max(steps[0], steps[2])
    if abs(size) > ROWS_LOST * moves:
        return True
    if abs(size) < moves:  # a sample that was taken late shifts nothing for good, but may look so for the rows around it
        return False
    for other, channel in channels.items():
        mine = channel.values[row - 2 : row + 5]
        usual = abs(float(mine[-1] - mine[0])) / 6
        if other != name and usual > LIVELY * channel.noise and abs(mine[3] - mine[2]) < 1.2 * usual:
            return True
    return False


def shifts(t: np.ndarray, channels: Mapping[str, Channel]) -> list[Finding]:
    """Counts lost: x, y or z alone goes on from another zero."""
    every = each(shifts_of, positions(channels))
    found: list[Finding] = []
    if not any(rows.size for rows, _ in every.values()):
        return found
    pauses = np.diff(t)
    gaps = np.flatnonzero(pauses > GAP * np.median(pauses))
    for name, (rows, sizes) in every.items():
        # A base that really jumps takes y along, or z the other way.
        others = [row for other, (those, _) in every.items() if other != name for row in those]
        alone = ~np.isin(rows, [*others, *gaps])
        sure = [_not_lost_rows(channels, name, int(row), size) for row, size in zip(rows, sizes, strict=True)]
        alone &= np.array(sure, dtype=bool)
        if not alone.any():
            continue
        rows, sizes = rows[alone], sizes[alone]
        more = f" and {rows.size - 1} more" if rows.size > 1 else ""
        what = f"shifts by {sizes[0]:.4g} between rows {rows[0] + 1} and {rows[0] + 2}{more} and moves on: counts look lost"
        found.append(Finding("shift", ASK, name, what, f"--unwrap {name}", tuple(rows.tolist()), float(sizes[0])))
    return found
