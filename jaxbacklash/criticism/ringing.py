"""At which frequencies does a model's residual ring? A resonance that the model lacks leaves a narrow band in what it misses."""

from __future__ import annotations

import numpy as np
from scipy.special import betainc

from ..records import Record

MOST = 2
"""Bands that are given back at most."""
WIDTH = 0.012
"""Half the width of a band, as a share of its frequency: that of a resonance with so much damping."""
RARE = 0.02
"""Share of records, at most, in which any band is as loud beside what surrounds it where all is noise."""
APART = 6.0
"""Widths between two bands that are given back."""
SURROUNDED = 2.0
"""From one part in so many to so many times its frequency goes what surrounds a band."""
SLOWEST, FASTEST = 3.0, 0.8
"""Periods in the record that a band's frequency has at least, and share of half the rate that it has at most."""


def ringing(record: Record, own: Record) -> list[float]:
    """Angular frequencies [rad/s] at which the channels of a record ring beside a model's own motion, the loudest first.

    The link's motion and the base's are both looked at: where the base is noisy too, a fit bends it to follow what is missing.
    """
    power, channels = np.zeros(record.samples // 2 + 1), 0
    for name, seen in record.channels.items():
        left = seen - own.channels[name]
        if (size := float(np.std(left))) > 0.0:
            power += np.abs(np.fft.rfft(left / size)) ** 2
            channels += 1
    if not channels:
        return []
    hertz = np.fft.rfftfreq(record.samples, record.dt)
    total = np.concatenate([[0.0], np.cumsum(power)])

    def within(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        first, last = np.searchsorted(hertz, low), np.searchsorted(hertz, high)
        return total[last] - total[first], last - first

    step = hertz[1]
    at = hertz[(hertz > SLOWEST * step) & (hertz < FASTEST * hertz[-1])]
    half = np.maximum(WIDTH * at, 1.5 * step)
    band, inside = within(at - half, at + half)
    wide, around = within(at / SURROUNDED, at * SURROUNDED)
    # The power of noise at one frequency is exponentially distributed: a band's share of what surrounds it is as Beta.
    quiet = 1.0 - band / np.maximum(wide, 1e-300)
    chance = at.size * betainc(channels * np.maximum(around - inside, 1), channels * inside, quiet)
    found: list[float] = []
    for k in np.argsort(chance, kind="stable"):
        if not chance[k] < RARE or len(found) == MOST:
            break
        if all(abs(at[k] / known - 1.0) > APART * WIDTH for known in found):
            found.append(float(at[k]))
    return [2.0 * np.pi * frequency for frequency in found]
