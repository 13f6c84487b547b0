"""Steady states of a joint with a dead zone under a sine of the base, by harmonic balance with many harmonics.

Alternating between frequency and time: the deflection is evaluated on a fine grid of one period and projected back. Nothing
here shares code with the package.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import root


def steady_state(inertia, backlash, stiffness, damping, amplitude, frequency, harmonics=31, start=None):
    """Odd complex amplitudes Z_1, Z_3, ... ((harmonics + 1) / 2,) of z under x = amplitude cos(2 pi frequency t).

    z = Re sum Z_n exp(j n w t). Args: SI units, backlash the total play; start: the same of a neighbouring state.
    """
    orders, omega, points = np.arange(1, harmonics + 1, 2), 2 * np.pi * frequency, 16 * harmonics
    theta = 2 * np.pi * np.arange(points) / points
    waves = np.exp(1j * np.outer(orders, theta))
    driven = np.where(orders == 1, amplitude, 0.0)

    def unpack(v):
        return v[: orders.size] + 1j * v[orders.size :]

    def balance(v):
        z_n = unpack(v)
        z = (z_n @ waves).real
        deflection = z - np.clip(z, -backlash / 2, backlash / 2)
        d_n = 2 * (waves.conj() @ deflection) / points
        left = -inertia * (orders * omega) ** 2 * (z_n + driven) + 1j * orders * omega * damping * z_n + stiffness * d_n
        return np.concatenate([left.real, left.imag]) / (inertia * omega**2 * amplitude)

    guess = np.where(orders == 1, backlash, 0.0).astype(complex) if start is None else start
    found = root(balance, np.concatenate([guess.real, guess.imag]), tol=1e-11)
    if np.max(np.abs(balance(found.x))) > 1e-8:
        raise RuntimeError(f"no steady state found at {frequency:g} Hz: {found.message}")
    return unpack(found.x)
