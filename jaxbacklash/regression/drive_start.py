r"""A start for the fit of a drive: weak-form regressions on the torque and on whichever encoders there are.

With an encoder on motor and link the joint cancels from the balance of the whole,
:math:`N \tau = N (J_m \ddot\theta + c_m \dot\theta) + J \ddot y`, which tells both inertias; what is left is a joint on a base
whose motion is measured, :math:`x = \theta / N`, as in `jaxbacklash.regression.equation_error`. In units of its gain, a servo's
torque is what its command is ahead of the motor behind its gear.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..effects import Motor, Servo
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


def start_of_drive(record: Record, inertia: float | None = None) -> tuple[Motor, Start]:
    """Where a fit of a drive begins: its motor, and the joint with its link.

    Parameters
    ----------
    record : of a drive with an encoder on motor, on link, or on both
    inertia : of the link [kg m^2], which is the scale of a record of a servo's command; None: there all is per unit inertia of
        the motor
    """
    if record.input_name == "command":
        return _start_of_servo(record, inertia)
    if record.relative is None:
        found = search_hidden(record)
        joint = Start(found.inertia, found.backlash, found.stiffness, found.damping, found.misfit)
        return Motor(found.motor_inertia, found.friction, record.ratio), joint
    motor_inertia, friction, of_link = inertias(record)
    return Motor(motor_inertia, friction, record.ratio), estimate(record.on_its_base(), inertia=of_link)


def _start_of_servo(record: Record, inertia: float | None) -> tuple[Motor, Start]:
    seen = {name: record.channels[name] for name in record.observed_names}
    ahead = record.channels["command"] - seen["motor"] / record.ratio
    motor, joint = start_of_drive(replace(record, channels={"torque": ahead, **seen}))
    own = float(motor.motor_inertia)
    gain = 1.0 / own if inertia is None else inertia / joint.inertia
    servo = Servo(gain * own, 0.0, record.ratio, gain, gain * float(motor.motor_damping))
    stiffness = None if joint.stiffness is None else gain * joint.stiffness
    return servo, replace(joint, inertia=gain * joint.inertia, stiffness=stiffness, damping=gain * joint.damping)
