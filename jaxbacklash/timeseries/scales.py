"""The time scales of a series: how long it remembers, and how long one swing takes."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import uniform_filter1d


def autocorrelation(series: np.ndarray, lags: int) -> np.ndarray:
    """Autocorrelation at lags 0 ... ``lags`` of a series (N,), shape (lags + 1,)."""
    centred = series - series.mean()
    size = 1 << int(np.ceil(np.log2(2 * series.size)))
    power = np.abs(np.fft.rfft(centred, size)) ** 2
    found = np.fft.irfft(power, size)[: lags + 1]
    return found / found[0]


def mean_period(series: np.ndarray) -> float:
    """Samples of one swing: mean time between peaks that stand out by a third of the standard deviation.

    Noise is smoothed away first, over a quarter of the correlation time.

    Parameters
    ----------
    series : (N,)

    Returns
    -------
    samples; the length of the series where it has fewer than three peaks
    """
    from scipy.signal import find_peaks  # half a second to import

    first = correlation_time(series)
    smooth = uniform_filter1d(series, max(1, first // 4)) if first > 2 else series
    peaks = find_peaks(smooth, prominence=float(np.std(smooth)) / 3.0)[0]
    return float((peaks[-1] - peaks[0]) / (peaks.size - 1)) if peaks.size >= 3 else float(series.size)


def correlation_time(series: np.ndarray) -> int:
    """First lag at which the autocorrelation has fallen below 1/e; a tenth of the series where it never does."""
    lags = max(2, series.size // 10)
    below = np.flatnonzero(autocorrelation(series, lags) < np.exp(-1.0))
    return int(below[0]) if below.size else lags
