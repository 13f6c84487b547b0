"""Times as files hold them: stamps of every writing, stamps that repeat, no stamps, a clock for each channel, lost rows."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

import numpy as np

from tests.odd_files.draft import REFUSED, SAID, Column, Draft
from tests.odd_files.good import NOISE, good_motion
from tests.odd_files.kinds import kind, pick


def stamps(draft: Draft, start: str) -> list[datetime]:
    """The moments of a draft's samples when the first is ``start``."""
    first = datetime.fromisoformat(start).replace(tzinfo=UTC)
    return [first + timedelta(microseconds=round(1e6 * t)) for t in draft.column("t").values]


def start(rng) -> str:
    """A morning, or three seconds before midnight."""
    return pick(rng, "2024-03-05T10:11:12.250", "2023-12-31T23:59:57", "2025-07-01T08:00:00")


def clock(when: datetime, digits: int) -> str:
    """HH:MM:SS with this many digits of a second."""
    return when.strftime("%H:%M:%S.%f")[: 9 + digits]


@kind("time names")
def iso_stamps(draft: Draft, rng) -> None:
    """Date and time in one cell."""
    between, zone, digits = pick(rng, "T", " "), pick(rng, "Z", "", "+02:00", "+0000"), pick(rng, 3, 6)
    draft.column("t").cells = [f"{when:%Y-%m-%d}{between}{clock(when, digits)}{zone}" for when in stamps(draft, start(rng))]
    draft.rename(t=pick(rng, "timestamp", "Time", "date_time"))


@kind("time names")
def clock_times(draft: Draft, rng) -> None:
    """HH:MM:SS.fff, also over midnight."""
    digits = pick(rng, 3, 4, 6)
    draft.column("t").cells = [clock(when, digits) for when in stamps(draft, start(rng))]
    draft.rename(t=pick(rng, "Time", "clock"))


@kind("time names")
def date_and_time_apart(draft: Draft, rng) -> None:
    """A column of dates and one of times."""
    moments = stamps(draft, start(rng))
    shape = pick(rng, "%Y-%m-%d", "%d.%m.%Y", "%m/%d/%Y")
    draft.column("t").cells = [clock(when, 3) for when in moments]
    draft.rename(t="Time")
    draft.columns.insert(0, Column(None, "Date", np.zeros(0), cells=[when.strftime(shape) for when in moments]))


@kind("time names")
def spreadsheet_days(draft: Draft, rng) -> None:
    """Days since 1899-12-30, as spreadsheets store moments."""
    days = 45356.0 + rng.uniform(0.3, 0.7) + draft.column("t").values / 86400.0
    draft.column("t").cells = [f"{day:.{pick(rng, 10, 11)}f}" for day in days]
    draft.rename(t=pick(rng, "Time", "Zeit"))
    draft.tolerance = 1e-4  # the tenth decimal of a day is 9 us
    draft.expect(SAID, r"\bt\b|time", r"day|--unit t=|uneven")


@kind("time names")
def epoch_stamps(draft: Draft, rng) -> None:
    """Seconds, ms, us or ns since 1970."""
    scale, digits = pick(rng, (1, 3), (10**3, 0), (10**6, 0), (10**9, 0))
    first = 1709633472
    exact = [round(1e6 * t) for t in draft.column("t").values]  # whole microseconds: a double holds no nanoseconds since 1970
    if digits:
        draft.column("t").cells = [f"{first + us // 1000000}.{us % 1000000 // 1000:03d}" for us in exact]
    else:
        draft.column("t").cells = [str((first * 1000000 + us) * scale // 1000000) for us in exact]
    draft.rename(t=pick(rng, "timestamp", "epoch", "stamp"))
    draft.tolerance = 2e-6  # a double holds seconds since 1970 to a quarter of a microsecond
    if scale != 1:
        draft.expect(SAID, r"ms|us|ns|milli|micro|nano|epoch|1970")


@kind("time names", rate=500.0)
def milliseconds(draft: Draft, rng) -> None:
    """ms taken for s."""
    scale, unit = pick(rng, (1e3, "ms"), (1e6, "us"))
    draft.column("t").values = np.round(scale * draft.column("t").values, 3)
    if pick(rng, True, False):
        draft.rename(t="time")
    draft.expect(REFUSED, r"column t|\bt\b", unit, remedy=f"t={unit}")


@kind("time names units head")
def no_time(draft: Draft, rng) -> None:
    """No time column; the rate is known, or asked for."""
    draft.columns.remove(draft.column("t"))
    if pick(rng, True, True, False):
        draft.options += ["--rate", "500"]
    else:
        draft.expect(REFUSED, r"--rate", r"time")


@kind("time names head")
def no_header(draft: Draft, rng) -> None:
    """Numbers from the first line on; columns by number, or the message shows how."""
    draft.header = False
    if pick(rng, True, True, False):
        draft.said_columns = draft.numbered()
    else:
        draft.expect(REFUSED, r"#\d", r"header|number")


@kind("time names head tail")
def no_header_no_time(draft: Draft, rng) -> None:
    """Two columns of numbers and nothing else."""
    draft.columns.remove(draft.column("t"))
    draft.header = False
    draft.said_columns = draft.numbered()
    draft.options += ["--rate", "500"]


@kind("head")
def skipped_lines(draft: Draft, rng) -> None:
    """Lines above the header that look like a table of their own, passed over by number."""
    draft.above = ["gain,offset,serial", "1.02,0.5,17", "0.98,0.1,18", "1.0,0.0,19"][: int(rng.integers(2, 5))]
    draft.options += ["--skip", str(len(draft.above))]


@kind("names")
def awkward_names(draft: Draft, rng) -> None:
    """Commas, quotes and blanks in column names; quoted as README says, or not, or by number."""
    commas, blanks = ("Time, s", "Base, rad", "Rel, rad"), ("the time", "base angle", "joint angle")
    names = pick(rng, commas, blanks, ("t [s]", 'x "in"', "z, rel"))
    draft.rename(**dict(zip("txz", names, strict=True)))
    how = int(rng.integers(3))
    if how == 1:
        draft.said_columns = draft.numbered()
    if how == 2 and any("," in name for name in names):
        draft.said_columns = {}
        pairs = (f"{column.channel}={column.name}" for column in draft.columns)
        draft.options += ["--columns", ",".join(pairs)]
        draft.expect(REFUSED, r"--columns", r"quote|number|#\d|\"")


@kind("names")
def name_twice(draft: Draft, rng) -> None:
    """One name over two columns: the clocks of two channels, or two encoders."""
    if pick(rng, True, False):
        t = draft.column("t").values
        late = pick(rng, 0.0, 0.0, 0.004)
        draft.columns.insert(2, Column(None, "Time", t + late))
        draft.rename(t="Time")
        if late:
            draft.expect(SAID, r"clock|second|twice|Time|late|lag|delay")
    else:
        draft.rename(x="angle", z="angle")
        draft.expect(REFUSED, r"angle", r"twice|more than once|two|#\d")


@kind("time names x z")
def clock_per_channel(draft: Draft, rng) -> None:
    """Every channel with times of its own; the second begins later, so that a row holds two moments."""
    motion, t = good_motion(), draft.column("t").values
    late = float(pick(rng, 0.0007, 0.003, 0.011))
    z = motion.z(t + late) + NOISE * rng.standard_normal(t.size)
    draft.column("z").values = z
    draft.columns.insert(2, Column(None, "t_z", t + late))
    draft.columns[0].name = "t_x"
    draft.said_columns["t"] = "t_x"
    draft.reference = None
    draft.expect(SAID, r"clock|t_z|late|lag|delay|apart")


@kind("time")
def repeated_stamps(draft: Draft, rng) -> None:
    """Stamps coarser than the sampling, with the rate known or not."""
    coarse = pick(rng, 0.01, 0.004, 0.02)
    t = draft.column("t").values
    draft.column("t").values = np.floor(t / coarse + 1e-9) * coarse
    if pick(rng, True, True, False):
        draft.options += ["--rate", "500"]
    else:
        draft.expect(REFUSED, r"row|line", r"--rate|--resample")


@kind("time")
def bursts(draft: Draft, rng) -> None:
    """Samples that arrive by the packet: the packet's samples bear stamps 20 us apart."""
    size = int(pick(rng, 5, 10, 16))
    index = np.arange(draft.column("t").values.size)
    draft.column("t").values = (index // size) * size / 500.0 + (index % size) * 2e-5
    draft.options += ["--rate", "500"]


@kind("time x z")
def lost_rows(draft: Draft, rng) -> None:
    """A few rows are missing."""
    t = draft.column("t").values
    gone = np.unique(np.concatenate([np.arange(at, at + rng.integers(1, 4)) for at in rng.integers(200, t.size - 200, 3)]))
    for column in draft.columns:
        column.values = np.delete(column.values, gone)
    draft.tolerance = 5.0 * NOISE
    if pick(rng, True, False):
        draft.options += ["--resample"]
    else:
        draft.expect(REFUSED, r"rows?\b|line", r"--resample", remedy="--resample")


@kind("x z container")
def short_nan_runs(draft: Draft, rng) -> None:
    """Cells that hold no number, two or three in a row."""
    blank = pick(rng, "NaN", "nan", "", "NA", "#N/A", "-")
    column = draft.column(pick(rng, "x", "z"))
    column.cells = column.texts()
    for at in rng.integers(200, column.values.size - 200, 3):
        for row in range(at, at + int(rng.integers(1, 4))):
            column.cells[row] = blank
    draft.tolerance = 5.0 * NOISE
    if pick(rng, True, False):
        draft.options += ["--resample"]
    else:
        draft.expect(REFUSED, r"line|row", r"column [xz]|\b[xz]\b", remedy="--resample")


@kind("time", rate=800.0)
def coarse_stamps_at_800(draft: Draft, rng) -> None:
    """800 Hz, stamps in whole milliseconds: neither 1000 Hz nor 500 Hz."""
    draft.column("t").values = np.round(np.floor(1e3 * draft.column("t").values + 1e-6) / 1e3, 3)
    how = int(rng.integers(3))
    draft.tolerance = 2e-3  # stamps tell each moment to a millisecond: 0.5 rad/s of speed times that, and it is not hidden
    if how == 0:
        draft.options += ["--rate", "800"]
        draft.tolerance = 2e-7
    elif how == 1:
        draft.options += ["--resample"]
        draft.expect(SAID, r"800|uneven|stamp|rate|clock|time")
    else:
        draft.expect(REFUSED, r"row|uneven|stamp", r"--resample|--rate 800")
