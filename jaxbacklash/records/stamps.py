"""Stamps of date and time written as text: the fields of each, and what they mean together.

Most columns are of one width throughout; their digits are then read for all rows at once. Others are read row by row.
"""

from __future__ import annotations

import re

import numpy as np

from .checks import wrong

_MONTH = r"(?:jan|feb|m[aä]r|mrz|apr|ma[yi]|jun|jul|aug|sep|o[ck]t|nov|de[cz])[a-z]*"
_DATE = (
    r"(?:[a-z]{2,9}\.?,?\s+)??(?:(?P<a>\d{1,4})(?P<sep>[-/.])(?P<b>\d{1,2})(?P=sep)(?P<c>\d{1,4})"  # 2025-11-12, 12.11.2025
    rf"|(?P<day>\d{{1,2}})[-/ .]+(?P<month>{_MONTH})\.?[-/, .]+(?P<year>\d{{2,4}})"  # 12-Nov-2025
    rf"|(?P<month2>{_MONTH})\.?\s+(?P<day2>\d{{1,2}}),?\s+(?P<year2>\d{{4}})"  # Nov 12, 2025
    r"|(?P<ymd>\d{8}))"
)
_TIME = (
    r"(?:(?P<days>\d+)\s*(?:days?|d),?\s+)?(?P<minus>[-+])?"
    r"(?:(?P<h>\d{1,4}):(?P<m>\d{1,2})(?::(?P<s>\d{1,2}))?|(?P<hms>\d{6}))"
    r"(?:(?P<point>[.,:])(?P<f>\d{1,12}))?(?:\s*(?P<half>[ap])\.?m\.?)?"
)
_ZONE = r"\s*(?:(?P<zone>Z|UTC|GMT|[-+]\d{2}(?::?\d{2})?)|[a-z]{3,4})?"
_STAMP = rf"(?:{_DATE}\.?(?:\s*[T,;_:\s-]\s*|$))?(?:{_TIME}{_ZONE})?"
_NUMBERS = ("a", "b", "c", "day", "year", "day2", "year2", "ymd", "days", "h", "m", "s", "hms", "f")
_OPTIONAL = frozenset(["f", "point", "s", "zone", "minus", "half", "days"])
_MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
_MONTHS_ELSEWHERE = {"mrz": 3, "mär": 3, "mai": 5, "okt": 10, "dez": 12}
_ABSENT = frozenset(["", "-", "--", "nan", "nat", "null", "none", "n/a", "#n/a", "na"])

SECOND = 1_000_000_000
"""Nanoseconds in a second, in which stamps are counted."""

DAY, HALF_DAY = 86400 * SECOND, 43200 * SECOND

LONGEST_PAUSE = 2 * 3600 * SECOND
"""Between two samples of a record no more than two hours pass: of two readings of a date, the one that says so is right."""


def read_stamps(values: np.ndarray, where: str, name: str) -> tuple[np.ndarray, np.ndarray, str, str]:
    """Read a column of stamps.

    Parameters
    ----------
    values : array of shape (N,), text
        Stripped of blanks; empty where there is none.
    where, name : str
        The file and the column, for the sentence.

    Returns
    -------
    nanoseconds : array of shape (N,), int64
        From a common origin; times of day go on over midnight.
    known : array of shape (N,), bool
        False where there is no stamp.
    how : str
        How they are written, for a sentence: "date and time (UTC)", "hours, minutes and seconds".
    first : str
        The first stamp, as it stands.

    Raises
    ------
    BadInput
        Naming the first row that is no stamp like the others, or dates that can be read in two ways.
    """
    place = f"{where}, column {name}"
    known = np.char.str_len(values) > max(map(len, _ABSENT))
    for row in np.flatnonzero(~known).tolist():
        known[row] = values[row].lower() not in _ABSENT
    if not known.any():
        return np.zeros(values.size, np.int64), known, "", ""
    rows = np.flatnonzero(known)
    texts = np.ascontiguousarray(values[rows])
    first = str(texts[0])
    match = re.fullmatch(_STAMP, first, re.IGNORECASE)
    if match is None or not first:
        raise wrong(
            f"{place}, row {rows[0] + 1}",
            f'"{first[:40]}"',
            "a number, or a time such as 2025-11-12T10:03:29.002 or 10:03:29.002",
        )
    fields = _of_equal_width(texts, match) or _row_by_row(texts, rows, match, place)
    time, notes = _time_of_day(fields, texts.size, place, rows)
    dates, order = _dates(fields, time, place, rows)
    total = time + dates
    how = order
    if not order:
        total, over = _over_midnight(total, "half" in fields or _beyond_noon(fields))
        how = (
            "days, hours, minutes and seconds" if "days" in fields else "minutes and seconds" if notes == "m" else "times of day"
        )
        how += over
    if notes == "unpadded":
        how += " with milliseconds that are not padded with zeros (29.2 is 29 s and 2 ms)"
    elif notes == "hm":
        how += " in hours and minutes"
    nanoseconds = np.zeros(values.size, np.int64)
    nanoseconds[rows] = total
    return nanoseconds, known, how, first


def _of_equal_width(texts: np.ndarray, match: re.Match) -> dict[str, np.ndarray] | None:
    """The fields of stamps that all have their digits where the first has them; None where some do not."""
    width = texts.dtype.itemsize // 4
    codes = texts.view(np.uint32).reshape(texts.size, width)
    digit = np.array([letter.isdigit() for letter in match.string])
    if len(match.string) > width or codes[:, len(match.string) :].any():
        return None
    codes = codes[:, : len(match.string)]
    numbers = codes[:, digit] - np.uint32(48)
    if (numbers > 9).any() or (codes[:, ~digit] != codes[0, ~digit]).any():
        return None
    fields: dict[str, np.ndarray] = {}
    for key in _NUMBERS:
        if match[key] is not None:
            start, stop = match.span(key)
            places = 10 ** np.arange(stop - start - 1, -1, -1, dtype=np.int64)
            fields[key] = (codes[:, start:stop].astype(np.int64) - 48) @ places
    for key in ("f", "a", "c"):
        if match[key] is not None:
            fields[f"{key}_width"] = np.array([len(match[key])])
    for key in ("sep", "month", "month2", "minus", "point", "half", "zone"):
        if match[key] is not None:
            start, stop = match.span(key)
            # The digits of a zone change where summer ends.
            if (codes[:, start:stop] != codes[0, start:stop]).any():
                return None
            fields[key] = np.array([match[key]])
    return fields


def _row_by_row(texts: np.ndarray, rows: np.ndarray, like: re.Match, place: str) -> dict[str, np.ndarray]:
    """The fields of stamps of several widths. A fraction of a second may be left out where it is 0, as some programs do."""
    matches = list(map(re.compile(_STAMP, re.IGNORECASE).fullmatch, texts.tolist()))
    alike = [match is not None and match.string != "" for match in matches]
    parts = zip(*(match.groups() if match else like.groups() for match in matches), strict=True)
    columns = dict(zip(like.re.groupindex, parts, strict=True))
    for key, column in columns.items():
        if key not in _OPTIONAL:
            alike = [fits and (part is None) == (like[key] is None) for fits, part in zip(alike, column, strict=True)]
    if not all(alike):
        row = alike.index(False)
        wanted = f'a time written as the first is ("{like.string[:40]}")'
        raise wrong(f"{place}, row {rows[row] + 1}", f'"{texts[row][:40]}"', wanted)
    fields: dict[str, np.ndarray] = {}
    for key, column in columns.items():
        if any(column):
            fields[key] = np.array([int(part or 0) for part in column] if key in _NUMBERS else [part or "" for part in column])
    for key in ("f", "a", "c"):
        if key in fields:
            fields[f"{key}_width"] = np.array([len(part or "0") for part in columns[key]])
    return fields


def _time_of_day(fields: dict[str, np.ndarray], size: int, place: str, rows: np.ndarray) -> tuple[np.ndarray, str]:
    """Nanoseconds since midnight, zone taken off, and how the fields were taken: "", "m", "hm" or "unpadded"."""
    if "hms" in fields:
        fields |= {"h": fields["hms"] // 10000, "m": fields["hms"] // 100 % 100, "s": fields["hms"] % 100}
    if "h" not in fields:
        return np.zeros(size, np.int64), ""
    how = ""
    hours, minutes, seconds = fields["h"], fields["m"], fields.get("s")
    if seconds is None:
        # "03:29.002" are minutes and seconds; "10:03" are hours and minutes, as clocks show them.
        how = "m" if "f" in fields and "a" not in fields else "hm"
        hours, minutes, seconds = (0 * hours, hours, minutes) if how == "m" else (hours, minutes, 0 * hours)
    for part, most, called in ((minutes, 10**9 if how == "m" else 59, "minutes"), (seconds, 60, "seconds")):
        if (part > most).any():
            row = int(np.argmax(part > most))
            raise wrong(f"{place}, row {rows[row] + 1}", f"{part[row]} {called}", f"{called} from 0 to {min(most, 59)}")
    if "half" in fields:
        afternoon = np.char.lower(fields["half"]) == "p"
        hours = hours % 12 + 12 * afternoon
    whole = ((hours * 60 + minutes) * 60 + seconds) * SECOND
    fraction, unpadded = _fractions(fields, whole)
    time = whole + fraction
    if "minus" in fields:
        time = np.where(fields["minus"] == "-", -time, time)
    if "days" in fields:
        time = time + fields["days"] * DAY
    if "zone" in fields:
        time = time - np.array([_offset(zone) for zone in fields["zone"].tolist()], dtype=np.int64)
    return time, "unpadded" if unpadded else how


def _fractions(fields: dict[str, np.ndarray], whole: np.ndarray) -> tuple[np.ndarray, bool]:
    """Nanoseconds behind the point, and whether the digits there are a count of milliseconds without leading zeros."""
    if "f" not in fields:
        return np.zeros(whole.size, np.int64), False
    digits, width = fields["f"], fields["f_width"]
    padded = np.where(width <= 9, digits * 10 ** np.maximum(9 - width, 0), digits // 10 ** np.maximum(width - 9, 0))
    if width.max() <= 3 and width.min() < width.max():
        counted = digits * 1_000_000
        # One of the two readings goes on without going back within a second.
        backwards = [np.count_nonzero(np.diff(whole + each) < -SECOND // 1000) for each in (padded, counted)]
        if backwards[1] < backwards[0]:
            return counted, True
    return padded, False


def _offset(zone: str) -> int:
    """Nanoseconds by which a zone is ahead of UTC."""
    if zone[:1] not in ("+", "-"):
        return 0
    digits = zone[1:].replace(":", "").ljust(4, "0")
    return (1 if zone[0] == "+" else -1) * (int(digits[:2]) * 3600 + int(digits[2:]) * 60) * SECOND


def _dates(fields: dict[str, np.ndarray], time: np.ndarray, place: str, rows: np.ndarray) -> tuple[np.ndarray, str]:
    """Nanoseconds from 1970 to the midnight of each date, and how dates are written; zeros and nothing where there are none."""
    zone = _zone_named(fields)
    for suffix in ("", "2"):
        if f"month{suffix}" in fields:
            names = {name: _month(str(name), place) for name in np.unique(fields[f"month{suffix}"])}
            months = np.array([names[name] for name in fields[f"month{suffix}"]])
            return _midnight(
                _century(fields[f"year{suffix}"]), months, fields[f"day{suffix}"], place, rows
            ), f"dates and times{zone}"
    if "ymd" in fields:
        ymd = fields["ymd"]
        return _midnight(ymd // 10000, ymd // 100 % 100, ymd % 100, place, rows), f"dates and times{zone}"
    if "a" not in fields:
        return np.zeros(time.size, np.int64), ""
    a, b, c = fields["a"], fields["b"], fields["c"]
    if (fields["a_width"] == 4).all():
        return _midnight(a, b, c, place, rows), f"dates (year, month, day) and times{zone}"
    orders = {"day, month, year": (_century(c), b, a), "month, day, year": (_century(c), a, b)}
    if fields["sep"][0] == ".":
        del orders["month, day, year"]
    if (fields["c_width"] == 2).all() and fields["sep"][0] != "/":
        orders["year, month, day"] = (_century(a), b, c)
    possible = {
        order: _midnight(*parts, place, rows)
        for order, parts in orders.items()
        if ((parts[1] >= 1) & (parts[1] <= 12) & (parts[2] >= 1) & (parts[2] <= 31)).all()
    }
    if not possible:
        raise wrong(
            f"{place}, row {rows[0] + 1}", f"the date {a[0]}{fields['sep'][0]}{b[0]}{fields['sep'][0]}{c[0]}", "a day and a month"
        )
    going_on = {
        order: days for order, days in possible.items() if (np.abs(np.diff(days + time)) <= LONGEST_PAUSE).all()
    } or possible
    courses = {(days - days[0]).tobytes() for days in going_on.values()}
    if len(courses) > 1:
        found = f"dates that can be {' or '.join(going_on)}, which gives other times"
        raise wrong(place, found, "dates of one meaning, such as 2025-11-12 (or leave the times out and pass --rate HZ)")
    order = next(iter(going_on))
    said = f" ({order})" if len(going_on) == 1 else ""
    return going_on[order], f"dates{said} and times{zone}"


def _zone_named(fields: dict[str, np.ndarray]) -> str:
    zones = np.unique(fields["zone"]).tolist() if "zone" in fields else []
    return f" of the zone {'UTC' if zones[0] in ('Z', 'GMT') else zones[0]}" if len(zones) == 1 else ""


def _century(years: np.ndarray) -> np.ndarray:
    """Years of two digits are of this century."""
    return np.where(years < 100, years + 2000, years)


def _month(name: str, place: str) -> int:
    """The number of a month by its name."""
    short = name[:3].lower()
    if short in _MONTHS:
        return _MONTHS.index(short) + 1
    if short in _MONTHS_ELSEWHERE:
        return _MONTHS_ELSEWHERE[short]
    raise wrong(place, f'the month "{name}"', "an English one, or its number")


def _midnight(years: np.ndarray, months: np.ndarray, days: np.ndarray, place: str, rows: np.ndarray) -> np.ndarray:
    """Nanoseconds from 1970 to the beginning of days."""
    bad = (months < 1) | (months > 12) | (days < 1) | (days > 31) | (years < 1700) | (years > 2200)
    if bad.any():
        row = int(np.argmax(bad))
        found = f"the year {years[row]}, month {months[row]}, day {days[row]}"
        raise wrong(f"{place}, row {rows[row] + 1}", found, "a date between 1700 and 2200")
    first = (years - 1970).astype("M8[Y]").astype("M8[M]") + (months - 1).astype("m8[M]")
    since = (first.astype("M8[D]") + (days - 1).astype("m8[D]")).astype(np.int64)
    return since * DAY


def _beyond_noon(fields: dict[str, np.ndarray]) -> bool:
    """Whether a clock of twelve hours without a.m. and p.m. is possible: hours from 1 to 12 only."""
    hours = fields.get("h")
    return hours is not None and "s" in fields and bool((hours >= 1).all() and (hours <= 12).all())


def _over_midnight(time: np.ndarray, twelve: bool) -> tuple[np.ndarray, str]:
    """Times of day that go on: 24 hours are added where the clock begins anew, 12 where it has only twelve."""
    steps = np.diff(time)
    back = steps < -HALF_DAY
    if back.any():
        return time + np.concatenate([[0], np.cumsum(back) * DAY]), " over midnight"
    half = (steps < 0) & (steps > -HALF_DAY - SECOND) & (steps < -HALF_DAY + 60 * SECOND)
    if twelve and half.any():
        return time + np.concatenate([[0], np.cumsum(half) * HALF_DAY]), " on a clock of twelve hours"
    return time, ""
