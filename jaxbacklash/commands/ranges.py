"""The range of every number that the command line takes, in one table, and the sentence for a number outside of it.

Checked before any library loads. What depends on several numbers, such as the size of a simulation, is checked where it is
known, see `bounded`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from ..errors import BadInput


class Range(NamedTuple):
    """``lower`` to ``upper``, both allowed, of a number described by ``what``."""

    lower: float
    upper: float
    what: str


TINY = 1e-12
"""Stands for "above zero": nothing that is measured is smaller in SI units."""

RANGES: dict[str, Range] = {
    "inertia": Range(TINY, 1e12, "a positive number of kg m^2 (kg for a translating mass)"),
    "window": Range(0.02, 10.0, "a length [s]"),
    "starts": Range(1, 100, "a number of starting points"),  # each is a fit of its own, of seconds
    "workers": Range(1, 1024, "a number of processes"),
    "seed": Range(0, 2**63 - 1, "a whole number"),
    "resample_rate": Range(1e-6, 1e7, "a rate [Hz]"),
    "gravity": Range(-1e9, 1e9, "m g L / J [1/s^2]"),
    "rate": Range(1e-6, 1e9, "a rate [Hz]"),
    "simulate.rate": Range(1e-3, 1e6, "a rate [Hz]"),
    "duration": Range(1e-6, 1e5, "a length [s]"),
    "noise": Range(0.0, 1e6, "a standard deviation [rad]"),
    "y0": Range(-1e6, 1e6, "an angle [rad]"),
    "dy0": Range(-1e9, 1e9, "a speed [rad/s]"),
    "count": Range(1, 999, "a number of surrogates"),  # 999 reach p = 0.001
    "case": Range(1, 2, "the paper's CASE"),
    "map.periods": Range(1, 100_000, "a number of periods"),
    "map.skip": Range(0, 100_000, "a number of periods"),
    "map.samples": Range(1, 10_000, "a number of samples"),
    "ratio": Range(1e-6, 1e6, "turns of x for a turn of the link"),
    "kt": Range(TINY, 1e9, "the torque of a motor for an ampere [N m/A]"),
    "start": Range(-1e12, 1e12, "a time of the record [s]"),
    "stop": Range(-1e12, 1e12, "a time of the record [s]"),
    "port": Range(0, 65_535, "a port of this machine, 0 for a free one"),
    "wind_up": Range(0.0, 1e3, "an angle [rad] or a travel [m]"),
    "skip": Range(0, 10**9, "a number of lines"),
}
"""By the name of the option, or by command and option where an option means something else in one command."""


def check_numbers(command: str, given: Mapping[str, Any], options: Mapping[str, str]) -> None:
    """Refuse the first number outside its range.

    Parameters
    ----------
    command : the command's name
    given : what was given, by the parameter's name; what is no number is passed over
    options : each parameter's name as it is typed, as in ``--resample-rate``

    Raises
    ------
    BadInput
        Naming the option, what was found and the range.
    """
    for name, value in given.items():
        known = RANGES.get(f"{command}.{name}", RANGES.get(name))
        if known is None or isinstance(value, bool) or not isinstance(value, int | float):
            continue
        # Compared as it is: a whole number may be too large to be a float.
        if (isinstance(value, float) and not math.isfinite(value)) or not known.lower <= value <= known.upper:
            typed = options.get(name, f"--{name}")
            between = " or " if isinstance(known.lower, int) and known.upper == known.lower + 1 else " to "
            raise BadInput(f"{typed} {shown(value)}: wanted {shown(known.lower)}{between}{shown(known.upper)}, {known.what}")


def bounded(place: str, found: float, most: float, what: str, cure: str) -> None:
    """Refuse work whose size is known beforehand to be beyond what a computer does in a sensible time.

    Parameters
    ----------
    place : the options that ask for it
    found, most : how much is asked for, and the bound
    what : of what, as in "samples"
    cure : what to do instead

    Raises
    ------
    BadInput
        With the number and the bound.
    """
    if not found <= most:
        raise BadInput(f"{place}: found {shown(found)} {what}, wanted at most {shown(most)}; {cure}")


def shown(value: float) -> str:
    """A number as it would be typed, cut short where it is long."""
    if isinstance(value, int) and abs(value) < 10**12:
        return str(value)
    try:
        return f"{float(value):.6g}"
    except OverflowError:
        text = str(value)
        return f"{text[:12]}... ({len(text)} digits)"
