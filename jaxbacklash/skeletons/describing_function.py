r"""What a dead zone returns to a sine: its describing function, the inverse, and the trap beside it.

A dead zone of half play h under :math:`z = A \sin\theta`, A > h, answers with the fundamental :math:`k A N(h/A)`,

.. math:: N(r) = 1 - \tfrac{2}{\pi}\left(\arcsin r + r\sqrt{1 - r^2}\right).

For large A the force :math:`k A N` runs along :math:`k (A - \tfrac{4}{\pi} h)`: a straight line through a restoring-force
skeleton (the paper's Figure 14) cuts the axis at 1.27 times the half play. `axis_crossing` is kept to show that, not to be used.
"""

from __future__ import annotations

import numpy as np

TRAP = 4.0 / np.pi
"""Where the asymptote cuts the axis, in half plays."""


def dead_zone(z: np.ndarray, half_play: float, centre: float = 0.0) -> np.ndarray:
    """Deflection of the contact: z beyond the play, 0 inside it, same shape and unit as z."""
    return z - np.clip(z, centre - half_play, centre + half_play)


def describing_function(amplitude: np.ndarray | float, half_play: float) -> np.ndarray:
    """N, the share of the contact stiffness that a sine of this amplitude feels: 0 inside the play, towards 1 far beyond."""
    amplitude = np.asarray(amplitude, float)
    with np.errstate(divide="ignore"):
        r = np.minimum(half_play / amplitude, 1.0)
    return 1.0 - 2.0 / np.pi * (np.arcsin(r) + r * np.sqrt(1.0 - r * r))


def half_play_for(share: float, amplitude: float) -> float:
    """The half play whose describing function at this amplitude is ``share``, 0 to 1: the inverse in h."""
    if not 0.0 <= share <= 1.0:
        raise ValueError(f"share {share:g}: wanted a number from 0 to 1")
    from scipy.optimize import brentq  # a seventh of a second to import, and a fit's cross-check does without

    return float(brentq(lambda h: float(describing_function(amplitude, h)) - share, 0.0, amplitude, xtol=1e-14 * amplitude))


def free_play_frequency(peak: np.ndarray | float, half_play: float, omega: float) -> np.ndarray:
    """Backbone of a free mass in a dead zone, exact [rad/s]: period 2 pi / omega + 4 h / (omega (A - h)), A the peak > h."""
    peak = np.asarray(peak, float)
    return 2.0 * np.pi / (2.0 * np.pi / omega + 4.0 * half_play / (omega * (peak - half_play)))


def axis_crossing(amplitude: np.ndarray, force: np.ndarray) -> tuple[float, float]:
    """The paper's regression: slope of a straight line through the restoring force, and where it cuts the axis.

    The paper does not say through which points its line goes. Through large amplitudes, where the curve looks straight, it runs
    near the asymptote; through all of them it is flatter, and its crossing lower: near the half play by chance, or below it.

    Parameters
    ----------
    amplitude, force : the skeleton (3.7) or the part of it that the line is to follow, shape (M,)

    Returns
    -------
    slope, crossing; the crossing is biased as a half play by up to 27 %
    """
    slope, offset = np.polyfit(amplitude, force, 1)
    return float(slope), float(-offset / slope)
