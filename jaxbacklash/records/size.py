"""Is a record too large for a fit? Then a rate is proposed that its motion still fits into.

Every sample is simulated over and over, and what a search keeps of it fills the memory. A logger that runs at tens of kilohertz
says no more of a joint that moves at ten hertz than every fiftieth sample does.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from ..errors import BadInput
from ..signals import highest_frequency
from .record import Record

MOST_SAMPLES = 400_000
"""Samples of all records that are fitted together, at most: a fit to so many takes minutes on two cores, and gigabytes."""
SAMPLES_A_PERIOD = 20
"""Samples to a period of the fastest motion in the proposed rate: a contact, which begins and ends in one, shows in several."""
POWER = 0.99
"""Share of the power of the speed that is the motion's own: what is above is noise."""
LOOKED_AT = 200_000
"""Samples at which the motion's frequency is looked for."""
SLOWEST = 100.0
"""Rate [Hz] below which none is proposed: a slow motion has fast contacts."""


def check_size(records: Iterable[Record]) -> None:
    """Refuse records too large to fit, and propose what to do.

    Raises
    ------
    BadInput
        With the rate that the motion needs, where that is clearly below the record's; else with a part of the record.
    """
    chosen = tuple(records)
    total = sum(r.samples for r in chosen)
    if total <= MOST_SAMPLES:
        return
    largest = max(chosen, key=lambda r: r.samples)
    rate = largest.rate_hz
    wanted = max(needed_rate(r) for r in chosen)
    found = f"{largest.path or 'the record'}: has {largest.samples} samples at {rate:.6g} Hz, of which a fit takes {MOST_SAMPLES}"
    share = min(1.0, wanted / rate)
    if share <= 0.5 and share * total <= MOST_SAMPLES:
        raise BadInput(f"{found}; the motion needs {wanted:.6g} Hz: add --resample-rate {wanted:.6g}")
    stop = largest.t[0] + 0.9 * MOST_SAMPLES / len(chosen) / rate
    raise BadInput(f"{found}, and the motion needs that rate; fit a part of it: add --to {stop:.6g}")


def needed_rate(record: Record) -> float:
    """Rate [Hz] that the motion of a record needs: 1, 2 or 5 times a power of ten."""
    return rate_for(record.channels[record.observed_name], record.dt)


def rate_for(values: np.ndarray, dt: float) -> float:
    """Rate [Hz] that the motion of a series (N,), sampled every ``dt`` [s], needs: 1, 2 or 5 times a power of ten."""
    fastest = highest_frequency(values[:LOOKED_AT], dt, POWER)
    wanted = max(SAMPLES_A_PERIOD * fastest, SLOWEST)
    decade = 10.0 ** math.floor(math.log10(wanted) + 1e-9)
    return float(next(decade * step for step in (1, 2, 5, 10) if decade * step >= wanted * (1.0 - 1e-9)))
