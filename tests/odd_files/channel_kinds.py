"""What is wrong with a channel, or between two: wraps, sentinels, spikes, held values, gears, signs, delays, clocks, units."""

from __future__ import annotations

import numpy as np

from tests.odd_files.draft import REFUSED, SAID, Column, Draft
from tests.odd_files.good import NOISE, good_motion
from tests.odd_files.kinds import kind, pick

TURN = 2.0 * np.pi


def as_link(draft: Draft) -> None:
    """The record as t, x, y: the link against the ground."""
    column = draft.column("z")
    column.values = column.values + draft.column("x").values
    column.channel = column.name = "y"
    if draft.reference is not None:
        z = draft.reference.channels.pop("z")
        draft.reference.channels["y"] = z + draft.reference.channels["x"]


@kind("x")
def wrap_at_pi(draft: Draft, rng) -> None:
    """The base's angle is kept between -pi and pi, or 0 and 2 pi, and the motion crosses that; its zero is elsewhere."""
    x, start = draft.column("x"), float(pick(rng, 0.0, np.pi))
    x.values = (x.values - 0.02) % TURN - np.pi + start
    _unwrapped(draft, rng, r"2 ?pi|turn|6\.28|wrap")


@kind("x z")
def wrap_at_360(draft: Draft, rng) -> None:
    """Degrees from 0 to 360."""
    for channel in "xz":
        draft.column(channel).values = np.rad2deg(draft.column(channel).values)
    draft.column("x").values = draft.column("x").values % 360.0
    draft.options += ["--unit", "x=deg,z=deg"]
    _unwrapped(draft, rng, r"360|2 ?pi|turn|6\.28|wrap")


@kind("x z")
def wrap_of_counts(draft: Draft, rng) -> None:
    """Counts of an encoder of 2^18 a turn in a counter of 12 or 13 bits."""
    count, bits = TURN / 2**18, int(pick(rng, 12, 13))
    for channel in "xz":
        draft.column(channel).values = np.round(draft.column(channel).values / count)
        draft.options += ["--scale", f"{channel}={count:.9g}"]
    draft.column("x").values = draft.column("x").values % 2**bits
    draft.tolerance = count
    _unwrapped(draft, rng, rf"2\^{bits}|{2**bits}|wrap|jump")


def _unwrapped(draft: Draft, rng, *words: str) -> None:
    if pick(rng, True, False):
        draft.options += ["--unwrap", "x"]
    else:
        draft.expect(REFUSED, r"\bx\b", r"row|line", r"--unwrap", *words, remedy="--unwrap")
    draft.tolerance = max(draft.tolerance, 1e-6)
    draft.kinds.append("zero is lost")


@kind("x z")
def sentinel(draft: Draft, rng) -> None:
    """Failed reads written as a number."""
    column, value = draft.column(pick(rng, "x", "z")), float(pick(rng, -9999.0, 0.0, 1e6, -1.0, 99.0))
    column.values = column.values.copy()
    large = np.flatnonzero(np.abs(column.values) > 6e-3)  # a zero near zero is not seen, and does no harm
    rows = rng.choice(large[(large > 100) & (large < column.values.size - 100)], 12, replace=False)
    column.values[rows] = value
    _despiked(draft, rng, column.channel or "")


@kind("x z")
def spikes(draft: Draft, rng) -> None:
    """Three single samples that stand out."""
    column = draft.column(pick(rng, "x", "z"))
    rows = rng.choice(np.arange(100, column.values.size - 100), 3, replace=False)
    column.values = column.values.copy()
    column.values[rows] += rng.choice((-1.0, 1.0), 3) * rng.uniform(0.03, 0.3)
    _despiked(draft, rng, column.channel or "")


def _despiked(draft: Draft, rng, channel: str) -> None:
    draft.tolerance = 5.0 * NOISE
    if pick(rng, True, False):
        draft.options += ["--despike", channel]
    else:
        draft.expect(SAID, rf"\b{channel}\b", r"row|line", remedy="--despike")


@kind("x z")
def held_values(draft: Draft, rng) -> None:
    """A channel that is refreshed at every k-th row only."""
    every, column = int(pick(rng, 2, 3, 5, 10)), draft.column(pick(rng, "z", "z", "x"))
    column.values = column.values[np.arange(column.values.size) // every * every]
    draft.reference = None
    draft.expect(SAID, rf"\b{column.channel}\b", r"held|hold|refresh|stay|repeat|same value|every|stair")


@kind("x z")
def stale_samples(draft: Draft, rng) -> None:
    """One sample in a hundred is the one before once more."""
    column = draft.column("z")
    column.values = column.values.copy()
    rows = np.sort(rng.choice(np.arange(50, column.values.size - 50), column.values.size // 100, replace=False))
    for row in rows:  # one after the other: a stale sample may be followed by another
        column.values[row] = column.values[row - 1]
    draft.reference = None
    draft.expect(SAID, r"\bz\b|row", r"stale|held|repeat|same value|stay|outl|stand out|sample")


@kind("x z")
def geared(draft: Draft, rng) -> None:
    """The base's encoder sits before a gear."""
    ratio = float(pick(rng, 10.0, 2.5, 50.0, 1.5))
    as_link(draft)
    draft.column("x").values = ratio * draft.column("x").values
    draft.expect(SAID, r"\b[xy]\b", r"gear|ratio|follows|unit|gain|scale|\d deg", remedy="--ratio")


@kind("x z")
def mounted_the_other_way(draft: Draft, rng) -> None:
    """An encoder that counts the other way."""
    if pick(rng, True, False):
        as_link(draft)
        draft.column("y").values = -draft.column("y").values
    else:
        draft.column("z").values = -draft.column("z").values
    draft.expect(SAID, r"\b[xyz]\b", r"-x|sign|turned|other way|opposite|--sign", remedy="--sign")


@kind("x z")
def late_channel(draft: Draft, rng) -> None:
    """The second channel is some ms late; both begin at rest."""
    late = float(pick(rng, 0.004, 0.006, 0.010, 0.002))
    motion, t = good_motion(), draft.column("t").values
    if pick(rng, True, False):
        draft.column("z").values = motion.z(np.maximum(t - late, 0.0)) + NOISE * rng.standard_normal(t.size)
    else:
        as_link(draft)
        before = np.maximum(t - late, 0.0)
        draft.column("y").values = motion.z(before) + motion.x(before) + NOISE * rng.standard_normal(t.size)
    draft.reference = None
    draft.expect(SAID, r"late|delay|lag|ms|clock")


@kind("x z")
def two_clocks(draft: Draft, rng) -> None:
    """The second channel's clock runs faster or slower than the first's."""
    apart = float(pick(rng, 2e-4, -5e-4, 1e-3))
    motion, t = good_motion(), draft.column("t").values
    draft.column("z").values = motion.z(np.clip(t * (1.0 + apart), 0.0, 6.05)) + NOISE * rng.standard_normal(t.size)
    draft.reference = None
    draft.expect(SAID, r"clock|drift|ppm|late|delay|lag")


@kind("x z")
def degrees_for_radians(draft: Draft, rng) -> None:
    """Degrees or milliradians, and nothing says so."""
    factor, unit = pick(rng, (180.0 / np.pi, "deg"), (1e3, "mrad"))
    for channel in "xz":
        draft.column(channel).values = factor * draft.column(channel).values
    draft.expect(SAID, r"\b[xz]\b", rf"{unit}|unit|radian|scale", remedy=rf"={unit}")


@kind("x z")
def counts_for_radians(draft: Draft, rng) -> None:
    """Whole counts of an encoder, and nothing says so."""
    count = TURN / float(pick(rng, 2**18, 2**17, 400000))
    for channel in "xz":
        draft.column(channel).values = np.round(draft.column(channel).values / count)
    draft.tolerance = count
    draft.expect(REFUSED, r"\b[xz]\b", r"count|unit|radian|--scale")
    draft.kinds.append("second needs the count")


@kind("x z")
def base_in_turns(draft: Draft, rng) -> None:
    """x in turns or degrees beside y in radians."""
    as_link(draft)
    factor = float(pick(rng, 1.0 / TURN, 180.0 / np.pi))
    draft.column("x").values = factor * draft.column("x").values
    draft.expect(SAID, r"\b[xy]\b", r"rev|turn|deg|unit|ratio|follows|gear|gain|scale", remedy=r"x=rev|x=deg|--ratio")


@kind("x z time")
def accelerometer(draft: Draft, rng) -> None:
    """Three axes of acceleration under the names x, y, z."""
    t = draft.column("t").values
    unit = float(pick(rng, 1.0, 9.81))
    wave = [np.sin(TURN * f * t + p) for f, p in zip(rng.uniform(2.0, 9.0, 3), rng.uniform(0.0, 6.0, 3), strict=True)]
    axes = {n: unit * (0.3 * w + 0.05 * rng.standard_normal(t.size) + (n == "z")) for n, w in zip("xyz", wave, strict=True)}
    draft.columns[1:] = [Column(name, name, values) for name, values in axes.items()]
    draft.reference, draft.truth = None, {}
    draft.expect(REFUSED, r"accel|x, y (and|,) z|three|which|one of|both|--columns")


@kind("x z")
def one_shaft(draft: Draft, rng) -> None:
    """Both encoders on one shaft: nothing moves between them."""
    as_link(draft)
    x = draft.column("x").values
    draft.column("y").values = good_motion().x(draft.column("t").values) + NOISE * rng.standard_normal(x.size)
    draft.reference, draft.truth = None, {}
    draft.expect(SAID, r"shaft|same|noise|not determined|does not answer|no motion|nothing|z stays|equal|follows")
