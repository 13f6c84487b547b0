"""How finely a channel was written or counted: below that no noise level can lie, however smooth the values are.

Readings of an encoder are whole numbers of a step; text files carry a fixed number of decimals or of digits. All three are read
off the values, also where degrees or turns were converted to radians after reading.
"""

from __future__ import annotations

import numpy as np

from .remembered import remembered

MOST_DECIMALS, MOST_DIGITS = 12, 12
"""Decimals and digits that are looked for: values with more were hardly written for a person."""
EXACT = 1e-4
"""What a value may be off a whole number of steps by, as a share of a step: conversions of units round a little."""
FEWEST = 30
"""Values different from zero that have to agree on a step: fewer may do so by chance."""
UNITS = (1.0, 180.0 / np.pi, 0.5 / np.pi, 1000.0)
"""Numbers to a radian or metre of the units in which values may have been written: SI, degrees, turns, milli."""
SELDOM = 4
"""Samples to each value that is there at least, or a column is not taken to be counted."""
ROUNDING = 0.02
"""What a reading may be off a whole number of counts by, as a share of a count: rows are written with a few digits."""
UNIFORM = 1.0 / np.sqrt(12.0)
"""Standard deviation of what rounding to a step takes away or adds, as a share of the step."""


@remembered
def rounding_noise(values: np.ndarray) -> float:
    """Standard deviation of the error that writing or counting has left in ``values`` (N,), in their unit.

    Zero where the values show no common number of decimals or digits.
    """
    count = count_of(values)
    counted = 0.0 if count is None else UNIFORM * count
    seen = values[values != 0.0]
    if seen.size < FEWEST:
        return counted
    for unit in UNITS:
        written = max(_decimals(seen * unit), _digits(seen * unit))
        if written > 0.0:
            return max(counted, UNIFORM * written / unit)
    return counted


def count_of(values: np.ndarray) -> float | None:
    """The count of an encoder that made these readings (N,), in their unit; None where they are no whole numbers of any."""
    readings = np.unique(values)
    readings = readings[np.append(True, np.diff(readings) > 1e-9 * np.ptp(readings))]
    if readings.size < 2 or SELDOM * readings.size > values.size:
        return None
    steps = np.diff(readings)
    count = float(np.min(steps))
    # The smallest step by itself may be off by the rounding of what was written down.
    count = float(np.ptp(readings) / np.round(np.ptp(readings) / count))
    off = np.abs(steps / count - np.round(steps / count))
    return count if np.max(off) < ROUNDING else None


def _decimals(values: np.ndarray) -> float:
    """Step of values that were all written with as many decimals; zero where there is none."""
    largest = float(np.max(np.abs(values)))
    few = values[:: max(1, values.size // (4 * FEWEST))]
    for decimals in range(MOST_DECIMALS + 1):
        step = 10.0**-decimals
        if largest < step:  # all of them are nought to so few decimals
            continue
        if largest / step > 10.0**MOST_DIGITS:
            break
        if _whole(few / step) and _whole(values / step):
            return step
    return 0.0


def _digits(values: np.ndarray) -> float:
    """Root mean square of the steps of values that were all written with as many digits; zero where there is none."""
    decade = np.floor(np.log10(np.abs(values)))
    some = slice(None, None, max(1, values.size // (4 * FEWEST)))
    for digits in range(2, MOST_DIGITS + 1):
        step = 10.0 ** (decade - digits + 1)
        if _whole(values[some] / step[some]) and _whole(values / step):
            return float(np.sqrt(np.mean(step**2)))
    return 0.0


def _whole(steps: np.ndarray) -> bool:
    nearest = np.round(steps)
    return bool(np.all(np.abs(steps - nearest) < EXACT + 1e-15 * np.abs(nearest)))
