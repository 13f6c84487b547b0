r"""The fundamental of any signal along a carrier, by Hilbert transform and by wavelet: two ways to the same numbers.

Both map samples (N,) to complex amplitudes (M,) at a number of points, and do so linearly, so that the equation of motion
holds between the amplitudes of its terms. They share nothing but the samples: one smooths the analytic signal by
splines with knots at whole cycles and takes derivatives from envelope and phase as in the paper's (3.6); the other
projects on Morlet atoms along the ridge and takes derivatives from the atoms.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from copy import copy
from functools import cached_property

import numpy as np

from ..signals import (
    Atoms,
    Carrier,
    CycleSpline,
    Morlet,
    Scalogram,
    analytic,
    carrier,
    frequency_grid,
    highest_frequency,
    ridge,
    scalogram,
)

MOST_POINTS = 1000
"""Points of a skeleton; two a cycle until there are so many."""
SHOWN = 16.0
"""Samples a cycle of the highest frequency that the picture in which the ridge is sought is made from."""
FASTEST = 0.5
"""Largest share of its own width squared by which an atom's frequency may sweep, see `WaveletFundamental`."""


class Fundamental(ABC):
    """Complex amplitudes at the points ``t`` (M,) [s], where the carrier has the frequency ``omega`` (M,) [rad/s].

    ``whole`` (M,) is False where an end of the record is too close; ``phase`` of the carrier at the samples [rad], rising,
    and ``cycles`` the spline that smooths by it; ``windowed`` the number of cycles that an amplitude draws on.
    """

    name: str
    t: np.ndarray
    omega: np.ndarray
    whole: np.ndarray
    phase: np.ndarray
    cycles: CycleSpline
    windowed: float

    @abstractmethod
    def of(self, values: np.ndarray, order: int = 0) -> np.ndarray:
        """Amplitude of the signal (N,), or of its first or second derivative, at the points: complex (M,)."""

    @abstractmethod
    def wider(self) -> Fundamental:
        """The same points seen through windows twice as long: how much a result owes to the length of the window."""


class HilbertFundamental(Fundamental):
    r"""From analytic signals: :math:`U = s(t)\,C(t)` with C the carrier and s slow, so that

    .. math:: \dot U = (\dot s + \lambda s)\,C,\qquad \ddot U = (\ddot s + 2\lambda\dot s + (\dot\lambda + \lambda^2) s)\,C

    with :math:`\lambda = \dot B/B + j\omega` of the carrier's envelope B and frequency (paper, above 3.6).

    Under a drive C has the carrier's phase alone, B = 1; a free decay has its envelope too (``decaying``), so that s stays
    near one while the motion dies away.
    """

    name = "hilbert"

    def __init__(self, found: Carrier, *, decaying: bool = False) -> None:
        self.carrier, self.phase, self.cycles, self.windowed = found, found.phase, found.cycles, 1.0
        self.t = _twice_a_cycle(found.t, found.phase)
        self.omega = np.maximum(found.slow_phase(self.t, 1), 1e-9)
        self.whole = np.interp(self.t, found.t, found.inside.astype(float)) > 0.999
        log, share = found.slow_log, float(decaying)
        self._rate = share * log(self.t, 1) + 1j * self.omega
        self._bend = share * log(self.t, 2) + 1j * found.slow_phase(self.t, 2)
        self._level = np.exp(share * log(self.t))
        self._back = np.exp(-share * log(found.t) - 1j * found.phase)

    def of(self, values: np.ndarray, order: int = 0) -> np.ndarray:
        slow = self.cycles.fit(analytic(values) * self._back)
        s = slow(self.t)
        if order == 0:
            return self._level * s
        first, rate = slow(self.t, 1), self._rate
        if order == 1:
            return self._level * (first + rate * s)
        return self._level * (slow(self.t, 2) + 2.0 * rate * first + (self._bend + rate**2) * s)

    def wider(self) -> HilbertFundamental:
        other = copy(self)
        other.cycles, other.windowed = CycleSpline(self.carrier.t, self.phase, 2.0), 2.0
        return other


class WaveletFundamental(Fundamental):
    r"""From Morlet atoms along the ridge of the carrier's scalogram.

    A frequency that sweeps at the rate :math:`\dot\omega` within an atom of width s lowers its amplitude by
    :math:`(1 + (\dot\omega s^2)^2)^{-1/4}`, alike for all signals; points where :math:`\dot\omega s^2` exceeds a half are
    not whole.
    """

    name = "wavelet"

    def __init__(self, t: np.ndarray, drive: np.ndarray, picture: Scalogram) -> None:
        self.picture = picture
        self.path = _smooth_path(picture.t, ridge(picture))
        each = 0.5 * (self.path[1:] + self.path[:-1]) * np.diff(picture.t)
        rough = 2.0 * np.pi * np.interp(t, picture.t, np.concatenate([[0.0], np.cumsum(each)]))
        early, late = t < picture.t[0], t > picture.t[-1]
        rough[early] += 2.0 * np.pi * self.path[0] * (t[early] - picture.t[0])
        rough[late] += 2.0 * np.pi * self.path[-1] * (t[late] - picture.t[-1])
        self._place(t, _twice_a_cycle(t, rough), picture.wavelet)
        # The ridge finds the frequency to a thousandth; the atoms' phase and its rate know it better.
        amplitude = self.of(drive)
        ahead = np.unwrap(np.angle(amplitude * np.exp(-1j * np.interp(self.t, t, rough))))
        trusted = self.whole if np.any(self.whole) else np.ones(self.t.size, bool)
        with np.errstate(divide="ignore", invalid="ignore"):
            rate = (self.of(drive, 1) / amplitude).imag
        near = self.whole & (np.abs(rate / self.omega - 1.0) < 0.2)
        self.omega = np.where(near, rate, self.omega)
        self.phase = np.maximum.accumulate(rough + np.interp(t, self.t[trusted], ahead[trusted])) + 1e-9 * np.arange(t.size)

    def _place(self, t: np.ndarray, centres: np.ndarray, wavelet: Morlet) -> None:
        self._samples, self.t = t, centres
        frequency = np.interp(centres, self.picture.t, self.path)
        self.omega = 2.0 * np.pi * frequency
        self.windowed = 4.0 * float(wavelet.width(1.0))
        self._atoms = Atoms(t, centres, frequency, wavelet)
        sweep = np.gradient(self.omega, centres) * wavelet.width(frequency) ** 2
        self.whole = self._atoms.complete & (np.abs(sweep) < FASTEST)
        self._lift = (1.0 + np.minimum(sweep**2, FASTEST**2)) ** 0.25

    @cached_property
    def cycles(self) -> CycleSpline:  # type: ignore[override]
        return CycleSpline(self._samples, self.phase)

    def of(self, values: np.ndarray, order: int = 0) -> np.ndarray:
        return self._lift * self._atoms.of(values, order)

    def wider(self) -> WaveletFundamental:
        other = copy(self)
        other._place(self._samples, self.t, Morlet(4.0 * self.picture.wavelet.f_b, self.picture.wavelet.f_c))
        return other


def hilbert_fundamental(t: np.ndarray, drive: np.ndarray, *, decaying: bool = False) -> HilbertFundamental | None:
    """Along the analytic signal of what sets the pace; None where that has no carrier."""
    found = carrier(t, drive)
    return None if found is None else HilbertFundamental(found, decaying=decaying)


def wavelet_fundamental(t: np.ndarray, drive: np.ndarray) -> WaveletFundamental | None:
    """Along the ridge of what sets the pace; None where fewer than eight cycles fit."""
    picture = picture_of(t, drive)
    return None if picture is None else WaveletFundamental(t, drive, picture)


def picture_of(t: np.ndarray, values: np.ndarray, wavelet: Morlet | None = None) -> Scalogram | None:
    """A scalogram over the band that holds all but a thousandth of the signal's speed, of means that still show that band."""
    dt = (t[-1] - t[0]) / (t.size - 1)
    low, fastest = 4.0 / (t[-1] - t[0]), highest_frequency(values, dt, 0.999)
    if not fastest > 0.0:
        return None
    high = float(np.clip(1.5 * fastest, 2.0 * low, 0.12 / dt))
    if high <= 1.5 * low:
        return None
    group = max(1, int(1.0 / (SHOWN * high * dt)))
    whole = t.size // group * group
    at, shown = (v[:whole].reshape(-1, group).mean(axis=1) for v in (t, values))
    return scalogram(at, shown, frequency_grid(low, high, 12), wavelet=wavelet)


def _twice_a_cycle(t: np.ndarray, phase: np.ndarray) -> np.ndarray:
    turns = (phase[-1] - phase[0]) / (2.0 * np.pi)
    count = int(np.clip(2.0 * turns, 4, MOST_POINTS))
    return np.interp(phase[0] + (np.arange(count) + 0.5) * (phase[-1] - phase[0]) / count, phase, t)


def _smooth_path(t: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    """The ridge over a running mean of half a cycle or so: its bins leave small waves."""
    spacing = (t[-1] - t[0]) / (t.size - 1)
    width = max(0.5 / (float(np.median(frequency)) * spacing), 0.5)
    reach = int(4.0 * width + 0.5)
    share = np.exp(-0.5 * (np.arange(-reach, reach + 1) / width) ** 2)
    return np.exp(np.convolve(np.pad(np.log(frequency), reach, mode="edge"), share / np.sum(share), "valid"))
