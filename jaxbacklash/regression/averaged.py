r"""A record's equation of motion averaged under smooth bumps: what every regression on it, its weak form, begins with.

Integration by parts moves the derivatives to the bump, so that no sample is differenced:
:math:`\int \varphi\,\ddot y = \int \ddot\varphi\,y`. The start of a fit (`jaxbacklash.regression.equation_error`) and the look at
which laws are absent (`jaxbacklash.regression.weak_form`) both regress on these rows.
"""

from __future__ import annotations

import numpy as np

from ..records import Record
from ..records.force import force_edges
from ..signals import Bump
from ..signals.bump import HALF_WIDTH


class Averaged:
    """A record under R bumps, a quarter of their half-width apart.

    Parameters
    ----------
    record : of N samples
    half_width : of the bumps [s]; the default is that of `jaxbacklash.signals.Bump`

    Attributes
    ----------
    x, y : (N,) measured motion of base and link [rad or m]; y is the transmitted force where that is what was measured
    acceleration : (R,) second derivative of y under the bumps
    force : (R,) force on the link under the bumps [N m or N]
    spacing : of the rows [s]
    """

    def __init__(self, record: Record, half_width: float = HALF_WIDTH) -> None:
        self._bump = Bump(record.samples, record.dt, half_width)
        self.spacing = self._bump.stride * record.dt
        self.loudness = self._bump.loudness
        self.x = record.channels.get("x", np.zeros(record.samples))
        seen = record.channels[record.observed_name]
        self.y = seen + self.x if record.observed_name == "z" else seen
        self.acceleration = self.average(self.y, 2)
        self.force = self.average(force_edges(record, 1))

    def average(self, values: np.ndarray, derivative: int = 0) -> np.ndarray:
        """One or several signals (..., N), or their first or second derivative, under the bumps (..., R)."""
        return self._bump.against(values, derivative)
