"""Which joints show a given pattern of regimes over the drive levels: regular, chaotic, chaotic, regular?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import BadInput
from ..frames import dataset
from ..showing import Shown
from .exponent_map import ExponentMap


@dataclass(frozen=True, eq=False)
class PatternMatch(Shown):
    """How a map matches a pattern, over its parameters and over plays.

    ``chance`` (..., B) probability that runs from starts drawn at random, one a level, show the pattern: 1 where every start
    does, 0 where none can; ``right`` (..., B) levels expected right; ``exponent`` (..., B, L) mean exponent of the starts that
    are chaotic, NaN where none is [1/drive period]; ``axes`` names and values of all axes, ``backlash`` the last.
    """

    chance: np.ndarray
    right: np.ndarray
    exponent: np.ndarray
    axes: dict[str, np.ndarray]

    def __str__(self) -> str:
        return f"the pattern appears from every start in {100.0 * self.share(1.0):.3g} % of the {self.chance.size} joints tried"

    def to_dataset(self) -> Any:
        """The match as an `xarray.Dataset` over all axes: ``chance`` of the pattern, and how many levels come out ``right``."""
        dims = tuple(self.axes)
        return dataset(
            {"chance": (dims, self.chance, "1"), "right": (dims, self.right, "1")},
            {name: (values, "") for name, values in self.axes.items()},
        )

    def share(self, least: float = 0.5) -> float:
        """Share of the region that shows the pattern with at least this probability."""
        return float(np.mean(self.chance >= least))

    def along(self, name: str) -> np.ndarray:
        """Mean chance over all axes but one, (P,)."""
        names = list(self.axes)
        if name not in names:
            raise BadInput(f"no axis {name!r}; there are {', '.join(names)}")
        return np.asarray(self.chance.mean(axis=tuple(i for i, other in enumerate(names) if other != name)))

    def matters(self) -> dict[str, float]:
        """For each axis the share of the chance's variance that its main effect explains (Sobol's first index)."""
        total = float(self.chance.var())
        return {name: float(self.along(name).var()) / total if total > 0.0 else 0.0 for name in self.axes}

    def best(self) -> dict[str, float]:
        """The parameters with the most chance, and among equals with the most levels right around them."""
        key = self.chance + 1e-6 * self.right
        at = np.unravel_index(int(np.argmax(key)), key.shape)
        return {name: float(values[i]) for i, (name, values) in zip(at, self.axes.items())}


def match_pattern(map_: ExponentMap, amplitudes: Sequence[float], chaotic: Sequence[bool], plays: Any) -> PatternMatch:
    """Compare a map with a pattern of regimes.

    Parameters
    ----------
    map_ : of exponents over amplitude / play and whatever else is in question
    amplitudes : of the base at each level [rad]
    chaotic : whether each level was seen to be chaotic
    plays : (B,) total plays in question [rad]

    Returns
    -------
    `PatternMatch`: the ``chance`` of the pattern at each joint and play

    Raises
    ------
    BadInput
        Lists of unlike length, or a level outside the map.

    Examples
    --------
    >>> joint = jb.two_link(3.16, np.radians(1.5), 15000.0, 9.0, -60.0, linearised=True)
    >>> curve = jb.signature.exponent_map(joint, 1.54, (0.6, 5.0, 60), starts=2, periods=60, skip=30)
    >>> jb.signature.match_pattern(curve, [0.03, 0.05], [False, True], [0.024, 0.026, 0.028]).chance.shape
    (3,)
    """
    amplitude, seen, plays = np.asarray(amplitudes, float), np.asarray(chaotic, bool), np.atleast_1d(np.asarray(plays, float))
    if amplitude.shape != seen.shape or amplitude.ndim != 1:
        raise BadInput(f"found {amplitude.size} amplitudes and {seen.size} regimes, wanted one regime an amplitude")
    place = np.rint(map_.place(amplitude[None], plays[:, None])).astype(int)
    if place.min() < 0 or place.max() >= map_.ratios.size:
        raise BadInput(
            f"the map holds ratios {map_.ratios[0]:.3g} to {map_.ratios[-1]:.3g}, wanted {amplitude.min() / plays.max():.3g} to "
            f"{amplitude.max() / plays.min():.3g}"
        )
    share = map_.chaotic_share[..., place]
    agrees = np.where(seen, share, 1.0 - share)
    count = map_.chaotic.sum(axis=0)
    mean = np.sum(map_.exponent, axis=0, where=map_.chaotic) / np.maximum(count, 1)
    mean = np.where(count > 0, mean, np.nan)
    return PatternMatch(agrees.prod(axis=-1), agrees.sum(axis=-1), mean[..., place], dict(map_.axes) | {"backlash": plays})
