"""The paper's models, ready-made, and the dimensionless form both ways."""

from __future__ import annotations

from typing import NamedTuple

from .effects import Contact, Damper, GapSpring, Gravity, LimitedServo, LinearGravity, Motor, Servo, Spring
from .excitation import Harmonic
from .system import System


def base_motion_joint(inertia: float, backlash: float, stiffness: float, damping: float, *, width: float = 0.0) -> System:
    r"""A link behind a joint with play whose base moves (paper, 3.1-3.2): :math:`J\ddot y = -k\delta(z) - c\dot z`.

    inertia [kg m^2], backlash the total play [rad], stiffness [N m/rad], damping [N m s/rad], width of the smoothed
    corner [rad].

    Examples
    --------
    >>> joint = jb.base_motion_joint(inertia=3.16, backlash=0.026, stiffness=15000.0, damping=20.0)
    >>> [round(float(edge), 3) for edge in joint.edges(0.0)]
    [-0.013, 0.013]
    """
    return System(inertia, Contact(backlash, stiffness, width), Damper(damping))


def two_link(
    inertia: float, backlash: float, stiffness: float, damping: float, gravity: float, *, linearised: bool = False
) -> System:
    r"""The second link of a two-link mechanism under its weight (paper, 3.3-3.4).

    ``gravity`` is G = m g L = J C [N m], positive upright; with ``linearised`` the torque is G y, else G sin y.

    Examples
    --------
    >>> sorted(jb.two_link(3.16, 0.026, 15000.0, 20.0, gravity=-45.0).effects)
    ['gravity']
    """
    weight = LinearGravity(gravity) if linearised else Gravity(gravity)
    return base_motion_joint(inertia, backlash, stiffness, damping).with_effects(weight)


def drive(
    motor_inertia: float, motor_damping: float, ratio: float, inertia: float, backlash: float, stiffness: float, damping: float,
    *, observed: str = "motor link", width: float = 0.0, Kp: float | None = None, Kd: float = 0.0, tmax: float | None = None,
) -> System:  # fmt: skip
    r"""A motor that turns a link through a gear and a joint with play: both move, the torque at the motor drives.

    .. math::
        J_m \ddot\theta = \tau - c_m \dot\theta + T / N, \qquad J \ddot y = -T, \qquad T = k \delta(z) + c \dot z,
        \qquad z = y - \theta / N

    motor_inertia [kg m^2] and motor_damping [N m s/rad] at the motor's shaft; ratio N, turns of the motor for a turn of the link;
    the others as `base_motion_joint` has them, at the link. observed: which of motor and link have an encoder. With a gain Kp
    [N m/rad] the motor has a `Servo`, which makes its torque of a position command, with Kd [N m s/rad] and, where it is limited,
    at most tmax [N m]; what drives (`HeldTorque`, `MotorTorque`) is then that command [rad].

    Examples
    --------
    >>> rig = jb.drive(4e-5, 9e-5, 50.0, inertia=0.05, backlash=0.0126, stiffness=860.0, damping=0.7)
    >>> rig.state_names
    ('y', 'dy', 'th', 'dth')
    >>> motion = jb.simulate(rig, jb.MotorTorque(jb.Harmonic(0.1, 10.0)), duration=1.0)
    >>> motion.observed.shape
    (501, 2)
    """
    motor = Motor(motor_inertia, motor_damping, ratio)
    if Kp is not None:
        own = (motor_inertia, motor_damping, ratio, Kp, Kd)
        motor = Servo(*own) if tmax is None else LimitedServo(*own, tmax)
    return System(inertia, Contact(backlash, stiffness, width), Damper(damping), observed=observed, motor=motor)


def linear_oscillator(inertia: float, stiffness: float, damping: float) -> System:
    """Mass, spring and damper without play."""
    return System(inertia, Spring(stiffness), Damper(damping))


def free_axis(inertia: float, damping: float, *, observed: str = "y") -> System:
    """Mass and damping alone: an axis without a spring."""
    return System(inertia, None, Damper(damping), observed=observed)


def forced_oscillator(mass: float, k0: float, damping: float, half_play: float, *, k1: float = 0.0, width: float = 0.0) -> System:
    r"""The force-driven oscillator of Table 1: :math:`m\ddot x + c\dot x + k_1 x + k_0\delta(x) = A\cos\omega t` (2.13).

    ``half_play`` is the paper's x_0 [m], half of the total play that `Contact` holds.

    Examples
    --------
    >>> jb.forced_oscillator(mass=1.0, k0=40000.0, damping=8.0, half_play=0.005).observed
    'y'
    """
    system = System(mass, Contact(2.0 * half_play, k0, width), Damper(damping), observed="y")
    return system.with_effects(GapSpring(k1, 0.0)) if k1 else system


def case_1() -> tuple[System, Harmonic]:
    """CASE 1 of Table 1 with its force: 100 N at 40 rad/s.

    Examples
    --------
    >>> system, force = jb.case_1()
    >>> float(force.amplitude), float(force.omega)
    (100.0, 40.0)
    """
    return forced_oscillator(1.0, 40000.0, 8.0, 0.005), Harmonic(100.0, 40.0, as_force=True)


def case_2() -> tuple[System, Harmonic]:
    """CASE 2 of Table 1 with its force: 240 N at 40 rad/s.

    Examples
    --------
    >>> system, force = jb.case_2()
    >>> sorted(system.effects)
    ['gap_spring']
    """
    return forced_oscillator(1.0, 31000.0, 8.0, 0.005, k1=1000.0), Harmonic(240.0, 40.0, as_force=True)


class Dimensionless(NamedTuple):
    r"""(2.14): :math:`p'' + 2\zeta p' + F(p) = \alpha\cos\Omega\tau`, in units of half play x_0 and 1 / omega_0."""

    zeta: float
    alpha: float
    Omega: float

    def system(self) -> tuple[System, Harmonic]:
        """The system and force whose y is p and whose time is tau: unit mass, unit stiffness, play from -1 to 1."""
        return forced_oscillator(1.0, 1.0, 2.0 * self.zeta, 1.0), Harmonic(self.alpha, self.Omega, as_force=True)

    def dimensional(self, mass: float, k0: float, half_play: float) -> tuple[System, Harmonic]:
        """The system of this dimensionless form with given mass [kg], stiffness [N/m] and half play [m]."""
        omega_0 = (k0 / mass) ** 0.5
        system = forced_oscillator(mass, k0, 2.0 * self.zeta * omega_0 * mass, half_play)
        return system, Harmonic(self.alpha * k0 * half_play, self.Omega * omega_0, as_force=True)


def dimensionless(system: System, force: Harmonic) -> Dimensionless:
    """The dimensionless form of a force-driven oscillator with play (2.14).

    Examples
    --------
    >>> found = jb.dimensionless(*jb.case_1())
    >>> round(found.zeta, 3), round(found.alpha, 3), round(found.Omega, 3)
    (0.02, 0.5, 0.2)
    """
    if not isinstance(system.contact, Contact):
        raise ValueError("the dimensionless form measures lengths in half plays: the system needs a play")
    mass, k0 = float(system.inertia), float(system.contact.stiffness)
    half_play, omega_0 = 0.5 * float(system.contact.backlash), (k0 / mass) ** 0.5
    return Dimensionless(
        float(system.damper.damping) / (2.0 * omega_0 * mass),
        float(force.amplitude) / (k0 * half_play),
        float(force.omega) / omega_0,
    )
