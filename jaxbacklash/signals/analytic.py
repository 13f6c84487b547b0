r"""Analytic signals, and the carrier of a vibration: its slow envelope, phase and frequency (paper, 2.1).

Harmonics and an offset make envelope and phase of :math:`Y = y + j \tilde y` wiggle. For
:math:`Y = A e^{j\varphi} (1 + \varrho)` with :math:`\varrho` a sum of harmonics smaller than one, the mean of
:math:`\log(1 + \varrho)` over a cycle is zero (Jensen). So the logarithm is smoothed, envelope and phase together and with
one model, a spline with knots a whole number of cycles apart (see `cycles`): what is left is the fundamental, not merely a
smoother curve, and its derivatives come from the spline.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .cycles import CycleSpline, SlowCurve
from .fourier import fast_length
from .smoothing import choose_intervals, fit_spline

END_CYCLES = 3.0
"""Cycles at either end of a record that are masked: there the transform would need what was not measured."""
COARSE = 8
"""Least samples a cycle must have for its fundamental to be told from its harmonics."""


def analytic(values: np.ndarray) -> np.ndarray:
    r"""Analytic signal :math:`y + j\tilde y` (paper, 2.1), complex, shape (N,).

    The record is continued beyond both ends by its mirror image in the nearest turning point, tapered, so that the periodic
    continuation that a discrete transform implies has no jump; a release from rest is continued as it would have come. The
    mean passes unchanged.

    Parameters
    ----------
    values : uniform samples, shape (N,)
    """
    count, mean = values.size, float(np.mean(values))
    pad = max(1, min(count // 2 - 2, max(16, count // 8)))
    left, right = _mirrored(values - mean, pad)[::-1], _mirrored(values[::-1] - mean, pad)
    long = np.concatenate([left, values - mean, right])
    length = fast_length(long.size)
    spectrum = np.fft.fft(long, length)
    spectrum[1 : (length + 1) // 2] *= 2.0
    spectrum[length // 2 + 1 :] = 0.0
    return np.fft.ifft(spectrum)[pad : pad + count] + mean


def _mirrored(values: np.ndarray, pad: int) -> np.ndarray:
    """What would precede the samples if they were symmetric about their first turning point, nearest first, faded out, (pad,)."""
    rise = np.diff(values[: values.size // 4 + 2])
    turns = np.flatnonzero(rise[1:] * rise[:-1] <= 0.0)
    turn = int(turns[0]) + 1 if turns.size else 0
    image = values[2 * turn + 1 : 2 * turn + 1 + pad]
    return np.pad(image, (0, pad - image.size)) * (0.5 + 0.5 * np.cos(np.pi * np.arange(pad) / pad))


def low_passed(values: np.ndarray, share: float) -> np.ndarray:
    """The paper's filter: zero-phase low-pass at ``share`` of half the sample rate (0.005 and 0.01 there), shape (N,)."""
    from scipy import signal  # half a second to import, and a fit's cross-check does without

    return signal.sosfiltfilt(signal.butter(2, share, output="sos"), values)


def denoised(t: np.ndarray, values: np.ndarray, window: float = 0.1) -> np.ndarray:
    """The samples seen through a smoothing spline as fine as the data ask for, shape (N,): noise shrinks, motion stays."""
    if not np.any(values != values[0]):
        return values
    return fit_spline(t, values, t[0], window / choose_intervals(t, values, window))(t)


@dataclass(frozen=True)
class Carrier:
    """The fundamental of a vibration at the sample times, arrays of shape (N,).

    Attributes: ``phase`` [rad], rising; ``omega`` [rad/s]; ``amplitude`` [unit]; ``inside`` True away from the
    masked ends; ``cycles`` the spline that smooths by its cycles, ``slow_phase`` and ``slow_log`` what it made of the phase
    and of the logarithm of the amplitude.
    """

    t: np.ndarray
    phase: np.ndarray
    omega: np.ndarray
    amplitude: np.ndarray
    inside: np.ndarray
    cycles: CycleSpline
    slow_phase: SlowCurve
    slow_log: SlowCurve


def carrier(t: np.ndarray, values: np.ndarray, *, cycles: float = 1.0) -> Carrier | None:
    """The fundamental of one signal from its analytic signal.

    Parameters
    ----------
    t, values : uniform samples, shape (N,); noise is taken off first where it can be told from motion
    cycles : distance of the smoothing spline's knots in cycles, a whole number

    Returns
    -------
    None where no carrier is found: fewer than eight cycles, or a phase that does not advance
    """
    full = analytic(values - np.mean(values))
    phase = np.unwrap(np.angle(full))
    if phase[-1] < phase[0]:
        return None
    turns = (phase[-1] - phase[0]) / (2.0 * np.pi)
    if turns < 8.0 or turns > t.size / COARSE:
        return None
    rough = _rising(t, phase, turns)
    for _ in range(2):
        # First by a rough count of cycles, then by the count that this gave.
        spline = CycleSpline(t, rough, cycles)
        level = np.maximum(np.abs(full), 1e-3 * float(np.median(np.abs(full))))
        log_level, smooth = spline.fit(np.log(level)), spline.fit(phase)
        rough = _monotone(smooth(t))
    omega = smooth(t, 1)
    begin, end = rough[0], rough[-1]
    margin = 2.0 * np.pi * END_CYCLES
    inside = (rough - begin > margin) & (end - rough > margin) & (omega > 0.0)
    return Carrier(t, rough, np.maximum(omega, 1e-9), np.exp(log_level(t)), inside, spline, smooth, log_level)


def _rising(t: np.ndarray, phase: np.ndarray, turns: float) -> np.ndarray:
    """The phase over a running mean of a few average cycles, made to rise."""
    length = int(np.clip(round(2.0 * t.size / turns), 3, max(3, t.size // 8)))
    padded = np.concatenate([2 * phase[0] - phase[length:0:-1], phase, 2 * phase[-1] - phase[-2 : -length - 2 : -1]])
    total = np.concatenate([[0.0], np.cumsum(padded)])[length - length // 2 :]
    return _monotone((total[length : length + t.size] - total[: t.size]) / length)


def _monotone(phase: np.ndarray) -> np.ndarray:
    least = 1e-3 * (phase[-1] - phase[0]) / phase.size
    return np.maximum.accumulate(phase - least * np.arange(phase.size)) + least * np.arange(phase.size)
