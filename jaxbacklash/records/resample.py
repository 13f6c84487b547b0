"""Uneven times made even, and rates changed: only on request, since it makes up values between the samples."""

import math

import numpy as np

from . import time_axis
from .checks import number, wrong

LONGEST_GAP_STEPS = 5
MOST_UPSAMPLING = 10


def resampled(
    t: np.ndarray, columns: dict[str, np.ndarray], rate: float | None, where: str
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Columns on an even grid.

    Between samples a cubic spline is followed: it passes through every sample and, unlike PCHIP, does not flatten the
    crests. Where the rate falls, the columns are first freed, without delay, of what the new rate cannot show
    (Chebyshev type II, 80 dB down from half the new rate on).

    Parameters
    ----------
    t : array of shape (N,), s, strictly increasing
    columns : dict of arrays of shape (N,)
        A column of text or with NaN takes the value of the nearest sample instead.
    rate : float or None
        Samples per second wanted, Hz; None keeps even times as they are and takes the median rate otherwise.
    where : str
        The file, for the sentence.

    Returns
    -------
    t : array of shape (M,), s
    columns : dict of arrays of shape (M,)

    Raises
    ------
    BadInput
        When a gap is longer than five median steps, or the rate is not positive or over ten times that of the record.
    """
    if rate is not None and not (math.isfinite(rate) and rate > 0):
        raise wrong(where, f"a rate of {number(rate)} Hz to resample to", "a positive number")
    old = time_axis.uniform_grid(t)
    if old is None:
        no_long_gap(t, where)
        old_rate = 1 / float(np.median(np.diff(t)))
        even = _grid(t, old_rate)
        columns = {name: _interpolated(t, values, even) for name, values in columns.items()}
        old = even
    old_rate = (old.size - 1) / (old[-1] - old[0])
    if rate is None or math.isclose(rate, old_rate, rel_tol=1e-9):
        return old, columns
    if rate > MOST_UPSAMPLING * old_rate:
        wanted = f"at most {MOST_UPSAMPLING} times the {number(old_rate)} Hz of the record"
        raise wrong(where, f"a rate of {number(rate)} Hz to resample to", wanted)
    if rate < old_rate:
        columns = {name: _low_passed(values, rate / old_rate) for name, values in columns.items()}
    new = _grid(old, rate)
    return new, {name: _interpolated(old, values, new) for name, values in columns.items()}


def no_long_gap(t: np.ndarray, where: str) -> None:
    """Refuse gaps that no interpolation bridges honestly."""
    steps = np.diff(t)
    usual = float(np.median(steps))
    long = np.flatnonzero(steps > LONGEST_GAP_STEPS * usual * (1 + time_axis.RELATIVE))
    if long.size:
        row = long[0]
        found = f"a gap of {number(steps[row])} s between rows {row + 1} and {row + 2}"
        wanted = f"none over {LONGEST_GAP_STEPS} median steps of {number(usual)} s, even with --resample"
        raise wrong(f"{where}, column t", found, wanted)


def _grid(t: np.ndarray, rate: float) -> np.ndarray:
    """Even times from the first sample up to the last."""
    return t[0] + np.arange(math.floor((t[-1] - t[0]) * rate * (1 + 1e-12) + 1e-6) + 1) / rate


def _smooth(values: np.ndarray) -> bool:
    """Whether a column can be filtered and interpolated."""
    return values.dtype.kind == "f" and bool(np.isfinite(values).all())


def _interpolated(t: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Values of a column at other times within those of the samples."""
    if _smooth(values):
        from scipy import interpolate  # a sixth of a second to import, and few records need it

        return interpolate.CubicSpline(t, values)(at)
    after = np.clip(np.searchsorted(t, at), 1, t.size - 1)
    return values[np.where(at - t[after - 1] < t[after] - at, after - 1, after)]


def _low_passed(values: np.ndarray, share: float) -> np.ndarray:
    """A column without what lies above half the new rate; `share` is the new rate over the old."""
    if not _smooth(values):
        return values
    from scipy import signal  # half a second to import, and few records need it

    sections = signal.cheby2(12, 40, share, output="sos")
    # Run both ways, so the channels keep their phase; the ends are continued for some periods of the cutoff.
    return signal.sosfiltfilt(sections, values, padlen=min(values.size - 1, math.ceil(20 / share)))
