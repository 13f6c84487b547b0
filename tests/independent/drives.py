r"""Drives by a program that shares nothing with the package: motor, gear, joint with play, link, dry friction at three ports, and
a second link behind a play of its own.

Time stepping after Moreau and Jean: with a step of a microsecond or two the smooth torques are taken in the middle of the step
and friction is an impulse that is found together with the speed at its end, which makes sticking exact and needs no events.
Of second order where nothing switches; a switch is late by a step at most. It needs numba.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.independent.kernel import njit

# Columns of the parameter vector; zero is the null value of every law.
(
    JM, CM, RATIO, J, B, K, C, TC_MOTOR, COG, COG_P, COG_PHI, TC_JOINT, TC_GROUND, G, PHI0, T0, RIPPLE, RIPPLE_N, RIPPLE_PHI,
    TE, TE_M, TE_PSI, K3, CC, DRAG, Z0, K1, MU, FAN, RUB, J2, K2, C2, B2, SIZE,
) = range(35)  # fmt: skip

COLUMNS = {
    "coulomb_motor": {"Tc": TC_MOTOR},
    "cogging": {"A": COG, "P": COG_P, "phi": COG_PHI},
    "coulomb_joint": {"Tc": TC_JOINT},
    "coulomb_ground": {"Tc": TC_GROUND},
    "gravity": {"G": G, "phi0": PHI0},
    "preload": {"T0": T0},
    "torque_ripple": {"A": RIPPLE, "N": RIPPLE_N, "phi": RIPPLE_PHI},
    "transmission_error": {"e": TE, "M": TE_M, "psi": TE_PSI},
    "cubic_stiffness": {"k3": K3},
    "contact_damping": {"cc": CC},
    "quadratic_drag": {"q": DRAG},
    "asymmetric_gap": {"z0": Z0},
    "gap_spring": {"k1": K1},
    "load_friction": {"mu": MU},
    "second_play": {"J2": J2, "k2": K2, "c2": C2, "b2": B2},
}
OUTSIDE = {"motor_fan": {"q": FAN}, "swing_damping": {"c": RUB}}
"""No laws of the catalogue: drag of the motor with the square of its speed, and damping of the link that grows with the square of
its angle."""


@dataclass(frozen=True)
class DriveRig:
    """Motor inertia [kg m^2] and viscous friction [N m s/rad] at its shaft, turns of it a turn of the link; link inertia, total
    play [rad], stiffness [N m/rad], damping [N m s/rad]."""

    motor_inertia: float
    motor_damping: float
    ratio: float
    inertia: float
    backlash: float
    stiffness: float
    damping: float


def random_rig(rng: np.random.Generator) -> DriveRig:
    """A geared axis like those of DRIVES' practice: 15 to 40 Hz in contact, 0.3 to 1 degree of play."""
    ratio, inertia = float(rng.choice([30.0, 50.0, 80.0])), float(np.exp(rng.uniform(np.log(0.05), np.log(0.4))))
    at_link = inertia * rng.uniform(1.0, 2.5)
    reduced = inertia * at_link / (inertia + at_link)
    stiffness = reduced * (2.0 * np.pi * rng.uniform(18.0, 35.0)) ** 2
    damping = 2.0 * rng.uniform(0.02, 0.05) * np.sqrt(stiffness * reduced)
    motor = at_link / ratio**2
    return DriveRig(motor, motor * rng.uniform(1.5, 4.0), ratio, inertia, rng.uniform(0.005, 0.017), stiffness, damping)


def packed(rig: DriveRig, effects: dict[str, dict[str, float]]) -> np.ndarray:
    """The parameter vector (SIZE,) of a rig with these laws, their parameters by name."""
    p = np.zeros(SIZE)
    p[[JM, CM, RATIO]] = rig.motor_inertia, rig.motor_damping, rig.ratio
    p[[J, B, K, C]] = rig.inertia, rig.backlash, rig.stiffness, rig.damping
    for name, given in effects.items():
        for key, value in given.items():
            p[(COLUMNS | OUTSIDE)[name][key]] = value
    return p


@njit(cache=True)
def _behind(p, y, dy, y2, dy2):
    """Torque that a second link takes from the first [N m]."""
    off, half = y2 - y, 0.5 * p[B2]
    press = off - half if off > half else off + half if off < -half else 0.0
    return p[K2] * press + p[C2] * (dy2 - dy)


@njit(cache=True)
def _torques(p, th, dth, y, dy, tau):
    """Torque on motor and on link without dry friction, and the size of the contact's load [N m]."""
    x, dx = th / p[RATIO], dth / p[RATIO]
    z, dz = y - x, dy - dx
    middle = p[Z0] + p[TE] * np.sin(p[TE_M] * x + p[TE_PSI])
    off, half = z - middle, 0.5 * p[B]
    press = off - half if off > half else off + half if off < -half else 0.0
    touch = 1.0 if press != 0.0 else 0.0
    joint = p[K] * press + p[C] * dz + p[K3] * press**3 + p[CC] * touch * dz + p[K1] * z
    ground = p[G] * np.sin(y + p[PHI0]) + p[T0] + p[RIPPLE] * np.sin(p[RIPPLE_N] * y + p[RIPPLE_PHI])
    ground -= p[DRAG] * abs(dy) * dy + p[RUB] * y**2 * dy
    motor = tau - p[CM] * dth - p[FAN] * abs(dth) * dth + p[COG] * np.sin(p[COG_P] * th + p[COG_PHI])
    return motor + joint / p[RATIO], ground - joint, abs(p[K] * press)


@njit(cache=True)
def _stopped(p, v, most):
    """Speeds (motor, link) after the impulses of friction, each at most ``most`` (motor, link to ground, joint)."""
    n, wm, wl = p[RATIO], 1.0 / p[JM], 1.0 / p[J]
    own = np.array([wm, wl, wl + wm / n**2])
    impulse = np.zeros(3)
    dth, dy = v[0], v[1]
    for _ in range(200):
        moved = 0.0
        for port in range(3):
            speed = dth if port == 0 else dy if port == 1 else dy - dth / n
            new = min(max(impulse[port] + speed / own[port], -most[port]), most[port])
            change = new - impulse[port]
            impulse[port] = new
            if port == 0:
                dth -= wm * change
            elif port == 1:
                dy -= wl * change
            else:
                dy -= wl * change
                dth += wm / n * change
            moved += abs(change) * own[port]
        if moved < 1e-15:
            break
    return dth, dy


@njit(cache=True)
def _step(p, q, tau, h, before):
    """One step of length h: q is th, dth, y, dy, y2, dy2, changed in place; ``before`` the accelerations of the last step,
    likewise."""
    th, dth, y, dy, y2, dy2 = q
    half = 0.5 * h
    middle = _torques(p, th + half * dth, dth + half * before[0], y + half * dy, dy + half * before[1], tau)
    pull = 0.0
    if p[J2] > 0.0:
        pull = _behind(p, y + half * dy, dy + half * before[1], y2 + half * dy2, dy2 + half * before[2])
        before[2] = -pull / p[J2]
        q[4], q[5] = y2 + h * (dy2 + half * before[2]), dy2 + h * before[2]
    free = np.array([dth + h * middle[0] / p[JM], dy + h * (middle[1] + pull) / p[J]])
    most = np.array([h * p[TC_MOTOR], h * p[TC_GROUND], h * (p[TC_JOINT] + p[MU] * middle[2])])
    new_th, new_y = free
    if most[0] + most[1] + most[2] > 0.0:
        new_th, new_y = _stopped(p, free, most)
    before[0], before[1] = (new_th - dth) / h, (new_y - dy) / h
    q[0], q[1] = th + 0.5 * h * (dth + new_th), new_th
    q[2], q[3] = y + 0.5 * h * (dy + new_y), new_y


@njit(cache=True)
def run_held(p, start, torque, dt, parts):
    """States (N, 6): th, dth, y, dy, and those of a second link, at the samples, under torques (N,) held for ``dt``, ``parts``
    steps each; ``start`` (6,)."""
    q, before = start.copy(), np.zeros(3)
    out = np.empty((torque.size, 6))
    for i in range(torque.size):
        out[i] = q
        for _ in range(parts):
            _step(p, q, torque[i], dt / parts, before)
    return out


@njit(cache=True)
def run_servo(p, wanted, rate_wanted, gains, most, count, dt, parts):
    """A servo on a counting encoder: states (N, 6) and the torque (N,) it holds for each sample; it follows (N,) and its rate."""
    q, before = np.zeros(6), np.zeros(3)
    out, torque = np.empty((wanted.size, 6)), np.empty(wanted.size)
    seen, speed = 0.0, 0.0
    for i in range(wanted.size):
        out[i] = q
        now = np.round(q[0] / count) * count
        speed += 0.2 * ((now - seen) / dt - speed)
        seen = now
        push = gains[0] * (wanted[i] - now) + gains[1] * (rate_wanted[i] - speed)
        torque[i] = min(max(push, -most), most)
        for _ in range(parts):
            _step(p, q, torque[i], dt / parts, before)
    return out, torque


def followed(rig: DriveRig, rng: np.random.Generator, duration: float, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """What a servo is told to follow at the motor's shaft [rad] and its rate, both (N,): a multisine from 0.3 to 10 Hz."""
    t = np.arange(round(duration * rate) + 1) / rate
    f = np.arange(0.3, 10.0, 0.31) * (1.0 + 0.02 * rng.standard_normal(32))
    size = 1.0 / (1.0 + (f / 2.5) ** 2)
    size *= rng.uniform(6.0, 12.0) * rig.backlash * rig.ratio / np.sqrt(0.5 * np.sum(size**2))
    phase = rng.uniform(0.0, 2.0 * np.pi, f.size)
    angle = 2.0 * np.pi * f * t[:, None] + phase
    return np.sin(angle) @ size, np.cos(angle) @ (2.0 * np.pi * f * size)


def servo_record(
    rig: DriveRig, effects: dict[str, dict[str, float]], rng: np.random.Generator, duration: float = 20.0, rate: float = 1000.0,
    noise: float = 0.002, bits: tuple[int, int] = (14, 17), parts: int = 100,
) -> dict[str, np.ndarray]:  # fmt: skip
    """A record as a servo drive logs it: t, torque (read with ``noise`` times its size), motor and link in whole counts."""
    wanted, speed = followed(rig, rng, duration, rate)
    stiff = rig.motor_inertia * (2.0 * np.pi * 6.0) ** 2
    gains = np.array([stiff, 1.4 * np.sqrt(stiff * rig.motor_inertia)])
    counts = [2.0 * np.pi / 2**b for b in bits]
    states, torque = run_servo(packed(rig, effects), wanted, speed, gains, 1e9, counts[0], 1.0 / rate, parts)
    rounded = [np.round(states[:, at] / count) * count for at, count in zip((0, 2), counts)]
    read = torque + noise * np.std(torque) * rng.standard_normal(torque.size)
    return {"t": np.arange(torque.size) / rate, "torque": read, "motor": rounded[0], "link": rounded[1]}


@njit(cache=True)
def run_commanded(p, start, command, servo, dt, parts):
    """States (N, 6) at the samples of a drive whose torque is ``servo`` = (Kp, Kd, tmax): Kp (command - th / N) - Kd th', within
    +-tmax, at every step, of a command (N,) held for ``dt`` [rad]."""
    q, before = start.copy(), np.zeros(3)
    out = np.empty((command.size, 6))
    h = dt / parts
    for i in range(command.size):
        out[i] = q
        for _ in range(parts):
            th, dth = q[0] + 0.5 * h * q[1], q[1] + 0.5 * h * before[0]
            push = servo[0] * (command[i] - th / p[RATIO]) - servo[1] * dth
            _step(p, q, min(max(push, -servo[2]), servo[2]), h, before)
    return out


def commanded_record(
    rig: DriveRig, servo: tuple[float, float, float], effects: dict[str, dict[str, float]], rng: np.random.Generator,
    duration: float = 20.0, rate: float = 1000.0, bits: tuple[int, int] = (14, 17), parts: int = 100,
) -> dict[str, np.ndarray]:  # fmt: skip
    """A record of a servo that only logs what it was told: t, command [rad, at the link], motor and link in whole counts."""
    command = followed(rig, rng, duration, rate)[0] / rig.ratio
    states = run_commanded(packed(rig, effects), np.zeros(6), command, np.array(servo), 1.0 / rate, parts)
    motor, link = (np.round(states[:, at] / c) * c for at, c in zip((0, 2), (2.0 * np.pi / 2**b for b in bits)))
    return {"t": np.arange(command.size) / rate, "command": command, "motor": motor, "link": link}
