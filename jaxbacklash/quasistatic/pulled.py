"""A link pulled to and fro by a force of which only the sign is known: the play from where z comes to rest on either side."""

from __future__ import annotations

import numpy as np

from ..signals.resolution import count_of
from .angle import Curve, drift_rows, families, waves
from .cells import cells
from .levels import levels
from .over_angle import errors_of, over_angle
from .reading import Condition, Reading, rough_noise
from .shows import at_edges, clear_of_counts, enough_passes

REST = 0.5
"""Share of a pull after which the link counts as at rest."""
SHORTEST = 4
"""Samples of a pull at least."""
SETTLED = 0.12
"""Share of the lost motion by which z may still move between the third and the last quarter of a pull."""


def pulled(
    t: np.ndarray, z: np.ndarray, sign: np.ndarray, *, x: np.ndarray | None, ratio: float | None, angular: bool
) -> Reading:
    """Read the play of a link that is pulled both ways.

    Parameters
    ----------
    t : (N,) s
    z : (N,) of the link against what holds it
    sign : (N,) of the force: -1, 0 or +1
    x : (N,) position of the drive at the link, None where it was not measured
    ratio : the gear's, for the waves of the motor's turn
    angular : whether positions are in rad
    """
    starts = np.flatnonzero(np.append(True, np.diff(sign) != 0.0))
    ends = np.append(starts[1:], sign.size)
    long = (ends - starts >= SHORTEST) & (sign[starts] != 0.0)
    number = np.searchsorted(starts, np.arange(sign.size), side="right") - 1
    share = (np.arange(sign.size) - starts[number]) / (ends - starts)[number]
    used = long[number] & (share >= REST)
    count = int(long.sum())
    both = _both(sign[starts[long]])
    first = (both, enough_passes(count, "pulls"))
    failed = next((one for one in first if one.holds is False), None)
    if failed is not None:
        return Reading("pulled", first, count)
    moves = x is not None and np.ptp(x) > max(3.0 * (count_of(x) or 0.0), 10.0 * rough_noise(x))
    angle = x if x is not None and moves else np.zeros_like(z)
    low, high = float(angle[used].min()), float(angle[used].max())
    told = waves(low, high, ratio=ratio, angular=angular) if moves else ()
    choice = families(low, high, told) if moves else [Curve(low, high, 0, ())]
    slow = drift_rows(t, count)
    parts = cells(number, share, used)
    fits = levels(z, sign, angle, slow, parts, choice, speed=None, step=float(t[1] - t[0]))
    noise = float(np.sqrt(np.average(fits.fit.left**2, weights=parts.size)))
    counts = [count_of(z) or 0.0, *([count_of(x) or 0.0] if x is not None else [])]
    drift = slow @ fits.fit.values[1 : 1 + slow.shape[1]]
    moved = _still_moving(z - drift - fits.curve.at(angle, fits.of_curve()), sign, number, share, long)
    # What it has moved by of late it may move by again.
    late = 2.0 * float(np.mean(moved)) if moved.size else 0.0
    counted = _counted(max(counts), max(noise, rough_noise(z[used])))
    stderr = float(np.sqrt(fits.stderr**2 + counted**2 + late**2))
    grown = stderr / max(fits.stderr, 1e-300)
    reach = grown * 0.5 * (fits.interval[1] - fits.interval[0])
    width = abs(fits.width)
    notes = ("z goes against the force: one of the two has the other sign",) if fits.width + reach < 0.0 else ()
    conditions = (
        *first, _at_rest(moved, width),
        clear_of_counts(width, width - reach, width + reach, max(counts)),
        at_edges(noise, width, rough_noise(z[used]) / float(np.sqrt(np.median(parts.size))), float(np.std(z[used]))),
    )  # fmt: skip
    return Reading(
        "pulled", conditions, count, width, stderr, (width - reach, width + reach), fits.freedom,
        np.where(used, np.sign(fits.width) * sign, 0.0), drift, noise,
        over_angle(z, sign * np.sign(fits.width), angle, parts, fits) if moves else None, errors_of(fits), levels=fits,
        notes=notes,
    )  # fmt: skip


def _both(signs: np.ndarray) -> Condition:
    said = f"{int(np.sum(signs > 0))} pulls one way, {int(np.sum(signs < 0))} the other"
    if np.any(signs > 0) and np.any(signs < 0):
        return Condition("both edges reached", True, said)
    why = "edges not reached: the force pulls one way only"
    return Condition("both edges reached", False, said, why, "pull the link both ways")


def _still_moving(z: np.ndarray, sign: np.ndarray, number: np.ndarray, share: np.ndarray, long: np.ndarray) -> np.ndarray:
    """How far each pull moves the link from its third quarter to its last, the way it pulls, (P,); empty where pulls are too
    short."""
    means = []
    for begin in (0.5, 0.75):
        inside = long[number] & (share >= begin) & (share < begin + 0.25)
        samples = np.bincount(number[inside], minlength=long.size)
        sums = np.bincount(number[inside], z[inside], minlength=long.size)
        means.append(np.where(samples > 0, sums / np.maximum(samples, 1), np.nan)[long])
    starts = np.searchsorted(number, np.flatnonzero(long))
    moved = sign[starts] * (means[1] - means[0])
    return moved[np.isfinite(moved)]


def _at_rest(moved: np.ndarray, width: float) -> Condition:
    """Whether the link has come to rest before the force turns round."""
    if moved.size == 0:
        return Condition("at rest before it is turned", None, "the pulls are too short to say")
    mean = abs(float(np.mean(moved)))
    error = float(np.std(moved) / np.sqrt(moved.size))  # what was hardly noticed does not count as motion
    said = f"in the last half of a pull z still moves by {mean / max(width, 1e-300):.2g} of the lost motion"
    if mean <= SETTLED * width or mean < 2.0 * error:
        return Condition("at rest before it is turned", True, said)
    why = "edges not reached: the link is still on its way, or rings, when the force turns round"
    return Condition("at rest before it is turned", False, said, why, "pull longer each way")


def _counted(count: float, noise: float) -> float:
    """What counting shifts the width by where z rests within one count: noise of some size takes it away."""
    if count <= 0.0:
        return 0.0
    return float(
        np.sqrt(2.0) * count * min(1.0 / np.sqrt(12.0), np.exp(-2.0 * (np.pi * noise / count) ** 2) / (np.pi * np.sqrt(2.0)))
    )
