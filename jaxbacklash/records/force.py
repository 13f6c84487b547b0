"""The force of a record between its samples: one rule, which every command asks."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Sequence
from functools import lru_cache

import numpy as np

from ..signals import edges_between, is_smooth, span, way_between
from .record import Record

BETWEEN = ("smooth", "straight", "held", "curved")
"""How a force may go on: along the spline that smooths its samples; or, where none does, as `signals.between` says."""
SAID = {"held": "held from each sample to the next", "curved": "a smooth curve through its samples"}


def way(record: Record, said: str | None = None) -> str:
    """How a record's force goes on between its samples, one of `BETWEEN`.

    Parameters
    ----------
    record : what was measured. A force that far fewer spline coefficients than samples follow is smooth. Of a rough one on a link
        whose base is at rest and whose motion is seen, that motion tells; all else is straight
    said : what a model says of its rig, which counts for a rough force
    """
    channels = record.channels
    if "F" not in channels or "x" in channels or record.observed_name == "T":
        return "straight"
    if _smooth(record.dt, channels["F"].tobytes()):
        return "smooth"
    if said in BETWEEN and said != "smooth":
        return said
    return _rough(channels["F"].tobytes(), channels[record.observed_name].tobytes())


@lru_cache(maxsize=8)
def _smooth(dt: float, force: bytes) -> bool:
    push = np.frombuffer(force)
    return is_smooth(dt * np.arange(push.size), push, span(dt))


@lru_cache(maxsize=8)
def _rough(force: bytes, motion: bytes) -> str:
    return way_between(np.frombuffer(force), np.frombuffer(motion))


def tell_way(records: Iterable[Record]) -> None:
    """Warn (UserWarning) of each record whose rough force is not taken as straight between its samples."""
    for record in records:
        if (found := way(record)) in SAID:
            where = f"{record.path}: " if record.path else ""
            warnings.warn(f"{where}the force F is taken as {SAID[found]}, which is how the motion answers to it", stacklevel=3)


def between(records: Sequence[Record]) -> str | None:
    """What a model fitted to these records says of its rig, one of `BETWEEN`: smooth if all are; None without a force."""
    found = [way(record) for record in records if "F" in record.channels]
    return next((one for one in found if one != "smooth"), "smooth") if found else None


def force_edges(record: Record, every: int) -> np.ndarray:
    """The force at ``every`` points a sample, ((N - 1) every + 1,), straight in between; zero where none is in the record.

    Of a smooth force, which is fitted along a spline of its own, these are the samples and their straight lines.
    """
    if "F" not in record.channels:
        return np.zeros((record.samples - 1) * every + 1)
    found = way(record)
    return edges_between(record.channels["F"], every, "straight" if found == "smooth" else found)
