"""The paper's experiment as a simulated twin: base-motion chirp, servo roll-off, play, encoder counts. Needs numba."""

import numpy as np

from jaxbacklash import Record

from .independent.generator import measure, simulate_truth
from .independent.motions import Chirp
from .independent.rigs import Excitation, Rig

COUNT = 2 * np.pi / 200_000
"""Step of the encoders [rad]."""


def twin(seed, seconds=30.0, rate=500.0, noise=2e-5, effects=None, damping=(0.03, 0.07)):
    """A rig like the paper's and its record; seed None is the paper's own: 1.5 deg, 11 Hz, 3.16 kg m^2.

    Returns: `Rig`, `Record`, the true motion as the generator gives it.
    """
    rng = np.random.default_rng(seed)
    spread = (lambda low, high: 0.5 * (low + high)) if seed is None else rng.uniform
    inertia, omega = 3.16, 2 * np.pi * spread(9.9, 12.1)
    rig = Rig(inertia, np.radians(spread(1.2, 1.8)), inertia * omega**2, 2 * spread(*damping) * inertia * omega)
    chirp = Chirp(spread(0.038, 0.052), 0.0, 12.0 / seconds, spread(2.6, 3.0), phase=spread(-0.3, 0.3), ramp=0.5)
    truth = simulate_truth(rig, effects or {}, Excitation("chirp", chirp), rate, seconds)
    measured = measure(truth, rng, noise, noise, COUNT)
    return rig, Record(measured["t"], {"x": measured["x"], "z": measured["z"]}), truth
