"""Is it worth measuring? What exponents at given drive levels would tell of the play, before anything is measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import BadInput
from ..frames import dataframe
from ..showing import Shown
from .exponent_map import ExponentMap
from .infer import DRIVE_ERROR, FALSE_ALARM, MISSED, SYSTEMATIC, play_from_exponents
from .levels import Level


@dataclass(frozen=True, eq=False)
class ExpectedPrecision(Shown):
    """What would come out, over many imagined experiments.

    ``play`` (T,) true plays [rad]; ``low``, ``high`` (T,) ends of the 95 % interval, NaN where no play was determined; ``value``
    (T,) its median; ``pieces`` (T,) number of pieces of the smallest set; ``bits`` (T,) learned.
    """

    play: np.ndarray
    value: np.ndarray
    low: np.ndarray
    high: np.ndarray
    pieces: np.ndarray
    bits: np.ndarray

    @property
    def determined(self) -> np.ndarray:
        """(T,) whether a play came out at all."""
        return np.isfinite(self.value)

    @property
    def covered(self) -> np.ndarray:
        """(T,) whether the interval held the truth; no interval holds everything."""
        return ~self.determined | ((self.low <= self.play) & (self.play <= self.high))

    @property
    def half_width(self) -> np.ndarray:
        """(T,) half the interval's width over the true play; NaN where no play was determined."""
        return np.asarray(0.5 * (self.high - self.low) / self.play)

    def __str__(self) -> str:
        some = self.determined
        width = np.quantile(self.half_width[some], [0.1, 0.5, 0.9]) if some.any() else np.full(3, np.nan)
        return (
            f"{self.play.size} imagined experiments: a play comes out of {100.0 * some.mean():.0f} %, "
            + (f"+- {100 * width[1]:.2g} % (80 % of them {100 * width[0]:.2g} to {100 * width[2]:.2g} %), " if some.any() else "")
            + f"intervals hold the truth in {100.0 * self.covered.mean():.1f} %, {self.bits.mean():.1f} bit each"
        )

    def to_dataframe(self) -> Any:
        """The imagined experiments as a `pandas.DataFrame`, a row each.

        Columns: the true ``play``, the ``value`` that came out, ``low`` and ``high`` of its interval [rad], its ``pieces``, and
        the ``bits`` that were learned.
        """
        return dataframe({name: getattr(self, name) for name in ("play", "value", "low", "high", "pieces", "bits")})


def expected_precision(
    map_: ExponentMap, amplitudes: Sequence[float], plays: tuple[float, float], *, experiments: int = 200, stderr: float = 0.1,
    truth: ExponentMap | None = None, drive_error: float = DRIVE_ERROR, false_alarm: float = FALSE_ALARM, missed: float = MISSED,
    systematic: float = SYSTEMATIC, seed: int = 0,
) -> ExpectedPrecision:  # fmt: skip
    """Imagine experiments on joints whose play is drawn from a range, and infer each play back.

    Parameters
    ----------
    map_ : with which the play is inferred
    amplitudes : of the base at the drive levels [rad]
    plays : range of the true play, and of what is thought possible [rad]
    experiments : how many
    stderr : standard error of a measured exponent, as a share of it
    truth : a map of the joint as it truly is, without further axes; default: ``map_`` itself
    drive_error, false_alarm, missed, systematic : as in `play_from_exponents`; the imagined measurements have them
    seed : of everything drawn

    Returns
    -------
    `ExpectedPrecision`: prints itself

    Examples
    --------
    >>> joint = jb.two_link(3.16, np.radians(1.5), 15000.0, 9.0, -60.0, linearised=True)
    >>> curve = jb.signature.exponent_map(joint, 1.54, (0.6, 5.0, 60), starts=2, periods=60, skip=30)
    >>> print(jb.signature.expected_precision(curve, [0.03, 0.05], (0.02, 0.03), experiments=5))
    5 imagined experiments: ...
    """
    truth = map_ if truth is None else truth
    if truth.axes:
        raise BadInput("truth: wanted a map of one joint, without further axes")
    rng = np.random.default_rng(seed)
    true = np.exp(rng.uniform(np.log(plays[0]), np.log(plays[1]), experiments))
    rows = []
    for play in true:
        levels = imagine(truth, amplitudes, play, rng, stderr, drive_error, false_alarm, missed, systematic)
        options: Any = {"drive_error": drive_error, "false_alarm": false_alarm, "missed": missed, "systematic": systematic}
        found = play_from_exponents(map_, levels, plays=plays, **options)
        low, high = found.interval or (np.nan, np.nan)
        rows.append((np.nan if found.value is None else found.value, low, high, len(found.pieces), found.bits))
    return ExpectedPrecision(true, *np.array(rows).T)


def imagine(
    map_: ExponentMap, amplitudes: Sequence[float], play: float, rng: np.random.Generator, stderr: float = 0.1,
    drive_error: float = DRIVE_ERROR, false_alarm: float = FALSE_ALARM, missed: float = MISSED, systematic: float = SYSTEMATIC,
) -> list[Level]:  # fmt: skip
    """One imagined experiment on a joint of the given play: at each level a start, a motion, a verdict, an exponent.

    Returns
    -------
    a `Level` for each amplitude

    Examples
    --------
    >>> joint = jb.two_link(3.16, np.radians(1.5), 15000.0, 9.0, -60.0, linearised=True)
    >>> curve = jb.signature.exponent_map(joint, 1.54, (0.6, 5.0, 60), starts=2, periods=60, skip=30)
    >>> [level.amplitude for level in jb.signature.imagine(curve, [0.03, 0.05], 0.026, np.random.default_rng(0))]
    [0.03, 0.05]
    """
    starts, chaotic = map_.exponent.shape[0], map_.chaotic
    most = float(np.max(map_.exponent, where=chaotic, initial=0.0))
    levels = []
    for amplitude in amplitudes:
        real = amplitude * np.exp(drive_error * rng.standard_normal())
        at = int(np.clip(np.rint(map_.place(real, play)), 0, map_.ratios.size - 1))
        start = int(rng.integers(starts))
        wrong = rng.uniform() < (missed if chaotic[start, at] else false_alarm)
        if bool(chaotic[start, at]) == wrong:
            levels.append(Level(amplitude, "regular"))
            continue
        value = rng.uniform(0.0, most) if wrong else float(map_.exponent[start, at])
        size = stderr * value
        measured = value + np.hypot(size, 0.0 if wrong else systematic * value) * rng.standard_normal()
        levels.append(Level(amplitude, "chaotic", max(measured, 1e-6), max(size, 1e-6)))
    return levels
