"""A record seen through a bump: the equation of motion in weak form, one row a position of the bump, and the laws' columns.

Both sides of J y'' = sum of torques are multiplied by a bump phi = (1 - u^2)^6 of half width `HALF_WIDTH` and summed. y'' and
z' then need no derivative of the data, which falls on the bump: sum phi'' y and -sum phi' z, from the raw samples. Laws that
are not linear in the motion are evaluated on a smoothed motion (a Wiener filter, undersmoothed), on a grid twice as fine as
the samples; indicators and signs are averaged exactly over each cell of that grid, so that where a jump falls between samples
matters little. numpy and scipy only; nothing is shared with the package.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy import fft
from scipy.interpolate import make_interp_spline
from scipy.ndimage import uniform_filter1d
from scipy.signal import lfilter

HALF_WIDTH, OVERLAP = 0.06, 5
"""Half width of the bump [s], and its positions a half width. A sixth power at 60 ms is as wide as a fourth at
50, and its sums over samples are as good as integrals to 1e-6."""
FINE = 2
"""Cells a sample."""
UNDERSMOOTH = 0.5
"""Share of the Wiener filter's attenuation that is really applied."""
LARGEST_DELAY = 0.02
"""[s]"""


def bump(u: np.ndarray, order: int) -> np.ndarray:
    """phi = (1 - u^2)^6 inside |u| < 1 or its derivative by u of order 0, 1, 2."""
    base = np.maximum(1.0 - u**2, 0.0)
    return (base**6, -12.0 * u * base**5, 120.0 * u**2 * base**4 - 12.0 * base**5)[order]


@dataclass(frozen=True)
class Smooth:
    """A channel without most of its noise: `values` (n,), and `sigma`, the standard deviation of its white noise.

    `gain` (n,) is the filter, over the frequencies of a cosine transform.
    """

    values: np.ndarray
    sigma: float
    gain: np.ndarray


def smooth(raw: np.ndarray, gain: np.ndarray | None = None) -> Smooth:
    """Wiener filter in a cosine transform: the noise's power is the median of the highest third of frequencies."""
    n = raw.size
    line = np.linspace(raw[0], raw[-1], n)
    lines = fft.dct(raw - line, norm="ortho")
    top = lines[2 * n // 3 :] ** 2
    floor = float(np.median(top)) / 0.4549  # the median of a chi-square of one degree of freedom
    if gain is None:
        power = uniform_filter1d(lines**2, max(9, n // 200))
        excess = np.maximum.accumulate(np.maximum(power / max(floor, 1e-300) - 1.5, 0.0)[::-1])[::-1]
        gain = excess / (excess + UNDERSMOOTH)
    return Smooth(fft.idct(lines * gain, norm="ortho") + line, float(np.sqrt(floor)), gain)


@dataclass(frozen=True)
class View:
    """The motion for given play and sensor errors, in the middle of each fine cell; arrays (m,).

    t [s]; y, z [rad]; dy, dz [rad/s]; d, how far the contact is pressed in [rad]; above, below: share of the cell in contact
    on that side; sign_z, sign_y: mean sign of the speeds.
    """

    t: np.ndarray
    y: np.ndarray
    dy: np.ndarray
    z: np.ndarray
    dz: np.ndarray
    d: np.ndarray
    above: np.ndarray
    below: np.ndarray
    sign_z: np.ndarray
    sign_y: np.ndarray

    @property
    def touch(self) -> np.ndarray:
        """Share of the cell in contact."""
        return self.above + self.below


@dataclass
class Rows:
    """The record under the bump.

    Args: t (n,) even times [s]; x base and z relative motion (n,) [rad]; gains: filters to use instead of own ones.
    """

    t: np.ndarray
    x: np.ndarray
    z: np.ndarray
    gains: tuple[np.ndarray, np.ndarray] | None = None
    _views: dict[tuple[float, ...], View] = field(default_factory=dict, repr=False)
    _raw: dict[tuple[str, int, float], np.ndarray] = field(default_factory=dict, repr=False)
    _late: dict[float, tuple[np.ndarray, ...]] = field(default_factory=dict, repr=False)
    _signs: dict[tuple[float, float], tuple[np.ndarray, np.ndarray]] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        self.dt = float(self.t[-1] - self.t[0]) / (self.t.size - 1)
        self.stride = max(2, round(HALF_WIDTH / self.dt / OVERLAP))
        self.reach = OVERLAP * self.stride
        self.pad = int(np.ceil(LARGEST_DELAY / self.dt))
        ends = self.reach + self.pad + 1
        self.centres = np.arange(ends, self.t.size - ends, self.stride)
        gain = (None, None) if self.gains is None else self.gains
        self.smooth_x, self.smooth_z = smooth(self.x, gain[0]), smooth(self.z, gain[1])
        self.spline_x, self.spline_z = (make_interp_spline(self.t, s.values, k=5) for s in (self.smooth_x, self.smooth_z))
        self.step = self.dt / FINE
        self.edges = self.t[0] + np.arange((self.t.size - 1) * FINE + 1) * self.step
        self.middles = 0.5 * (self.edges[1:] + self.edges[:-1])
        u = (np.arange(2 * self.reach * FINE) + 0.5) / (self.reach * FINE) - 1.0
        self._taps = (bump(u, 0) * self.step).reshape(2 * OVERLAP, self.stride * FINE).T

    def raw(self, channel: str, order: int, delay: float = 0.0) -> np.ndarray:
        """Integral of phi and the derivative of that order of a raw channel, x or z, read `delay` later: (rows,)."""
        key = (channel, order, delay)
        if key not in self._raw:
            if len(self._raw) > 24:
                self._raw.clear()
            width = self.reach + self.pad
            u = (np.arange(-width, width + 1) * self.dt - delay) / (self.reach * self.dt)
            taps = bump(u, order) * self.dt / (-self.reach * self.dt) ** order
            windows = np.lib.stride_tricks.sliding_window_view(getattr(self, channel), taps.size)
            self._raw[key] = windows[self.centres - width] @ taps
        return self._raw[key]

    def over(self, *torques: np.ndarray) -> np.ndarray:
        """Integrals of phi and torques on the fine cells, each (m,): (rows, q). Strides are blocks, and a bump is ten of them."""
        begin, rows = (self.centres[0] - self.reach) * FINE, self.centres.size
        blocks = rows + 2 * OVERLAP - 1
        out = np.empty((rows, len(torques)))
        for j, torque in enumerate(torques):
            parts = torque[begin : begin + blocks * self.stride * FINE].reshape(blocks, -1) @ self._taps
            out[:, j] = sum(parts[i : i + rows, i] for i in range(2 * OVERLAP))
        return out

    @cached_property
    def _base(self) -> tuple[np.ndarray, ...]:
        return self.spline_x(self.middles), self.spline_x(self.middles, 1), self.spline_x(self.edges, 1)

    def _joint(self, tau: float) -> tuple[np.ndarray, ...]:
        """z and its speed in the middles and at the edges of the cells, read `tau` later."""
        near = next((known for known in self._late if abs(known - tau) < 5e-5), None)
        if near is None:
            if len(self._late) > 6:
                self._late.clear()
            middles, edges = (np.minimum(v + tau, self.t[-1]) for v in (self.middles, self.edges))
            self._late[tau] = tuple(self.spline_z(v, order) for v in (middles, edges) for order in range(3))
            near = tau
        z, dz, ddz, z_edge, dz_edge, ddz_edge = self._late[near]
        if near == tau:
            return z, dz, z_edge, dz_edge
        more = tau - near
        return z + more * dz, dz + more * ddz, z_edge + more * dz_edge, dz_edge + more * ddz_edge

    def view(self, b: float, z0: float = 0.0, r: float = 0.0, tau: float = 0.0, g: float = 1.0) -> View:
        """The motion for a total play b [rad] centred at z0 [rad] that grows by r [1/s], and a z seen g-fold and tau [s] late."""
        key = (b, z0, r, tau, g)
        if key not in self._views:
            if len(self._views) > 12:
                self._views.clear()
            self._views[key] = self._view(*key)
        return self._views[key]

    def _view(self, b: float, z0: float, r: float, tau: float, g: float) -> View:
        x, dx, dx_edge = self._base
        z, dz, z_edge, dz_edge = (v / g for v in self._joint(tau))
        half, half_edge = (0.5 * b * (1.0 + r * v) for v in (self.middles, self.edges)) if r else (0.5 * b, 0.5 * b)
        above, below = _share(z_edge - z0 - half_edge), _share(z0 - z_edge - half_edge)
        d = np.maximum(z - z0 - half, 0.0) - np.maximum(z0 - z - half, 0.0)
        if (tau, g) not in self._signs:
            self._signs = {(tau, g): (_sign(dz_edge), _sign(dx_edge + dz_edge))}
        return View(self.middles, x + z, dx + dz, z, dz, d, above, below, *self._signs[tau, g])


def _share(u: np.ndarray) -> np.ndarray:
    """Share of each cell in which u > 0, u linear between the edges: (m + 1,) to (m,)."""
    step, rise = np.diff(u), np.diff(np.maximum(u, 0.0))
    flat = np.abs(step) < 1e-14
    return np.where(flat, (u[1:] > 0.0).astype(float), rise / np.where(flat, 1.0, step))


def _sign(v: np.ndarray) -> np.ndarray:
    """Mean sign of v over each cell."""
    return 2.0 * _share(v) - 1.0


def dahl(z: np.ndarray, length: float) -> np.ndarray:
    """Dahl's friction in units of its Coulomb limit along z (m,): u' = z' (1 - u sgn z') / length, exact for every z."""
    step = np.sign(np.diff(z))
    turns = np.concatenate([[0], np.flatnonzero(step[1:] != step[:-1]) + 1, [z.size - 1]])
    out, u = np.zeros_like(z), 0.0
    for a, b in pairwise(turns):
        # Between two reversals u goes exponentially to the direction of sliding.
        if s := step[a]:
            out[a : b + 1] = s + (u - s) * np.exp(-np.abs(z[a : b + 1] - z[a]) / length)
            u = out[b]
        else:
            out[a : b + 1] = u
    return out


def follower(y: np.ndarray, step: float, omega: float, zeta: float) -> np.ndarray:
    """Motion y2 (m,) of an inertia hung on y (m,) by a spring and a damper: natural frequency omega [rad/s], damping ratio.

    Bilinear transform with the natural frequency kept.
    """
    w = np.tan(0.5 * omega * step)
    top = np.array([w * w + 2.0 * zeta * w, 2.0 * w * w, w * w - 2.0 * zeta * w])
    bottom = np.array([1.0 + 2.0 * zeta * w + w * w, 2.0 * w * w - 2.0, 1.0 - 2.0 * zeta * w + w * w])
    return lfilter(top / bottom[0], bottom / bottom[0], y - y[0]) + y[0]
