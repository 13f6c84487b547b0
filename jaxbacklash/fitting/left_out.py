"""How much a model leaves out, of a fit by continuation: as misfit of one trajectory, whether there is one or not.

A model that leaves out a torque has windows that do not join, and misses little inside them. What it leaves out shows in its
evidence, which is below that of a trajectory with noise alone.
"""

from __future__ import annotations

import math

import numpy as np

from ..shooting.information import freedom
from ..shooting.levenberg import Levenberg, Minimum, minimise
from .continuation import Continued, log_evidence, tied
from .settings import NEAR_NOISE, SURE, TIGHTEST


def excess(found: Continued) -> float:
    """By how much minus twice the log evidence of a fit is above that of one trajectory that leaves noise alone.

    Such a one would have half a unit of cost for each degree of freedom, and the log-determinants of this model's windows.
    """
    count = freedom(found.problem, tied=True)
    if found.tie >= TIGHTEST:
        return 2.0 * float(np.nan_to_num(found.minimum.stats["cost"], nan=np.inf)) - count
    tight = tied(found.problem, TIGHTEST)
    seen = minimise(tight, found.minimum.value, Levenberg(limit=1))
    stats = {**seen.stats, "cost": np.asarray(0.5 * count)}
    height = log_evidence(tight, Minimum(seen.value, stats))
    # Windows through which no trajectory can be run tell nothing of one: that is no model which leaves nothing.
    return 2.0 * (height - found.log_evidence) if np.isfinite(height) else np.inf


def misfit(found: Continued) -> float:
    """Root of the reduced chi-square of one trajectory, or of what would leave as much as this model leaves out."""
    return math.sqrt(max(1.0 + excess(found) / freedom(found.problem, tied=True), 0.0))


def most_of_noise(freedom: float, sigmas: float = SURE) -> float:
    r"""The largest root of the reduced chi-square that noise may leave: its standard deviation is :math:`1/\sqrt{2\nu}`, with
    :math:`\nu` degrees of freedom."""
    return NEAR_NOISE + sigmas / math.sqrt(2.0 * max(freedom, 1.0))
