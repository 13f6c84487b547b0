"""A link that friction carries behind its drive: the play from where z stands on the way up and on the way down."""

from __future__ import annotations

import numpy as np

from ..signals.resolution import count_of
from .angle import drift_rows, families, waves
from .cells import Cells, cells
from .crossing import Crossing, crossing, thinned
from .levels import Levels, levels
from .over_angle import errors_of, over_angle, slope_of
from .play import Passes, passes, states
from .reading import Condition, Reading, rough_noise
from .shows import (
    at_edges,
    at_one_edge,
    both_edges,
    clear_of_counts,
    enough_passes,
    follows,
    gear,
    no_lag,
    stays_put,
)

BEYOND = 1.25
"""Travel after a turning point, in crossings, from which on the link counts as carried: contact does not begin at once."""
COUNTS, NOISES = 2.5, 8.0
"""Travel back that makes a turning point, in counts and in standard deviations of the noise."""
SLOW_COUNTS = 4.0
"""Counts before a turning point within which the drive is too slow for the counts to average out."""
OTHER_WAY = 0.7
"""What the link as the driver must leave, against the other way round, to be taken for it."""


def carried(
    t: np.ndarray, x: np.ndarray, y: np.ndarray, *, ratio: float | None, angular: bool, torque: np.ndarray | None = None
) -> Reading:
    """Read the play of a link that is carried, or that carries its motor.

    Parameters
    ----------
    t : (N,) s
    x, y : (N,) the drive's position at the link, and the link's, in one unit
    ratio : the gear's, for the waves of the motor's turn
    angular : whether positions are in rad
    torque : (N,) that the joint carries, where it was measured

    Returns
    -------
    Reading
        Without a width where the record does not show it.
    """
    counts = tuple(count_of(values) or 0.0 for values in (x, y))
    least = max(COUNTS * max(counts), NOISES * max(rough_noise(x), rough_noise(y)), 1e-4 * float(np.ptp(x)))
    few_t, few_x, few_y = (thinned(values) for values in (t, x, y))
    told = waves(float(x.min()), float(x.max()), ratio=ratio, angular=angular)
    drift = drift_rows(few_t, passes(few_x, least).count)
    motionless = follows(x, y, counts, ratio)
    if motionless.holds is False:
        return Reading("carried", (motionless,), 0)
    found = crossing(few_t, few_x, few_y, least, drift, told)
    if found is None or not np.isfinite(found.left):
        return Reading("carried", (motionless, enough_passes(passes(x, least).count)), passes(x, least).count)
    back = crossing(few_t, few_y, few_x, least, drift, told)
    best = found.left
    notes: tuple[str, ...] = ()
    if found.width < 0.0 < found.slope and found.left < OTHER_WAY * found.plain:
        # z goes with the direction: either it was taken the other way round, or the link is what drives.
        other = crossing(few_t, few_x, 2.0 * few_x - few_y, least, drift, told)
        if other is not None and (back is None or other.left < back.left):
            found, y, back = other, 2.0 * x - y, None
            notes = ("z goes with the drive's direction where a link that is carried lags: z is taken for x - y",)
    if back is not None and back.width > 0.0 and back.left < (OTHER_WAY if found.width > 0.0 else 1.0) * best:
        return _read(t, y, x, back, least, counts, told, motionless, torque, ratio, notes, link_drives=True)
    return _read(t, x, y, found, least, counts, told, motionless, torque, ratio, notes, link_drives=False)


def _read(
    t: np.ndarray, driver: np.ndarray, follower: np.ndarray, found: Crossing, least: float, counts: tuple[float, ...], told,
    motionless: Condition, torque: np.ndarray | None, ratio: float | None,
    notes: tuple[str, ...], *, link_drives: bool,
) -> Reading:  # fmt: skip
    way = passes(driver, least)
    where = states(driver, way, BEYOND * found.travel)
    used = where.engaged & (where.side != 0.0) & ~_turning(way, max(counts))
    count = sum(bool(used[way.number == one].any()) for one in range(way.count)) if way.count < 5000 else way.count
    sides = {side: np.unique(way.number[used & (where.side == side)]).size for side in (-1.0, 1.0)}
    first = (motionless, both_edges(sides, found, least), enough_passes(count), gear(found.slope, ratio, link_drives))
    failed = next((one for one in first if one.holds is False), None)
    if failed is not None:
        return Reading("carried", first, count)
    parts = cells(way.number, driver, used)
    slow = drift_rows(t, count)
    z = follower - driver
    speed = np.gradient(driver, t)
    fits = levels(z, -where.side, driver, slow, parts, families(float(driver[used].min()), float(driver[used].max()), told),
                  speed=speed, step=float(t[1] - t[0]), others=_torque(torque, used))  # fmt: skip
    width, counted = fits.width, _counted(counts, fits, parts, _wide(driver, used, parts), 0.5 * count)
    stderr = float(np.hypot(fits.stderr, counted))
    grown = stderr / max(fits.stderr, 1e-300)
    low, high = (fits.width + grown * (end - fits.width) for end in fits.interval)
    around = over_angle(z, -where.side, driver, parts, fits)
    noise = float(np.sqrt(np.average(fits.fit.left**2, weights=parts.size)))
    conditions = (
        *first, at_edges(noise, width, _by_noise(z[used], counts, parts), float(np.std(parts.mean(z)))),
        no_lag(found, fits, float(t[1] - t[0])),
        clear_of_counts(width, low, high, max(counts), float(np.ptp(parts.mean(z)))),
        stays_put(driver, follower, way, min(width, found.travel)), at_one_edge(z, way, found, width),
    )  # fmt: skip
    extra = {name: (*fits.coefficient(name), fits.freedom) for name in fits.names if name == "torque"}
    return Reading(
        "carried", conditions, count, width, stderr, (low, high), fits.freedom, np.where(used, -where.side, 0.0),
        _drift(slow, fits), noise, around, errors_of(fits), *_bends(fits, parts, z, driver, where.side), fits, bool(notes),
        (*notes, *(("the link drives and the motor follows",) if link_drives else ())), extra,
    )  # fmt: skip


def _turning(way: Passes, count: float) -> np.ndarray:
    """Samples just before a turning point, (N,): within so few counts of it the encoder's steps do not average out."""
    stroke = way.strokes[way.number]
    return stroke - way.travel < np.minimum(SLOW_COUNTS * count, 0.2 * stroke)


def _by_noise(z: np.ndarray, counts: tuple[float, ...], parts: Cells) -> float:
    """By how much a cell's mean would scatter for noise and counts alone."""
    return float(np.hypot(rough_noise(z), max(counts) / np.sqrt(12.0)) / np.sqrt(np.median(parts.size)))


def _torque(torque: np.ndarray | None, used: np.ndarray) -> dict[str, np.ndarray] | None:
    if torque is None or np.ptp(torque[used]) == 0.0:
        return None
    return {"torque": torque}


def _bends(fits: Levels, parts, z, angle, side) -> tuple[float, tuple[float, float]]:
    """The curve from end to end without its straight line, peak to peak; and z's slope over the angle with its error."""
    slope = slope_of(z, angle, -side, parts)
    grid = np.linspace(fits.curve.low, fits.curve.high, 400)
    curve = fits.curve.rows(grid) @ fits.of_curve()
    curve = curve - np.polyval(np.polyfit(grid, curve, 1), grid)
    return float(np.ptp(curve)), slope


def _drift(slow: np.ndarray, fits: Levels) -> np.ndarray:
    """What the fit took for a drift, (N,)."""
    after = len(fits.names)
    return slow @ fits.fit.values[after : after + slow.shape[1]]


def _wide(driver: np.ndarray, used: np.ndarray, parts: Cells) -> float:
    """How wide a cell is, over the angle."""
    return float(np.ptp(driver[used])) / parts.parts


def _counted(counts: tuple[float, ...], fits: Levels, parts: Cells, wide: float, passes_each: float) -> float:
    """What counting may shift the width by and no repetition shows, where strokes repeat to the sample: the same parts of a count
    are then left over on every pass.

    Parameters
    ----------
    wide : of a cell, over the angle
    passes_each : how many passes go one way
    """
    variance = 0.0
    for count in counts:
        if count <= 0.0:
            continue
        crossed = wide / count
        # Several samples to a count average its sawtooth out, all but the count that a pass ends in; fewer are at random in it.
        each = count**2 / 12.0 / parts.size * np.minimum(1.0, crossed / parts.size)
        at_ends = 4.0 * count**2 / 12.0 * float(np.mean(fits.influence**2)) * (passes_each / crossed) ** 2
        variance += passes_each * float(np.sum(fits.influence**2 * each)) + at_ends
    return 2.0 * np.sqrt(variance)
