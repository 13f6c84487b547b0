"""The causes with a size that is searched for: what each would have done to a record, undone.

A kind takes a record and a size and gives the record as it would be without the cause, and for each sample of the measured
channel the share of the noise that it still has (0: no value is left there). Small sizes are found by a linearisation, large
ones from a coarse list and the weak form (`screen`).
"""

from __future__ import annotations

import abc
from dataclasses import dataclass

import numpy as np

from ..records import Record
from ..regression.equation_error import estimate
from .resampled import read_at


@dataclass(frozen=True)
class Corrected:
    """A corrected ``record`` and ``share`` (N,), how much of the noise's standard deviation each value of the measured channel
    has; ``noise`` of the measured channel where it is another than that of the record as it stands."""

    record: Record
    share: np.ndarray
    noise: float | None = None


@dataclass(frozen=True)
class Kind(abc.ABC):
    """A cause with one size: ``name`` and ``channel`` as in `Cause`; ``mixed`` where only y is concerned though z is recorded."""

    channel: str
    mixed: bool = False
    name = ""
    unit = "1"
    law = ""
    null = 0.0
    measured_only = True
    """Only values of the measured channel change, not the input and not which samples there are."""
    crops = False
    """Samples are left out, so that the records have another length."""
    far = True
    """Sizes so large are likely that the search has to begin anew."""

    @abc.abstractmethod
    def corrected(self, record: Record, size: float) -> Corrected:
        """The record without a cause of this size."""

    @abc.abstractmethod
    def coarse(self, record: Record) -> np.ndarray:
        """Sizes to begin from, the null value apart."""

    def step(self, record: Record) -> float:
        """A small size, over which the misfit is linear in the data; 0 where the cause has no small sizes."""
        return 0.0

    def least(self, record: Record) -> float:
        """How far from the null value a cause is worth a word."""
        return 0.0


def _moved(record: Record, places: np.ndarray, mixed: bool) -> Corrected:
    name = record.observed_name
    own = record.channels[name]
    values, share = read_at(own, places)
    if mixed:  # z = y - x was formed of a y that is late
        x = record.channels["x"]
        values = values + read_at(x, places)[0] - x
    return Corrected(record.replace(**{name: values}), share)


class Delay(Kind):
    """The measured channel, or y alone, is late by a time [s] against the other one; early where it is negative."""

    name, unit = "delay", "s"

    def corrected(self, record: Record, size: float) -> Corrected:
        return _moved(record, np.arange(record.samples) + size / record.dt, self.mixed)

    def coarse(self, record: Record) -> np.ndarray:
        steps = np.unique(np.round(1.6 ** np.arange(0, 30)))
        steps = steps[steps <= max(min(LONGEST / record.dt, record.samples / 8), 1.0)]
        return record.dt * np.concatenate([-steps[::-1], steps])

    def step(self, record: Record) -> float:
        return record.dt

    def least(self, record: Record) -> float:
        return 0.02 * record.dt


class Clock(Kind):
    """The clock of the measured channel runs fast by a share of the other's: it is late by so much of the time passed."""

    name, far = "clock", False

    def corrected(self, record: Record, size: float) -> Corrected:
        return _moved(record, np.arange(record.samples) * (1.0 + size), self.mixed)

    def coarse(self, record: Record) -> np.ndarray:
        return np.array([])

    def step(self, record: Record) -> float:
        return 1.0 / record.samples


LONGEST = 0.25
"""Longest delay that is looked for [s]."""
GEARS = np.concatenate([np.geomspace(0.004, 0.8, 22), np.geomspace(1.25, 250.0, 22)])
"""Ratios to begin from: 1 : 250 to 250 : 1, each a quarter more than the last, as far as a search finds the rest of its way."""


class Scale(Kind):
    """The input x is in another unit or behind another gear: it reads ``size`` times what it should be."""

    name, null, measured_only = "scale", 1.0, False
    spare = 0.2
    """What is nearer to one is a calibration, the catalogue's sensor_gain."""

    def corrected(self, record: Record, size: float) -> Corrected:
        return Corrected(record.replace(x=record.channels["x"] / size), np.ones(record.samples))

    def coarse(self, record: Record) -> np.ndarray:
        return GEARS

    def step(self, record: Record) -> float:
        return 1e-3

    def least(self, record: Record) -> float:
        return self.spare


@dataclass(frozen=True)
class Inertia(Scale):
    """The inertia that was given is wrong: it is ``size`` times as large, as a measured force tells.

    With the force divided by the size the given inertia is right, and stiffness, damping and torques come out too small by it.
    """

    given: float = 1.0
    name, spare = "inertia", 0.1

    def coarse(self, record: Record) -> np.ndarray:
        with np.errstate(all="ignore"):
            try:
                return np.array([estimate(record, inertia=None).inertia / self.given])
            except (np.linalg.LinAlgError, ValueError):  # nothing in it depends on the inertia
                return np.array([])

    def corrected(self, record: Record, size: float) -> Corrected:
        return Corrected(record.replace(F=record.channels["F"] / size), np.ones(record.samples))


class Turned(Kind):
    """A channel has its sign turned."""

    name, null, measured_only = "sign", 1.0, False

    def corrected(self, record: Record, size: float) -> Corrected:
        return Corrected(record.replace(**{self.channel: size * record.channels[self.channel]}), np.ones(record.samples))

    def coarse(self, record: Record) -> np.ndarray:
        return np.array([-1.0])
