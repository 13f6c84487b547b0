"""Whether a record is a slow one, as `fit` and `look` ask of any record: a quick look first, and the reading where that is
passed."""

from __future__ import annotations

import warnings

import numpy as np

from ..errors import BadInput
from ..records import Record
from .angle import Curve
from .crossing import thinned
from .estimate import SIGNS, lost_motion
from .result import LostMotion

BY_DIRECTION = 0.4
"""Share of z's variance, beside a curve over x, that the direction of x has to explain before a record is read as a slow one."""


def slow_reading(record: Record, *, translational: bool = False) -> LostMotion | None:
    """The play of a record that is slow, None for any other.

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> slow_reading(record) is None
    True
    """
    if not _looks_slow(record):
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            found = lost_motion(record, translational=translational)
        except BadInput:
            return None
    return found if found.applies else None


def _looks_slow(record: Record) -> bool:
    """A least squares of z on the direction of x; a force of a few values; a torque beside z alone."""
    channels = record.channels
    if record.kind == "force":
        return np.unique(channels["F"]).size <= SIGNS
    if record.kind != "base_motion":
        return "T" in channels and "z" in channels
    x = channels["x"]
    z = channels["z"] if "z" in channels else channels["y"] - x
    x, z = thinned(x, 4000), thinned(z, 4000)
    direction = np.sign(np.gradient(np.convolve(x, np.ones(5) / 5.0, "same")))
    curve = Curve(float(x.min()), float(x.max()), 12, ()).rows(x)
    plain, both = (_left(rows, z) for rows in (curve, np.column_stack([curve, direction])))
    return both < (1.0 - BY_DIRECTION) * plain


def _left(rows: np.ndarray, values: np.ndarray) -> float:
    found, *_ = np.linalg.lstsq(rows, values, rcond=None)
    return float(np.mean((values - rows @ found) ** 2))


def why_not(found: LostMotion) -> str:
    """Why a fit tells neither play nor stiffness of such a record."""
    b = found.parameters["backlash"]
    return f"the record is slow, so that no stiffness shows; its play, {b.value:.4g} {b.unit}, is read by jaxbacklash lost-motion"


def said_of(found: LostMotion) -> str:
    """What a fit says of such a record in place of the parameters that it cannot tell."""
    b = found.parameters["backlash"]
    assert b.value is not None
    assert b.ci95 is not None
    by = {"carried": "the direction of the motion", "pulled": "the sign of the force", "loop": "the torque"}[found.way]
    return (
        f"the record is slow: z is at one edge of its play or the other by {by}, and nothing swings, so that no stiffness shows; "
        f"its play is read without dynamics, {b.value:.4g} {b.unit} ({b.ci95[0]:.4g} to {b.ci95[1]:.4g})"
    )
