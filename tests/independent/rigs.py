"""Random joints, excitations and hidden effects, in the ranges of a laboratory two-link rig.

The natural frequency is near 10 Hz and the play near 1.5 degrees; every strength below is large enough to be found at
an encoder noise of 3e-5 rad and small enough not to change the character of the motion.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from tests.independent.motions import Chirp, ModulatedSine, Motion, Multisine, Rest, SteppedSine

KINDS = ("chirp", "multisine", "stepped", "modulated", "free_decay", "force_chirp", "force_multisine")

# name -> parameter -> (low, high) of a uniform draw; a name in SIGNED also draws the sign of its first parameter.
STRENGTHS = {
    "gravity": {"G": (15.0, 45.0)},
    "preload": {"T0": (4.0, 15.0)},
    "gap_spring": {"k1": (200.0, 800.0)},
    "asymmetric_gap": {"z0": (0.001, 0.003)},
    "asymmetric_stiffness": {"a": (0.05, 0.2)},
    "cubic_stiffness": {"k3": (1e7, 4e7)},
    "contact_damping": {"cc": (10.0, 25.0)},
    "hunt_crossley": {"chi": (800.0, 3000.0)},
    "coulomb_joint": {"Tc": (2.0, 5.0)},
    "stribeck": {"Tc": (2.0, 4.0), "Ts": (5.0, 8.0), "vs": (0.05, 0.15)},
    "coulomb_ground": {"Tc": (2.0, 5.0)},
    "quadratic_drag": {"q": (4.0, 12.0)},
    "torque_ripple": {"A": (4.0, 10.0), "N": (20.0, 100.0), "phi": (-np.pi, np.pi)},
    "dahl": {"sigma": (1000.0, 4000.0), "Fc": (4.0, 8.0)},
    "lugre": {"sigma0": (2000.0, 6000.0), "sigma1": (1.0, 5.0), "Fc": (3.0, 5.0), "Fs": (5.0, 8.0), "vs": (0.05, 0.15)},
    "bouc_wen": {"sigma": (1000.0, 4000.0), "Fc": (4.0, 8.0), "n": (1.0, 2.0), "beta": (0.5, 1.0)},
    "flexible_link": {"J2": (0.4, 0.8), "k2": (12000.0, 24000.0), "c2": (0.8, 2.0)},
    "gap_drift": {"r": (0.005, 0.015)},
    "stiffness_drift": {"r": (0.004, 0.012)},
    "sensor_delay": {"tau": (0.001, 0.004)},
    "sensor_gain": {"g": (1.02, 1.06)},
    "sensor_offset": {"z_s": (0.0005, 0.002)},
    "unknown_disturbance": {"A": (4.0, 10.0), "w": (20.0, 50.0), "phi": (-np.pi, np.pi)},
    "speed_stiffness": {"s": (2000.0, 5000.0)},
}
RIG_STRENGTHS = {
    "gravity:off": {"G": (15.0, 45.0), "phi0": (0.2, 1.2)},
    "transmission_error": {"e": (5e-4, 2e-3), "M": (15.0, 80.0), "psi": (-np.pi, np.pi)},
    "load_friction": {"mu": (0.05, 0.2)},
    "second_play": {"J2": (0.4, 0.8), "k2": (12000.0, 24000.0), "c2": (2.0, 6.0), "b2": (0.004, 0.016)},
    "relaxation": {"kr": (600.0, 3000.0), "tau_r": (0.02, 0.2)},
    "contact_exponent": {"p": (1.15, 1.8), "d0": (0.005, 0.005)},
    "damping_drift": {"r": (0.015, 0.05)},
    "friction_drift": {"r": (0.015, 0.05)},
    "disturbance": {"A": (2.0, 10.0), "omega": (15.0, 120.0), "phi": (-np.pi, np.pi)},
    "sensor_filter": {"tau_f": (0.002, 0.008)},
    "clock_drift": {"r": (5e-5, 3e-4)},
    "contact_damping:pushes": {"cc": (10.0, 25.0), "pulls": (0.0, 0.0)},
    "hunt_crossley:pushes": {"chi": (800.0, 3000.0), "pulls": (0.0, 0.0)},
}
"""The same of laws that real rigs add; what stands behind a colon is the form of the law before it."""
OUTSIDE_STRENGTHS = {
    "speed_stiffness": {"s": (2000.0, 5000.0)},
    "pulsing_stiffness": {"a": (0.1, 0.3), "w": (30.0, 90.0)},
    "end_stop": {"K": (300.0, 1000.0), "y1": (0.0, 0.02)},
    "detent": {"A": (5.0, 15.0), "width": (0.01, 0.03)},
    "rumble": {"A": (1.5, 4.0)},
    "play_step": {"a": (0.05, 0.2), "t1": (6.0, 14.0)},
    "one_way_damping": {"c1": (4.0, 12.0)},
    "squeeze_film": {"c1": (10.0, 30.0), "h": (0.001, 0.003)},
}
"""The same of what no law of the catalogue describes: a contact that stiffens with the speed or is pulsed, a stop that one side
of the swing meets, a detent, a hum of five tones, a play that grows all at once, a damper that acts one way, a film of oil that
is squeezed where the play ends."""
_DRIFTS = ("gap_drift", "stiffness_drift")
SIGNED = (
    "gravity", "preload", "asymmetric_gap", "asymmetric_stiffness", "sensor_offset", *_DRIFTS,
    "gravity:off", "friction_drift", "clock_drift",
)  # fmt: skip
OUTSIDE_CATALOGUE = ("unknown_disturbance", "speed_stiffness")


@dataclass(frozen=True)
class Rig:
    """A joint: inertia J [kg m^2], backlash, the total play [rad], stiffness k [N m/rad], damping c [N m s/rad]."""

    inertia: float
    backlash: float
    stiffness: float
    damping: float


@dataclass(frozen=True)
class Excitation:
    """How a joint is driven: base motion x(t) [rad], force on the link F(t) [N m], start y0 [rad], v0 [rad/s]."""

    kind: str
    base: Motion = field(default=Rest())
    force: Motion = field(default=Rest())
    y0: float = 0.0
    v0: float = 0.0


def make_rig(rng) -> Rig:
    """A random joint: J 2.6-3.8 kg m^2, play 0.017-0.034 rad, 8-11.5 Hz in contact, damping ratio 3-7 %."""
    inertia = rng.uniform(2.6, 3.8)
    omega = 2 * np.pi * rng.uniform(8.0, 11.5)
    damping = 2 * rng.uniform(0.03, 0.07) * inertia * omega
    return Rig(inertia, rng.uniform(0.017, 0.034), inertia * omega**2, damping)


def make_excitation(rng, kind: str, duration: float = 20.0, scale: float = 1.0) -> Excitation:
    """A random excitation of one of KINDS; `scale` multiplies its amplitude; `duration` [s] sets a chirp's rate."""
    if kind == "chirp":
        rate = rng.uniform(10.5, 13.0) / duration
        base = Chirp(scale * rng.uniform(0.055, 0.08), 0.05, rate, rng.uniform(3.7, 4.3), ramp=0.5)
        return Excitation(kind, base)
    if kind == "multisine":
        return Excitation(kind, _lines(rng, scale * rng.uniform(0.024, 0.037), 0.3, 11.0, corner=4.0))
    if kind == "stepped":
        levels = tuple(scale * rng.uniform(0.02, 0.06, max(1, round(duration / 4))))
        return Excitation(kind, SteppedSine(rng.uniform(2.5, 3.5), levels))
    if kind == "modulated":
        wave = (rng.uniform(0.025, 0.045) * scale, rng.uniform(2.2, 3.5), rng.uniform(0.3, 0.7), rng.uniform(0.1, 0.3))
        return Excitation(kind, ModulatedSine(*wave))
    if kind == "free_decay":
        return Excitation(kind, y0=scale * rng.uniform(0.06, 0.12))
    if kind == "force_chirp":
        rate = rng.uniform(12.0, 16.0) / duration
        return Excitation(kind, force=Chirp(scale * rng.uniform(80.0, 180.0), 0.5, rate, ramp=0.5))
    if kind == "force_multisine":
        return Excitation(kind, force=_lines(rng, scale * rng.uniform(60.0, 120.0), 0.5, 15.0, corner=np.inf))
    raise ValueError(f"kind must be one of {', '.join(KINDS)}, not {kind!r}")


def _lines(rng, rms, low, high, corner) -> Multisine:
    """About 40 lines, jittered so that the record never repeats, with random phases and a rolled-off amplitude."""
    spacing = (high - low) / 40
    frequencies = np.arange(low, high, spacing) + rng.uniform(-0.2, 0.2, len(np.arange(low, high, spacing))) * spacing
    amplitudes = 1 / (1 + (frequencies / corner) ** 2)
    amplitudes *= rms / np.sqrt(np.sum(amplitudes**2) / 2)
    return Multisine(amplitudes, frequencies, rng.uniform(-np.pi, np.pi, len(frequencies)))


def make_effects(rng, *names: str) -> dict[str, dict[str, float]]:
    """The named effects with random strengths, ready for `simulate_truth`."""
    strengths = OUTSIDE_STRENGTHS | RIG_STRENGTHS | STRENGTHS
    effects = {}
    for name in names:
        draw = {key: float(rng.uniform(*bounds)) for key, bounds in strengths[name].items()}
        if name in SIGNED:
            first = next(iter(draw))
            draw[first] *= rng.choice((-1.0, 1.0))
        effects[name.partition(":")[0]] = draw
    return effects
