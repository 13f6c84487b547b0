r"""A mass under a force, with springs, drag and dry friction of any law: stick and slip, located one by one.

    m y'' = F(t) - spring(y, v) - R sgn y'  while it slides,   y' = 0  while |F - spring| <= R,   R = friction(t, y, v, F)

Runge-Kutta steps of a sixteenth of a sample; one at whose end the mass has turned is cut there by bisection, and a mass at rest
is looked at until its friction gives way. Nothing is smoothed, and nothing here shares code with the package.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

FINE = 16
"""Steps to a sample."""
LEAST = 1e-9
"""Share of a step that a mass which has just begun to slide is let go at least."""


def no_friction(t: float, y: float, v: float, force: float) -> float:
    """No resistance to sliding [N]."""
    return 0.0


@dataclass(frozen=True)
class SlidingMass:
    """``mass`` [kg]; ``spring``, the force (y [m], v [m/s]) -> [N] that resists; ``friction`` (t, y, v, F) -> [N], at least 0."""

    mass: float
    spring: Callable[[float, float], float]
    friction: Callable[[float, float, float, float], float] = no_friction

    def sample(
        self, t: float, y: float, v: float, dt: float, force: Callable[[float], float], fine: int = FINE
    ) -> tuple[float, float]:
        """Place and speed one sample of ``dt`` [s] after ``t``, under ``force``, a function of the time since ``t``."""
        h, left = dt / fine, dt
        while left > 1e-9 * dt:
            step = min(h, left)
            gone = dt - left
            net = force(gone) - self.spring(y, 0.0)
            most = self.friction(t + gone, y, 0.0, force(gone))
            if v == 0.0 and abs(net) <= most:
                left -= step  # looked at again a step later, which is a small part of a sample
                continue
            way = 1.0 if v > 0.0 or (v == 0.0 and net > 0.0) else -1.0
            later = self._step(t, gone, y, v, way, step, force)
            if later[1] * way < 0.0 and most > 0.0:
                step, later = self._turn(t, gone, y, v, way, step, force)
            (y, v), left = later, left - step
        return y, v

    def _turn(
        self, t: float, gone: float, y: float, v: float, way: float, step: float, force: Callable[[float], float]
    ) -> tuple[float, tuple[float, float]]:
        low, high = LEAST * step, step
        for _ in range(40):
            middle = 0.5 * (low + high)
            turned = self._step(t, gone, y, v, way, middle, force)[1] * way < 0.0
            low, high = (low, middle) if turned else (middle, high)
        return high, (self._step(t, gone, y, v, way, high, force)[0], 0.0)

    def _step(
        self, t: float, gone: float, y: float, v: float, way: float, h: float, force: Callable[[float], float]
    ) -> tuple[float, float]:
        def rate(after: float, y: float, v: float) -> tuple[float, float]:
            push = force(gone + after)
            return v, (push - self.spring(y, v) - way * self.friction(t + gone + after, y, v, push)) / self.mass

        a, b = rate(0.0, y, v)
        c, d = rate(0.5 * h, y + 0.5 * h * a, v + 0.5 * h * b)
        e, f = rate(0.5 * h, y + 0.5 * h * c, v + 0.5 * h * d)
        g, i = rate(h, y + h * e, v + h * f)
        return y + h / 6.0 * (a + 2.0 * c + 2.0 * e + g), v + h / 6.0 * (b + 2.0 * d + 2.0 * f + i)
