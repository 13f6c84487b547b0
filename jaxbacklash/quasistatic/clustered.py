"""Least squares whose rows come in groups that err together, and an interval from leaving each group out.

The rows of one pass of a slow motion share whatever the pass had: creep, friction, a part of the gear's error. What is
independent is the pass, so the interval is the jackknife's over passes, with the quantile of Student's t for as many as carry
the answer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

MOST_GROUPS = 120
"""Groups that are left out in turn; of more, neighbours are left out together, which only makes the interval more careful."""


@dataclass(frozen=True)
class Clustered:
    """Coefficients of a least squares by groups.

    Attributes
    ----------
    values : (K,) coefficients
    without : (G, K) coefficients with each group left out
    left : (R,) what each row leaves
    missed : weighted mean square of the rows when predicted without their own group
    groups : how many groups carry the first coefficient, by their shares of its information
    weighed, inverse : (R, K) rows times their weights, and (K, K) the inverse of the normal matrix
    """

    values: np.ndarray
    without: np.ndarray
    left: np.ndarray
    missed: float
    groups: float
    weighed: np.ndarray
    inverse: np.ndarray

    def influence(self, index: int = 0) -> np.ndarray:
        """What a change of each row's answer adds to one coefficient, (R,)."""
        return self.weighed @ self.inverse[index]

    def covariance(self) -> np.ndarray:
        """The jackknife's covariance of the coefficients, (K, K)."""
        count = self.without.shape[0]
        off = self.without - self.values
        return (count - 1.0) / count * off.T @ off

    def stderr(self, index: int = 0) -> float:
        """Standard error of one coefficient."""
        return float(np.sqrt(self.covariance()[index, index]))


def clustered(rows: np.ndarray, answer: np.ndarray, weights: np.ndarray, group: np.ndarray) -> Clustered:
    """Least squares of ``answer`` (R,) on ``rows`` (R, K) with ``weights`` (R,), the rows of a ``group`` (R,) erring together."""
    names, number = np.unique(group, return_inverse=True)
    if names.size > MOST_GROUPS:
        number = number * MOST_GROUPS // names.size
    count = int(number.max()) + 1
    scale = np.sqrt(np.maximum(np.einsum("rk,r->k", rows**2, weights), 1e-300))
    scaled = rows / scale
    normal = np.zeros((count, rows.shape[1], rows.shape[1]))
    right = np.zeros((count, rows.shape[1]))
    for one in range(count):
        own = number == one
        weighed = scaled[own] * weights[own, None]
        normal[one], right[one] = weighed.T @ scaled[own], weighed.T @ answer[own]
    whole, sought = normal.sum(axis=0), right.sum(axis=0)
    ridge = 1e-10 * np.eye(rows.shape[1])
    values = np.linalg.solve(whole + ridge, sought)
    without = np.linalg.solve(whole + ridge - normal, (sought - right)[..., None])[..., 0]
    missed = (answer - np.einsum("rk,rk->r", scaled, without[number])) ** 2
    inverse = np.linalg.inv(whole + ridge)
    toward = inverse[0]
    share = np.einsum("k,gkl,l->g", toward, normal, toward)
    return Clustered(
        values / scale, without / scale, answer - scaled @ values, float(np.average(missed, weights=weights)),
        float(share.sum() ** 2 / np.sum(share**2)) * names.size / count, scaled * weights[:, None],
        inverse / scale[:, None],
    )  # fmt: skip


def quantile(freedom: float) -> float:
    """The factor of a standard error in a 95 % interval, by Student's t."""
    from scipy.special import stdtrit  # heavy to load, and only slow records need it

    return float(stdtrit(max(1.0, freedom), 0.975))


@dataclass(frozen=True)
class Leaning:
    """The first coefficient, and another that is ``likely`` near zero, known by the rows and by that together; ``influence``
    (R,) of the rows on the first."""

    value: float
    stderr: float
    other: float
    other_stderr: float
    influence: np.ndarray


def leaning(plain: Clustered, full: Clustered, at: int, likely: float) -> Leaning:
    """Bring in what is known of a coefficient beforehand: that it is nothing, give or take ``likely``.

    Parameters
    ----------
    plain, full : fits without and with it
    at : where it stands in the full fit
    likely : its standard deviation beforehand
    """
    found, error = float(full.values[at]), full.stderr(at)
    if not np.isfinite(error):
        error = 1e12 * likely
    # The first coefficient goes with the other in a straight line.
    slope = (float(full.values[0]) - float(plain.values[0])) / found if found != 0.0 else 0.0
    trust = likely**2 / (likely**2 + error**2)
    spread = np.sqrt(trust) * error
    stderr = float(np.hypot(plain.stderr(), slope * spread))
    moved = plain.influence() + slope * trust * full.influence(at)
    return Leaning(float(plain.values[0]) + slope * trust * found, stderr, trust * found, float(spread), moved)
