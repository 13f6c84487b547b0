"""How well the joint's equation of motion holds on a record, by the weak form: cheap, and good from any distance."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..errors import BadInput, NoAnswer
from ..mechanics import AbstractEffect
from ..records import Record
from ..regression.equation_error import Start, estimate

MOST = 2500
"""Samples of a record that the weak form is asked on, for speed."""

PLAYS = 16
"""Sizes of the play that it tries: enough to tell a wrong record from a right one."""


def part_of(record: Record) -> Record:
    """The stretch of a record where the measured channel moves most."""
    if record.samples <= MOST:
        return record
    moved = np.cumsum(np.concatenate([[0.0], np.abs(np.diff(record.channels[record.observed_name]))]))
    first = int(np.argmax(moved[MOST - 1 :] - moved[: 1 - MOST]))
    return record.between(record.t[first], record.t[first + MOST - 1])


def misfit(record: Record, inertia: float | None, play: bool, spring: bool, effects: Sequence[AbstractEffect]) -> Start | None:
    """The weak-form estimate of a record, whose ``misfit`` is the share that it leaves; None for a record that has none."""
    try:
        with np.errstate(all="ignore"):
            return estimate(record, inertia=inertia, play=play, spring=spring, effects=effects, plays=PLAYS)
    except (BadInput, NoAnswer, np.linalg.LinAlgError, ValueError):
        return None
