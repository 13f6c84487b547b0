"""The paper's experiment of Table 2 as a simulated twin: a hanging link, its base at 1.54 Hz, eight amplitudes. Needs numba.

The simulation is non-smooth, has the weight as G sin y, and shares nothing with the package.
"""

from dataclasses import dataclass

import numpy as np

from jaxbacklash import Record, two_link

from .independent.generator import measure, simulate_truth
from .independent.motions import SteppedSine
from .independent.rigs import Excitation, Rig

FREQUENCY = 1.54
"""Of the base [Hz]."""
AMPLITUDES = np.radians([1.34, 2.07, 2.68, 3.41, 3.65, 3.78, 4.87, 5.73])
"""Of the base [rad], Table 2."""
PAPER = np.array([0.0, 0.0, 1.423, 1.322, 1.533, 1.802, 0.0, 0.0])
"""Largest exponents of Table 2, 'bit/time'."""
INERTIA = 3.16
"""From the paper's mass line [kg m^2]; by geometry 2.84."""
COUNT = 2 * np.pi / 200_000
"""Step of the encoders [rad]."""


@dataclass(frozen=True)
class Twin:
    """Gravity G [N m], negative hanging; natural frequency in contact [Hz]; damping ratio there; total play [deg]."""

    gravity: float = -90.0
    contact: float = 11.0
    zeta: float = 0.02
    play: float = 1.5

    @property
    def rig(self):
        omega = 2 * np.pi * self.contact
        return Rig(INERTIA, np.radians(self.play), INERTIA * omega**2, 2 * self.zeta * INERTIA * omega)

    def system(self, linearised=True):
        """The same joint for the package."""
        rig = self.rig
        return two_link(INERTIA, rig.backlash, rig.stiffness, rig.damping, self.gravity, linearised=linearised)

    def series(self, amplitude, *, seconds, rate, noise, rng, settle=60.0, start=(0.0, 0.0)):
        """A record t, x, z of the steady motion with noise and encoder counts, and z without them.

        amplitude [rad]; seconds of record at `rate` [Hz] after `settle` [s]; noise, standard deviation [rad]; start, the
        link's y [rad] and y' [rad/s].
        """
        base = SteppedSine(FREQUENCY, (amplitude,), hold=1e9, ramp=2.0)
        excitation = Excitation("sine", base, y0=start[0], v0=start[1])
        truth = simulate_truth(self.rig, {"gravity": {"G": self.gravity}}, excitation, rate, settle + seconds, step=1e-4)
        kept = {name: values[round(settle * rate) : -1] for name, values in truth.items()}
        seen = measure(kept, rng, noise, noise, COUNT)
        return Record(seen["t"] - seen["t"][0], {"x": seen["x"], "z": seen["z"]}), kept["z"]
