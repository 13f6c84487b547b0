"""The 0-1 test for chaos (Gottwald and Melbourne, 2009): does a walk driven by the series wander or stay?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

FREQUENCIES = 100
LONGEST = 2000
SEED_BAND = (np.pi / 5.0, 4.0 * np.pi / 5.0)  # away from 0 and pi, where every series resonates


@dataclass(frozen=True, eq=False)
class ZeroOne:
    """``k`` near 1 for chaos and noise, near 0 for regular motion; ``stride`` samples between those used; ``samples`` used;
    ``p``, ``q`` (samples,) the walk at the median frequency, for the picture."""

    k: float
    stride: int
    samples: int
    p: np.ndarray
    q: np.ndarray


def zero_one(series: np.ndarray, stride: int, rng: np.random.Generator) -> ZeroOne:
    """The correlation form of the test; the mean is taken off first, and with it the oscillating term of their equation (2.8).

    A finely sampled flow looks regular to this test whatever it is, so the series is thinned first (Gottwald and
    Melbourne, 2016); the walk is that of every ``stride``-th sample. It cannot tell chaos from noise and is never the only
    witness here.

    Parameters
    ----------
    series : (N,)
    stride : samples from one used to the next, as a rule the delay
    rng : draws the frequencies
    """
    used = series[::stride][:LONGEST]
    used = used - used.mean()
    n = used.size
    most = max(10, n // 10)
    c = rng.uniform(*SEED_BAND, FREQUENCIES)
    turn = np.exp(1j * np.outer(c, np.arange(1, n + 1)))
    walk = np.cumsum(used * turn, axis=1)
    lags = np.arange(1, most + 1)
    rows = n - most
    square = np.empty((FREQUENCIES, most))
    for k, lag in enumerate(lags):
        square[:, k] = np.mean(np.abs(walk[:, lag : lag + rows] - walk[:, :rows]) ** 2, axis=1)
    centred = lags - lags.mean()
    apart = square - square.mean(axis=1, keepdims=True)
    spread = np.sqrt(np.sum(apart**2, axis=1) * np.sum(centred**2))
    each = np.sum(apart * centred, axis=1) / np.maximum(spread, 1e-300)
    middle = int(np.argsort(each)[FREQUENCIES // 2])
    return ZeroOne(float(np.median(each)), stride, n, walk[middle].real, walk[middle].imag)
