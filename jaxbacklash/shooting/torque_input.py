"""The input of a drive: torque that a controller holds from one sample to the next, read with noise.

It is a spline of degree 0 with a coefficient for each sample, where base motion is one of degree 5 with a few
(`jaxbacklash.shooting.windows`): the torque's noise is carried through the model in the same way.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..records import Record
from ..signals import noise_level, noise_of_differences, rounding_noise

Array = Any
LEAST_NOISE = 1e-4
"""Noise of a torque, as a share of its size, below which it is not taken: no current sensor is as good as that."""


def held_basis(length: int, every: int) -> Array:
    """How each of ``length`` samples shows at the panel edges, ``every`` panels a sample: (6, P + 1, length), as `Windows.basis`.

    A panel takes what is held at its left edge.
    """
    basis = np.zeros((6, length * every + 1, length))
    at = np.arange(length * every)
    basis[0, at, at // every] = 1.0
    return basis


def channel_noise(record: Record, name: str) -> float:
    """Standard deviation of the noise of an encoder of a drive [rad]: what no smooth curve follows, at least its counts."""
    return noise_level(record.t, record.channels[name])


def torque_noise(record: Record) -> float:
    """Standard deviation of the noise of the torque of a drive, before a model is known [N m].

    A controller's output need not be smooth, so that this is a bound from above; a fit tells more (`jaxbacklash.fitting`).
    """
    torque = record.channels["torque"]
    rough = min(noise_of_differences(torque), noise_level(record.t, torque))
    return max(rough, rounding_noise(torque), LEAST_NOISE * float(np.std(torque)))
