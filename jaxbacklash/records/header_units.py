"""Units as the headers of files write them: "Time [s]", "x (deg)", "z/rad", "torque, Nm", "Pos_deg".

Used by the readers of text tables and of other formats; what a unit means is the matter of `units`.
"""

from __future__ import annotations

import re

_PLAIN = """
s sec secs second seconds min mins minute minutes h hour hours day days
rad radian radians deg degs degree degrees ° º arcmin arcsec ' " rev revs revolution revolutions turn turns cycle cycles gon
gradians count counts cts ct tick ticks inc incs increment increments pulse pulses step steps lsb bit bits raw
m meter meters metre metres in inch inches ft micron N newton newtons kp kgf lb lbs lbf kip ozf oz
V volt volts A amp amps ampere amperes W watt watts J Hz rpm cps g gn g0 kg Pa bar psi K °C degC C °F degF ohm Ω F H T
samples sample # % pct dB norm au a.u. dimensionless
"""
SYMBOLS = frozenset(_PLAIN.split())
"""Units without a prefix, as they are spelt."""

_SCALABLE = "s sec rad m meter metre N V A W J Hz g Pa deg F H T ohm Ω"
PREFIXED = frozenset(_SCALABLE.split())
"""Units that may follow a prefix of a thousand or a thousandth."""

_CLEAR = """
ms us µs μs ns msec usec sec secs seconds milliseconds microseconds nanoseconds
rad rads mrad urad radians deg degs degree degrees arcmin arcsec mdeg revs turns
mm um µm μm Nm Nmm kNm kN mNm lbf volts volt mV amps rpm counts cts ticks Hz kHz
"""
UNMISTAKABLE = frozenset(_CLEAR.split())
"""Units that a name such as "Pos_deg" may end with after an underscore. Single letters and "in", "min", "rev" are left out:
theta_m is a motor's angle, x_in an input, z_min a least value, x_rev a reversed one."""

RATES = re.compile(r"(.+?)_(m?rad|m?deg|m?m|rev|turns|counts)(?:_per_|_|per|p)(s|sec|min)(_?\^?2)?")
"""Names such as "speed_rad_s": a velocity or an acceleration, whose last letters are no seconds."""

_SMALL = {symbol.lower() for symbol in SYMBOLS if len(symbol) > 1}
_PREFIX = "mµμunkMGc"
_MARKS = re.compile(r"\s*(?:[*·⋅/.\-]|\bper\b|\s)\s*")
_POWER = re.compile(r"(?:\^|\*\*)?[-+−]?[0-9]$|[²³⁻¹]+$")
_TIMES = re.compile(r"(?:.*[\s_])?(?:t|time|zeit|clock|elapsed|timestamp|stamp)", re.IGNORECASE)


def is_unit(text: str) -> bool:
    """Whether a text is a unit or a product of units: "deg", "mm/s²", "N·m", "Nm", "counts".

    Examples
    --------
    >>> is_unit("rad/s^2"), is_unit("left")
    (True, False)
    """
    text = text.strip()
    if not text or len(text) > 24:
        return False
    if _symbol(text):
        return True
    parts = [part.strip("()") for part in _MARKS.split(text)]
    return len(parts) <= 4 and all(part == "1" or _symbol(part) for part in parts) and any(_symbol(part) for part in parts)


def _symbol(text: str) -> bool:
    """Whether a text is one unit, with a prefix or a power perhaps."""
    text = _POWER.sub("", text) or text
    if text in SYMBOLS or text.lower() in _SMALL:
        return True
    if text[:1] in _PREFIX and text[1:] in PREFIXED:
        return True
    if text.lower().startswith(("milli", "micro", "nano", "kilo")) and _symbol(
        re.sub("^(milli|micro|nano|kilo)", "", text.lower())
    ):
        return True
    # Torques are often written without a mark between their two units.
    return (
        re.fullmatch(
            r"[kmcµμuM]?[Nn][-.]?[mcµk]?[mM]|(?:lbf?|oz|ozf|kgf?|kp)[-.]?(?:in|ft|cm|m)|(?:in|ft)[-.]?(?:lbf?|ozf?)", text
        )
        is not None
    )


def split_unit(name: str) -> tuple[str, str]:
    """A column's name without its unit, and the unit.

    Parameters
    ----------
    name : str
        As it stands in the header.

    Returns
    -------
    bare_name, unit : str
        The unit in the header's own spelling; empty, and the name unchanged, where none is stated.

    Notes
    -----
    Square brackets are taken for a unit whatever they hold, save numbers; round ones, braces, what follows a comma, a slash
    or "in" only where it is a unit by `is_unit`; what follows an underscore only where it is in `UNMISTAKABLE`, and "_s"
    where the rest is a time.

    Examples
    --------
    >>> split_unit("Time [s]"), split_unit("torque, Nm"), split_unit("Pos_deg"), split_unit("theta_m")
    (('Time', 's'), ('torque', 'Nm'), ('Pos', 'deg'), ('theta_m', ''))
    """
    name = name.strip()
    found = re.fullmatch(r"(.*?)\s*\[\s*([^\[\]]*?)\s*\]", name)
    if found and not re.fullmatch(r"[-\d.,:\s]*", found[2]):
        return found[1], found[2]
    for pattern in (
        r"(.+?)\s*/\s*[(]\s*(.+?)\s*[)]",
        r"(.*?)[\s_]*[(]\s*(.+?)\s*[)]",
        r"(.*?)\s*[{<]\s*(.+?)\s*[}>]",
        r"(.+?)\s*[,;:]\s*(.+)",
        r"(.*?)\s*\bin\s+(.+)",
    ):
        found = re.fullmatch(pattern, name, re.IGNORECASE)
        if found and is_unit(found[2]):
            return found[1], found[2]
    # "Time (s) Run #1": the unit in the middle.
    found = re.fullmatch(r"(.+?)\s*[\[(]\s*([^\[\]()]+?)\s*[\])]\s+(.+)", name)
    if found and is_unit(found[2]):
        return f"{found[1]} {found[3]}", found[2]
    # "z/rad", "v / (m/s)"; but "m/s" alone is a unit and no name, and "rig/z" a group and its channel.
    bare, slash, unit = name.partition("/")
    if slash and bare.strip() and not is_unit(name) and is_unit(unit.strip()):
        return bare.strip(), unit.strip().strip("()")
    rate = RATES.fullmatch(name)
    if rate:
        return rate[1], f"{rate[2]}/{rate[3]}" + ("^2" if rate[4] else "")
    bare, underscore, unit = name.rpartition("_")
    if underscore and bare and (unit in UNMISTAKABLE or (unit == "s" and _TIMES.fullmatch(bare))):
        return bare, unit
    camel = re.fullmatch(r"(.*[a-z0-9])(Deg|Rad)", name)
    if camel:
        return camel[1], camel[2].lower()
    # "Time s", "Angle deg": a unit behind a blank must be one that no word is.
    bare, blank, unit = name.rpartition(" ")
    if blank and bare.strip() and unit in UNMISTAKABLE:
        return bare.strip(), unit
    return name, ""
