"""Analytic prescribed motions x(t), with exact first and second derivatives.

Each motion has `x(t)`, `dx(t)`, `ddx(t)` for a scalar or an array of times t [s]; the unit of x is whatever the
amplitude is in: rad for a base motion, N m for a force. All start smoothly from zero over `ramp` seconds, so that a
link at rest in the middle of its play is a fair initial state.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np


def smooth_step(s):
    """The quintic step 0 -> 1 on 0 <= s <= 1 with its first two derivatives with respect to s, each shaped like s."""
    s = np.clip(s, 0.0, 1.0)
    return s**3 * (10 - 15 * s + 6 * s**2), 30 * s**2 * (1 - s) ** 2, 60 * s * (1 - s) * (1 - 2 * s)


def ramp_up(t, seconds):
    """A smooth start over `seconds`: value, first and second derivative at t [s]; seconds = 0 is no ramp."""
    t = np.asarray(t, float)
    if seconds <= 0:
        return np.ones_like(t), np.zeros_like(t), np.zeros_like(t)
    value, first, second = smooth_step(t / seconds)
    return value, first / seconds, second / seconds**2


def product(a, b):
    """The value and two derivatives of a b, from those of a and of b."""
    return a[0] * b[0], a[1] * b[0] + a[0] * b[1], a[2] * b[0] + 2 * a[1] * b[1] + a[0] * b[2]


def sine_of(phase):
    """The value and two derivatives of sin(phase), from those of the phase [rad]."""
    s, c = np.sin(phase[0]), np.cos(phase[0])
    return s, c * phase[1], c * phase[2] - s * phase[1] ** 2


class Motion(ABC):
    """A motion is one method, `derivatives(t) -> (x, x', x'')`; the rest follows."""

    @abstractmethod
    def derivatives(self, t):
        """Position, speed and acceleration at times t."""

    def x(self, t):
        return self.derivatives(t)[0]

    def dx(self, t):
        return self.derivatives(t)[1]

    def ddx(self, t):
        return self.derivatives(t)[2]


@dataclass(frozen=True)
class Rest(Motion):
    """No motion at all."""

    def derivatives(self, t):
        zero = np.zeros_like(np.asarray(t, float))
        return zero, zero, zero


@dataclass(frozen=True)
class Chirp(Motion):
    """Linear chirp A(f) sin(2 pi (f0 t + rate t^2 / 2) + phase), f = f0 + rate t, A(f) = A / (1 + (f/corner)^2)^order.

    The falling amplitude is that of a servo driven with a constant command (the paper's Figure 8: 0 to 12 Hz in 30 s).

    Args: amplitude; f0 [Hz]; rate [Hz/s]; corner [Hz] (inf: constant amplitude); order [1]; phase [rad]; ramp [s].
    """

    amplitude: float
    f0: float = 0.0
    rate: float = 0.4
    corner: float = np.inf
    order: float = 1.0
    phase: float = 0.0
    ramp: float = 1.0

    def derivatives(self, t):
        t = np.asarray(t, float)
        frequency = self.f0 + self.rate * t
        angle = 2 * np.pi * (self.f0 + self.rate * t / 2) * t + self.phase
        phase = (angle, 2 * np.pi * frequency, np.full_like(t, 2 * np.pi * self.rate))
        u, du, p = frequency / self.corner, self.rate / self.corner, self.order
        base = 1 + u**2
        second = -2 * p * du**2 * base ** (-p - 1) + 4 * p * (p + 1) * (u * du) ** 2 * base ** (-p - 2)
        roll_off = (base**-p, -2 * p * u * du * base ** (-p - 1), second)
        wave = product(product(roll_off, ramp_up(t, self.ramp)), sine_of(phase))
        return tuple(self.amplitude * part for part in wave)


@dataclass(frozen=True)
class Multisine(Motion):
    """x = sum_j A_j sin(2 pi f_j t + phi_j), times the ramp.

    Args: amplitudes, frequencies [Hz], phases [rad], each (n,); ramp [s].
    """

    amplitudes: np.ndarray
    frequencies: np.ndarray
    phases: np.ndarray
    ramp: float = 1.0

    def derivatives(self, t):
        t = np.asarray(t, float)
        w = 2 * np.pi * np.asarray(self.frequencies)
        total = np.zeros((3, t.size))
        for chunk in np.array_split(np.arange(t.size), t.size // 4096 + 1):
            angle = np.outer(t.reshape(-1)[chunk], w) + self.phases
            s, c = np.sin(angle), np.cos(angle)
            total[:, chunk] = s @ self.amplitudes, c @ (w * self.amplitudes), -s @ (w**2 * self.amplitudes)
        return product(tuple(total.reshape(3, *t.shape)), ramp_up(t, self.ramp))


@dataclass(frozen=True)
class SteppedSine(Motion):
    """A sine of one frequency [Hz] whose amplitude goes smoothly through `levels`, each held for `hold` seconds.

    One level is a steady sine. The change from a level to the next takes `blend` seconds at the start of the next.
    """

    frequency: float
    levels: tuple[float, ...]
    hold: float = 4.0
    blend: float = 0.2
    phase: float = 0.0
    ramp: float = 0.4

    def derivatives(self, t):
        t = np.asarray(t, float)
        levels = np.asarray(self.levels, float)
        index = np.clip(np.floor(t / self.hold).astype(int), 0, len(levels) - 1)
        before = levels[np.maximum(index - 1, 0)]
        step, first, second = smooth_step((t - index * self.hold) / self.blend)
        jump = levels[index] - before
        envelope = (before + jump * step, jump * first / self.blend, jump * second / self.blend**2)
        w = 2 * np.pi * self.frequency
        carrier = sine_of((w * t + self.phase, np.full_like(t, w), np.zeros_like(t)))
        return product(product(envelope, ramp_up(t, self.ramp)), carrier)


@dataclass(frozen=True)
class ModulatedSine(Motion):
    """An amplitude-modulated sine, x = A (1 + depth sin(2 pi f_m t)) sin(2 pi f t + phase). Frequencies in Hz."""

    amplitude: float
    frequency: float
    depth: float = 0.5
    modulation: float = 0.13
    phase: float = 0.0
    ramp: float = 0.4

    def derivatives(self, t):
        t = np.asarray(t, float)
        slow, fast = 2 * np.pi * self.modulation, 2 * np.pi * self.frequency
        zero = np.zeros_like(t)
        wave = sine_of((slow * t, zero + slow, zero))
        gain = self.amplitude * self.depth
        envelope = (self.amplitude + gain * wave[0], gain * wave[1], gain * wave[2])
        carrier = sine_of((fast * t + self.phase, zero + fast, zero))
        return product(product(envelope, ramp_up(t, self.ramp)), carrier)
