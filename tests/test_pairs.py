"""Two effects at once: did either not see what the other makes of the joint, their true model would leave more than noise."""

import importlib.util

import numpy as np
import pytest

from jaxbacklash.criticism.model_fitter import ModelFitter
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.mechanics import catalogue
from jaxbacklash.parameters import with_values
from jaxbacklash.records import Record

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(importlib.util.find_spec("numba") is None, reason="the generator needs numba"),
]
SMOOTH = (
    "asymmetric_gap", "asymmetric_stiffness", "contact_damping", "cubic_stiffness", "gap_drift", "gap_spring", "gravity",
    "hunt_crossley", "preload", "quadratic_drag", "sensor_delay", "sensor_gain", "sensor_offset", "stiffness_drift",
    "torque_ripple", "clock_drift", "contact_exponent", "damping_drift", "disturbance", "transmission_error",
)  # fmt: skip
"""Effects without dry friction and internal states: one program fits them all."""


@pytest.mark.parametrize("name", SMOOTH)
def test_the_true_model_of_two_effects_leaves_but_noise(name):
    from tests.independent.generator import make_effects, make_excitation, make_rig, measure, simulate_truth

    rng, laws = np.random.default_rng([17, SMOOTH.index(name)]), catalogue()
    left = {}
    for other in SMOOTH[SMOOTH.index(name) + 1 :]:
        rig, motion, given = make_rig(rng), make_excitation(rng, "multisine", 8.0), make_effects(rng, name, other)
        seen = measure(simulate_truth(rig, given, motion, 500.0, 8.0), rng, 1e-5, 1e-5)
        record = Record(seen["t"], {"x": seen["x"], "z": seen["z"]}, confirmed=frozenset("txz"))
        base, free, _ = base_system(record, "joint", rig.inertia)
        true = with_values(base, {n: getattr(rig, n) for n in ("backlash", "stiffness", "damping")})
        fitter = ModelFitter(record, true, free, 0.2)
        left[other] = fitter.fit_model({n: laws[n](**v) for n, v in given.items()}).misfit
    assert all(misfit < 1.05 for misfit in left.values()), left


def test_every_smooth_effect_is_paired():
    """But for the one that does nothing where nothing rubs."""
    own = {n: law for n, law in catalogue().items() if law.__module__.startswith("jaxbacklash.") and law.catalogued}
    assert {n for n, law in own.items() if not law.states and not law.slides and not law.beside} == {*SMOOTH, "friction_drift"}
