"""Columns that hold another quantity than the channel they are taken for: degrees or counts for radians, an acceleration."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping

import numpy as np

from jaxbacklash.records.finding import ASK, Finding
from jaxbacklash.records.options import ReadOptions

from .channel import POSITIONS, Channel
from .spikes import bad_rows

MAX_RELATIVE_RAD = 1.0
"""The relative motion of a loose joint is its play and the give of its contact. Over 1 rad (57 degrees) to one side of its middle
it is no joint with play, while a degree or two read as radians exceeds it."""
MAX_BASE_RAD = 2 * np.pi
"""The base may swing widely, but one full turn away from its middle is more than a base that shakes a joint does."""
MILLI = {"z": 10.0, "y": 10.0, "x": 360.0}
"""From here on, in the column's own numbers, milliradians are likelier than degrees: few joints give by 10 degrees. Both are
named."""
COUNTS = 20.0
"""Range of a column of whole numbers from which on it is one of counts: no joint of that many radians or metres is read to 1."""
INERTIAL = re.compile(r"(^|[^a-z])(a[ _.-]?[xyz]|acc\w*|gyr\w*)($|[^a-z])", re.IGNORECASE)
"""Names under which accelerations and rates of turn are written."""


def quantities(channels: Mapping[str, np.ndarray], options: ReadOptions, stated: Collection[str]) -> list[Finding]:
    """Accelerations, counts and degrees taken for positions in radians; ``stated`` are the channels whose unit is known."""
    return [*_inertial(channels, options), *(_counts(channels, options, stated) or degrees(channels, stated, options.scales))]


def degrees(
    channels: Mapping[str, np.ndarray], stated: Collection[str], scaled: Mapping[str, float] | None = None
) -> list[Finding]:
    """Degrees taken for radians.

    Absolute motion y of a force-driven link is not looked at: it may be in metres, or turn freely.

    Parameters
    ----------
    channels : mapping of arrays of shape (N,)
        In rad (or m, where the same bounds are wider still).
    stated : collection of str
        Channels whose unit was stated: those are believed.
    scaled : mapping of float, or None
        The factors by which channels were brought to radians. Where such a channel is too large for a joint, its factor is what
        is asked about, and no remedy is known.

    Returns
    -------
    list of Finding
        At most one, which names the channel, its peak and the ways out, the likeliest as its remedy.
    """
    suspects = {}
    if "z" in channels:
        suspects["z"] = (_peak(channels["z"]), MAX_RELATIVE_RAD)
    elif {"x", "y"} <= set(channels) and "y" not in stated:
        suspects["y"] = (_peak(channels["y"] - channels["x"]), MAX_RELATIVE_RAD)
    if "x" in channels:
        suspects["x"] = (_peak(channels["x"]), MAX_BASE_RAD)
    beyond = [name for name, (peak, most) in suspects.items() if peak > most and name not in stated]
    # A sample that was never measured is no motion; looking for those takes time, so only here.
    for name in beyond:
        if name != "y":
            good = np.delete(channels[name], bad_rows(Channel(channels[name])))
            suspects[name] = (_peak(good), suspects[name][1])
    beyond = [name for name in beyond if suspects[name][0] > suspects[name][1]]
    if not beyond:
        return []
    name = beyond[0]
    peak, most = suspects[name]
    what = {"z": "relative motion", "y": "motion y - x relative to the base", "x": "base motion"}[name]
    # When one channel is in degrees so, as a rule, is the other, though it may be too small to look wrong by itself.
    both = [each for each in ("x", "z", "y") if each in channels and each not in stated]
    deg, mrad, rad = (
        "--unit " + ",".join(f"{each}={unit}" for each in names)
        for names, unit in ((both, "deg"), (both, "mrad"), (beyond, "rad"))
    )
    if scaled and scaled.get(name, 1.0) != 1.0:
        found = (
            f"is a {what} of up to {peak:.6g} with --scale {name}={scaled[name]:g}, where a joint has at most {most:.6g} "
            f"radians; state the factor to radians (2 pi over the counts of a turn), or add {deg} where this one is to degrees"
        )
        return [Finding("degrees", ASK, name, found, size=peak, otherwise=rad)]
    text, remedy = f"degrees, or in milliradians ({mrad})", deg
    if peak > MILLI[name]:
        text, remedy = f"milliradians, or in degrees ({deg})", mrad
    found = f"is a {what} of up to {peak:.6g}, where a joint has at most {most:.6g} radians; it may be in {text}"
    return [Finding("degrees", ASK, name, found, remedy, size=peak, otherwise=rad)]


def _inertial(channels: Mapping[str, np.ndarray], options: ReadOptions) -> list[Finding]:
    """Positions read from a column whose name is that of another quantity."""
    found = []
    for name in POSITIONS:
        column = options.columns.get(name, name)
        if name in channels and INERTIAL.search(column):
            what = f'is "{column}", which names an acceleration or a rate of turn, where a position is wanted'
            found.append(Finding("quantity", ASK, name, what))
    return found


def _counts(channels: Mapping[str, np.ndarray], options: ReadOptions, stated: Collection[str]) -> list[Finding]:
    """Counts of an encoder taken for radians."""
    found = []
    for name in POSITIONS:
        if name not in channels or name in options.scales or name in stated:
            continue
        values = channels[name]
        low, high = values.min(), values.max()
        if high - low >= COUNTS and np.array_equal(values, np.round(values)):
            count = 2 * np.pi / 4096
            what = (
                f"holds whole numbers from {low:.0f} to {high:.0f}, counts of an encoder it seems, not radians (2 pi "
                f"over the counts of a turn for each; {count:.6g} where these are 4096)"
            )
            keep = f"--unit {name}=rad"
            found.append(
                Finding("counts", ASK, name, what, f"--scale {name}={count:.6g}", size=float(high - low), otherwise=keep)
            )
    return found


def _peak(values: np.ndarray) -> float:
    """Largest distance from the middle of the range: an encoder's arbitrary zero must not count as motion."""
    return float(values.max() - values.min()) / 2
