r"""A channel as it would have been sampled at other instants: read between its samples by a windowed sinc.

An ideal low-pass filter (Shannon 1949) leaves white noise white; cut off after `TAPS` samples on either side and tapered (Kaiser
1974) it takes away a few percent of it between the samples: the share of the noise that is left is returned beside the values.
"""

from __future__ import annotations

import numpy as np

TAPS, TAPER = 16, 9.0
"""Samples on either side that take part in a value between two samples, and the shape of the Kaiser window over them: signals
up to 0.8 of half the sampling rate are kept to a ten-thousandth."""
TOGETHER = 1 << 16
"""Values that are worked out at a time: 17 MB of weights."""


def read_at(values: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values of an evenly sampled channel at other places.

    Parameters
    ----------
    values : array of shape (N,)
    places : array of shape (K,), in samples from the first: 0.5 is midway between the first two

    Returns
    -------
    the values (K,), and the share of white noise's standard deviation that each has (K,), 0 where the channel does not reach

    Example
    -------
    >>> read_at(np.sin(0.1 * np.arange(100)), np.array([50.5]))[0]  # sin(5.05)
    array([-0.9433])
    """
    out, share = np.zeros(places.size), np.zeros(places.size)
    for first in range(0, places.size, TOGETHER):
        part = slice(first, first + TOGETHER)
        out[part], share[part] = _read(values, places[part])
    return out, share


def _read(values: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    whole = np.floor(places).astype(int)
    rest = places - whole
    offsets = np.arange(1 - TAPS, TAPS + 1)
    away = offsets[None, :] - rest[:, None]
    inside = np.clip(1.0 - (away / TAPS) ** 2, 0.0, None)
    taps = np.sinc(away) * np.i0(TAPER * np.sqrt(inside)) / np.i0(TAPER)
    taps /= np.sum(taps, axis=1, keepdims=True)  # a constant stays what it is
    # A place on a sample needs no other, so that the ends are not lost there.
    on_sample = rest < 1e-9
    taps[on_sample] = 0.0
    taps[on_sample, TAPS - 1] = 1.0
    known = (whole >= np.where(on_sample, 0, TAPS - 1)) & (whole < values.size - np.where(on_sample, 0, TAPS))
    index = np.clip(whole[:, None] + offsets[None, :], 0, values.size - 1)
    read = np.sum(taps * values[index], axis=1)
    share = np.sqrt(np.sum(taps**2, axis=1))
    nearest = values[np.clip(np.round(places).astype(int), 0, values.size - 1)]
    return np.where(known, read, nearest), np.where(known, share, 0.0)
