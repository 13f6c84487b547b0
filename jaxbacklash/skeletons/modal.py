r"""Modal stiffness and damping at each moment, from complex amplitudes: FREEVIB, FORCEVIB and the base-motion form.

All three are one complex equation with two real unknowns, the paper's (2.3) with what drives the mass on the right:

.. math:: \omega_0^2 Z + 2 h_0 \dot Z = R,\qquad
   2 h_0 = \frac{\mathrm{Im}(R/Z)}{\mathrm{Im}(\dot Z/Z)},\qquad
   \omega_0^2 = \mathrm{Re}(R/Z) - 2 h_0\,\mathrm{Re}(\dot Z/Z).

With :math:`Z = A e^{j\varphi}`, :math:`\dot Z/Z = \dot A/A + j\omega` and
:math:`\ddot Z/Z = \ddot A/A - \omega^2 + j(2\omega\dot A/A + \dot\omega)` these are (2.4a) and (2.4b) word for word. Arguments
are amplitudes (M,) of a signal and of its derivatives, as `Fundamental.of` gives them; results are
:math:`\omega_0^2` [1/s^2] and :math:`h_0` [1/s], real (M,). The sources are Feldman's FREEVIB and FORCEVIB as the paper
quotes them.
"""

from __future__ import annotations

import numpy as np

Pair = tuple[np.ndarray, np.ndarray]


def modal(z: np.ndarray, dz: np.ndarray, right: np.ndarray) -> Pair:
    """Solve the equation above; ``right`` is R, the force per inertia less the acceleration. Shapes (M,)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio, rate = right / z, dz / z
        twice = ratio.imag / rate.imag
        return ratio.real - twice * rate.real, 0.5 * twice


def freevib(y: np.ndarray, dy: np.ndarray, ddy: np.ndarray) -> Pair:
    """Free vibration: (2.4) without a force."""
    return modal(y, dy, -ddy)


def forcevib(y: np.ndarray, dy: np.ndarray, ddy: np.ndarray, force: np.ndarray, inertia: float) -> Pair:
    """Vibration under a measured force [N m] on an inertia [kg m^2]: (2.4a) and (2.4b)."""
    return modal(y, dy, force / inertia - ddy)


def base_motion(
    z: np.ndarray, dz: np.ndarray, ddz: np.ndarray, ddx: np.ndarray, gravity: float = 0.0, y: np.ndarray | float = 0.0
) -> Pair:
    """Vibration z against a base that moves by x: (3.6), with gravity C = m g L / J [1/s^2] acting on y = z + x."""
    return modal(z, dz, gravity * y - ddz - ddx)
