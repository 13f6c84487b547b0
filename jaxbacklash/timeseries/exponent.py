"""The largest Lyapunov exponent with its interval: local maps for the number, stretching curves as the second witness."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from ..side_by_side import side_by_side
from .tangent import CHAIN, Growth, LocalMap, growth, scan

AS_GOOD = 1.5  # maps whose prediction error is within this factor of the best also count
MODELS = 4
SHORT_CHAIN = 2400  # points on which maps are compared with the best ones
LARGEST = 8
PREDICTS = 0.7  # prediction error above which the maps say nothing of the dynamics [standard deviations]
SYSTEMATIC = 0.05  # what no resampling sees, as a share of the exponent: coverage is measured by benchmarks.chaos_literature
STRETCHES = 24
NORMAL_95 = 1.96
WIDER = 1.2  # from which factor on it is said that, and why, an interval is wider than the scatter of the series makes it


@dataclass(frozen=True, eq=False)
class Exponent:
    """Largest exponent per sample: ``value``, 95 % ``interval``, ``stderr``; ``error`` the prediction error of the best map
    [standard deviations]; ``maps`` used, ``values`` of each, and all that were ``tried``. ``bend`` is by how much the best map's
    value changes with twice the neighbours, ``shift`` by how much it changed when noise was taken off a coarse series: parts of
    ``stderr`` that no resampling shows."""

    value: float
    stderr: float
    interval: tuple[float, float]
    error: float
    maps: tuple[LocalMap, ...]
    values: tuple[float, ...]
    tried: tuple[LocalMap, ...]
    bend: float = 0.0
    shift: float = 0.0

    @property
    def widened(self) -> bool:
        """Whether ``bend`` and ``shift`` make the interval wider by more than a fifth."""
        return self.stderr**2 > WIDER**2 * (self.stderr**2 - self.bend**2 - self.shift**2)

    @property
    def scatter(self) -> tuple[float, float]:
        """95 % interval by the scatter of the series alone, without ``bend`` and ``shift``: those say by how much the value may
        be off, not whether there is growth."""
        return _interval(self.value, float(np.sqrt(max(self.stderr**2 - self.bend**2 - self.shift**2, 0.0))))

    def with_shift(self, shift: float) -> Exponent:
        """The same with an interval that is wider by how far two estimates lie apart."""
        stderr = float(np.hypot(self.stderr, shift))
        return dataclasses.replace(self, stderr=stderr, interval=_interval(self.value, stderr), shift=abs(shift))

    @property
    def predicts(self) -> bool:
        """Whether the maps foretell enough of the series to speak of its dynamics."""
        return self.error <= PREDICTS


def largest_exponent(series: np.ndarray, delay: int, theiler: int, rng: np.random.Generator) -> Exponent | None:
    """The largest exponent from local maps; None for a series too short for any.

    The number of coordinates and of neighbours is the pair that predicts best out of sample. Other pairs that predict nearly as
    well (within a factor of 1.5, at most four in all) count too, weighted by the inverse square of their error: their scatter is
    the error of the choice. The error of a finite series comes from stretches of it. An affine map of a neighbourhood that is too
    wide misses how the motion bends in it, as in a short or coarsely sampled series: the change of the value with twice the
    neighbours, which about doubles that error on an attractor of dimension two, is added. So are 5 % for what nothing sees.

    Parameters
    ----------
    series : (N,) with standard deviation 1
    delay, theiler : samples
    rng : chooses points and first directions
    """
    tried = scan(series, delay, theiler, range(1, LARGEST + 1), rng)
    if not tried:
        return None
    best = tried[0]
    # One pair for each number of coordinates first: that choice matters more than the number of neighbours.
    near = [one for one in tried if one.error <= AS_GOOD * max(best.error, 1e-6)]
    firsts = [one for k, one in enumerate(near) if one.dimension not in {other.dimension for other in near[:k]}]
    used = (firsts + [one for one in near if one not in firsts])[:MODELS]
    if best.error > PREDICTS:
        used = used[:1]
    # The others are compared with the best over the same shorter stretches, in which their sampling errors cancel.
    wider = dataclasses.replace(best, neighbours=2 * best.neighbours)
    chains = [(best, CHAIN), *((one, SHORT_CHAIN) for one in (*used, wider))]

    def told(asked: tuple[tuple[LocalMap, int], np.random.Generator]) -> Growth:
        (chosen, chain), own = asked
        return growth(series, delay, theiler, chosen, own, chain)

    grown, *short = side_by_side(told, zip(chains, rng.spawn(len(chains))))
    values = grown.exponent + np.array([one.exponent - short[0].exponent for one in short[:-1]])
    weights = np.array([(best.error / max(one.error, 1e-12)) ** 2 for one in used])
    weights /= weights.sum()
    value = float(weights @ values)
    between = float(weights @ (values - value) ** 2)
    within = _sampling(grown) ** 2
    bend = abs(short[-1].exponent - short[0].exponent)
    stderr = float(np.sqrt(between + within + (SYSTEMATIC * value) ** 2 + bend**2))
    return Exponent(
        value, stderr, _interval(value, stderr), best.error, tuple(used), tuple(float(one) for one in values), tuple(tried), bend,
    )  # fmt: skip


def _interval(value: float, stderr: float) -> tuple[float, float]:
    return value - NORMAL_95 * stderr, value + NORMAL_95 * stderr


def _sampling(grown: Growth) -> float:
    """Standard error of the mean rate, from the scatter of stretches of the series."""
    rates = grown.rates.mean(axis=0) if grown.rates.shape[0] < 12 or grown.rates.shape[1] > 2000 else grown.rates.T.ravel()
    parts = np.array([part.mean() for part in np.array_split(rates, min(STRETCHES, rates.size))])
    return float(parts.std(ddof=1) / np.sqrt(parts.size)) if parts.size > 1 else 0.0
