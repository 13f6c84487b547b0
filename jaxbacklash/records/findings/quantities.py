"""Columns that hold another quantity than the channel they are taken for: counts for radians, an acceleration for a position."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from jaxbacklash.records.finding import ASK, Finding
from jaxbacklash.records.options import ReadOptions

from .local import POSITIONS

COUNTS = 20.0
"""Range of a column of whole numbers from which on it is one of counts: no joint of that many radians or metres is read to 1."""
INERTIAL = re.compile(r"(^|[^a-z])(a|acc|accel\w*|gyro\w*|imu\w*|vib\w*)([^a-z]*[xyz])?($|[^a-z])", re.IGNORECASE)
"""Names under which accelerations and rates of turn are written."""


def quantities(channels: Mapping[str, np.ndarray], options: ReadOptions) -> list[Finding]:
    """Counts taken for radians, and accelerations for positions."""
    found = []
    for name in POSITIONS:
        if name not in channels:
            continue
        values, column = channels[name], options.columns.get(name, name)
        if INERTIAL.search(column):
            what = f'is "{column}", which names an acceleration or a rate of turn, where a position is wanted'
            found.append(Finding("quantity", ASK, name, what))
        if name in options.scales:
            continue
        low, high = values.min(), values.max()
        if high - low >= COUNTS and np.array_equal(values, np.round(values)):
            what = (
                f"holds whole numbers from {low:.0f} to {high:.0f}, counts of an encoder it seems, where radians are wanted (a "
                f"turn over the counts of a turn: 2 pi / 4096 is {2 * np.pi / 4096:.6g})"
            )
            found.append(
                Finding(
                    "counts",
                    ASK,
                    name,
                    what,
                    f"--scale {name}={2 * np.pi / 4096:.6g}",
                    size=float(high - low),
                    otherwise=f"--unit {name}=rad",
                )
            )
    return found
