"""What a refusal proposes, put into the options and into the command that was typed."""

from __future__ import annotations

import dataclasses
import shlex
from collections.abc import Callable, Sequence

from .mappings import parse_channels, parse_columns, parse_scales, parse_units
from .options import ReadOptions

FLAGS = ("--resample",)
"""Options that stand alone; all others have a value behind them."""
REPLACING = ("--columns", "--rate", "--ratio", "--from", "--to", "--decimal", "--skip", "--inertia", "--resample-rate")
"""Options of which the last one said is meant; all others add to what was said before."""


def applied(options: ReadOptions, remedy: str) -> ReadOptions:
    """The options with a remedy, "--unwrap x" or "--columns x=enc1 --rate 500", added to them."""
    change: Callable[..., ReadOptions] = dataclasses.replace
    for option, value in _words(remedy):
        if option == "--columns":
            options = change(options, columns={**options.columns, **parse_columns(value)})
        elif option == "--unit":
            options = change(options, units={**options.units, **parse_units(value)})
        elif option == "--scale":
            options = change(options, scales={**options.scales, **parse_scales(value)})
        elif option in ("--unwrap", "--sign", "--despike"):
            name = option[2:]
            options = change(options, **{name: getattr(options, name) | parse_channels(value, option)})
        elif option == "--accept":
            options = change(options, accept=options.accept | frozenset(value.split(",")))
        elif option == "--resample":
            options = change(options, resample=True)
        elif option == "--resample-rate":
            options = change(options, resample=float(value))
        elif option in ("--rate", "--ratio"):
            options = change(options, **{option[2:]: float(value)})
        elif option in ("--from", "--to"):
            options = change(options, **{"start" if option == "--from" else "stop": float(value)})
        elif option == "--skip":
            options = change(options, skip=int(value))
        elif option == "--decimal":
            options = change(options, decimal=value)
    return options


def with_remedy(words: Sequence[str], remedy: str) -> list[str]:
    """The words of a command with a remedy behind them, in the place of what it replaces.

    Examples
    --------
    >>> with_remedy(["fit", "a.csv", "--columns", "t=Time"], "--columns t=Time,x=Base --unwrap x")
    ['fit', 'a.csv', '--columns', 't=Time,x=Base', '--unwrap', 'x']
    """
    new = _words(remedy)
    gone = {option for option, _ in new if option in REPLACING or option in FLAGS}
    kept: list[str] = []
    skip = False
    for word in words:
        option, equals, _ = word.partition("=")
        if skip:
            skip = False
        elif option in gone:
            skip = not equals and option not in FLAGS
        else:
            kept.append(word)
    return kept + [word for option, value in new for word in ((option,) if option in FLAGS else (option, value))]


def _words(remedy: str) -> list[tuple[str, str]]:
    """Pairs of an option and its value ("" for one that stands alone)."""
    words = iter(shlex.split(remedy))
    return [(word, "" if word in FLAGS else next(words, "")) for word in words]
