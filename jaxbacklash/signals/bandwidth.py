"""How fast is a signal? The frequency below which nearly all the power of its rate lies, noise not counted."""

from __future__ import annotations

import numpy as np

ABOVE_FLOOR = 4.0
"""Times the noise floor that a stretch of the spectrum must have to count as motion."""


def highest_frequency(values: np.ndarray, dt: float, share: float) -> float:
    """Frequency [Hz] below which this share of the power of the signal's rate lies; 0 for a constant.

    White noise has most of its rate's power at the highest frequencies. Its floor, the median of the upper half of the spectrum
    in stretches of 32 lines or fewer, is taken off, and stretches near it do not count. Differences and not the samples are
    transformed, so that a record that ends elsewhere than it began has no jump.

    Parameters
    ----------
    values : uniform samples, shape (N,)
    dt : their spacing [s]
    share : between 0 and 1
    """
    steps = np.diff(values)
    angle = np.pi * np.fft.rfftfreq(steps.size, 1.0)[1:]
    power = (np.abs(np.fft.rfft(steps))[1:] / (2.0 * np.sin(angle))) ** 2
    lines = int(np.clip(power.size // 256, 1, 32))
    whole = power.size // lines * lines
    level = power[:whole].reshape(-1, lines).mean(axis=1)
    floor = float(np.median(level[level.size // 2 :]))
    motion = np.repeat(np.where(level > ABOVE_FLOOR * floor, 1.0, 0.0), lines)
    of_rate = np.cumsum(np.maximum(power[:whole] - floor, 0.0) * motion * angle[:whole] ** 2)
    if not of_rate.size or not of_rate[-1] > 0.0:
        return 0.0
    return float(angle[np.searchsorted(of_rate, share * of_rate[-1])] / (np.pi * dt))
