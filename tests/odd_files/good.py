"""The good record behind every odd file: a joint with play and gravity under base motion, simulated by SciPy alone.

    motion = good_motion()
    t = np.arange(3001) / 500
    x, z = motion.x(t), motion.z(t)      # free of noise, at any times

The equation is J y'' = -k d(z) - c z' + G sin y with the dead zone d of half width b/2 and z = y - x, as in CONVENTIONS.md.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

RATE, DURATION = 500.0, 6.0
NOISE = 3e-5
"""Standard deviation of the noise of x and of z [rad]."""
INERTIA, BACKLASH, STIFFNESS, DAMPING, GRAVITY = 2.94, 0.0186, 13400.0, 21.5, -26.0
TRUTH = {"backlash": BACKLASH, "stiffness": STIFFNESS, "damping": DAMPING, "gravity.G": GRAVITY}
_LINES = np.array([[0.9, 0.045, 0.4], [2.3, 0.035, 2.0], [3.7, 0.02, 4.1], [5.2, 0.012, 5.5], [8.3, 0.006, 1.3]])
"""Frequency [Hz], amplitude [rad] and phase [rad] of the base motion's sines."""
_FINE = 1e4  # Hz, of the samples that stand for the motion between its samples


@dataclass(frozen=True)
class Motion:
    """Base angle x(t) and relative angle z(t) [rad], each a function of an array of times [s] from 0 to DURATION + 0.1."""

    x: Callable[[np.ndarray], np.ndarray]
    z: Callable[[np.ndarray], np.ndarray]


def base(t: np.ndarray, offset: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Angle [rad] and speed [rad/s] of the base at times t [s]; the motion grows from rest within the first 0.5 s."""
    w = 2.0 * np.pi * _LINES[:, :1]
    angles = w * t + _LINES[:, 2:]
    wave, slope = (_LINES[:, 1] @ part for part in (np.sin(angles), w * np.cos(angles)))
    s = np.clip(t / 0.5, 0.0, 1.0)
    ramp, rise = s**3 * (10.0 - 15.0 * s + 6.0 * s**2), 30.0 * s**2 * (1.0 - s) ** 2 / 0.5
    return offset + ramp * wave, ramp * slope + rise * wave


@functools.cache
def good_motion(offset: float = 0.0) -> Motion:
    """The joint's motion when the base moves about ``offset`` [rad]."""

    t = np.arange(round((DURATION + 0.1) * _FINE) + 1) / _FINE
    # The solver asks for the base tens of thousands of times: a spline through it answers ten times as fast.
    spline = CubicSpline(t, base(t, offset)[0])
    slope = spline.derivative()

    def law(t: float, state: np.ndarray) -> list[float]:
        x, dx = float(spline(t)), float(slope(t))
        y, v = state
        z, half = y - x, 0.5 * BACKLASH
        contact = z - half if z > half else z + half if z < -half else 0.0
        return [v, (GRAVITY * np.sin(y) - STIFFNESS * contact - DAMPING * (v - dx)) / INERTIA]

    run = solve_ivp(law, (0.0, t[-1]), [offset, 0.0], "DOP853", t, rtol=1e-9, atol=1e-11, max_step=2e-3)
    return Motion(lambda when: base(when, offset)[0], CubicSpline(t, run.y[0] - base(t, offset)[0]))


@dataclass
class Measured:
    """A record as its sensors saw it: times [s] and channels [rad] by name, before anything odd is done to it."""

    t: np.ndarray
    channels: dict[str, np.ndarray] = field(default_factory=dict)


def measured(rng: np.random.Generator, rate: float = RATE, offset: float = 0.0) -> Measured:
    """The good record t, x, z with fresh noise at ``rate`` [Hz]."""
    t = np.arange(round(DURATION * rate) + 1) / rate
    motion = good_motion(offset)
    x, z = (each(t) + NOISE * rng.standard_normal(t.size) for each in (motion.x, motion.z))
    return Measured(t, {"x": x, "z": z})
