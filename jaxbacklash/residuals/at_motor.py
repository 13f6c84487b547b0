r"""The torque that is missing at the motor of a drive, apart from that on its link.

What `jaxbacklash.residuals.latent` finds acts on the link, whose base the motor moves as it was measured. Here the balance of the
whole, from which the joint cancels (`jaxbacklash.regression.motor_form`), is set against what the noise of torque and encoders
would leave of it. `where_it_fails` tells both.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import equinox as eqx
import numpy as np

from ..effects import LimitedServo, Motor, Servo
from ..records import Record
from ..regression.along_motion import smooth
from ..regression.motor_form import MotorForm
from ..shooting.torque_input import channel_noise, torque_noise
from ..system import System

EVIDENT = 1.3
"""How many times what noise leaves has to be left for a torque to be missing: of fifty random rigs that lacked nothing, with fine
and with coarse encoders, the largest left 1.14 times of it."""
MOSTLY = 0.5
"""Share of a torque from which on what it goes with is told."""


@dataclass(frozen=True)
class AtMotor:
    """A torque missing at the motor's port: ``rms`` and what ``noise`` would leave of it [``unit``]; ``by_direction``, the share
    of its variance that goes with the direction in which the motor turns; where it was averaged over a tenth of a second, the
    ``torque`` (R,) at times ``t`` (R,) [s] and the part of it that ``goes`` (R,) with the direction."""

    rms: float
    noise: float
    by_direction: float
    unit: str = "N m"
    t: np.ndarray | None = field(default=None, repr=False, compare=False)
    torque: np.ndarray | None = field(default=None, repr=False, compare=False)
    goes: np.ndarray | None = field(default=None, repr=False, compare=False)

    @property
    def evident(self) -> bool:
        """Whether it is more than noise."""
        return self.rms > EVIDENT * self.noise

    def __str__(self) -> str:
        goes = f"; {100 * self.by_direction:.0f} % of it goes with the direction in which the motor turns, as dry friction does"
        return f"At the motor a torque of {self.rms:.3g} {self.unit} rms is missing{goes if self.by_direction > MOSTLY else ''}."


def missing_at_motor(system: System, free: tuple[str, ...], record: Record, unit: str = "N m") -> AtMotor | None:
    """What is missing at the motor of a fitted drive, on average over a tenth of a second; None where there is no motor, or where
    one side has no encoder.

    Parameters
    ----------
    system : as it was fitted
    free : the parameters that were
    record : of the drive
    unit : of its torques

    Examples
    --------
    >>> found = missing_at_motor(fit.system, fit.free, fit.records[0])  # doctest: +SKIP
    >>> print(found)  # doctest: +SKIP
    At the motor a torque of 0.0543 N m rms is missing; 99 % of it goes with the direction in which the motor turns, ...
    """
    motor = system.motor
    if motor is None or record.blind:
        return None
    form = MotorForm(record)
    left, by = form.missing(system, free)
    rest = left - by @ np.linalg.lstsq(by, left, rcond=None)[0]
    direction = form.average(np.sign(form.motion.dy))
    apart = direction - by @ np.linalg.lstsq(by, direction, rcond=None)[0]
    energy = float(rest @ rest)
    share = float(rest @ apart) ** 2 / max(float(apart @ apart) * energy, 1e-300)
    goes = apart * float(rest @ apart) / max(float(apart @ apart), 1e-300)
    whole = float(form.average(np.ones(record.samples))[0])
    of_link = float(system.inertia) / float(motor.ratio) * channel_noise(record, "link")
    counts = channel_noise(record, "motor")
    of_motor = float(motor.motor_inertia) * counts
    if isinstance(motor, Servo):  # its torque is made of the motor's angle and speed
        of_torque = counts * np.hypot(float(motor.Kp) / float(motor.ratio) * form.loudness(0), float(motor.Kd) * form.loudness(1))
    else:
        of_torque = torque_noise(record) * form.loudness(0)
    noise = np.hypot(of_torque, np.hypot(of_link, of_motor) * form.loudness(2))
    told = form.average(record.t) / whole, rest / whole, goes / whole
    return AtMotor(float(np.sqrt(energy / rest.size)) / whole, float(noise) / whole, share, unit, *told)


def as_pushed(system: System, free: Iterable[str], record: Record) -> tuple[System, tuple[str, ...], Record]:
    """A fitted drive, its free parameters and its record, a servo's command as the torque that it has made of it.

    What the servo makes of the error is the torque, and its gain on the speed the viscous friction of a motor that is pushed by
    it; a limited one makes both. A drive whose torque was measured stays as it is.
    """
    servo = system.motor
    if not isinstance(servo, Servo):
        return system, tuple(free), record
    # The command is held from one sample to the next, the motor moves on meanwhile.
    angle, speed = (0.5 * (v + np.append(v[1:], v[-1])) for v in smooth(record.t, record.channels["motor"]))
    limited = isinstance(servo, LimitedServo)
    maker = servo if limited else replace(servo, Kd=0.0)
    torque = np.asarray(maker.pushed(record.channels["command"], angle, speed))
    rubs = servo.motor_damping if limited else servo.Kd
    pushed = eqx.tree_at(lambda s: s.motor, system, Motor(servo.motor_inertia, rubs, servo.ratio))
    own = [n for n in free if n not in ("motor_inertia", "motor_damping", "Kp", "Kd", "tmax")]
    seen = {name: record.channels[name] for name in record.observed_names}
    return pushed, (*own, "motor_damping"), replace(record, channels={"torque": torque, **seen})
