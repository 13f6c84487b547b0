"""The force of a record between its samples."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from functools import lru_cache

import numpy as np

from ..records import Record
from ..signals import edges_between, is_smooth, span, way_between

SAID = {"held": "held from each sample to the next", "curved": "a smooth curve through its samples"}


def way(record: Record) -> str:
    """How a record's force goes on between its samples, one of `jaxbacklash.signals.between.WAYS`.

    Asked of a rough force alone, on a link whose base is at rest and whose motion is seen; all else is straight.
    """
    channels = record.channels
    if "F" not in channels or "x" in channels or record.observed_name == "T":
        return "straight"
    return _way(record.dt, channels["F"].tobytes(), channels[record.observed_name].tobytes())


@lru_cache(maxsize=8)
def _way(dt: float, force: bytes, motion: bytes) -> str:
    push = np.frombuffer(force)
    smooth = is_smooth(dt * np.arange(push.size), push, span(dt))
    return "straight" if smooth else way_between(push, np.frombuffer(motion))


def tell_way(records: Iterable[Record]) -> None:
    """Warn (UserWarning) of each record whose force is not taken as straight between its samples."""
    for record in records:
        if (found := way(record)) != "straight":
            where = f"{record.path}: " if record.path else ""
            warnings.warn(f"{where}the force F is taken as {SAID[found]}, which is how the motion answers to it", stacklevel=3)


def force_edges(record: Record, every: int) -> np.ndarray:
    """The force at ``every`` points a sample, ((N - 1) every + 1,), straight in between; zero where none is in the record."""
    if "F" not in record.channels:
        return np.zeros((record.samples - 1) * every + 1)
    return edges_between(record.channels["F"], every, way(record))
