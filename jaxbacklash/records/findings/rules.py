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
        "jumps of x, y or z by a full turn (2 pi, 360, 2^n counts, or the channel's own range again and again)",
        "4 times the steps beside it for a known turn, 20 for another: no mass moves a turn between two samples",
        REFUSE,
        "--unwrap",
    ),
    "shift": Rule(
        "a lasting shift of x, y or z alone, which moves on as before: counts lost",
        "20 times noise and motion around it, more than lost rows explain, at most 5: more are how a stepper moves",
        ASK,
        "--unwrap",
    ),
    "sentinel": Rule(
        "codes of failed readings: a value two ranges beyond all others, 0 between samples that are not near it",
        "up to a thousandth of the samples of a position is bridged with a warning, more asks",
        ASK,
        "--despike",
    ),
    "spike": Rule(
        "single samples of x, y or z that stand out of the motion, though not as a corner does",
        "20 times noise and motion around it; up to a thousandth of the samples is bridged with a warning, more asks",
        ASK,
        "--despike",
    ),
    "held": Rule(
        "a channel with a new value every k-th row only",
        "4 of 5 runs of equal values have one length, and values differ by more counts than a slow encoder's",
        ASK,
        "--despike",
    ),
    "stale": Rule(
        "samples that repeat the one before amid motion",
        "3 times as many as counting brings by chance; a thousandth of the samples is bridged with a warning, more asks",
        ASK,
        "--despike",
    ),
    "held-rows": Rule("all channels stand still for 4 rows and then jump", "3 times the usual step", WARN),
    "clipped": Rule("a sensor or a force at its limit", "3 runs of 5 equal values, 5 times as many as beside the limit", WARN),
    "gear": Rule(
        "y that follows x in slow motion at another factor than 1",
        "1.3, in two neighbouring octaves alike, coherent and in step",
        ASK,
        "--ratio",
    ),
    "sign": Rule(
        "y that follows -x in slow motion; z that is x - y, or grows against x with the frequency",
        "as for a gear; a tenth of z",
        ASK,
        "--sign",
    ),
    "no-ratio": Rule("a drive without the turns of its motor for a turn of the link", "none said", ASK, "--ratio"),
    "wrong-ratio": Rule(
        "a link that follows the motor of a drive at another ratio than was said",
        "as for a gear",
        ASK,
    ),
    "command": Rule("a command that the motor follows at another ratio than its gear's", "as for a gear", ASK),
    "turned-link": Rule("a link that turns against the motor of its drive", "as for a gear", ASK, "--sign"),
    "absolute": Rule("z that follows x one to one in slow motion: it is y", "as for a gear", ASK),
    "contradiction": Rule("x, y and z all present, z not y - x", "a tenth of z's own standard deviation", WARN),
    "axes": Rule(
        "x, y and z all present and no one joint's: three axes of an accelerometer",
        "0.7 of z's own standard deviation",
        ASK,
    ),
    "quantity": Rule("a position read from a column named as an acceleration or a rate of turn", "its name", ASK),
    "degrees": Rule(
        "degrees taken for radians",
        "a relative motion over 1 rad, a base over a turn, to one side of the middle",
        ASK,
        "--unit",
    ),
    "counts": Rule("whole numbers for radians or metres", "a range of 20", ASK, "--unit"),
    "no-answer": Rule(
        "an observed channel of white noise or of three counts while the input moves",
        "5 standard errors of a correlation at 64 lags",
        REFUSE,
    ),
    "held-first": Rule(
        "a free decay whose link stands still, off its rest, before it is let go",
        "a twentieth of the way to rest, for longer than it then takes to swing back; those rows are left out",
        WARN,
        "--from",
    ),
    "driven": Rule(
        "z or y alone, which is read as a free decay, whose motion grows and does not die away",
        "1.5 times from one sixth of the record to a later one, two swings in each, and 40 times the noise",
        ASK,
    ),
    "stale-first": Rule(
        "first rows that repeat one value until the observed channel goes on at full speed",
        "1.5 times the sharpest corner anywhere else, up to 12 rows; they are left out",
        WARN,
        "--from",
    ),
    "backwards": Rule("times that go back", "any", REFUSE, "--rate"),
    "bursts": Rule("times that repeat or come in bursts", "gaps of 3 mean steps, 4 of them; any repeat", ASK, "--rate"),
    "time-unit": Rule(
        "milliseconds or finer where seconds are wanted",
        "a step of 0.05 s, where the record lasts half a second in either unit",
        ASK,
        "--unit",
    ),
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
