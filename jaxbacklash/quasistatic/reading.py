"""What a slow record says of its play, before it is put into words: numbers, curves, and which conditions it meets."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .levels import Levels


@dataclass(frozen=True)
class Condition:
    """One thing the reading rests on: ``name``, whether it ``holds`` (None: the record cannot tell), and what was found.

    ``why`` is the reason for giving no play, and ``way_out`` what to do, where it does not hold.
    """

    name: str
    holds: bool | None
    found: str
    why: str = ""
    way_out: str = ""


@dataclass(frozen=True)
class OverAngle:
    """What both levels do over the angle.

    Attributes
    ----------
    angle, width, stderr : (A,) their distance in parts of the angle, with its error
    fine, middle : (M,) their middle, less drift, at finer steps
    """

    angle: np.ndarray
    width: np.ndarray
    stderr: np.ndarray
    fine: np.ndarray
    middle: np.ndarray


@dataclass(frozen=True)
class Error:
    """One wave of the transmission error: of which turn, its order, and its amplitude in z's unit."""

    turn: str
    order: int
    amplitude: float
    stderr: float


@dataclass(frozen=True)
class Reading:
    """Numbers of one way of reading.

    Attributes
    ----------
    way : "carried", "pulled" or "loop"
    width : the lost motion, with ``stderr``, ``interval`` of 95 % and ``freedom``; None where it cannot be had
    conditions : in the order in which they are to be told
    passes : how many stand behind it
    side : (N,) the side at every sample, 0 where it does not count
    drift : (N,) what was taken for a drift
    noise : standard deviation of what is left at an edge
    turned : whether z was taken for x - y
    """

    way: str
    conditions: tuple[Condition, ...]
    passes: int
    width: float | None = None
    stderr: float = 0.0
    interval: tuple[float, float] | None = None
    freedom: float = 1.0
    side: np.ndarray = field(default_factory=lambda: np.zeros(0))
    drift: np.ndarray = field(default_factory=lambda: np.zeros(0))
    noise: float | None = None
    over_angle: OverAngle | None = None
    errors: tuple[Error, ...] = ()
    peak_to_peak: float | None = None
    slope: tuple[float, float] | None = None
    levels: Levels | None = None
    turned: bool = False
    notes: tuple[str, ...] = ()
    extra: dict[str, tuple[float, float, float]] = field(default_factory=dict)

    @property
    def failed(self) -> Condition | None:
        """The first condition that does not hold."""
        return next((one for one in self.conditions if one.holds is False), None)


def rough_noise(values: np.ndarray) -> float:
    """Standard deviation of the noise of neighbouring samples, by the median of second differences; coarse, and quick."""
    if values.size < 5:
        return 0.0
    return float(np.median(np.abs(np.diff(values, 2)))) / (0.6745 * np.sqrt(6.0))
