"""Causes that show in the samples: where they are is read off the record, and the fit only says whether they matter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..records import Record
from ..signals import noise_level
from .kinds import Corrected, Kind

RHYTHM, FRESH = 0.9, 32
"""Share of the gaps between fresh samples that are whole multiples of the usual one, and fresh samples at least, for a rhythm."""
STILL, CREPT, LONG = 5.0, 0.02, 0.02
"""Noises, or share of the channel's range, within which a channel at rest stays, and the share of a record that a rest at its
start lasts at least."""
SIDE, CLEAR = 6, 12.0
"""Samples on either side of a step that tell where the channel was going, and by how many noises of that a step stands out."""


@dataclass(frozen=True)
class HeldSamples(Kind):
    """The measured channel is refreshed only every few samples and repeats the last value between."""

    name, measured_only, unit = "held_samples", True, "samples"

    def corrected(self, record: Record, size: float) -> Corrected:
        values = record.channels[record.observed_name]
        fresh = np.concatenate([[False], np.diff(values) != 0.0])
        return Corrected(record, fresh.astype(float), noise=self.noise(record, int(size)))

    def coarse(self, record: Record) -> np.ndarray:
        values = record.channels[record.observed_name]
        fresh = np.flatnonzero(np.diff(values) != 0.0)
        if fresh.size < FRESH:
            return np.array([])
        gaps = np.diff(fresh)
        usual = int(np.median(gaps))
        # An encoder at rest repeats itself too, but not with a rhythm.
        rhythm = float(np.mean(gaps % usual == 0)) if usual > 1 else 0.0
        return np.array([float(usual)]) if rhythm > RHYTHM else np.array([])

    def noise(self, record: Record, every: int) -> float:
        """Noise of the fresh samples, by themselves."""
        values, first = record.channels[record.observed_name], first_fresh(record)
        return float(noise_level(record.t[first::every], values[first::every]))


def first_fresh(record: Record) -> int:
    """The first sample of the measured channel that does not repeat the one before."""
    return int(np.flatnonzero(np.diff(record.channels[record.observed_name]) != 0.0)[0]) + 1


@dataclass(frozen=True)
class HeldStart(Kind):
    """The link was held until a time [s] and then let go."""

    name, unit, measured_only, crops = "held_start", "s", False, True

    def corrected(self, record: Record, size: float) -> Corrected:
        part = record.between(size, record.t[-1])
        return Corrected(part, np.ones(part.samples))

    def coarse(self, record: Record) -> np.ndarray:
        values = record.channels[record.observed_name]
        level = float(np.median(values[: max(8, round(LONG * record.samples))]))
        limit = max(STILL * noise_level(record.t, values), CREPT * float(np.ptp(values)))
        away = np.abs(values - level) > limit
        # Single samples stand out by chance: the rest ends where the channel does not come back at once.
        gone = np.flatnonzero(away[:-2] & away[1:-1] & away[2:])
        if not gone.size or not max(8, LONG * record.samples) < gone[0] < 0.8 * record.samples:
            return np.array([])
        # A link that is let go at the start rests there too, for less time than it then takes to cross over.
        across = np.flatnonzero((values[gone[0] :] - np.mean(values[gone[0] :])) * (level - np.mean(values[gone[0] :])) < 0.0)
        over = int(across[0]) if across.size else record.samples
        return np.array([float(record.t[gone[0]])]) if gone[0] > 2 * over else np.array([])


@dataclass(frozen=True)
class StepChange(Kind):
    """Counts were lost at one sample: from there on the channel is off by a constant."""

    at: int = 0
    name, unit = "step", "rad"

    def corrected(self, record: Record, size: float) -> Corrected:
        after = np.arange(record.samples) >= self.at
        values = record.channels[self.channel] - size * after
        return Corrected(record.replace(**{self.channel: values}), np.ones(record.samples))

    def coarse(self, record: Record) -> np.ndarray:
        sizes, _ = steps(record.channels[self.channel])
        return np.array([sizes[self.at]])


@dataclass(frozen=True)
class Limit(Kind):
    """The force that was applied is limited, while what was recorded is not: the recorded one is cut off at ``size``."""

    name, unit, measured_only, null = "force_limit", "N m", False, np.inf

    def corrected(self, record: Record, size: float) -> Corrected:
        return Corrected(record.replace(F=np.clip(record.channels["F"], -size, size)), np.ones(record.samples))

    def coarse(self, record: Record) -> np.ndarray:
        return float(np.max(np.abs(record.channels["F"]))) * np.linspace(0.9, 0.3, 7)

    def step(self, record: Record) -> float:
        return 2e-3 * float(np.max(np.abs(record.channels["F"])))


def steps(values: np.ndarray) -> tuple[np.ndarray, float]:
    """By how much a channel jumps before each sample (N,), between parabolas through those before and after, and its noise."""
    ahead = _reaching(SIDE)
    size = np.zeros(values.size)
    if values.size < 4 * SIDE:
        return size, 1.0
    rows = np.lib.stride_tricks.sliding_window_view(values, 2 * SIDE)
    size[SIDE : SIDE + rows.shape[0]] = rows[:, SIDE:] @ ahead[::-1] - rows[:, :SIDE] @ ahead
    spread = 1.4826 * float(np.median(np.abs(size[SIDE : SIDE + rows.shape[0]])))
    return size, max(spread, 1e-300)


def _reaching(count: int) -> np.ndarray:
    """Weights of the last samples that carry a parabola half a sample beyond them."""
    powers = np.vander(np.arange(-count, 0.0), 3)
    return np.vander([-0.5], 3)[0] @ np.linalg.pinv(powers)


def stepped(record: Record, channel: str) -> int | None:
    """The sample before which a channel jumps most, None where it does not."""
    size, spread = steps(record.channels[channel])
    at = int(np.argmax(np.abs(size)))
    beside = np.abs(size).copy()
    beside[max(at - 2 * SIDE, 0) : at + 2 * SIDE] = 0.0
    return at if abs(size[at]) > CLEAR * spread and abs(size[at]) > 2.0 * float(np.max(beside)) else None
