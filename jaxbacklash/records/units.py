"""Units and names as the command line states them: `--columns t=time_s`, `--unit x=deg`, `--scale F=35.15`."""

import math
from collections.abc import Iterable, Mapping

from .checks import CHANNELS, listed, wrong

TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0}
ANGLE = {
    "rad": 1.0,
    "mrad": 1e-3,
    "urad": 1e-6,
    "deg": math.pi / 180,
    "arcmin": math.pi / 180 / 60,
    "arcsec": math.pi / 180 / 3600,
    "rev": 2 * math.pi,
}
LENGTH = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "in": 0.0254}
# The pound-force is exact by definition: 0.45359237 kg times standard gravity, 9.80665 m/s^2.
FORCE = {"N": 1.0, "kN": 1e3, "lbf": 4.4482216152605, "kip": 4448.2216152605}
TORQUE = {"N m": 1.0, "N mm": 1e-3, "kN m": 1e3, "lbf in": 4.4482216152605 * 0.0254}

MOTION = ANGLE | LENGTH
FAMILIES = (TIME, ANGLE, LENGTH, FORCE, TORQUE)
UNITS: dict[str, dict[str, float]] = {
    "t": TIME,
    **dict.fromkeys(("x", "z", "y"), MOTION),
    **dict.fromkeys(("F", "T"), FORCE | TORQUE),
}


def parse_mapping(text: str | Iterable[str], option: str) -> dict[str, str]:
    """The pairs of an option such as "t=time_s,x=enc1".

    Parameters
    ----------
    text : str or iterable of str
        As given; several texts (an option given more than once) are joined.
    option : str
        The option's name, for the sentence.

    Returns
    -------
    dict of str
        By channel, in the order given.

    Raises
    ------
    BadInput
        When a pair has no "=", an empty side, a channel that does not exist or that came before.
    """
    texts = [text] if isinstance(text, str) else list(text)
    pairs: dict[str, str] = {}
    for part in ",".join(texts).split(","):
        name, equals, value = (piece.strip() for piece in part.partition("="))
        if not (name and equals and value):
            raise wrong(option, f'"{part.strip()}"', "pairs such as x=VALUE separated by commas")
        if name not in UNITS:
            raise wrong(option, f'the channel "{name}"', f"one of t, {listed(CHANNELS)}")
        if name in pairs:
            raise wrong(option, f"the channel {name} twice", "each at most once")
        pairs[name] = value
    return pairs


def parse_columns(text: str | Iterable[str], option: str = "--columns") -> dict[str, str]:
    """Column names by channel; a column may stand for one channel only. Raises `BadInput`."""
    pairs = parse_mapping(text, option)
    for column in pairs.values():
        same = [other for other in pairs if pairs[other] == column]
        if len(same) > 1:
            raise wrong(option, f'the column "{column}" for {same[0]} and for {same[1]}', "one channel for it")
    return pairs


def parse_units(text: str | Iterable[str], option: str = "--unit") -> dict[str, str]:
    """Units by channel, each spelt as in `UNITS`. Raises `BadInput` listing the units that the channel may have."""
    return {name: known_unit(name, unit, option) for name, unit in parse_mapping(text, option).items()}


def parse_scales(text: str | Iterable[str], option: str = "--scale") -> dict[str, float]:
    """Factors by channel, finite and not zero. Raises `BadInput`."""
    scales = {}
    for name, value in parse_mapping(text, option).items():
        try:
            scales[name] = float(value)
        except ValueError:
            raise wrong(option, f'"{value}" for {name}', "a number") from None
        if not math.isfinite(scales[name]) or scales[name] == 0:
            raise wrong(option, f'"{value}" for {name}', "a finite number other than 0")
    return scales


def known_unit(name: str, unit: str, option: str = "--unit") -> str:
    """The unit of a channel in the spelling of `UNITS`: "Nm", "N*m" and "N.m" mean "N m", a micro sign means u.

    Raises
    ------
    BadInput
        When the channel has no such unit; lists those it may have.
    """
    allowed = UNITS[name]
    spellings = {each.replace(" ", ""): each for each in allowed}
    plain = unit.translate(str.maketrans("µμ", "uu", " *.·"))
    if plain not in spellings:
        raise wrong(option, f'the unit "{unit}" for {name}', f"one of {listed(allowed, limit=len(allowed))}")
    return spellings[plain]


def factors(
    units: Mapping[str, str], scales: Mapping[str, float], present: Iterable[str], where: str
) -> dict[str, float]:
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
