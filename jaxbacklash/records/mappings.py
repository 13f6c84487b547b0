"""What the command line says of channels: `--columns t=time_s`, `--unit x=deg`, `--scale F=35.15`, `--sign z`.

The pairs are written as NAME=VALUE with commas between them. A value that holds a comma stands in quotes, as in `t="Time, s"`.
"""

import math
import re
from collections.abc import Iterable

from .checks import CHANNELS, OF_A_DRIVE, listed, wrong
from .units import UNITS, known_unit

PAIR = re.compile(r"""\s*(?P<name>[^=,"']*?)\s*=\s*(?:"(?P<double>[^"]*)"|'(?P<single>[^']*)'|(?P<plain>[^,]*))\s*(?:,|$)""")
"""One pair and the comma behind it; a quote counts where the value begins with it."""

EXAMPLES = {"--columns": "x=NAME_OF_A_COLUMN", "--unit": "x=deg", "--scale": "x=0.00153"}


def _wanted(option: str) -> str:
    return f"pairs such as {EXAMPLES.get(option, 'x=VALUE')} separated by commas"


def _pairs(text: str, option: str, *, commas_in_values: bool = False) -> list[tuple[str, str]]:
    """(name, value) in the order given; ``commas_in_values`` joins what has no "=" to the value before it."""
    pairs: list[tuple[str, str]] = []
    at = 0
    while at < len(text):
        match = PAIR.match(text, at)
        if match is None:
            part, _, _ = text[at:].partition(",")
            if not (commas_in_values and pairs and part.strip() and '"' not in part):
                raise wrong(option, f'"{part.strip()}"', _wanted(option))
            name, value = pairs.pop()
            pairs.append((name, f"{value},{part.rstrip()}"))
            at += len(part) + 1
            continue
        value = next(match[kind] for kind in ("double", "single", "plain") if match[kind] is not None).strip()
        if not (match["name"] and value):
            raise wrong(option, f'"{match[0].strip(" ,")}"', _wanted(option))
        pairs.append((match["name"], value))
        at = match.end()
    if not pairs:
        raise wrong(option, f'"{text}"', _wanted(option))
    return pairs


def parse_mapping(text: str | Iterable[str], option: str, *, commas_in_values: bool = False) -> dict[str, str]:
    """The pairs of an option such as "t=time_s,x=enc1".

    Parameters
    ----------
    text : str or iterable of str
        As given; several texts (an option given more than once) are joined.
    option : str
        The option's name, for the sentence.
    commas_in_values : bool
        Whether "t=Time, s,x=Base" may mean the value "Time, s".

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
    for name, value in (pair for each in texts for pair in _pairs(each, option, commas_in_values=commas_in_values)):
        _known(name, option)
        if name in pairs:
            raise wrong(option, f"the channel {name} twice", "each at most once")
        pairs[name] = value
    return pairs


def _known(name: str, option: str) -> None:
    if name not in UNITS:
        raise wrong(option, f'the channel "{name}"', f"one of t, {listed((*CHANNELS, *OF_A_DRIVE))}")


def parse_columns(text: str | Iterable[str], option: str = "--columns") -> dict[str, str]:
    """Column names by channel. Raises `BadInput`."""
    return parse_mapping(text, option, commas_in_values=True)


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


def parse_channels(text: str | Iterable[str], option: str) -> frozenset[str]:
    """Channels such as "x,z" of an option that needs no more than their names. Raises `BadInput`."""
    texts = [text] if isinstance(text, str) else list(text)
    names = [name.strip() for each in texts for name in each.split(",")]
    for name in names:
        _known(name, option)
    return frozenset(names)
