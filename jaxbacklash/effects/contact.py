r"""The joint itself: a spring behind a play, and a damper that always acts (the paper's base model)."""

from __future__ import annotations

import equinox as eqx
import jax.numpy as jnp

from ..parameters import Scalar, param


def corner(u: Scalar, width: Scalar) -> tuple[Scalar, Scalar]:
    r"""A smoothed :math:`\max(u, 0)` and its slope, exact outside :math:`|u| < w`.

    The corner is the sharp one averaged with the parabolic (Epanechnikov) kernel of half-width ``width``: twice
    continuously differentiable, and at the corner it stands 3/16 of the width above the sharp law. Zero width is the sharp law.

    Parameters
    ----------
    u : distance beyond the edge of the play [rad], any shape
    width : half-width of the smoothing [rad], a stated length, >= 0

    Returns
    -------
    value [rad] and slope [1], of the shape of ``u``
    """
    # The floor is far below any corner that matters and keeps the derivative in the width finite.
    s = jnp.clip(u / jnp.maximum(width, 1e-12), -1.0, 1.0)
    value = width * (0.1875 + s * (0.5 + s * (0.375 - 0.0625 * s * s))) + jnp.maximum(u - width, 0.0)
    return value, 0.5 + s * (0.75 - 0.25 * s * s)


class Contact(eqx.Module):
    r"""Contact spring behind a play: :math:`T = -k\,\delta(z)`.

    :math:`\delta(z) = z - b/2` above the play, :math:`z + b/2` below it, 0 inside (PHYSICS: dead zone; paper, 3.1).
    ``backlash`` is the TOTAL play. ``width`` smooths both corners where the law is evaluated without a known region.
    """

    backlash: Scalar = param(unit="rad", lower=0.0, required=True, label="backlash (total play)")
    stiffness: Scalar = param(unit="N m/rad", lower=0.0, required=True, label="contact stiffness")
    width: Scalar = param(unit="rad", default=0.0, lower=0.0, fixed=True, label="corner smoothing half-width")


class Spring(eqx.Module):
    """A spring without play: :math:`T = -k z`."""

    stiffness: Scalar = param(unit="N m/rad", lower=0.0, required=True, label="stiffness")


class Damper(eqx.Module):
    r"""Viscous damping that always acts, in the play and in contact: :math:`T = -c\,\dot z`."""

    damping: Scalar = param(unit="N m s/rad", null=0.0, lower=0.0, required=True, label="viscous damping")
