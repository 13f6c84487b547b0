r"""Recognising a system whose motion is exact between switches, and bringing it to units of its half play.

In z = y - x, with play b around its middle :math:`z_m` and :math:`z = z_m + (b/2)\,p`, the joint with a spring across its
play, linear gravity, preload and damping of the contact under a harmonic force or base motion is `LinearPieces`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..effects import AsymmetricGap, Contact, GapSpring, LinearGravity, Preload
from ..effects.damping import ContactDamping
from ..excitation import AbstractExcitation, Harmonic
from ..sensors import SensorDelay, SensorGain, SensorOffset
from ..solvers.exact_courses import Joint
from ..solvers.linear_pieces import LinearPieces
from ..system import System

Array = Any
KNOWN = (AsymmetricGap, GapSpring, LinearGravity, Preload, ContactDamping, SensorDelay, SensorGain, SensorOffset)
"""Laws under which the motion stays linear between the edges; what the sensors do to it is not part of it."""


class NormalForm(NamedTuple):
    """``pieces`` in units of the half play and the system's own time; ``phase`` of the drive at t = 0 [rad];
    z is ``middle + half_play p`` [rad]."""

    pieces: LinearPieces
    phase: Array
    middle: Array
    half_play: Array


def not_linear(system: System) -> str | None:
    """Why the motion is not linear between the edges of a play, in a few words; None when it is."""
    if not isinstance(system.contact, Contact):
        return "there is no play"
    other = sorted(name for name, effect in system.effects.items() if type(effect) not in KNOWN)
    if other:
        return f"{other[0]} is not linear between the edges"
    if np.any(np.asarray(system.contact.backlash) <= 0.0):
        return "the play is closed"
    return None


def why_not(system: System, drive: AbstractExcitation) -> str | None:
    """Why the exact steps of a harmonic drive cannot be used; None when they can. Parameters may be arrays over cells."""
    why = not_linear(system)
    if why is not None:
        return why
    if not isinstance(drive, Harmonic):
        return "the drive is not harmonic"
    form = normal_form(system, drive)
    p = form.pieces
    if np.any((np.asarray(p.stiffness) == 0.0) & (np.asarray(p.load) != 0.0)):
        return "a constant load acts in a play without a spring"
    if np.any(np.asarray(p.stiffness + p.contact_stiffness) <= 0.0):
        return "a contact pushes outwards"
    if np.any(np.asarray(p.omega) <= 0.0):
        return "the drive stands still"
    for stiffness, damping in (
        (p.stiffness, p.damping), (p.stiffness + p.contact_stiffness, p.damping + p.contact_damping),
    ):  # fmt: skip
        near = np.abs(np.asarray(stiffness - p.omega**2)) < 1e-9 * np.asarray(p.omega) ** 2
        if np.any(near & (np.asarray(damping) < 1e-9 * np.asarray(p.omega))):
            return "an undamped branch is driven in resonance"
    return None


def normal_form(system: System, drive: Harmonic) -> NormalForm:
    """The system under a harmonic drive in units of its half play; parameters may be arrays over cells of one shape."""
    joint, middle, half = bare_joint(system)
    # J z'' = ... + F + G x - J x''
    by = joint.by_force if drive.as_force else joint.by_x - joint.by_bend * drive.omega**2
    size = by * drive.amplitude
    one = np.ones(np.broadcast_shapes(np.shape(joint.damping), np.shape(size), np.shape(drive.omega)))
    pieces = LinearPieces(
        one * joint.damping, one * joint.contact_damping, one * joint.stiffness, one * joint.contact_stiffness,
        one * joint.load, one * size, one * drive.omega,
    )  # fmt: skip
    return NormalForm(pieces, one * drive.phase, one * middle, one * half)


def bare_joint(system: System) -> tuple[Joint, Array, Array]:
    """The joint in units of its half play, whatever drives it, the middle of the play and half of it [rad]."""
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
    load = constant + k1 * z1 - (k1 - G) * middle
    numbers = (
        system.damper.damping / inertia, extra / inertia, (k1 - G) / inertia, system.contact.stiffness / inertia,
        load / (inertia * half), G / (inertia * half), -1.0 / half, 1.0 / (inertia * half),
    )  # fmt: skip
    # numpy: numbers that are known need no program of their own for each operation.
    one = np.ones(np.broadcast_shapes(*(np.shape(v) for v in (*numbers, middle))))
    return Joint(*(one * v for v in numbers)), one * middle, one * half
