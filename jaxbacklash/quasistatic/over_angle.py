"""Both levels over the angle: how the play varies on the way round, and what the gear's error beside it is."""

from __future__ import annotations

import numpy as np

from .cells import Cells
from .clustered import clustered
from .levels import Levels
from .reading import Error, OverAngle

FINE = 400
"""Steps at which the middle of the levels is told."""
BINS = 24
"""Parts of the angle that are shown."""


def over_angle(z: np.ndarray, side: np.ndarray, angle: np.ndarray, parts: Cells, fits: Levels) -> OverAngle:
    """The middle and the distance of both levels in parts of the angle, of samples that count.

    The middle is the fitted curve; the distance adds what each part leaves on either side, so that a play which varies shows.
    """
    where, on, left = parts.mean(angle), np.sign(parts.mean(side)), fits.fit.left
    edges = np.linspace(where.min(), where.max(), BINS + 1)
    number = np.clip(np.searchsorted(edges, where, side="right") - 1, 0, BINS - 1)
    rows = []
    for one in range(BINS):
        both = [left[(number == one) & (on == sign)] for sign in (-1.0, 1.0)]
        groups = [np.unique(parts.group[(number == one) & (on == sign)]).size for sign in (-1.0, 1.0)]
        if min(groups) < 2:
            continue
        error = float(np.sqrt(sum(np.var(rest) / count for rest, count in zip(both, groups, strict=True))))
        rows.append((0.5 * (edges[one] + edges[one + 1]), fits.width + float(both[1].mean() - both[0].mean()), error))
    at, width, stderr = np.array(rows).T if rows else np.zeros((3, 0))
    fine = np.linspace(fits.curve.low, fits.curve.high, FINE)
    return OverAngle(at, width, stderr, fine, fits.curve.rows(fine) @ fits.of_curve())


def errors_of(fits: Levels) -> tuple[Error, ...]:
    """The amplitudes of the waves of motor and link."""
    found = []
    covariance = fits.fit.covariance()
    start = fits.fit.values.size - fits.of_curve().size
    for index, wave in enumerate(fits.curve.waves):
        own = fits.curve.wave_at(index)
        at = slice(start + own.start, start + own.stop)
        pair = fits.fit.values[at]
        amplitude = float(np.hypot(*pair))
        along = pair / max(amplitude, 1e-300)
        found.append(Error(wave.name, wave.order, amplitude, float(np.sqrt(along @ covariance[at, at] @ along))))
    return tuple(found)


def slope_of(z: np.ndarray, angle: np.ndarray, side: np.ndarray, parts: Cells) -> tuple[float, float]:
    """z over the angle as a straight line beside two levels: the slope and its standard error."""
    where = parts.mean(angle)
    rows = np.stack([where - where.mean(), np.ones_like(where), parts.mean(side)], axis=1)
    fit = clustered(rows, parts.mean(z), parts.weights, parts.group)
    return float(fit.values[0]), fit.stderr()
