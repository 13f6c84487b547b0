"""Fewer points that look the same: long records drawn fast without losing a peak."""

from __future__ import annotations

from typing import Any

import numpy as np


def envelope(t: Any, y: Any, bins: int = 1200) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Smallest and largest value in each of ``bins`` stretches of equal sample count.

    Parameters
    ----------
    t, y : (N,) time [s] and any channel; NaN samples are passed over
    bins : stretches wanted; a record of fewer than twice as many samples is returned as it is

    Returns
    -------
    time of each stretch, its minimum and its maximum, (M,) each; NaN where a stretch holds nothing
    """
    t, y = np.asarray(t, float), np.asarray(y, float)
    if t.size < 2 * bins:
        return t, y, y
    each = -(-t.size // bins)
    spare = -t.size % each
    wide = np.pad(y, (0, spare), constant_values=np.nan).reshape(-1, each)
    times = np.pad(t, (0, spare), mode="edge").reshape(-1, each)
    blank = np.all(np.isnan(wide), axis=1)
    low = np.where(blank, np.nan, np.min(np.where(np.isnan(wide), np.inf, wide), axis=1))
    high = np.where(blank, np.nan, np.max(np.where(np.isnan(wide), -np.inf, wide), axis=1))
    return 0.5 * (times[:, 0] + times[:, -1]), low, high


def extremes(channels: list[np.ndarray], limit: int) -> np.ndarray:
    """Indices of at most ``limit`` samples that keep every channel's peaks and every break (NaN).

    Parameters
    ----------
    channels : arrays (N,) that are drawn against the same time
    limit : how many samples may stay

    Returns
    -------
    ascending indices (M,); all of them when the record is short enough
    """
    samples = channels[0].size if channels else 0
    if samples <= limit:
        return np.arange(samples)
    per_stretch = 3 * len(channels)  # a minimum, a maximum and a break of each
    each = -(-samples // max(1, (limit - 2) // per_stretch))
    spare = -samples % each
    start = np.arange(0, samples + spare, each)
    kept = [np.array([0, samples - 1])]
    for channel in channels:
        wide = np.pad(np.asarray(channel, float), (0, spare), mode="edge").reshape(-1, each)
        gone = np.isnan(wide)
        kept.append(start + np.argmin(np.where(gone, np.inf, wide), axis=1))
        kept.append(start + np.argmax(np.where(gone, -np.inf, wide), axis=1))
        holed = np.any(gone, axis=1)
        kept.append(start[holed] + np.argmax(gone[holed], axis=1))
    return np.unique(np.minimum(np.concatenate(kept), samples - 1))


def strided(samples: int, limit: int) -> slice:
    """Every n-th sample so that at most ``limit`` of ``samples`` stay."""
    return slice(None, None, max(1, -(-samples // limit)))
