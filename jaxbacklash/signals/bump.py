r"""A smooth bump that carries derivatives: :math:`\int \varphi \ddot u = \int \ddot\varphi\, u`; no sample is differenced."""

from __future__ import annotations

import numpy as np

HALF_WIDTH = 0.05
"""Half-width of the bump [s]: shorter amplifies noise, longer blurs the contacts."""


class Bump:
    r"""The bump :math:`(1 - \tau^2)^4` at positions a quarter half-width apart.

    Parameters
    ----------
    samples : length of the signals
    dt : sample spacing [s]
    half_width : [s], eight samples at least
    """

    def __init__(self, samples: int, dt: float, half_width: float = HALF_WIDTH) -> None:
        reach = int(np.clip(round(half_width / dt), 8, samples // 6))
        tau = np.arange(-reach, reach + 1) / reach
        base = 1.0 - tau**2
        first = -8.0 * tau * base**3 / (reach * dt)
        second = (48.0 * tau**2 * base**2 - 8.0 * base**3) / (reach * dt) ** 2
        self._orders = base**4, first, second
        self.stride = max(1, reach // 4)

    def against(self, values: np.ndarray, order: int = 0) -> np.ndarray:
        """One or several signals (..., N) summed against the bump or its derivative of order 1 or 2: (..., R)."""
        bump = self._orders[order]
        return np.lib.stride_tricks.sliding_window_view(values, bump.size, axis=-1)[..., :: self.stride, :] @ bump

    def loudness(self, order: int = 0) -> float:
        """Standard deviation of what `against` makes of white noise of deviation 1."""
        return float(np.linalg.norm(self._orders[order]))
