r"""Where a quantity that was estimated in one record after another changes, if it does.

For every place at which the series may be split, the two sides' weighted means are compared; the largest ratio of their
difference to its standard error is the statistic. What chance makes of it is found by putting the pairs of value and error in
random order: with nothing changed any order is as likely as another, whatever the distribution, the errors, or the scatter
between records, so that the test claims a change with the probability that it says and no more. The scatter in excess of the
errors (`jaxbacklash.many.scatter`) only sets the weights, and afterwards the interval of the change.

Records in which the quantity wanders slowly (with the day's temperature, say) are not in random order though nothing broke;
such a wandering is a change too, and is told as one.

Source: Pettitt, Applied Statistics 28 (1979) 126, on tests for a change at an unknown place; Hinkley, Biometrika 57 (1970) 1, on
where it is; Phipson and Smyth, Statistical Applications in Genetics and Molecular Biology 9 (2010) 39, on the p-value of random
orders.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri, stdtrit

from .scatter import excess_scatter

ORDERS = 1999
"""Random orders: the smallest p-value that can come out is one in two thousand."""
CLAIMED = 0.01
"""The p-value from which on a change is claimed."""
FEWEST = 8
"""Records that are looked at for a change at least."""
SIDE = 3
"""Records on either side of it at least."""
ROOM = 4_000_000
"""Numbers that are shuffled at a time."""


@dataclass(frozen=True)
class Change:
    """A change from one record on.

    Attributes: ``at``, index of the first record after it, and ``between``, the first and last index that it may be with 95 %
    confidence; ``before`` and ``after``, the means, and their standard errors ``before_stderr`` and ``after_stderr``;
    ``growth`` in shares of the value before, with the 95 % half width ``growth_half``; ``p_value``.
    """

    at: int
    between: tuple[int, int]
    before: float
    after: float
    before_stderr: float
    after_stderr: float
    growth: float
    growth_half: float
    p_value: float

    @property
    def claimed(self) -> bool:
        """Whether chance makes as much of nothing less than once in a hundred times."""
        return self.p_value <= CLAIMED


def find_change(values: np.ndarray, variances: np.ndarray, seed: int = 0) -> Change | None:
    """The likeliest change of a series, with the probability that chance makes as much; None of fewer records than eight.

    Parameters
    ----------
    values, variances : (N,) estimates in the order of the records, and the squares of their standard errors
    seed : of the random orders

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> values = np.where(np.arange(40) < 20, 1.0, 1.1) + 0.02 * rng.normal(size=40)
    >>> found = find_change(values, np.full(40, 0.02**2))
    >>> found.at, found.claimed, round(found.growth, 1)
    (20, True, 0.1)
    """
    count = values.size
    if count < FEWEST:
        return None
    weights = 1.0 / (variances + excess_scatter(values, variances))
    seen = _statistic(values[None], weights[None])[0]
    rng, beyond = np.random.default_rng(seed), 0
    rows = max(1, ROOM // count)
    for first in range(0, ORDERS, rows):
        order = rng.permuted(np.tile(np.arange(count), (min(rows, ORDERS - first), 1)), axis=1)
        beyond += int(np.sum(np.max(_statistic(values[order], weights[order]), axis=1) >= np.max(seen) * (1.0 - 1e-12)))
    at = SIDE + int(np.argmax(seen))
    return _told(values, variances, at, (1 + beyond) / (1 + ORDERS))


def _statistic(values: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Squared difference of the two sides' means over its variance, (K, N - 2 `SIDE` + 1) for K orders (K, N)."""
    inside = slice(SIDE - 1, values.shape[1] - SIDE)
    weight = np.cumsum(weights, axis=1)
    moment = np.cumsum(weights * values, axis=1)
    left, total = weight[:, inside], weight[:, -1:]
    apart = moment[:, inside] / left - (moment[:, -1:] - moment[:, inside]) / (total - left)
    return apart**2 * left * (total - left) / total


def _told(values: np.ndarray, variances: np.ndarray, at: int, p_value: float) -> Change:
    """The change at a place, with the scatter that is left on both sides of it."""
    count = values.size
    after = (np.arange(count) >= at).astype(float)
    square = excess_scatter(values, variances, np.stack([1.0 - after, after], axis=1))
    weights = 1.0 / (variances + square)
    # Where errors say more than the scatter allows, the scatter tells.
    means, errors = zip(*(_mean(values[side], weights[side]) for side in (slice(0, at), slice(at, count))))
    growth = means[1] / means[0] - 1.0 if means[0] else np.nan
    spread = np.hypot(errors[1], errors[0] * means[1] / means[0]) / abs(means[0]) if means[0] else np.nan
    fall = _statistic(values[None], weights[None])[0]
    likely = SIDE + np.flatnonzero(np.max(fall) - fall <= float(chdtri(1.0, 0.05)))
    half = float(stdtrit(count - 2, 0.975)) * spread
    return Change(
        at, (int(likely[0]), int(likely[-1])), means[0], means[1], errors[0], errors[1], float(growth), float(half), p_value
    )


def _mean(values: np.ndarray, weights: np.ndarray) -> tuple[float, float]:
    return float(np.sum(weights * values) / np.sum(weights)), float(1.0 / np.sqrt(np.sum(weights)))
