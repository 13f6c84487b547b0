r"""A slow loop of torque over angle: play, the stiffness of either side, and friction as half the loop's width.

Beyond the play, on side :math:`\sigma` and in direction s, z = z_0 + \sigma b/2 + (T - s T_f)/k_\sigma. That is a straight
line in T for each branch of the loop, so all of it is one least squares; the play is what lies between the two lines where the
torque, less the friction, is nothing.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..signals.resolution import count_of
from .angle import drift_rows
from .cells import Cells, cells
from .clustered import Clustered, Leaning, clustered, leaning, quantile
from .play import passes
from .reading import Condition, Reading, rough_noise
from .shows import clear_of_counts, enough_passes

LIGHT = (0.12, 0.25)
"""Torque, as a share of the largest on its side, from which on contact is taken for a straight line; the second is a check of
that."""
THIRD = 0.2
"""How large the third order of a branch may be against its first, at full load, as one standard deviation."""
TURNED = 0.15
"""Share of a pass's stroke after a turning point that friction needs to turn round, to begin with."""


def loop(t: np.ndarray, torque: np.ndarray, z: np.ndarray) -> Reading:
    """Read a loop of torque (N,) over angle (N,), at times t (N,) [s]."""
    least = max(8.0 * rough_noise(torque), 3.0 * (count_of(torque) or 0.0), 0.05 * float(np.ptp(torque)))
    way = passes(torque, least)
    largest = {side: float(np.max(side * torque, initial=0.0)) for side in (-1.0, 1.0)}
    both = _both(largest, float(np.ptp(torque)))
    first = (both, enough_passes(way.count, "passes", along="torque"))
    failed = next((one for one in first if one.holds is False), None)
    if failed is not None:
        return Reading("loop", first, way.count)
    found = [_fit(t, torque, z, way, light, largest) for light in LIGHT]
    if found[0] is None:
        why = "edges not reached: too few samples lie beyond the play under load"
        return Reading(
            "loop", (both, Condition("both edges reached", False, both.found, why, "load it more, on both sides")), way.count
        )
    fit, play, used, side, slow, parts = found[0]
    width, freedom = 2.0 * play.value, max(1.0, fit.groups - 4.0)
    # What the lightest loads change, beyond what chance would, is what the shape of the branches leaves open.
    other, chance = (2.0 * found[1][1].value, 2.0 * found[1][1].stderr) if found[1] is not None else (width, 0.0)
    open_ = max((width - other) ** 2 - chance**2, 0.0)
    counted = np.sqrt(2.0 / 12.0) * (count_of(z) or 0.0) / np.sqrt(max(1.0, np.median(parts.size)))
    stderr = float(np.sqrt((2.0 * play.stderr) ** 2 + 0.25 * open_ + counted**2))
    reach = quantile(freedom) * stderr
    noise = float(np.sqrt(np.average(fit.left**2, weights=parts.size)))
    conditions = (*first, clear_of_counts(width, width - reach, width + reach, count_of(z) or 0.0), _straight(noise, z))
    start = 5
    drift = slow @ fit.values[start : start + slow.shape[1]]
    return Reading(
        "loop", conditions, way.count, width, stderr, (width - reach, width + reach), freedom, np.where(used, side, 0.0), drift,
        noise, extra=_of_branches(fit, freedom),
    )  # fmt: skip


def _fit(
    t: np.ndarray, torque: np.ndarray, z: np.ndarray, way, light: float, largest: dict[float, float]
) -> tuple[Clustered, Leaning, np.ndarray, np.ndarray, np.ndarray, Cells] | None:
    """One least squares of all branches beyond ``light`` shares of the largest torque."""
    side = np.sign(torque)
    going = way.signs[way.number]
    slow = drift_rows(t, way.count)
    friction = 0.0
    for _ in range(3):
        turned = way.travel >= np.maximum(TURNED * way.strokes[way.number], 2.5 * friction)
        # A torque that the friction alone may hold says nothing of contact.
        enough = np.abs(torque) >= np.maximum(light * np.where(side > 0, largest[1.0], largest[-1.0]), 1.5 * friction)
        used = turned & enough
        if any(np.unique(way.number[used & (side == one)]).size < 2 for one in (-1.0, 1.0)):
            return None
        parts = replace(cells(way.number, torque, used))
        columns = [side, *(np.where(side == one, torque, 0.0) for one in (1.0, -1.0)),
                   *(np.where(side == one, -going, 0.0) for one in (1.0, -1.0))]  # fmt: skip
        rows = np.concatenate([np.stack(columns, axis=1), slow, np.ones_like(z)[:, None]], axis=1)
        fit, play = _bent(rows, torque, side, z, parts)
        compliance = np.abs(fit.values[1:3])
        friction = float(np.max(np.abs(fit.values[3:5]) / np.maximum(compliance, 1e-300)))
        friction = min(friction, 0.2 * min(largest.values()))
    return fit, play, used, side, slow, parts


def _bent(rows: np.ndarray, torque: np.ndarray, side: np.ndarray, z: np.ndarray, parts: Cells) -> tuple[Clustered, Leaning]:
    """Branches that may bend, each its own way: contact hardens as it is pressed, and a straight line would call that play.

    The third order is the same for both sides, and small against the first: most records cannot tell it.
    """
    size = np.abs(torque) / np.max(np.abs(torque))
    curves = [np.where(side == one, torque * size, 0.0) for one in (1.0, -1.0)]
    averaged = parts.mean(np.concatenate([rows, np.stack([*curves, torque * size**2], axis=1)], axis=1))
    answer = parts.mean(z)
    plain = clustered(averaged[:, :-1], answer, parts.weights, parts.group)
    bent = clustered(averaged, answer, parts.weights, parts.group)
    soft = 0.5 * float(np.sum(np.abs(plain.values[1:3])))
    return plain, leaning(plain, bent, averaged.shape[1] - 1, THIRD * soft)


def _of_branches(fit: Clustered, freedom: float) -> dict[str, tuple[float, float, float]]:
    """Stiffness of either side and friction, each with standard error and freedom."""
    covariance = fit.covariance()
    found: dict[str, tuple[float, float, float]] = {}
    for name, at in (("stiffness_up", 1), ("stiffness_down", 2)):
        soft, error = float(fit.values[at]), float(np.sqrt(covariance[at, at]))
        if soft > 3.0 * error:
            found[name] = (1.0 / soft, error / soft**2, freedom)
    pairs = [
        (float(fit.values[3 + i]), float(fit.values[1 + i]), covariance[np.ix_([3 + i, 1 + i], [3 + i, 1 + i])]) for i in (0, 1)
    ]
    each = []
    for loss, soft, both in pairs:
        if soft > 0.0:
            toward = np.array([1.0 / soft, -loss / soft**2])
            each.append((loss / soft, float(toward @ both @ toward)))
    if len(each) == 2:
        found["friction"] = (float(np.mean([one for one, _ in each])), 0.5 * float(np.sqrt(sum(two for _, two in each))), freedom)
    return found


def _both(largest: dict[float, float], range_: float) -> Condition:
    said = f"torque from {-largest[-1.0]:.4g} to {largest[1.0]:.4g}"
    if min(largest.values()) > 0.15 * range_:
        return Condition("both edges reached", True, said)
    why = "edges not reached: the torque has hardly more than one sign, so one side of the play is not loaded"
    return Condition("both edges reached", False, said, why, "load it both ways")


def _straight(noise: float, z: np.ndarray) -> Condition:
    share = noise / max(float(np.ptp(z)), 1e-300)
    said = f"the branches leave {noise:.3g}, {share:.2g} of z's range"
    if share < 0.1:
        return Condition("z goes with torque and direction", True, said)
    why = "z is no function of torque and direction: something else moves it, such as inertia or a slipping mount"
    return Condition("z goes with torque and direction", False, said, why, "load it more slowly, against a fixed mount")
