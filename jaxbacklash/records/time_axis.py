"""The times of a record: what counts as uniform, and every refusal that concerns them.

Like those in `checks`, the checks here take `where`, the file as the user named it, and raise `BadInput` or return.
"""

from collections.abc import Iterator

import numpy as np

from jaxbacklash.errors import BadInput

from .checks import number, wrong
from .findings.stamps import ODD, time_unit

RELATIVE = 1e-6
"""Times are uniform when none is further from an even grid than this fraction of a step."""

HARMLESS = 1e-3
"""Rounding finer than this fraction of a step is accepted without further evidence."""

WITHIN = 0.58
"""Units that rounded times lie from an even grid at most: half of one, and what a second rounding, to binary digits, adds."""

GAP = 1.5
"""A step of this many usual steps is called a gap, where such steps are rare."""


def uniform_grid(t: np.ndarray) -> np.ndarray | None:
    """The even grid that the times stand for.

    Times in files are rounded: printed with three decimals, stored in single precision, or read off a counter.
    Rounding an even grid to a multiple of u leaves every time within u/2 of a straight line, so times are accepted
    when they lie that close to one, for a u the times themselves show (see `_roundings`).

    The danger is a lost row that looks like rounding. A rounding finer than a thousandth of a step cannot hide one. A
    coarser one, up to half a step, is believed only when at least three steps differ from the usual one: rounding
    spaces its odd steps evenly, which three glitches would hardly do, while one or two may be anything. Rounding to
    more than half a step is believed where twenty steps and more are odd.

    Parameters
    ----------
    t : array of shape (N,), s, strictly increasing, N >= 3

    Returns
    -------
    array of shape (N,) or None
        `t` itself where it is uniform to 1e-6 of a step, the straight line through it where it is uniform up to its
        rounding, None where it is not uniform.
    """
    rows = np.arange(t.size, dtype=float)
    rows -= (t.size - 1) / 2
    since = t - t[0]
    square = float(t.size) * (float(t.size) ** 2 - 1.0) / 12.0  # rows @ rows
    # By einsum, not by BLAS: its threads may wait for each other far longer than this takes.
    step = float(np.einsum("i,i", rows, since)) / square
    error = step * rows
    np.subtract(since, error, out=error)  # in place: a new array of a million takes longer to get than to fill
    # Once more on what is left: over millions of rows the first slope carries the rounding of its own sums.
    error -= error.mean()
    step += float(np.einsum("i,i", rows, error)) / square
    np.subtract(since, np.multiply(step, rows, out=error), out=error)
    low, high = error.min(), error.max()
    middle, worst = (high + low) / 2, (high - low) / 2
    if worst <= max(RELATIVE * step, np.spacing(max(abs(t[0]), abs(t[-1])))):
        return t
    if worst > step / 2:
        return None
    steps = np.diff(t)
    for unit in _roundings(t, steps):
        if worst > WITHIN * unit:
            continue
        # Stamps to a millisecond at 800 Hz: a coarse unit, but as many lost rows would lead away from the line.
        if unit <= HARMLESS * step or _odd_steps(steps, unit) >= (3 if unit <= step / 2 * (1 + RELATIVE) else ODD):
            return t[0] + middle + step * rows
    return None


def _odd_steps(steps: np.ndarray, unit: float) -> int:
    """How many steps differ from the usual one by a unit of rounding and not by the rounding of its own arithmetic."""
    return int(np.count_nonzero(np.abs(steps - np.median(steps)) > unit / 4))


def _roundings(t: np.ndarray, steps: np.ndarray) -> Iterator[float]:
    """Units (s) to which the times may have been rounded, largest unit where the rounding is relative."""
    # A counter, or a fixed number of decimals: an even grid rounded to u has steps of two sizes only, u apart.
    low, high = steps.min(), steps.max()
    unit = high - low
    largest = np.abs(t).max()
    fuzz = max(8 * np.spacing(largest), 0.01 * unit)
    if np.all((steps - low < fuzz) | (high - steps < fuzz)):
        yield float(unit)
    # Single precision, perhaps of milliseconds or microseconds that have been converted since.
    for factor in (1.0, 1e3, 1e6):
        single = (t * factor).astype(np.float32)
        if np.allclose(single.astype(np.float64), t * factor, rtol=1e-15, atol=0.0):
            yield float(np.spacing(np.abs(single).max())) / factor
    # A fixed number of significant digits, as "%.9g" prints.
    power = 10.0 ** np.floor(np.log10(np.where(t == 0, 1.0, np.abs(t))))
    for digits in range(4, 13):
        scaled = t / power * 10.0 ** (digits - 1)
        if np.all(np.abs(scaled - np.round(scaled)) <= 4e-16 * 10.0**digits):
            yield float(10.0 ** (np.floor(np.log10(largest)) - digits + 1))
            return


def increasing(t: np.ndarray, where: str) -> None:
    """Refuse times that go back or stand still, naming the first two rows (counted from 1) that do."""
    stuck = np.diff(t) <= 0
    if stuck.any():
        row = int(np.argmax(stuck))
        what = "stays at" if t[row + 1] == t[row] else "goes back to"
        found = f"that {t[row]:.9g} s at row {row + 1} {what} {t[row + 1]:.9g} s at row {row + 2}"
        raise wrong(f"{where}, column t", found, "strictly increasing times")


def in_seconds(t: np.ndarray, confirmed, where: str) -> None:
    """Refuse milliseconds taken for seconds: 20 samples per second cannot show the motion of most loose joints.

    Parameters
    ----------
    t : array of shape (N,), increasing
    confirmed : collection of str
        Holds "t" when the user stated its unit, which is then believed.
    """
    if "t" in confirmed:
        return
    for finding in time_unit(t):
        raise BadInput(finding.sentence(where))


def uniform(t: np.ndarray, where: str) -> np.ndarray:
    """The even grid that the times stand for, or a refusal.

    Parameters
    ----------
    t : array of shape (N,), s, strictly increasing, N >= 3
    where : str
        The file, for the sentence.

    Returns
    -------
    array of shape (N,), s
        See `uniform_grid`.

    Raises
    ------
    BadInput
        Naming the first gap, or the step furthest from the usual one.
    """
    grid = uniform_grid(t)
    if grid is not None:
        return grid
    steps = np.diff(t)
    usual = float(np.median(steps))
    wide = np.flatnonzero(steps >= GAP * usual)
    way_out = "mend the times or pass --resample"
    if 0 < wide.size <= steps.size / 20:
        row = wide[0]
        more = f" and {wide.size - 1} more like it" if wide.size > 1 else ""
        found = f"a gap of {number(steps[row])} s between rows {row + 1} and {row + 2} (at {t[row]:.9g} s){more}"
        raise wrong(f"{where}, column t", found, f"even steps of {number(usual)} s; {way_out}", "--resample")
    row = int(np.argmax(np.abs(steps - usual)))
    found = f"uneven times, such as a step of {steps[row]:.9g} s between rows {row + 1} and {row + 2}"
    wanted = f"even steps, of {usual:.9g} s here, to a millionth of a step; {way_out}"
    raise wrong(f"{where}, column t", found, wanted, "--resample")
