"""How numbers, units and colours look, in figures and on the page alike.

Colours are the vermillion, blue and green that colour-blind readers tell apart, at a lightness that stands out from
white and from near-black (contrast of 3 or more); shape says the same as colour (dots measured, lines model).
"""

from __future__ import annotations

import math
import re
from typing import Any

INK = "#1d2129"  # becomes the page's own text colour inside an SVG
MEASURED = "#2b83c6"
MODEL = "#d9601a"
HELDOUT = "#0f9d78"
GAP = "#8a8f98"  # the play, and whatever else is background
PALETTE = {"measured": MEASURED, "model": MODEL, "heldout": HELDOUT, "gap": GAP}

WIDTH = 8.6  # inches; at 9 points of text this reads well across a page of 60 em
TALL, MEDIUM, SHORT = 5.6, 3.8, 2.7

_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def pretty_unit(unit: str | None) -> str:
    """``N m/rad^3`` as it is printed: ``N m/rad³``; a ratio (``1``) has no unit to print."""
    if not unit or unit == "1":
        return ""
    return re.sub(r"\^(-?\d+)", lambda found: found.group(1).translate(_SUPERSCRIPT), unit)


def with_unit(label: str, unit: str | None) -> str:
    """An axis label: ``z [rad]``."""
    shown = pretty_unit(unit)
    return f"{label} [{shown}]" if shown else label


def error_decimals(stderr: float) -> int:
    """Decimals that a standard error deserves; negative when whole tens or hundreds are already uncertain.

    The rule is the Particle Data Group's: two digits of the error up to 35, one up to 95, then rounded up.
    """
    power = math.floor(math.log10(stderr))
    leading = round(stderr / 10.0**power * 100.0)  # 100 to 1000
    if leading <= 354:
        return 1 - power
    return -power if leading < 950 else -power - 1


def _fixed(value: float, decimals: int) -> str:
    text = f"{round(value, decimals):.{max(decimals, 0)}f}"
    return text[1:] if float(text) == 0.0 and text.startswith("-") else text


def _power(value: float) -> int:
    """The power of ten to pull out of a number that is awkward in full, else 0."""
    if value == 0.0 or 1e-4 <= abs(value) < 1e6:
        return 0
    return math.floor(math.log10(abs(value)))


def _exponent(power: int) -> str:
    return f"×10{str(power).translate(_SUPERSCRIPT)}" if power else ""


def short(value: Any, digits: int = 3) -> str:
    """A number without an error, to so many significant digits: ``0.0262``, ``3.1×10⁻⁵``; a dash for none."""
    if not is_number(value):
        return "–"
    value = float(value)
    power = _power(value)
    mantissa = value / 10.0**power
    if mantissa == 0.0:
        return "0"
    decimals = digits - 1 - math.floor(math.log10(abs(mantissa)))
    text = _fixed(mantissa, max(decimals, 0))
    if "." in text and power:
        text = text.rstrip("0").rstrip(".")
    return text + _exponent(power)


def is_number(value: Any) -> bool:
    """True for a finite number; None, text and NaN are not."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _pair(value: float, stderr: float | None) -> str:
    if not is_number(stderr) or not stderr:
        return short(value, 5)
    assert stderr is not None
    power = _power(max(abs(value), stderr))
    decimals = error_decimals(stderr) + power
    scale = 10.0**power
    text = f"{_fixed(value / scale, decimals)} ± {_fixed(stderr / scale, decimals)}"
    return f"({text}){_exponent(power)}" if power else text


def format_parts(value: float | None, stderr: float | None, unit: str | None) -> list[tuple[str, str]]:
    """A value and its error as (number, unit), once more in degrees if it is an angle; empty when there is none."""
    if not is_number(value):
        return []
    assert value is not None
    parts = [(_pair(value, stderr), pretty_unit(unit))]
    if unit == "rad":
        error = None if stderr is None or not is_number(stderr) else math.degrees(stderr)
        parts.append((_pair(math.degrees(value), error), "deg"))
    return parts


def format_value(value: float | None, stderr: float | None, unit: str | None) -> str:
    """A value and its standard error with the digits that the error allows; angles in degrees as well.

    Parameters
    ----------
    value : in ``unit``; None: not determined
    stderr : standard error in ``unit``; None or 0: the value is given, five digits are shown
    unit : as in result.json, ``N m/rad^3``; ``1`` for a ratio

    Returns
    -------
    ``0.026180 ± 0.000011 rad (1.5000 ± 0.0006 deg)``
    """
    parts = [f"{number} {shown}".rstrip() for number, shown in format_parts(value, stderr, unit)]
    if not parts:
        return "not determined"
    return parts[0] + "".join(f" ({part})" for part in parts[1:])


def format_evidence(value: Any) -> str:
    """Evidence, where a tenth is as fine as anyone should read: ``812``, ``3.1``."""
    if not is_number(value):
        return "–"
    return f"{value:.0f}" if abs(value) >= 10.0 else f"{value:.1f}"


def format_interval(interval: Any, stderr: float | None, unit: str) -> str:
    """A 95 % interval with the digits of its value; an open side is ``-∞`` or ``∞``, none at all a dash."""
    if not isinstance(interval, list | tuple) or len(interval) != 2:
        return "–"
    known = [float(end) for end in interval if is_number(end)]
    if not known:
        return "–"
    spread = float(stderr) if is_number(stderr) and stderr else (known[-1] - known[0]) / 4.0
    if not spread > 0.0:
        ends = [short(end, 5) if is_number(end) else None for end in interval]
        power = 0
    else:
        power = _power(max(max(abs(end) for end in known), spread))
        decimals = error_decimals(spread) + power
        ends = [_fixed(float(end) / 10.0**power, decimals) if is_number(end) else None for end in interval]
    low, high = ends[0] or "-∞", ends[1] or "∞"
    text = f"{low} to {high}"
    if power:
        text = f"({text}){_exponent(power)}"
    return f"{text} {pretty_unit(unit)}".rstrip()
