"""Envelope and phase of a signal as the usual tools give them: (times, amplitude, frequency in Hz, phase in rad)."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from scipy import signal

from jaxbacklash.signals import low_passed

Track = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def scipy_hilbert(t: np.ndarray, values: np.ndarray, share: float | None = None) -> Track:
    """scipy.signal.hilbert and plain differences; with ``share`` low-passed as the paper does, at that share of half the rate."""
    full = signal.hilbert(values)
    amplitude, phase = np.abs(full), np.unwrap(np.angle(full))
    frequency = np.gradient(phase, t) / (2.0 * np.pi)
    if share is not None:
        amplitude, frequency = low_passed(amplitude, share), low_passed(frequency, share)
        phase = phase[0] + 2.0 * np.pi * np.concatenate([[0.0], np.cumsum(0.5 * (frequency[1:] + frequency[:-1]) * np.diff(t))])
    return t, amplitude, frequency, phase


def pywavelets(t: np.ndarray, values: np.ndarray, grid: np.ndarray, wavelet: str = "cmor1.5-1.0") -> Track | None:
    """PyWavelets' cwt and the largest modulus of each column; None where it is not installed."""
    try:
        import pywt
    except ImportError:
        return None

    dt = t[1] - t[0]
    scales = pywt.central_frequency(wavelet) / (grid * dt)
    found, frequencies = pywt.cwt(values, scales, wavelet, dt)
    best, every = np.argmax(np.abs(found), axis=0), np.arange(t.size)
    # With the factor 1/sqrt(s) of (2.5) and the mother wavelet normalised, a unit cosine has the modulus sqrt(s) / 2.
    amplitude = 2.0 * np.abs(found[best, every]) / np.sqrt(scales[best])
    return t, amplitude, frequencies[best], np.unwrap(np.angle(found[best, every]))


def ssqueezed(t: np.ndarray, values: np.ndarray) -> Track | None:
    """ssqueezepy's synchrosqueezed transform, its own penalised ridge; None where it is not installed."""
    try:
        from ssqueezepy import extract_ridges, ssq_cwt
    except ImportError:
        return None
    squeezed, plain, frequencies, scales, *_ = ssq_cwt(values, ("morlet", {"mu": 6.0}), t=t)
    row = extract_ridges(plain, scales, penalty=2.0, n_ridges=1, bw=8)[:, 0]
    every = np.arange(t.size)
    on_squeezed = np.array(extract_ridges(squeezed, frequencies, penalty=2.0, n_ridges=1, bw=4))[:, 0]
    size = np.abs(plain[row, every]) / _unit()
    return t, size, np.asarray(frequencies)[on_squeezed], np.unwrap(np.angle(plain[row, every]))


@lru_cache
def _unit() -> float:
    """What ssqueezepy's transform makes of a unit cosine: its scale is a convention, for which it should not pay."""
    from ssqueezepy import cwt

    found, *_ = cwt(np.cos(2 * np.pi * 0.01 * np.arange(4000)), ("morlet", {"mu": 6.0}))
    return float(np.max(np.abs(found[:, 2000])))


PEERS: dict[str, Callable[..., Track | None]] = {
    "scipy hilbert, differences": lambda t, v, grid: scipy_hilbert(t, v),
    "scipy hilbert, low-passed 0.5 %": lambda t, v, grid: scipy_hilbert(t, v, 0.005),
    "scipy hilbert, low-passed 1 %": lambda t, v, grid: scipy_hilbert(t, v, 0.01),
    "scipy hilbert, low-passed 2 %": lambda t, v, grid: scipy_hilbert(t, v, 0.02),
    "PyWavelets, column maximum": pywavelets,
    "PyWavelets, 4 times as long": lambda t, v, grid: pywavelets(t, v, grid, "cmor6.0-1.0"),
    "ssqueezepy, its ridge": lambda t, v, grid: ssqueezed(t, v),
}
