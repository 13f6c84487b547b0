"""Frequency and phase of laws that repeat, read off the spectrum of the torque that the joint alone leaves."""

import numpy as np
import pytest

pytest.importorskip("numba", reason="the generator needs numba")

from jaxbacklash.criticism.candidates import likeliest_sine
from jaxbacklash.mechanics import catalogue
from jaxbacklash.parameters import values
from jaxbacklash.regression.spectrum import read_off

from .hidden import fitter, hidden

SHARE = {"t": 0.1, "x": 0.2, "y": 0.2}
"""How near a frequency has to be, in radians of phase over half of what the record shows of the coordinate."""


def found(name, kind, seed, **told):
    record, rig, effects, _ = hidden(name, kind, seed, **told)
    own, law = fitter(record, rig.inertia), catalogue()[name]
    if law.wave.over == "t":
        sine = likeliest_sine(own, own.fit_model({}))
        read = law(sine.amplitude, sine.frequency, sine.phase)
    else:
        read = read_off(own.weak_form, own.base, own.base_free, law)
    return read, effects[name], own.weak_form.motion


@pytest.mark.parametrize("kind", ["multisine", "chirp", "stepped"])
@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("disturbance", {"A": 4.0, "omega": 46.3, "phi": 0.7}),
        ("disturbance", {"A": 4.0, "omega": 101.7, "phi": -2.0}),
        ("torque_ripple", {"A": 6.0, "N": 57.0, "phi": 0.7}),
        ("transmission_error", {"e": 1e-3, "M": 41.0, "psi": 0.7}),
    ],
    ids=["hum", "fast hum", "ripple", "gear"],
)
def test_a_frequency_is_read_off(name, told, kind):
    law, true, motion = found(name, kind, 11, **told)
    wave, own = law.wave, values(law)
    over = np.asarray(getattr(motion, wave.over))
    reach = 0.5 * float(np.subtract(*np.quantile(over, (0.98, 0.02))))
    assert abs(own[wave.frequency] - true[wave.frequency]) * reach < SHARE[wave.over] * np.pi
    middle = float(np.mean(over))
    phase = (own[wave.frequency] - true[wave.frequency]) * middle + own[wave.phase] - true[wave.phase]
    assert abs(np.sin(phase)) < 0.5
    assert abs(own[wave.strength]) == pytest.approx(true[wave.strength], rel=0.35)


def test_the_angle_of_a_weight_is_read_off():
    law, true, _ = found("gravity", "multisine", 12, G=-30.0, phi0=0.6)
    assert float(law.phi0) == pytest.approx(true["phi0"], abs=0.2)
    assert float(law.G) == pytest.approx(true["G"], rel=0.2)
