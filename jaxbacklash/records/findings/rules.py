"""The table of what is looked for in a record, and which flag switches a check off. `find` goes through it row by row."""

from __future__ import annotations

import dataclasses

from jaxbacklash.records.finding import ASK, REFUSE, WARN
from jaxbacklash.records.options import ReadOptions


@dataclasses.dataclass(frozen=True)
class Rule:
    """One row of the table.

    Parameters
    ----------
    looks_for : str
        What is looked for.
    threshold : str
        From where on it counts, and why there.
    action : str
        `REFUSE`, `WARN` or `ASK`.
    flag : str
        The option that switches the check off, for the channel that it names; `--accept KIND` always does.
    """

    looks_for: str
    threshold: str
    action: str
    flag: str = ""


RULES: dict[str, Rule] = {
    "wrap": Rule(
        "jumps of x, y or z by a full turn (2 pi, 360, 1, 2^n counts, or the channel's own range, again and again)",
        "20 times what the steps around it differ by: no mass moves a turn between two samples",
        REFUSE,
        "--unwrap",
    ),
    "clipped": Rule("a sensor at its stop", "3 runs of 5 equal values at the limit, 5 times as many as beside it", WARN),
    "held rows": Rule("all channels stand still for 4 rows and then jump", "3 times the usual step", WARN),
    "contradiction": Rule("x, y and z all present, z not y - x", "a tenth of z's own standard deviation", WARN),
}
"""By kind; the kinds are those of `Finding.kind` and what `--accept` takes."""


def silenced(kind: str, channel: str, options: ReadOptions, units_stated: frozenset[str]) -> bool:
    """Whether the user has answered this check for this channel."""
    if kind in options.accept:
        return True
    flag = RULES[kind].flag
    return {
        "": False,
        "--unwrap": channel in options.unwrap,
        "--despike": channel in options.despike,
        "--sign": channel in options.sign,
        "--ratio": options.ratio is not None,
        "--rate": options.rate is not None,
        "--unit": channel in units_stated,
        "--from": options.start is not None,
    }[flag]


__all__ = ["ASK", "REFUSE", "RULES", "WARN", "Rule", "silenced"]
