r"""A start for the fit of a drive: weak-form regressions on the torque and on whichever encoders there are.

With an encoder on motor and link the joint cancels from the balance of the whole,
:math:`N \tau = N (J_m \ddot\theta + c_m \dot\theta) + J \ddot y`, which tells both inertias; what is left is a joint on a base
whose motion is measured, :math:`x = \theta / N`, as in `jaxbacklash.regression.equation_error`. In units of its gain, a servo's
torque is what its command is ahead of the motor behind its gear, :math:`u - \theta / N`, less what goes with the motor's speed;
where it was limited the balance of the whole shows that, by how much less it leaves.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..effects import LimitedServo, Motor, Servo
from ..errors import BadInput
from ..records import Record
from ..records.checks import LARGEST
from ..signals import Bump
from .along_motion import smooth
from .equation_error import Start, estimate
from .hidden_side import search_hidden

LIMITED, HELD = 0.1, 1e-3
"""A servo is taken as limited where that leaves less than this share of the balance's misfit, and its torque stays at the limit
for more than this share of the time."""
LEVELS, LAGS = np.linspace(0.3, 0.98, 18), np.geomspace(0.1, 10.0, 13)
"""Limits that are tried, as quantiles of the torque that an unlimited servo would have, and its gains on the speed, as multiples
of that of one."""


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

    Raises
    ------
    BadInput
        The motor does not follow the command.
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
    as_torque = replace(record, channels={"torque": ahead, **seen})
    if not (record.blind or inertias(as_torque)[0] < LARGEST):
        raise BadInput(
            f"{record.path or 'the record'}: the motor does not move as a servo's does that is told this command; wanted the "
            "position of the link in rad, to which one of the motor's shaft is brought by --scale command=1/N, with its sign"
        )
    limit = None if record.blind else limit_of_servo(as_torque)
    if limit is not None:
        lag, most = limit
        ahead = np.clip(ahead - lag * smooth(record.t, seen["motor"])[1], -most, most)
        as_torque = as_torque.replace(torque=ahead)
    motor, joint = start_of_drive(as_torque)
    own, rubs = float(motor.motor_inertia), float(motor.motor_damping)
    gain = 1.0 / own if inertia is None else inertia / joint.inertia
    servo = Servo(gain * own, 0.0, record.ratio, gain, gain * rubs)
    if limit is not None:
        servo = LimitedServo(gain * own, gain * rubs, record.ratio, gain, gain * lag, gain * most)
    stiffness = None if joint.stiffness is None else gain * joint.stiffness
    return servo, replace(joint, inertia=gain * joint.inertia, stiffness=stiffness, damping=gain * joint.damping)


def limit_of_servo(record: Record) -> tuple[float, float] | None:
    """Gain on the motor's speed and largest torque of a servo, in units of its gain on the position; None where no limit shows.

    Parameters
    ----------
    record : of a drive with both encoders, ``torque`` what its command is ahead of the motor behind its gear
    """
    from scipy.optimize import minimize  # a quarter of a second, for which few fits wait

    bump, ahead = Bump(record.samples, record.dt), centred(record.channels["torque"])
    motor, link = record.channels["motor"], record.channels["link"]
    speed = smooth(record.t, motor)[1]
    rest = bump.against(np.stack([np.sign(speed), np.ones(record.samples), link]))  # friction, and loads on the link
    columns = np.stack([bump.against(motor, 1), bump.against(motor, 2), bump.against(link, 2), *rest], axis=1)
    plane = np.linalg.qr(columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300))[0]

    def left(at: np.ndarray) -> float:
        lag, most = np.exp(at)
        made = bump.against(np.clip(ahead - lag * speed, -most, most))
        made = made - plane[:, 0] * (plane[:, 0] @ made)  # what goes with the speed is explained however large it is
        return float(1.0 - np.sum((plane.T @ made) ** 2) / max(float(made @ made), 1e-300))

    lag = inertias(record)[1]
    tried = [
        (left(at), *at)
        for one in lag * LAGS
        for most in np.quantile(np.abs(ahead - one * speed), LEVELS)
        if np.all(np.isfinite(at := np.log([one, max(most, 1e-300)])))
    ]
    within = list(zip(np.min(tried, axis=0)[1:], np.max(tried, axis=0)[1:]))
    found = minimize(left, min(tried)[1:], method="Nelder-Mead", bounds=within, options={"xatol": 1e-4, "fatol": 1e-12})
    lag_found, most = (float(v) for v in np.exp(found.x))
    held = float(np.mean(np.abs(ahead - lag_found * speed) > most))
    free = left(np.log([lag, 2.0 * np.max(np.abs(ahead - lag * speed))]))
    return (lag_found, most) if found.fun < LIMITED * free and held > HELD else None
