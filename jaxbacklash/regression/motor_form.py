r"""Weak-form regression on the motor of a drive: which laws at its port the measured motion of both sides speaks for.

The joint cancels from the balance of the whole, :math:`J_m \ddot\theta + c_m \dot\theta - \tau + J \ddot y / N = \ldots`, so that
what is left at the motor's port does not depend on play and stiffness. The torque is the measured one, or what the model's servo
makes of its command along the measured motion. It proposes shapes of laws that feel the motor's angle, as
`jaxbacklash.regression.weak_form` does of those that feel joint or link.
"""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ..compiled import kept_jit
from ..effects.contact import Damper
from ..effects.motor import Motor
from ..mechanics import AbstractEffect
from ..parameters import unravel
from ..records import Record
from ..system import System
from .along_motion import Motion, own_tangents, smooth, torques
from .drive_start import centred
from .weak_form import WeakForm, seeds_of


class MotorForm(WeakForm):
    """A drive with an encoder on motor and link, its balance at the motor averaged under bumps.

    Attributes: ``motion`` of the motor, as that of a link (y is its angle); ``link``, the motion of the link on its base.
    """

    def __init__(self, record: Record) -> None:
        super().__init__(record)
        self.link = self.motion
        angle, still = record.channels["motor"], np.zeros(record.samples)
        self.motion = Motion(record.t, *smooth(record.t, angle), still, still, still)
        # By parts: the bump is even, so that its own first derivative takes the rate off with its sign changed.
        self.bend, self.speed = self.average(angle, 2), -self.average(angle, 1)
        given = centred(record.channels[record.input_name or "torque"])
        # Under the bump what is held counts as its integral does, which samples alone take for larger by a twelfth of its bend.
        self.given = given - np.gradient(np.gradient(given)) / 12.0

    def missing(self, system: System, free: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
        """Missing torque at the motor under the bump (R,), and how it falls with each free parameter of the model (R, q)."""
        assert system.motor is not None
        motor, inertia = system.motor, float(system.inertia)
        held: dict[str, AbstractEffect] = {n: e for n, e in system.effects.items() if e.port == "ground"}
        loads = System(system.inertia, None, Damper(0.0), held, "y")
        of_laws = tuple(n if "." in n else "" for n in free)  # not of the joint, which cancels
        on_link, by_load = torques(loads, seeds_of(loads, of_laws), self.link)
        at_motor, by_motor = self._own(system, free)
        pushed, by_pushed = map(np.asarray, _pushed(motor, seeds_of(motor, free), self.given, self.motion.y, self.motion.dy))
        left = float(motor.motor_inertia) * self.bend + float(motor.motor_damping) * self.speed - self.average(pushed)
        left = left + (inertia * self.acceleration - self.average(on_link)) / float(motor.ratio) - self.average(at_motor)
        by = self.average(by_load / float(motor.ratio) + by_motor + by_pushed)
        told = {"motor_inertia": -self.bend, "motor_damping": -self.speed, "inertia": -self.acceleration / float(motor.ratio)}
        for j, name in enumerate(free):
            by[j] = told.get(name, by[j])
        return left, by.T

    def _own(self, system: System, free: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
        """Torque of the laws at the motor's port along its motion (N,), and how it changes with each free parameter (q, N)."""
        samples = self.motion.t.size
        torque, columns = np.zeros(samples), np.zeros((len(free), samples))
        for name, law in system.effects.items():
            if law.port == "motor":
                mine = tuple(n.removeprefix(f"{name}.") if n.startswith(f"{name}.") else "" for n in free)
                own: Any = own_tangents(law, system, seeds_of(law, mine), self.motion)
                torque, columns = torque + own[0], columns + own[1]
        return torque, columns


@kept_jit
def _pushed(motor: Motor, seeds: Any, given: Any, th: Any, dth: Any) -> tuple[Any, Any]:
    """Torque (N,) that a motor makes of what it is ``given`` (N,) at angle and speed ``th``, ``dth`` (N,), and how it changes
    along ``seeds`` (q, p) of its parameters, (q, N)."""
    vector = jnp.stack([jnp.asarray(leaf, dtype=th.dtype) for leaf in jax.tree.leaves(motor)])

    def made(vector: Any) -> Any:
        return unravel(motor, vector).pushed(given, th, dth) + jnp.zeros_like(th)

    torque, push = jax.linearize(made, vector)
    return torque, jax.vmap(push)(seeds)
