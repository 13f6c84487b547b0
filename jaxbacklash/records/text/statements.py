"""What the lines above a table, or comments in it, state about the samples: how many a second, or how far apart."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

_OF_SAMPLES = r"(?:sampl\w*|scan|acquisition|update|data|logging|log|capture|daq|adc|cycle)[\s_.-]*"
_RATE = (
    rf"(?:{_OF_SAMPLES}(?:rate|freq\w*|clock)|samplerate|sampling|abtastrate|abtastfrequenz|fs|f_s|fsamp\w*|rate|rate_hz|"
    r"frame[\s_-]?rate|fps)"
)
_STEP = (
    rf"(?:{_OF_SAMPLES}(?:interval|period|time|step)|delta[\s_]?[xt]|dt|d_t|x?[\s_-]?inc(?:r(?:ement)?)?|"
    r"time[\s_-]?(?:step|increment|interval|base step)|abtastzeit|abtastintervall|horizontal[\s_-](?:interval|resolution)|"
    r"interval|ts|t_s|tsample|ipo)"
)
_UNIT = r"[\[(]?\s*(k|M|G|m|u|µ|μ|n)?(Hz|hz|HZ|S/s|Sa/s|SPS|sps|Hertz|hertz|samples/s|1/s|fps|sec(?:onds?)?|s|S)?\s*[\])]?"
_STATED = (
    rf"^(?:[^\w]*)(?:(?P<rate>{_RATE})|(?P<step>{_STEP}))\s*(?P<key>[\[(][^\])]*[\])])?\s*[:=,;\t |]+\s*\"?"
    rf"(?P<value>[-+]?\d*[.,]?\d+(?:[eE][-+]?\d+)?)\"?\s*[,;\t]?\s*\"?(?P<unit>{_UNIT})\"?(?=$|[\s,;\t\"])"
)
_FACTORS = {"k": 1e3, "M": 1e6, "G": 1e9, "m": 1e-3, "u": 1e-6, "µ": 1e-6, "μ": 1e-6, "n": 1e-9}

AGREE = 1e-3
"""Two statements whose rates differ by less than this fraction are one: an interval is printed with few digits."""


def stated_rate(lines: Iterable[str]) -> tuple[float | None, str]:
    """Samples per second as lines of text state them.

    Parameters
    ----------
    lines : iterable of str
        Lines above the table and comments, each with its mark.

    Returns
    -------
    rate_hz : float or None
        None where nothing is stated, or two lines contradict each other.
    note : str
        A sentence where they do; else the line that states it.

    Examples
    --------
    >>> stated_rate(["# rig 4", "# Sample rate: 500 Hz"])
    (500.0, 'Sample rate: 500 Hz')
    """
    rate, said = None, ""
    for line in lines:
        found = _of_line(line)
        if found is None:
            continue
        plain = " ".join(line.strip('#%/;! \t\r\n,"').split())[:60]
        if rate is not None and abs(found - rate) > AGREE * rate:
            return None, f'two rates are stated, "{said}" and "{plain}"; neither is used'
        rate, said = (rate or found), (said or plain)
    return rate, said


def _of_line(line: str) -> float | None:
    """The rate [Hz] that one line states."""
    found = re.match(_STATED, line.strip(), re.IGNORECASE)
    if found is None:
        return None
    value = float(found["value"].replace(",", "."))
    text = (found["unit"] or "").strip("[]() ") or (found["key"] or "").strip("[]() ")
    unit = re.fullmatch(_UNIT, text)
    prefix, base = (unit[1], unit[2]) if unit else (None, None)
    if not unit or not math.isfinite(value) or value <= 0 or (prefix and not base):
        return None
    value *= _FACTORS.get(prefix or "", 1.0)
    per_second = base is not None and base.lower() not in ("s", "sec", "second", "seconds")
    # "Sampling: 2 ms" is an interval whatever its name, "Sample time: 500 Hz" a rate.
    return value if per_second or (found["rate"] and base is None) else 1.0 / value
