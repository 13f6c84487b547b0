"""Units of channels, as the command line and the headers of files spell them, and their factors to SI and radians."""

import math
from collections.abc import Iterable, Mapping

from .checks import listed, wrong

TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}
ANGLE = {
    "rad": 1.0,
    "mrad": 1e-3,
    "urad": 1e-6,
    "deg": math.pi / 180,
    "arcmin": math.pi / 180 / 60,
    "arcsec": math.pi / 180 / 3600,
    "rev": 2 * math.pi,
    "grad": math.pi / 200,
}
LENGTH = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254}
# The pound-force is exact by definition: 0.45359237 kg times standard gravity, 9.80665 m/s^2.
FORCE = {"N": 1.0, "kN": 1e3, "lbf": 4.4482216152605, "kip": 4448.2216152605}
TORQUE = {"N m": 1.0, "N mm": 1e-3, "N cm": 1e-2, "mN m": 1e-3, "kN m": 1e3, "lbf in": 4.4482216152605 * 0.0254}

MOTION = ANGLE | LENGTH
CURRENT = {"A": 1.0, "mA": 1e-3}
FAMILIES = (TIME, ANGLE, LENGTH, FORCE, TORQUE, CURRENT)
UNITS: dict[str, dict[str, float]] = {
    "t": TIME,
    **dict.fromkeys(("x", "z", "y"), MOTION),
    **dict.fromkeys(("F", "T"), FORCE | TORQUE),
    "torque": TORQUE,
    "current": CURRENT,
    **dict.fromkeys(("command", "motor", "link"), ANGLE),
}


SPELLINGS = {
    "s": ("sec", "secs", "second", "seconds"),
    "ms": ("msec", "millisecond", "milliseconds"),
    "us": ("usec", "microsecond", "microseconds"),
    "ns": ("nsec", "nanosecond", "nanoseconds"),
    "min": ("minute", "minutes"),
    "h": ("hour", "hours"),
    "rad": ("rads", "radian", "radians"),
    "deg": ("degs", "degree", "degrees", "°"),
    "arcmin": ("′",),
    "arcsec": ("″",),
    "rev": ("revs", "turn", "turns", "revolution", "revolutions"),
    "grad": ("gon",),
    "m": ("meter", "meters", "metre", "metres"),
    "mm": ("millimeter", "millimeters", "millimetre", "millimetres"),
    "in": ("inch", "inches", '"'),
    "N": ("newton", "newtons"),
    "A": ("amp", "amps", "ampere", "amperes"),
    "N m": ("newton-meter", "newtonmeter", "newtonmeters"),
    "lbf": ("lb", "lbs"),
    "lbf in": ("lb-in", "in-lb", "inlbf"),
}
"""How files and people write units beside the names of `UNITS`, in lower case."""


def spelt(name: str, unit: str) -> str | None:
    """The unit of a channel in the spelling of `UNITS`, None where it has no such unit.

    "Nm", "N*m", "N-m" and "N.m" mean "N m", a micro sign means u, "degrees" and "°" mean "deg"; "DEG" is read, "MS" is not, since
    capitals tell milli from mega.
    """
    plain = unit.translate(str.maketrans("µμ", "uu", " *.·⋅-")).strip()
    short = {each.replace(" ", ""): each for each in UNITS[name]}
    if plain in short:
        return short[plain]
    words = {word.replace("-", ""): each for each in UNITS[name] for word in SPELLINGS.get(each, ())}
    words |= {each.lower(): full for each, full in short.items() if len(each) > 2}
    return words.get(plain.lower())


def known_unit(name: str, unit: str, option: str = "--unit") -> str:
    """The unit of a channel in the spelling of `UNITS`; see `spelt`.

    Raises
    ------
    BadInput
        When the channel has no such unit; lists those it may have.
    """
    known = spelt(name, unit)
    if known is None:
        raise wrong(option, f'the unit "{unit}" for {name}', f"one of {listed(UNITS[name], limit=len(UNITS[name]))}")
    return known


def factors(units: Mapping[str, str], scales: Mapping[str, float], present: Iterable[str], where: str) -> dict[str, float]:
    """What to multiply each channel by to have it in SI and radians.

    Parameters
    ----------
    units, scales : mappings by channel
        As `parse_units` and `parse_scales` return them; a channel with both is multiplied by both.
    present : iterable of str
        The channels that the record has, with t.
    where : str
        The file, for the sentence.

    Returns
    -------
    dict of float
        Factors of the channels named in `units` or `scales`.

    Raises
    ------
    BadInput
        When a channel named is not in the record, or when x, z and y would mix angles with lengths.
    """
    present = list(present)
    for option, given in (("--unit", units), ("--scale", scales)):
        absent = [name for name in given if name not in present]
        if absent:
            raise wrong(where, f"no channel {absent[0]}, which {option} names", f"one of {listed(present)}")
    motions = {name: known_unit(name, unit) for name, unit in units.items() if name in ("x", "z", "y")}
    angles = [name for name, unit in motions.items() if unit in ANGLE]
    lengths = [name for name, unit in motions.items() if unit in LENGTH]
    if angles and lengths:
        found = f"{angles[0]} in {motions[angles[0]]} and {lengths[0]} in {motions[lengths[0]]}"
        raise wrong(where, found, "all motions as angles or all as lengths")
    return {
        name: (UNITS[name][known_unit(name, units[name])] if name in units else 1.0) * scales.get(name, 1.0)
        for name in present
        if name in units or name in scales
    }


def base_unit(unit: str | None) -> str:
    """The unit a channel has once it is converted: rad for deg, m for mm; empty for none."""
    for family in FAMILIES:
        if unit in family:
            return next(name for name, factor in family.items() if factor == 1.0)
    return ""
