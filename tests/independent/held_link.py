r"""A link that dry friction holds to the ground, moved through a joint with play: stick, slip and contact, located one by one.

    m y'' = -T - Tc sgn y'  while it slides,   y' = 0  while |T| <= Tc,   T = k delta_b(y - x) + c (y' - x')

The base motion is given as functions. Between events the motion is integrated by Runge-Kutta steps far shorter than a sample;
a step that passes an edge of the play, or at whose end the link has turned, is cut there by bisection; a link at rest is looked
at until its friction gives way. Nothing is smoothed, and nothing here shares code with the package.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import copysign, cos, pi, sin

import numpy as np

Motion = Callable[[float], float]


@dataclass(frozen=True)
class HeldLink:
    """inertia [kg], backlash total play [m], stiffness [N/m], damping [N s/m], friction Tc at the ground [N]."""

    inertia: float
    backlash: float
    stiffness: float
    damping: float
    friction: float

    def force(self, z: float, dz: float) -> float:
        """Force of the link on its base."""
        half = 0.5 * self.backlash
        pressed = z - half if z > half else z + half if z < -half else 0.0
        return self.stiffness * pressed + self.damping * dz

    def side(self, z: float) -> int:
        half = 0.5 * self.backlash
        return 1 if z > half else -1 if z < -half else 0

    def run(self, x: Motion, dx: Motion, rate: float, samples: int, fine: int = 24) -> tuple[np.ndarray, np.ndarray]:
        """Transmitted force and link position at the samples, (N,) each, from rest in the middle of the play."""
        t, y, v, slides = 0.0, x(0.0), 0.0, 0
        forces, places = np.empty(samples), np.empty(samples)
        for k in range(samples):
            forces[k], places[k] = self.force(y - x(t), v - dx(t)), y
            until = (k + 1) / rate
            while until - t > 1e-13:
                h = min(1.0 / (rate * fine), until - t)
                if not slides:
                    t, slides = self._rest(t, y, h, x, dx)
                else:
                    t, y, v, slides = self._slide(t, y, v, slides, h, x, dx)
        return forces, places

    def _rest(self, t: float, y: float, h: float, x: Motion, dx: Motion) -> tuple[float, int]:
        def pull(at: float) -> float:
            return -self.force(y - x(at), -dx(at))

        if abs(pull(t + h)) <= self.friction:
            return t + h, 0
        low, high = 0.0, h
        for _ in range(50):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if abs(pull(t + middle)) > self.friction else (middle, high)
        return t + high, int(copysign(1, pull(t + high)))

    def _slide(self, t: float, y: float, v: float, way: int, h: float, x: Motion, dx: Motion) -> tuple[float, float, float, int]:
        def rate(at: float, y: float, v: float) -> tuple[float, float]:
            return v, (-self.force(y - x(at), v - dx(at)) - self.friction * way) / self.inertia

        def step(h: float) -> tuple[float, float]:
            a, b = rate(t, y, v)
            c, d = rate(t + h / 2, y + h / 2 * a, v + h / 2 * b)
            e, f = rate(t + h / 2, y + h / 2 * c, v + h / 2 * d)
            g, i = rate(t + h, y + h * e, v + h * f)
            return y + h / 6 * (a + 2 * c + 2 * e + g), v + h / 6 * (b + 2 * d + 2 * f + i)

        begun = self.side(y - x(t) + 1e-15)

        def passed(h: float) -> bool:
            y1, v1 = step(h)
            return v1 * way < 0.0 or self.side(y1 - x(t + h)) != begun

        if passed(h) and not passed(1e-9):
            low, high = 1e-9, h
            for _ in range(40):
                middle = 0.5 * (low + high)
                low, high = (low, middle) if passed(middle) else (middle, high)
            h = high
        y1, v1 = step(h)
        t += h
        if v1 * way > 0.0:
            return t, y1, v1, way
        pull = -self.force(y1 - x(t), -dx(t))
        return t, y1, 0.0, 0 if abs(pull) <= self.friction else int(copysign(1, pull))


def modulated_sine(amplitude: float, frequency: float, duration: float) -> tuple[Motion, Motion]:
    """A sine that swells and fades, and its rate: amplitude sin^2 ramps over a quarter of the duration at either end."""
    ramp, omega = 0.25 * duration, 2 * pi * frequency

    def envelope(t: float) -> tuple[float, float]:
        away = min(t, duration - t)
        if away >= ramp:
            return 1.0, 0.0
        turn = 0.5 * pi * max(away, 0.0) / ramp
        slope = 0.5 * pi / ramp * sin(2 * turn)
        return sin(turn) ** 2, slope if t < 0.5 * duration else -slope

    def x(t: float) -> float:
        return amplitude * envelope(t)[0] * sin(omega * t)

    def dx(t: float) -> float:
        size, slope = envelope(t)
        return amplitude * (size * omega * cos(omega * t) + slope * sin(omega * t))

    return x, dx


def measured(link: HeldLink, amplitude: float, frequency: float, *, duration: float, rate: float) -> dict[str, np.ndarray]:
    """Columns t, x, T without noise, and the link's own y."""
    x, dx = modulated_sine(amplitude, frequency, duration)
    samples = round(duration * rate) + 1
    force, y = link.run(x, dx, rate, samples)
    t = np.arange(samples) / rate
    return {"t": t, "x": np.array([x(v) for v in t]), "T": force, "y": y}
