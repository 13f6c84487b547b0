r"""Recognising a system whose motion is exact between switches, and bringing it to units of its half play.

In z = y - x, with play b around its middle :math:`z_m` and :math:`z = z_m + (b/2)\,p`, the joint with a spring across its
play, linear gravity, preload and damping of the contact under a harmonic force or base motion is `LinearPieces`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np

from ..effects import AsymmetricGap, Contact, GapSpring, LinearGravity, Preload
from ..effects.damping import ContactDamping
from ..excitation import AbstractExcitation, Harmonic
from ..solvers.linear_pieces import LinearPieces
from ..system import System

Array = Any
KNOWN = (AsymmetricGap, GapSpring, LinearGravity, Preload, ContactDamping)


class NormalForm(NamedTuple):
    """``pieces`` in units of the half play and the system's own time; ``phase`` of the drive at t = 0 [rad];
    z is ``middle + half_play p`` [rad]."""

    pieces: LinearPieces
    phase: Array
    middle: Array
    half_play: Array


def why_not(system: System, drive: AbstractExcitation) -> str | None:
    """Why the exact steps cannot be used, in a few words; None when they can. Parameters may be arrays over cells."""
    if not isinstance(system.contact, Contact):
        return "there is no play"
    if not isinstance(drive, Harmonic):
        return "the drive is not harmonic"
    other = sorted(name for name, effect in system.effects.items() if type(effect) not in KNOWN)
    if other:
        return f"{other[0]} is not linear between the edges"
    form = normal_form(system, drive)
    p = form.pieces
    if np.any((np.asarray(p.stiffness) == 0.0) & (np.asarray(p.load) != 0.0)):
        return "a constant load acts in a play without a spring"
    if np.any(np.asarray(p.stiffness + p.contact_stiffness) <= 0.0):
        return "a contact pushes outwards"
    if np.any(np.asarray(p.omega) <= 0.0) or np.any(np.asarray(form.half_play) <= 0.0):
        return "the drive stands still or the play is closed"
    for stiffness, damping in (
        (p.stiffness, p.damping), (p.stiffness + p.contact_stiffness, p.damping + p.contact_damping),
    ):  # fmt: skip
        near = np.abs(np.asarray(stiffness - p.omega**2)) < 1e-9 * np.asarray(p.omega) ** 2
        if np.any(near & (np.asarray(damping) < 1e-9 * np.asarray(p.omega))):
            return "an undamped branch is driven in resonance"
    return None


def normal_form(system: System, drive: Harmonic) -> NormalForm:
    """The system in units of its half play; parameters may be arrays over cells of one shape."""
    assert isinstance(system.contact, Contact)
    inertia, half = system.inertia, 0.5 * system.contact.backlash
    found: dict[Any, Any] = {type(effect): effect for effect in system.effects.values()}
    spring, weight = found.get(GapSpring), found.get(LinearGravity)
    k1, z1 = (spring.k1, spring.z0) if spring else (0.0, 0.0)
    G = weight.G if weight else 0.0
    constant = found[Preload].T0 if Preload in found else 0.0
    middle = found[AsymmetricGap].z0 if AsymmetricGap in found else 0.0
    extra = found[ContactDamping].cc if ContactDamping in found else 0.0
    # J z'' = F + T0 - k delta - c z' - k1 (z - z1) + G (z + x) - J x''
    size = drive.amplitude if drive.as_force else (G + inertia * drive.omega**2) * drive.amplitude
    load = constant + k1 * z1 - (k1 - G) * middle
    # numpy: numbers that are known need no program of their own for each operation.
    one = np.ones(jnp.broadcast_shapes(*(jnp.shape(v) for v in (inertia, half, k1, size, load, extra, drive.omega,
        system.damper.damping, system.contact.stiffness))))  # fmt: skip
    pieces = LinearPieces(
        one * system.damper.damping / inertia, one * extra / inertia, one * (k1 - G) / inertia,
        one * system.contact.stiffness / inertia, one * load / (inertia * half), one * size / (inertia * half), one * drive.omega,
    )  # fmt: skip
    return NormalForm(pieces, one * drive.phase, one * middle, one * half)
