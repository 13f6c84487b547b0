r"""The play from exponents measured at several drive levels, with an interval.

Every level is one place :math:`\log(X_i / b)` on the exponent map; another play moves all of them together. The likelihood of a
level at a place of the map is a mixture over the map's starts, since attractors coexist and nobody knows which one the rig was
on, and over places within the amplitude's own uncertainty, since the map is full of narrow windows. For one start it is

* verdict chaotic with exponent v: a normal density around the map's exponent where the map is chaotic, the verdict's
  false-alarm rate where it is regular;
* verdict regular: 1 less the false-alarm rate where the map is regular, the rate of missed chaos where it is chaotic;
* any other verdict: nothing.

With a prior that is flat in log b, and flat over the map's other axes, the posterior is their product.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter1d

from ..errors import BadInput
from ..frames import dataset
from ..showing import Shown
from .exponent_map import ExponentMap
from .levels import Level

FALSE_ALARM, MISSED = 0.02, 0.05
"""Rates of wrong verdicts that `jaxbacklash.timeseries` is held to; benchmarks.chaos_verdicts measures them."""
SYSTEMATIC = 0.05
"""Error of a measured exponent that its own interval does not hold, as a share of it."""
DRIVE_ERROR = 0.01
MASS = 0.95
FLAT = 0.75
"""An interval as wide as this share of the prior's range tells nothing."""
UNLIKELY = 0.02
"""A level disagrees with the map where it is so many times less likely than at the place that suits it best."""


@dataclass(frozen=True, eq=False)
class PlayFromChaos(Shown):
    """The play as exponents tell it. Prints itself. Plays are total plays in the unit of the amplitudes, rad.

    ``value`` posterior median and ``interval`` the 95 % interval with equal tails, both None with ``why`` where the levels do not
    determine a play; ``pieces`` the smallest set of plays that holds 95 %, often in several pieces; ``plays`` (B,), evenly spaced
    in the logarithm, and ``density`` (B,) the posterior for log b over them; ``each`` (L, B) likelihood of every level, its
    largest value 1; ``parameters`` posterior weights over the map's other axes; ``bits`` that were learned, the information
    from prior to posterior; ``disagree`` amplitudes of levels that the map cannot explain together with the others.
    """

    value: float | None
    interval: tuple[float, float] | None
    why: str | None
    pieces: list[tuple[float, float]]
    plays: np.ndarray
    density: np.ndarray
    each: np.ndarray
    parameters: dict[str, tuple[np.ndarray, np.ndarray]]
    bits: float
    disagree: list[float]
    levels: tuple[Level, ...]

    def __str__(self) -> str:
        counting = sum(level.counts for level in self.levels)
        lines = [f"from {counting} drive levels that count, of {len(self.levels)}: {self.bits:.1f} bit about the play"]
        if self.value is None or self.interval is None:
            lines.append(f"  backlash (total play)   not determined: {self.why}")
        else:
            low, high = self.interval
            lines.append(
                f"  backlash (total play)   {self.value:.5g} rad ({np.degrees(self.value):.4g} deg), 95 % interval {low:.5g} to "
                f"{high:.5g} (+- {50.0 * (high - low) / self.value:.2g} %)"
            )
        if len(self.pieces) > 1:
            told = ", ".join(f"{low:.4g} to {high:.4g}" for low, high in self.pieces)
            lines.append(f"  95 % of it lies in      {told} rad")
        if self.disagree:
            told = ", ".join(f"{np.degrees(a):.3g}" for a in self.disagree)
            lines.append(
                f"  disagreement            the level at {told} deg does not fit the map together with the others: damping, "
                "stiffness or gravity of the map may be off"
            )
        return "\n".join(lines)

    def to_dataset(self) -> Any:
        """What the levels say as an `xarray.Dataset` over the total ``play`` [rad].

        It holds the posterior ``density`` for its logarithm, and the likelihood ``each`` of every level, by ``amplitude`` [rad].
        """
        return dataset(
            {"density": ("play", self.density, "1"), "each": (("amplitude", "play"), self.each, "1")},
            {"play": (self.plays, "rad"), "amplitude": ([level.amplitude for level in self.levels], "rad")},
            bits=self.bits,
        )  # fmt: skip


def play_from_exponents(
    map_: ExponentMap, levels: Sequence[Level], *, plays: tuple[float, float] | None = None, drive_error: float = DRIVE_ERROR,
    false_alarm: float = FALSE_ALARM, missed: float = MISSED, systematic: float = SYSTEMATIC,
) -> PlayFromChaos:  # fmt: skip
    """Infer the total play.

    Parameters
    ----------
    map_ : of the joint whose play is asked for, at the drive's frequency
    levels : what was measured, see `Level`
    plays : lowest and highest play thought possible [rad]; default: as far as the map reaches
    drive_error : relative standard deviation of the amplitudes
    false_alarm, missed : how often regular motion is called chaotic, and chaos regular
    systematic : relative standard deviation of exponents beyond their own

    Returns
    -------
    `PlayFromChaos`: prints itself; ``value`` and ``interval`` of the play, or ``why`` there is none

    Raises
    ------
    BadInput
        No level counts, a rate is out of range, or the map does not reach as far as the levels and plays ask.

    Examples
    --------
    >>> joint = jb.two_link(3.16, np.radians(1.5), 15000.0, 9.0, -60.0, linearised=True)
    >>> curve = jb.signature.exponent_map(joint, 1.54, (0.6, 5.0, 60), starts=2, periods=60, skip=30)
    >>> levels = [jb.signature.Level(0.05, "chaotic", 1.2, 0.05), jb.signature.Level(0.03, "regular")]
    >>> found = jb.signature.play_from_exponents(curve, levels)
    >>> print(found)
    from 2 drive levels that count, of 2: ... bit about the play
    ...
    """
    levels = tuple(levels)
    if not any(level.counts for level in levels):
        raise BadInput("the levels: found no verdict that is chaotic or regular, wanted at least one")
    for name, rate in (("false_alarm", false_alarm), ("missed", missed)):
        if not 0.0 < rate < 0.5:
            raise BadInput(f"{name} {rate}: wanted a rate above 0 and below 0.5; no verdict is certain")
    low, high = _range(map_, levels, plays)
    count = int(np.ceil(np.log(high / low) / map_.step)) + 1
    grid = np.geomspace(low, high, count)
    per_level = [
        _along(map_, level, grid, _likelihood(map_, level, false_alarm, missed, systematic), drive_error) for level in levels
    ]
    total = np.sum([np.log(one) for one in per_level], axis=0)
    weight = np.exp(total - total.max())
    posterior = weight.sum(axis=tuple(range(weight.ndim - 1)))
    posterior /= posterior.sum()
    parameters = {}
    for k, (name, values) in enumerate(map_.axes.items()):
        along = weight.sum(axis=tuple(i for i in range(weight.ndim) if i != k))
        parameters[name] = (values, along / along.sum())
    # What each level says alone, averaged over the other parameters as they came out.
    share = weight.sum(axis=-1, keepdims=True)
    share /= share.sum()
    each = np.array([np.sum(one * share, axis=tuple(range(one.ndim - 1))) for one in per_level])
    best = np.unravel_index(int(np.argmax(total)), total.shape)
    disagree = [level.amplitude for level, one in zip(levels, per_level) if level.counts and one[best] < UNLIKELY * one.max()]
    value, interval, why = _summary(grid, posterior)
    bits = float(np.sum(posterior * np.log2(np.maximum(posterior, 1e-300) * count)))
    density = posterior / np.log(grid[1] / grid[0])
    return PlayFromChaos(
        value, interval, why, _smallest_set(grid, posterior), grid, density, each / each.max(axis=1, keepdims=True), parameters,
        bits, disagree, levels,
    )  # fmt: skip


def _range(map_: ExponentMap, levels: tuple[Level, ...], plays: tuple[float, float] | None) -> tuple[float, float]:
    amplitudes = [level.amplitude for level in levels]
    least, most = max(amplitudes) / map_.ratios[-1], min(amplitudes) / map_.ratios[0]
    low, high = (least, most) if plays is None else (float(plays[0]), float(plays[1]))
    if not 0.0 < low < high:
        raise BadInput(
            f"plays from {low:.4g} to {high:.4g} rad: wanted a range above zero; the map holds all levels for plays of "
            f"{least:.4g} to {most:.4g} rad"
        )
    if low < least * (1.0 - 1e-9) or high > most * (1.0 + 1e-9):
        raise BadInput(
            f"plays from {low:.4g} to {high:.4g} rad: the map holds all levels only for {least:.4g} to {most:.4g} rad; wanted a "
            f"map of ratios {min(amplitudes) / high:.3g} to {max(amplitudes) / low:.3g}"
        )
    return low, high


def _likelihood(map_: ExponentMap, level: Level, false_alarm: float, missed: float, systematic: float) -> np.ndarray:
    """(..., R) likelihood of one level at every place of the map, averaged over the starts."""
    chaotic = map_.chaotic
    if not level.counts:
        return np.ones(chaotic.shape[1:])
    if level.word == "regular":
        one = np.where(chaotic, missed, 1.0 - false_alarm)
    elif level.exponent is None or level.stderr is None:
        one = np.where(chaotic, 1.0 - missed, false_alarm)
    else:
        value = np.where(chaotic, map_.exponent, 1.0)
        spread = np.sqrt(level.stderr**2 + np.where(chaotic, map_.stderr, 0.0) ** 2 + (systematic * value) ** 2)
        density = np.exp(-0.5 * ((level.exponent - value) / spread) ** 2) / (np.sqrt(2.0 * np.pi) * spread)
        # A false alarm may give any exponent that the joint can have.
        most = max(float(np.max(map_.exponent, where=chaotic, initial=0.0)), level.exponent)
        one = np.where(chaotic, (1.0 - missed) * density, false_alarm / most)
        # A verdict with a number that suits no start is a wrong verdict or a wrong number; neither is impossible.
        one = np.maximum(one, false_alarm / most)
    return _mean_known(one, np.isfinite(map_.exponent))


def _mean_known(one: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Mean over the starts that could be followed; where none could, the mean of the whole map."""
    count = known.sum(axis=0)
    mean = np.sum(one, axis=0, where=known) / np.maximum(count, 1)
    return np.where(count > 0, mean, float(np.mean(one, where=known)))


def _along(map_: ExponentMap, level: Level, grid: np.ndarray, likelihood: np.ndarray, drive_error: float) -> np.ndarray:
    """(..., B) likelihood over the plays, blurred by what is not known of the amplitude."""
    blurred = likelihood
    if drive_error > 0.0:
        blurred = gaussian_filter1d(likelihood, drive_error / map_.step, axis=-1, mode="nearest")
    place = np.clip(map_.place(level.amplitude, grid), 0.0, map_.ratios.size - 1.0)
    lower = np.minimum(place.astype(int), map_.ratios.size - 2)
    part = place - lower
    return np.asarray((1.0 - part) * blurred[..., lower] + part * blurred[..., lower + 1])


def _summary(grid: np.ndarray, posterior: np.ndarray) -> tuple[float | None, tuple[float, float] | None, str | None]:
    """Median and interval, or why there are none."""
    step = np.log(grid[1] / grid[0])
    edges = np.concatenate([[0.0], np.cumsum(posterior)])
    at = np.log(grid[0]) + step * (np.arange(edges.size) - 0.5)
    low, middle, high = (float(np.exp(np.interp(q, edges, at))) for q in (0.5 - MASS / 2, 0.5, 0.5 + MASS / 2))
    reach = np.log(grid[-1] / grid[0])
    if np.log(high / low) > FLAT * reach:
        return (
            None,
            None,
            (f"95 % of the probability spreads over {low:.3g} to {high:.3g} rad, nearly all that was thought possible"),
        )
    return middle, (low, high), None


def _smallest_set(grid: np.ndarray, posterior: np.ndarray) -> list[tuple[float, float]]:
    """The most probable plays that together hold 95 %, as intervals."""
    falling = np.sort(posterior)[::-1]
    least = falling[min(int(np.searchsorted(np.cumsum(falling), MASS)), grid.size - 1)]
    # Plays as good as the last one belong to it too, or rounding would cut a plateau to pieces.
    inside = posterior >= 0.999 * least
    turns = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(int)))
    half = 0.5 * np.log(grid[1] / grid[0])
    return [(float(grid[a] * np.exp(-half)), float(grid[b - 1] * np.exp(half))) for a, b in zip(turns[::2], turns[1::2])]
