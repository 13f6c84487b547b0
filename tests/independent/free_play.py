"""Free vibration of a mass in a dead zone, exactly: every stretch between two edges, and when it ends, in closed form.

Nothing here shares code with the package, or with the other simulators.
"""

from __future__ import annotations

import numpy as np


def period(peak, half_play, omega):
    """Of the undamped motion with this peak > half_play: half a sine at either contact, a straight line between."""
    return 2 * np.pi / omega + 4 * half_play / (omega * (peak - half_play))


def decay(t, peak, half_play, omega, zeta=0.0):
    """z (n,) at the rising times t [s] of a mass released at rest from z = peak > half_play.

    Args: omega = sqrt(k/m) [rad/s]; zeta = c / (2 m omega), the damper acting always.
    """
    z, done, now = np.empty(len(t)), 0, 0.0
    piece, side = _Contact(peak - half_play, 0.0, omega, zeta), 1
    while done < len(t):
        lasts, to = (piece.lasts, 0) if side else piece.leaves(half_play)
        until = np.searchsorted(t, now + lasts, side="right") if np.isfinite(lasts) else len(t)
        z[done:until] = side * half_play + piece.at(t[done:until] - now)
        done, now = until, now + lasts
        if done < len(t):
            speed = piece.speed(lasts)
            piece = _Contact(0.0, speed, omega, zeta) if to else _Coast(side * half_play, speed, zeta * omega)
            side = to
    return z


class _Contact:
    """On a contact: the deflection is a damped sine, over when it first comes back to zero."""

    def __init__(self, depth, speed, omega, zeta):
        self.h0, self.damped, self.depth = zeta * omega, omega * np.sqrt(1 - zeta**2), depth
        self.swing = (speed + self.h0 * depth) / self.damped
        turn = np.arctan2(-depth, self.swing) % np.pi if depth else np.pi
        self.lasts = turn / self.damped

    def at(self, s):
        c, n = np.cos(self.damped * s), np.sin(self.damped * s)
        return np.exp(-self.h0 * s) * (self.depth * c + self.swing * n)

    def speed(self, s):
        c, n = np.cos(self.damped * s), np.sin(self.damped * s)
        return np.exp(-self.h0 * s) * self.damped * (self.swing * c - self.depth * n) - self.h0 * self.at(s)


class _Coast:
    """Inside the play: only the damper acts; the link reaches the other edge or comes to rest before."""

    def __init__(self, start, speed, h0):
        self.start, self.fast, self.rate = start, speed, 2 * h0

    def at(self, s):
        return self.start + self.fast * (-np.expm1(-self.rate * s) / self.rate if self.rate else s)

    def speed(self, s):
        return self.fast * np.exp(-self.rate * s)

    def leaves(self, half_play):
        """After how long [s] and on which side; never, if it comes to rest."""
        to = int(np.sign(self.fast))
        way = (to * half_play - self.start) / self.fast
        if self.rate * way >= 1:
            return np.inf, 0
        return (-np.log1p(-self.rate * way) / self.rate if self.rate else way), to
