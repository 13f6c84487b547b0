"""The two-link rig of the paper's section 3.1 as a simulation: what the paper prints of it, and what had to be chosen.

Printed: play 1.5 deg, 11 Hz at the edge of the play and 3.16 kg m^2 (so 15,095 N m/rad), a linear chirp from 0 to 12 Hz in 30 s.
Not printed: damping, amplitude of the base and how it falls with frequency, sample rate, noise, the link's weight. Damping is
taken as 5 %, the amplitude falls as a servo's would, with its corner where it puts the end of contact at the paper's 16.25 s; 500
samples a second, encoders of 200,000 counts a turn with noise of 2e-5 rad, no weight. The simulation is non-smooth and shares
no code with the package; it needs numba.
"""

from __future__ import annotations

from functools import cache

import numpy as np

import jaxbacklash as jb
from tests.independent.generator import measure, simulate_truth
from tests.independent.motions import Chirp
from tests.independent.rigs import Excitation, Rig
from tests.twin import COUNT

INERTIA, INERTIA_BY_GEOMETRY = 3.16, 2.84  # kg m^2, as printed
NATURAL = 11.0  # Hz, from the paper's Figure 11
STATED_STIFFNESS = 11000.0  # N m/rad, from the paper's Figure 14
PLAY, STATED_PLAY = np.radians(1.5), 0.0258  # rad, by hand and from the paper's Figure 14
FALL = 16.25  # s, where the paper's z falls inside the play
SWEEP = 12.0 / 30.0  # Hz/s
OMEGA = 2.0 * np.pi * NATURAL
RIG = Rig(INERTIA, float(PLAY), INERTIA * OMEGA**2, 2.0 * 0.05 * INERTIA * OMEGA)
BASE = Chirp(0.045, 0.0, SWEEP, 1.93, ramp=0.5)
RATE, SECONDS, NOISE = 500.0, 30.0, 2e-5


@cache
def swept() -> tuple[jb.Record, dict[str, np.ndarray]]:
    """The record of x and z, and the true motion."""
    truth = simulate_truth(RIG, {}, Excitation("chirp", BASE), RATE, SECONDS)
    seen = measure(truth, np.random.default_rng(0), NOISE, NOISE, COUNT)
    return jb.Record(seen["t"], {"x": seen["x"], "z": seen["z"]}), truth


def base_envelope(t: np.ndarray) -> np.ndarray:
    """The true envelope of x [rad]."""
    return np.asarray(BASE.amplitude / (1.0 + (SWEEP * t / BASE.corner) ** 2) ** BASE.order)


def last_outside() -> float:
    """When z is outside the play for the last time [s]."""
    _, truth = swept()
    return float(truth["t"][np.flatnonzero(np.abs(truth["z"]) > 0.5 * RIG.backlash)[-1]])
