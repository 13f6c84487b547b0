r"""A start for the fit of a drive with one encoder: the link that nobody sees is run along the motion of the motor.

With an encoder on the motor alone its motion behind the gear, :math:`x = \theta / N`, drives a link of which only play,
:math:`k / J` and :math:`c / J` are asked. Whatever these are, the rest is linear: the motor's own balance,

.. math:: \tau = J_m \ddot\theta + c_m \dot\theta + T_c\,\mathrm{sgn}\,\dot\theta - T / N,

tells J by how large the joint's torque T has to be. Many such links, lanes of one program, run through a part of the record at
once; those that leave least of the balance say where the next ones are tried (`jaxbacklash.regression.drive_start` asks). With an
encoder on the link alone the balance of the whole tells the inertia in all; `jaxbacklash.one_encoder.near_by` looks for the
rest.

Source: Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413, on leaving to least squares what is linear.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ..compiled import kept_jit
from ..records import Record
from ..signals import Bump, choose_intervals, fit_spline, span

Array = Any
SAMPLES = 8192
"""Samples of a record that are run through at most: the part with the most motion."""
STEP = 2e-3
"""Longest step of a run [s]."""
LANES, BEST, CHILDREN, ROUNDS = 512, 6, 20, 6
"""Lanes of the first round; the best of them, of which each has so many near it in the next; and rounds."""
NEAR = 0.35
"""Standard deviation of the logarithms in which the second round's lanes are near their parents; half as much in each later."""
PLAYS = (1e-3, 0.6)
"""Plays that are tried, as shares of the range of the motion."""
DAMPING = (0.005, 0.3)
"""Damping ratios of the link on its contact that are tried."""
LOWEST, FINEST = 2.0, 6.0
"""Frequency of the link on its contact [Hz] that is tried at least; samples in a period of it at least."""
UNSEEN = (0.02, 0.05)
"""Play, as a share of the range of the motion, and damping ratio with which a search begins where the motor is not seen."""


@dataclass(frozen=True)
class Sides:
    """A drive as one of its sides tells it: inertia [kg m^2], viscous and dry friction of the motor [N m s/rad, N m] at its
    shaft, inertia of the link, play [rad], stiffness [N m/rad], damping [N m s/rad]; ``misfit``, the share of the joint's part of
    the balance that is left."""

    motor_inertia: float
    friction: float
    dry: float
    inertia: float
    backlash: float
    stiffness: float
    damping: float
    misfit: float


def search_hidden(record: Record, seed: int = 0) -> Sides:
    """Search for the drive of a record with one encoder.

    Parameters
    ----------
    record : of a drive, with ``motor`` or ``link``
    seed : of the lanes
    """
    seen = _Seen(record)
    if record.observed_name == "link":
        return seen.undecided()
    rng = np.random.default_rng(seed)
    lanes = seen.first_lanes(rng)
    for turn in range(ROUNDS):
        misfit, lanes = seen.judge(seen.run(lanes), lanes)
        best = lanes[:, np.argsort(misfit)[:BEST]]
        if turn + 1 < ROUNDS:
            spread = NEAR * 0.5**turn * np.clip(rng.standard_normal((lanes.shape[0], BEST * CHILDREN)), -2.0, 2.0)
            lanes = np.concatenate([best, np.repeat(best, CHILDREN, axis=1) * np.exp(spread)], axis=1)
    return seen.told(best[:, 0], float(np.min(misfit)))


class _Seen:
    """The side of a drive that is seen, in a part of its record, at the link's shaft.

    A lane is a column of play b, frequency on the contact :math:`\\omega`, damping ratio :math:`\\zeta` and inertia of the link.
    ``whole`` is the inertia in all, ``rubs`` its viscous friction, both seen from the link.
    """

    def __init__(self, record: Record) -> None:
        name, self.ratio = record.observed_name, record.ratio
        first = _liveliest(record.channels[name])
        rows = slice(first, first + SAMPLES)
        angle = record.channels[name][rows] / (self.ratio if name == "motor" else 1.0)
        torque = self.ratio * record.channels["torque"][rows]
        self.t, self.dt = record.dt * np.arange(angle.size), record.dt
        self.parts = max(1, int(np.ceil(record.dt / STEP - 1e-9)))
        window = span(record.dt)
        self.motion = fit_spline(self.t, angle, 0.0, window / choose_intervals(self.t, angle, window))
        self.range = float(np.ptp(angle))
        self.bump = Bump(angle.size, record.dt)
        under = self.bump.against
        # What is held from one sample to the next is, on average, half a sample late.
        self.torque = under(0.5 * (torque + np.concatenate([torque[:1], torque[:-1]])))
        dry = under(np.sign(self.motion(self.t, 1)))
        own = np.stack([under(angle, 2), -under(angle, 1), dry, under(np.ones_like(angle)), under(angle)], axis=1)
        inertia, friction, _, load, slope = _least_squares(own, self.torque)
        self.whole = max(inertia, 1e-9 * float(np.linalg.norm(self.torque)) / float(np.linalg.norm(own[:, 0])))
        self.rubs = max(friction, 1e-3 * self.whole)
        self.load = -(load + slope * angle)  # what is no inertia and no friction is taken to act on the link
        self.own = own[:, :4]
        self.plane = np.linalg.qr(self.own / np.maximum(np.linalg.norm(self.own, axis=0), 1e-300))[0]
        self.rest = self.torque - self.plane @ (self.plane.T @ self.torque)

    def undecided(self) -> Sides:
        """A drive with half of its inertia on either side and a joint of no particular size."""
        gear, half = self.ratio**2, 0.5 * self.whole
        omega = min(2.0 * np.pi * 20.0, 0.5 / self.dt)
        stiffness = 0.5 * half * omega**2
        return Sides(half / gear, self.rubs / gear, 0.0, half, UNSEEN[0] * self.range, stiffness, UNSEEN[1] * half * omega, 1.0)

    def first_lanes(self, rng: np.random.Generator) -> np.ndarray:
        """Lanes (4, L) over all that is thought possible."""
        from scipy.stats import qmc  # heavy to load, and only these records need it

        fastest = min(2.0 * np.pi / (FINEST * self.dt), 1.5 * self.parts / self.dt)
        low = np.array([PLAYS[0] * self.range, min(2.0 * np.pi * LOWEST, 0.1 * fastest), DAMPING[0]])[:, None]
        high = np.array([PLAYS[1] * self.range, fastest, DAMPING[1]])[:, None]
        lanes = low * (high / low) ** qmc.Sobol(3, seed=rng).random(LANES).T
        return np.concatenate([lanes, np.full((1, LANES), 0.5 * self.whole)])

    def run(self, lanes: np.ndarray) -> np.ndarray:
        """Acceleration (N, L) that the joint gives the link at the samples."""
        step = self.dt / self.parts
        at = np.clip(0.5 * step * np.arange(2 * SAMPLES * self.parts + 1), 0.0, self.t[-1])
        load = np.zeros(SAMPLES)
        load[: self.t.size] = self.load
        motion = np.stack([self.motion(at), self.motion(at, 1)])
        found = np.asarray(_run(lanes, motion, load, np.asarray(step), self.parts))
        return found[: self.t.size * self.parts : self.parts]

    def judge(self, accelerations: np.ndarray, lanes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Share (L,) of the balance that each lane leaves, infinite where it pulls the wrong way; and the lanes with the inertia
        of the link that the balance tells."""
        column = self.bump.against(np.ascontiguousarray(accelerations.T)).T
        column = column - self.plane @ (self.plane.T @ column)
        size, along = np.sum(column**2, axis=0), self.rest @ column
        with np.errstate(all="ignore"):  # a lane may run away
            inertia = along / size
            misfit = 1.0 - along**2 / (size * (self.rest @ self.rest))
        sound = (inertia > 0.0) & np.isfinite(misfit)
        lanes = np.array(lanes)
        lanes[3] = np.where(sound, np.clip(inertia, 0.02 * self.whole, self.whole), lanes[3])
        return np.where(sound, misfit, np.inf), lanes

    def told(self, lane: np.ndarray, misfit: float) -> Sides:
        """The drive that a lane stands for."""
        play, omega, zeta, link = (float(v) for v in lane)
        under = self.bump.against(np.ascontiguousarray(self.run(lane[:, None]).T))[0]
        motor, friction, dry, _, inertia = _least_squares(np.column_stack([self.own, under]), self.torque)
        inertia = inertia if inertia > 0.0 else link
        motor = motor if motor > 0.0 else 0.5 * self.whole
        gear = self.ratio**2
        return Sides(
            motor / gear, max(friction, 1e-3 * motor) / gear, max(dry, 0.0) / self.ratio, inertia, play, inertia * omega**2,
            2.0 * zeta * omega * inertia, misfit,
        )  # fmt: skip


def _liveliest(values: np.ndarray) -> int:
    """First of the samples that are run through: those which stray farthest from their mean."""
    if values.size <= SAMPLES:
        return 0
    strayed = np.concatenate([[0.0], np.cumsum((values - np.mean(values)) ** 2)])
    return int(np.argmax(strayed[SAMPLES:] - strayed[:-SAMPLES]))


def _least_squares(matrix: np.ndarray, right: np.ndarray) -> list[float]:
    scale = np.maximum(np.linalg.norm(matrix, axis=0), 1e-300)
    return [float(v) for v in np.linalg.lstsq(matrix / scale, right, rcond=None)[0] / scale]


@kept_jit
def _run(lanes: Array, motion: Array, load: Array, h: Array, parts: int) -> Array:
    """Accelerations (steps, L) by the joint where each step begins; ``motion`` (2, 2 steps + 1) of the base and its rate."""
    play, omega, zeta, inertia = lanes
    stiff, damped = omega**2, 2.0 * zeta * omega

    def joint(y: Array, v: Array, base: Array) -> Array:
        z = y - base[0]
        return -stiff * (z - jnp.clip(z, -0.5 * play, 0.5 * play)) - damped * (v - base[1])

    def step(carry: Any, at: Any) -> Any:
        (y, v), (left, middle, right, load) = carry, at
        k1 = joint(y, v, left) + load / inertia
        k2 = joint(y + 0.5 * h * v, v + 0.5 * h * k1, middle) + load / inertia
        k3 = joint(y + 0.5 * h * (v + 0.5 * h * k1), v + 0.5 * h * k2, middle) + load / inertia
        k4 = joint(y + h * (v + 0.5 * h * k2), v + h * k3, right) + load / inertia
        following = y + h * (v + h * (k1 + k2 + k3) / 6.0), v + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
        return following, joint(y, v, left)

    seen = motion.T
    along = seen[:-1:2], seen[1::2], seen[2::2], jnp.repeat(load, parts)
    begin = jnp.full_like(play, motion[0, 0]), jnp.full_like(play, motion[1, 0])
    return jax.lax.scan(step, begin, along)[1]
