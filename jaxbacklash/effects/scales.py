"""The scales of a joint and of a record, from which laws whose shape does not show at their null value begin.

A shape that begins at so many hertz or rad/s begins well at one joint only, and somewhere else in other units.
"""

from __future__ import annotations

from typing import Any

import numpy as np

LABORATORY = 2.0 * np.pi * 10.0
"""Angular frequency [rad/s] where neither the joint nor the record tells one: a joint of the source paper's size."""
FURTHEST, RUNGS = 120.0, 32
"""Order of a ripple up to which it is looked for where the link swings by less than 0.4 rad, and how many are tried."""


def natural_frequency(system: Any) -> float:
    """Angular frequency of the link in contact, sqrt(k / J) [rad/s]."""
    stiffness = 0.0 if system.contact is None else float(system.contact.stiffness)
    omega = float(np.sqrt(stiffness / max(float(system.inertia), 1e-300)))
    return omega if np.isfinite(omega) and omega > 0.0 else LABORATORY


def presliding(system: Any) -> tuple[float, ...]:
    """Distances [rad] over which friction may give before it slips, in a joint like this one: parts of the play."""
    if system.has_play:
        return tuple(share * float(system.contact.backlash) for share in (0.08, 0.02, 0.3))
    return 1e-3, 3e-3


def sliding_speeds(motion: Any | None) -> tuple[float, ...]:
    """Speeds [rad/s] over which dry friction may fall, the likeliest first: parts of the joint's speed in a record."""
    typical = 1.0 if motion is None else float(np.sqrt(np.mean((motion.dy - motion.dx) ** 2)))
    return tuple(share * (typical if typical > 0.0 else 1.0) for share in (0.1, 0.03, 0.3))


def swing(motion: Any | None) -> float:
    """A typical size of the link's motion [rad]: its standard deviation in a record."""
    typical = 0.1 if motion is None else float(np.std(motion.y))
    return typical if typical > 0.0 else 0.1


def pressed(system: Any, motion: Any | None) -> float:
    """A round length near which a contact is pressed in [rad]: by a record's motion, else as much as half the play."""
    half = 0.5 * float(system.contact.backlash) if system.has_play else 0.0
    deep = 0.0
    if motion is not None:
        deflection = np.maximum(np.abs(motion.y - motion.x) - half, 0.0)
        deep = float(np.sqrt(np.sum(deflection**2) / max(np.count_nonzero(deflection), 1)))
    typical = deep if deep > 0.0 else half if half > 0.0 else 0.01
    return float(f"{typical:.0e}")


def orders(motion: Any | None, least: float, over: str = "y") -> np.ndarray:
    """Orders N of what repeats N times a turn of the link, or of the base for ``over`` "x", from ``least`` on: as far as
    `FURTHEST`, or as far as neighbours can be whose phases over the swing differ by little enough for each of them to be found
    from one."""
    swing = 0.0 if motion is None else 0.5 * float(np.subtract(*np.quantile(getattr(motion, over), (0.98, 0.02))))
    spacing = min((FURTHEST - least) / RUNGS, 1.5 / swing if swing > 0.0 else np.inf)
    return least + spacing * np.arange(RUNGS)
