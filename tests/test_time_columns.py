"""Times of every writing become seconds from the first sample, and a sentence says how they were read."""

from datetime import datetime, timedelta

import numpy as np
import pytest

from jaxbacklash.errors import BadInput
from jaxbacklash.records.time_axis import uniform_grid
from jaxbacklash.records.times import join_date_time, seconds

ROWS = 600
STEP_MS = 2
T = np.arange(ROWS) * STEP_MS / 1000
NEW_YEAR = datetime(2025, 12, 31, 23, 59, 59, 500000)
NOON = datetime(2025, 11, 12, 12, 0, 0, 250000)
EPOCH = 1762941809  # 2025-11-12 10:03:29 UTC


def moments(start: datetime) -> list[datetime]:
    return [start + timedelta(milliseconds=STEP_MS * row) for row in range(ROWS)]


def read(values, unit: str = "") -> tuple[np.ndarray, str]:
    return seconds(np.asarray(values), unit, "rec.csv", "clock")


@pytest.mark.parametrize("start", [NEW_YEAR, NOON, datetime(2024, 2, 28, 23, 59, 59, 900000)])
@pytest.mark.parametrize(
    "pattern",
    [
        "%Y-%m-%dT%H:%M:%S.%fZ",
        "%Y-%m-%dT%H:%M:%S,%f",
        "%Y-%m-%d %H:%M:%S.%f",
        "%Y-%m-%d %H:%M:%S.%f+02:00",
        "%Y-%m-%dT%H:%M:%S.%f-0530",
        "%Y/%m/%d %H:%M:%S.%f",
        "%d.%m.%Y %H:%M:%S,%f",
        "%d.%m.%y %H:%M:%S.%f",
        "%d-%b-%Y %H:%M:%S.%f",
        "%d %B %Y %H:%M:%S.%f",
        "%b %d, %Y %I:%M:%S.%f %p",
        "%Y%m%dT%H%M%S.%f",
        "%Y%m%d %H:%M:%S.%f",
        "%H:%M:%S.%f",
        "%H:%M:%S,%f",
        "%I:%M:%S.%f %p",
        "%d/%m/%Y %H:%M:%S.%f",
        "%m/%d/%Y %H:%M:%S.%f",
        "%m/%d/%Y %I:%M:%S.%f %p",
        "%a, %d %b %Y %H:%M:%S.%f GMT",
    ],
)
def test_stamps_of_every_writing(pattern, start):
    t, sentence = read([when.strftime(pattern) for when in moments(start)])
    np.testing.assert_array_equal(t, T)
    assert start.strftime(pattern) in sentence


def test_fractions_that_leave_zeros_out():
    stamps = [when.isoformat().rstrip("0") if when.microsecond else when.isoformat() for when in moments(NOON)]
    np.testing.assert_array_equal(read(stamps)[0], T)


def test_milliseconds_without_leading_zeros_are_recognised():
    stamps = [f"{when:%H:%M:%S}.{when.microsecond // 1000}" for when in moments(NOON)]
    t, sentence = read(stamps)
    np.testing.assert_array_equal(t, T)
    assert "not padded" in sentence


def test_milliseconds_behind_a_colon():
    np.testing.assert_array_equal(read([f"{when:%H:%M:%S:%f}"[:-3] for when in moments(NOON)])[0], T)


def test_minutes_and_seconds():
    t, sentence = read([f"{int(59 + t // 60)}:{30 + t % 60:06.3f}" for t in T])
    np.testing.assert_allclose(t, T, atol=1e-12)
    assert "minutes and seconds" in sentence


def test_elapsed_times_in_hours_beyond_a_day_and_before_zero():
    np.testing.assert_array_equal(read([f"100:00:{t:06.3f}" for t in T])[0], T)
    np.testing.assert_array_equal(read([f"1 days 00:00:{t:09.6f}" for t in T])[0], T)
    before = [f"-00:00:{-t:06.3f}" if t < 0 else f"00:00:{t:06.3f}" for t in T - 0.5]
    np.testing.assert_array_equal(read(before)[0], T)


def test_a_clock_of_twelve_hours_without_its_half():
    stamps = [when.strftime("%I:%M:%S.%f") for when in moments(datetime(2025, 1, 1, 12, 59, 59, 500000))]
    np.testing.assert_array_equal(read(stamps)[0], T)


def test_a_date_that_can_be_read_in_two_ways_is_harmless_within_a_day_and_decided_by_midnight():
    for pattern in ("%d/%m/%Y %H:%M:%S.%f", "%m/%d/%Y %H:%M:%S.%f"):
        within = read([when.strftime(pattern) for when in moments(datetime(2025, 4, 3, 10))])
        over = read([when.strftime(pattern) for when in moments(datetime(2025, 4, 3, 23, 59, 59, 500000))])
        np.testing.assert_array_equal(within[0], T)
        np.testing.assert_array_equal(over[0], T)
        assert ("day, month" if pattern.startswith("%d") else "month, day") in over[1]


def test_dates_that_give_other_times_by_each_reading_are_refused():
    with pytest.raises(BadInput, match=r"day, month, year or month, day, year.*--rate HZ"):
        read(["03/04/2025 10:00:00.0", "03/05/2025 10:00:00.0", "03/06/2025 10:00:00.0"])


def test_stamps_with_zones_that_change():
    stamps = [f"2025-10-26T02:59:59.{row:03d}+02:00" for row in range(500, 1000, 2)]
    stamps += [f"2025-10-26T02:00:00.{row:03d}+01:00" for row in range(0, 500, 2)]
    np.testing.assert_array_equal(read(stamps)[0], T[:500])


def test_missing_stamps_are_not_a_number():
    stamps = [when.isoformat() for when in moments(NOON)]
    stamps[0], stamps[7] = "", "NaT"
    t, _ = read(stamps)
    assert np.flatnonzero(np.isnan(t)).tolist() == [0, 7]
    np.testing.assert_allclose(t[8:], T[8:] - T[1])


@pytest.mark.parametrize(
    ("values", "fragment"),
    [
        (["10:03:29.1", "", "10:03:29.3", "abc"], 'row 4: found "abc", wanted a time written as the first'),
        (["run", "stop"], 'row 1: found "run", wanted a number, or a time such as'),
        (["10:03:29.1", "10:03:61.3"], "row 2: found 61 seconds"),
        (["10:63:29.1", "10:03:21.3"], "row 1: found 63 minutes"),
        (["2025-13-01 10:00:00", "2025-13-01 10:00:01"], "month 13"),
        (["45.13.2025 10:00:00.1", "45.13.2025 10:00:00.2"], "45.13.2025"),
        (["", "-"], "no time in any row"),
    ],
)
def test_what_is_no_time_is_refused_by_its_row(values, fragment):
    with pytest.raises(BadInput) as caught:
        read(values)
    assert fragment in str(caught.value)
    assert str(caught.value).startswith("rec.csv, column clock")


@pytest.mark.parametrize(
    ("values", "called", "tolerance"),
    [
        (EPOCH + T, "seconds since 1970", 0.0),
        (EPOCH + np.round(T + 0.25, 3), "seconds since 1970", 0.0),
        (1e3 * (EPOCH + T), "milliseconds since 1970", 1e-9),
        (1e6 * EPOCH + 1e6 * T, "microseconds since 1970", 1e-9),
        (1e9 * EPOCH + 1e9 * T, "nanoseconds since 1970", 1.3e-7),
        ((EPOCH * 10**9 + np.arange(ROWS) * 2_000_000).astype(str), "nanoseconds since 1970", 0.0),
        ((EPOCH * 10**3 + np.arange(ROWS) * 2), "milliseconds since 1970", 0.0),
        (EPOCH + 2082844800 + T, "seconds since 1904", 0.0),
        (45973.4191 + T / 86400, "days since 1899-12-30", 1e-6),
        (np.round(45356.5 + T / 86400, 10), "days since 1899-12-30", 1e-5),
        (0.4191 + T / 86400, "fractions of a day", 1e-9),
        (739933.4191 + T / 86400, "days since the year 0, as MATLAB", 1.1e-5),
        (6.389e17 + 1e7 * T, ".NET", 1.3e-5),
        (1.341e17 + 1e7 * T, "Windows", 1.3e-5),
    ],
)
def test_counts_of_computers(values, called, tolerance):
    t, sentence = read(values)
    np.testing.assert_allclose(t, T, atol=tolerance, rtol=0)
    assert called in sentence


def test_the_first_moment_is_said_as_a_date():
    assert "2025-11-12 10:03:29" in read(EPOCH + T)[1]
    assert "2025-11-12 10:03:29" in read(1e3 * (EPOCH + T))[1]
    assert "2025-11-12 12:00:00" in read(45973.5 + T / 86400)[1]
    assert "2025-11-12 12:00:00" in read(739933.5 + T / 86400)[1]


def test_rounding_that_matters_is_said():
    assert "10.0583 us" in read(739933.4191 + T / 86400)[1]
    assert "kept to" not in read(EPOCH + T)[1]


@pytest.mark.parametrize(
    "values",
    [
        T,
        T + 0.1,
        1e3 * T,
        1e6 * T,
        45000.0 + T,
        1.2e9 + 1e6 * T,
        T - 0.3,
        np.arange(ROWS) * 1e-4,
        np.full(ROWS, 3.0),
        np.array([0.0]),
        np.array([np.nan, np.nan]),
    ],
)
def test_plain_numbers_are_returned_bit_for_bit(values):
    t, sentence = read(values)
    np.testing.assert_array_equal(t, values)
    assert sentence == ""


def test_a_unit_stated_keeps_numbers_from_being_days():
    values = 45973.4191 + T / 86400
    assert read(values, "s")[1] == ""
    assert "days" in read(values)[1]


def test_stamps_without_fractions_point_at_the_rate():
    long = [NOON.replace(microsecond=0) + timedelta(seconds=row // 100) for row in range(1000)]
    _, sentence = read([when.strftime("%H:%M:%S") for when in long])
    assert "about 100 samples share each stamp" in sentence
    assert "--rate 100" in sentence
    assert "--rate 100" in read(np.floor(EPOCH + np.arange(1000) / 100))[1]


def test_date_and_time_of_two_columns():
    when = moments(NEW_YEAR)
    times = np.array([each.strftime("%H:%M:%S.%f") for each in when])
    for dates in ([each.strftime("%d.%m.%Y") for each in when], [float(each.strftime("%Y%m%d")) for each in when]):
        np.testing.assert_array_equal(read(join_date_time(np.array(dates), times))[0], T)


@pytest.mark.parametrize("decimals", [9, 10])
@pytest.mark.parametrize("rate", [100.0, 500.0, 1000.0])
@pytest.mark.parametrize("start", [45000.4375, 36900.1, 51000.9])
def test_days_of_spreadsheets_are_even_times(decimals, rate, start):
    even = np.arange(3000) / rate
    t, _ = read(np.round(start + even / 86400.0, decimals))
    grid = uniform_grid(t)
    assert grid is not None
    np.testing.assert_allclose(grid - grid[0], even, atol=86400 * 10.0**-decimals)


def test_a_lost_row_among_days_is_not_taken_for_rounding():
    even = np.delete(np.arange(3000) / 500.0, 1500)
    assert uniform_grid(read(np.round(45000.4375 + even / 86400.0, 10))[0]) is None
