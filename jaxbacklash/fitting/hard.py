r"""A contact that is over before the next sample: a start that a search from the samples does not find.

Where the link stays in contact for less than two samples, it looks as if it turned round at once at the edges of the play. The
regression of the equation of motion then finds a soft contact in a play that is too small, and no search leads from there to the
hard one. The play is the range of z; of the contact the record tells only that it is harder than the sampling can show.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..parameters import values, with_values
from ..records import Record
from ..system import System
from .settings import SHORTEST, TAIL


def contact_samples(system: System, dt: float) -> float:
    r"""Samples (spacing ``dt`` [s]) in a contact: :math:`\pi \sqrt{J/k}` is half a period, J of what swings; else infinite."""
    if system.contact is None:
        return np.inf
    stiffness = float(system.contact.stiffness)
    return float(np.pi * np.sqrt(float(system.reduced_inertia) / stiffness) / dt) if stiffness > 0.0 else np.inf


def reach_of_sampling(system: System, dt: float) -> float:
    """Contact stiffness whose contacts last `SHORTEST` samples: the record does not tell a harder one."""
    return float(system.reduced_inertia) * (np.pi / (SHORTEST * dt)) ** 2


def harder(system: System, records: Sequence[Record]) -> System:
    """The system to start from with the range of z as the play and contacts of less than a sample."""
    record = records[0]
    dt, z = record.dt, _relative(record)
    low, high = _range(z)
    mass, found = float(system.inertia), values(system)
    damping = min(found["damping"], 0.5 * mass / dt / z.size)  # what a long flight tells, the search finds
    stiffness = mass * (4.0 * np.pi / (SHORTEST * dt)) ** 2
    return with_values(system, {"backlash": float(high - low), "stiffness": stiffness, "damping": damping})


def most_play(record: Record) -> float:
    """What the play is at most, where contacts lie between the samples: the range of z, in its unit."""
    low, high = _range(_relative(record))
    return float(high - low)


def travel_in_contact(system: System, record: Record) -> float:
    """How far the link travels at its usual speed in the time of a contact, in the unit of z: by so much the play is open where
    the stiffness is, since a softer contact and a smaller play turn the link round at the same moments."""
    z = _relative(record)
    lag = round(2.0 * SHORTEST)  # noise is little of the travel in so many samples
    return contact_samples(system, record.dt) * float(np.sqrt(np.mean((z[lag:] - z[:-lag]) ** 2))) / lag


def _relative(record: Record) -> np.ndarray:
    assert record.relative is not None
    return record.relative


def _range(z: np.ndarray) -> np.ndarray:
    return np.asarray(np.quantile(z, [TAIL, 1.0 - TAIL]))
