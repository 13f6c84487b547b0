r"""MJCF, the model files of MuJoCo: motor and link are bodies on hinges, the joint is a tendon whose length is z.

A fixed tendon with the coefficients 1 at the link and :math:`-1/N` at the motor has the length :math:`z = y - \theta / N`. Its
spring has a dead band where ``springlength`` is a range, and its damper always acts: :math:`T = k \delta(z) + c \dot z`. Dry
friction is MuJoCo's ``frictionloss``, as hard as the time step allows: it creeps a little where that of the model holds.

Source: MuJoCo's XML reference, tendon/fixed and springlength.
"""

from __future__ import annotations

import math

from ..parameters import values
from ..system import System
from .numbers import edges, number

LAWS = ("asymmetric_gap", "coulomb_ground", "coulomb_joint", "coulomb_motor", "gap_spring", "gravity", "preload")
"""Laws that have a place in MJCF."""
EARTH = 9.81
"""Acceleration along -x [m/s^2]; the weight of the link is its mass times that."""
LIGHT = 0.1
"""Share of the link's inertia that comes from the mass that stands for its weight, at most."""
STEP = 2e-5
"""Time step that is written [s]."""


def mjcf(system: System) -> str:
    """The text of an MJCF file of a system that `jaxbacklash.export.exported` has looked at.

    Actuators are ``torque`` at the motor [N m] of a drive, else ``F`` on the link; joints are ``motor`` and ``link`` [rad].
    """
    has, (low, high) = values(system), edges(system)
    get = lambda name: float(has.get(name, 0.0))  # noqa: E731
    place = _weight(system, float(system.inertia))
    drive = system.motor is not None
    lines = [
        '<mujoco model="jaxbacklash">',
        "  <!-- angles in rad at their own shaft, torques in N m; friction of MuJoCo creeps where that of the model holds -->",
        '  <compiler angle="radian" inertiafromgeom="false"/>',
        f'  <option timestep="{number(STEP)}" integrator="RK4" gravity="{number(-EARTH)} 0 0"/>',
        "  <worldbody>",
    ]
    if system.motor is not None:
        lines += [
            '    <body name="motor">',
            f'      <inertial pos="0 0 0" mass="1e-6" diaginertia="{_around(get("motor_inertia"))}"/>',
            f'      <joint name="motor" type="hinge" axis="0 0 1" damping="{number(get("motor_damping"))}"'
            f"{_dry(get('coulomb_motor.Tc'))}/>",
            "    </body>",
        ]
    lines += [
        '    <body name="link">',
        f"      <inertial {place}/>",
        f'      <joint name="link" type="hinge" axis="0 0 1"{_dry(get("coulomb_ground.Tc"))}/>',
        "    </body>",
        "  </worldbody>",
        "  <tendon>",
        f'    <fixed name="joint" springlength="{number(low)} {number(high)}" stiffness="{number(get("stiffness"))}"'
        f' damping="{number(get("damping"))}"{_dry(get("coulomb_joint.Tc"))}>',
        *_length(system),
        "    </fixed>",
    ]
    if "gap_spring" in system.effects:
        lines += [f'    <fixed name="gap_spring" springlength="0 0" stiffness="{number(get("gap_spring.k1"))}">']
        lines += [*_length(system), "    </fixed>"]
    lines += ["  </tendon>", "  <actuator>"]
    lines += [f'    <motor name="{"torque" if drive else "F"}" joint="{"motor" if drive else "link"}"/>']
    if "preload" in system.effects:
        lines += [
            f'    <general name="preload" joint="link" gainprm="0" biastype="affine" biasprm="{number(get("preload.T0"))} 0 0"/>'
        ]
    return "\n".join([*lines, "  </actuator>", "</mujoco>", ""])


def _dry(level: float) -> str:
    """Dry friction of a joint or tendon, nothing where there is none [N m]."""
    hard = f'solreffriction="{number(2.0 * STEP)} 1" solimpfriction="0.9999 0.9999 0.001"'
    return f' frictionloss="{number(level)}" {hard}' if level else ""


def _length(system: System) -> list[str]:
    """What makes the length of a tendon the relative motion z."""
    link = '      <joint joint="link" coef="1"/>'
    return (
        [link]
        if system.motor is None
        else [link, f'      <joint joint="motor" coef="{number(-1.0 / float(system.motor.ratio))}"/>']
    )


def _weight(system: System, inertia: float) -> str:
    """Mass, place and inertia of the link, so that the earth pulls with G sin(y + phi0)."""
    has = values(system)
    pull, angle = float(has.get("gravity.G", 0.0)), float(has.get("gravity.phi0", 0.0))
    if pull == 0.0:
        return f'pos="0 0 0" mass="1e-6" diaginertia="{_around(inertia)}"'
    arm = min(0.1, LIGHT * inertia * EARTH / abs(pull))
    mass = abs(pull) / (EARTH * arm)
    angle += 0.0 if pull > 0.0 else math.pi
    place = f"{number(arm * math.cos(angle))} {number(arm * math.sin(angle))} 0"
    return f'pos="{place}" mass="{number(mass)}" diaginertia="{_around(inertia - mass * arm**2)}"'


def _around(inertia: float) -> str:
    """Principal inertias of a body that turns about z with this one [kg m^2]."""
    return " ".join([number(inertia)] * 3)
