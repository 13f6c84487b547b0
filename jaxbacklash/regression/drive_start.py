r"""A start for the fit of a drive: weak-form regressions on the torque and on whichever encoders there are.

With an encoder on motor and link the joint cancels from the balance of the whole,
:math:`N \tau = N (J_m \ddot\theta + c_m \dot\theta) + J \ddot y`, which tells both inertias; what is left is a joint on a base
whose motion is measured, :math:`x = \theta / N`, as in `jaxbacklash.regression.equation_error`.
"""

from __future__ import annotations

import numpy as np

from ..records import Record
from ..signals import Bump
from .equation_error import Start, estimate
from .hidden_side import search_hidden


def inertias(record: Record) -> tuple[float, float, float]:
    """Inertia [kg m^2] and viscous friction [N m s/rad] of the motor at its shaft, and inertia of the link [kg m^2].

    Both encoders are there. Least squares on the balance of the whole under bumps that carry the derivatives.
    """
    bump = Bump(record.samples, record.dt)
    motor, link = record.channels["motor"], record.channels["link"]
    # What is held from one sample to the next is, on average, half a sample late.
    torque = bump.against(centred(record.channels["torque"]), 0)
    columns = np.stack([bump.against(motor, 2), -bump.against(motor, 1), bump.against(link, 2) / record.ratio], axis=1)
    scale = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    found = np.linalg.lstsq(columns / scale, torque, rcond=None)[0] / scale
    whole = float(torque @ torque) / max(float(columns[:, 0] @ torque), 1e-300)
    motor_inertia, friction, inertia = (float(v) for v in found)
    if not (motor_inertia > 0.0 and inertia > 0.0):  # one of the two hides behind the other: half each
        motor_inertia, inertia = 0.5 * abs(whole), 0.5 * abs(whole) * record.ratio**2
    return motor_inertia, max(friction, 1e-3 * motor_inertia), inertia


def centred(held: np.ndarray) -> np.ndarray:
    """A held series (N,) as it is on average around each sample."""
    return 0.5 * (held + np.concatenate([held[:1], held[:-1]]))


def start_of_drive(record: Record) -> tuple[tuple[float, float], Start]:
    """Where a fit of a drive begins: inertia and friction of its motor, and the joint with its link.

    Parameters
    ----------
    record : of a drive with an encoder on motor, on link, or on both
    """
    if record.relative is None:
        found = search_hidden(record)
        joint = Start(found.inertia, found.backlash, found.stiffness, found.damping, found.misfit)
        return (found.motor_inertia, found.friction), joint
    motor_inertia, friction, inertia = inertias(record)
    return (motor_inertia, friction), estimate(record.on_its_base(), inertia=inertia)
