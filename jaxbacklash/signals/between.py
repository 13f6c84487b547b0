r"""How a rough force goes on from one sample to the next: in straight lines, held, or along a smooth curve.

A computer's output is held, a simulated force mostly straight, and what has passed an analogue filter is a curve. Of a slow
force it hardly matters; at a tenth of the sampling rate a held force lags half a sample, which a fit would take for physics.

The record tells. Under test functions :math:`\varphi` (a Hann window times :math:`e^{-i\omega t}`, windows half apart) the force
is what inertia, damping, stiffness and some plain nonlinear laws make of the motion,

.. math::
    H(\omega) \int \varphi F = m \int \ddot\varphi y - c \int \dot\varphi y + k \int \varphi y + \sum_j p_j \int \varphi g_j,

where H is what each way of going on makes of the samples: :math:`\mathrm{sinc}^2`, :math:`\mathrm{sinc}\; e^{-i\omega\Delta/2}`
(which is a lag) or 1. Whichever leaves least at every frequency is likeliest; y may lag as well, so that a sensor that is
late is no force that is held.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import solveh_banded

WAYS = ("straight", "held", "curved")
LENGTH, LEAST, MOST = 512, 4, 24
"""Samples a window, windows that have to fit into a record half apart, and windows that are looked at."""
HEARD, HIGHEST = 30.0, 0.42
"""A frequency counts where the motion's power is so many times that near the highest ones, and below this share of the rate."""
LAGS = np.arange(-1.0, 4.1, 0.25)
"""Lags of the motion that are tried [samples]."""
ROUNDS, LEFT = 12, 0.03
"""How often the frequencies are weighed anew by what is left there, and the share of the median that this counts as at least:
without noise, the few that fit best would soon be all that is fitted."""
CLEARLY = 0.1
"""Gain in log-likelihood a complex value (a frequency in a window) above which one way is likelier than another."""


def way_between(force: np.ndarray, motion: np.ndarray) -> str:
    """One of `WAYS`; the straight line where the record does not tell, or is too short.

    ``force``, ``motion`` : samples of the force on a link and of its position y, both (N,), evenly spaced
    """
    seen = _Seen(force, motion)
    if seen.count == 0:
        return WAYS[0]
    prompt = {way: seen.likelihood(way, 0.0) for way in WAYS}
    late = {way: max(seen.likelihood(way, lag) for lag in LAGS) for way in WAYS}
    best, margin = max(late.values()), CLEARLY * seen.count
    for found in (prompt, late):  # a motion that does not lag is simpler than one that does
        likeliest = max(found, key=lambda way: found[way])
        if found[likeliest] > best - margin:
            return WAYS[0] if found[WAYS[0]] > found[likeliest] - margin else likeliest
    return WAYS[0]


def edges_between(force: np.ndarray, every: int, way: str) -> np.ndarray:
    """Values at ``every`` points a sample, shape ((N - 1) every + 1,), whose straight lines stand for the force.

    They are those of the force itself where it is straight, else those of its projection on straight lines (least squares over
    time), whose effect on anything slow beside them is that of the force up to the fourth order of their spacing.
    """
    at = np.arange((force.size - 1) * every + 1) / every
    if way == "straight" or force.size < 8:
        return np.interp(at, np.arange(force.size), force)
    # Moments of the force against the hats of the grid, in units of its spacing.
    if way == "held":
        pieces = np.repeat(force[:-1], every)
        moments = 0.5 * (np.append(pieces, 0.0) + np.append(0.0, pieces))
    else:
        from scipy.interpolate import make_interp_spline  # a sixth of a second to import, and few records need it

        curve = make_interp_spline(np.arange(force.size), force, k=5)
        nodes, weights = np.polynomial.legendre.leggauss(4)
        shares = 0.5 * (nodes + 1.0)
        values = curve(at[:-1, None] + shares / every) * (0.5 * weights)
        moments = np.append(values @ (1.0 - shares), 0.0) + np.append(0.0, values @ shares)
    overlap = np.full((2, at.size), 1.0 / 6.0)
    overlap[1] = 2.0 / 3.0
    overlap[1, [0, -1]] = 1.0 / 3.0
    return np.asarray(solveh_banded(overlap, moments))


class _Seen:
    """A record under the test functions: ``count`` complex values, none where nothing is heard."""

    def __init__(self, force: np.ndarray, motion: np.ndarray) -> None:
        self.count = 0
        starts = np.arange(0, force.size - LENGTH + 1, LENGTH // 2)
        size, push = float(np.std(motion)), float(np.std(force))
        if starts.size < LEAST or not size or not push:
            return
        at = starts[:: -(-starts.size // MOST), None] + np.arange(LENGTH)
        share = np.fft.rfftfreq(LENGTH)  # of the sampling rate
        phase = 2.0 * np.pi * np.arange(LENGTH) / LENGTH
        hann, slope = 0.5 * (1.0 - np.cos(phase)), np.pi / LENGTH * np.sin(phase)
        bend = 2.0 * (np.pi / LENGTH) ** 2 * np.cos(phase)

        def under(values: np.ndarray, window: np.ndarray = hann) -> np.ndarray:
            return np.fft.rfft(values[at] * window, axis=1)

        y = motion / size
        omega = 2.0 * np.pi * share
        flat = under(y)
        tilted = under(y, slope) - 1j * omega * flat
        curved = under(y, bend) - 2j * omega * under(y, slope) - omega**2 * flat
        power = np.mean(np.abs(flat) ** 2, axis=0)
        floor = np.median(power[int(0.9 * power.size) :])
        heard = (power > HEARD * floor) & (share < HIGHEST) & (np.arange(share.size) > 1)
        laws = [under(v) for v in (y**2, y**3, np.abs(y), np.sign(np.gradient(y)))]
        self.share, self.omega = share[heard], omega[heard]
        self.force = under(force / push)[:, heard]
        self.terms = np.stack([curved, tilted, flat, *laws])[:, :, heard]
        self.count = self.force.size

    def likelihood(self, way: str, lag: float) -> float:
        """The log-likelihood, up to what all ways have in common."""
        seen = np.sinc(self.share) ** 2 if way == "straight" else np.ones_like(self.share, dtype=complex)
        if way == "held":
            seen = np.sinc(self.share) * np.exp(-0.5j * self.omega)
        terms = self.terms * (np.exp(1j * self.omega * lag) / seen)
        left: Any = np.ones(self.share.size)
        for _ in range(ROUNDS):
            weighted = terms / left
            gram = np.einsum("iwf,jwf->ij", weighted.conj(), terms).real
            pull = np.einsum("iwf,wf->i", weighted.conj(), self.force).real
            scale = np.sqrt(np.maximum(np.diag(gram), 1e-300))  # a law may find nothing to act on
            found = np.linalg.lstsq(gram / scale / scale[:, None], pull / scale, rcond=1e-12)[0] / scale
            left = np.mean(np.abs(self.force - np.einsum("i,iwf->wf", found, terms)) ** 2, axis=0)
            left = np.maximum(left, LEFT * np.median(left) + 1e-300)
        return -float(np.sum(np.log(left))) * self.force.shape[0]
