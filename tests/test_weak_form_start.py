"""The weak-form start of a fit: strengths of effects beside play and stiffness, and which of them the play shows in."""

import numpy as np
import pytest

from jaxbacklash.mechanics import catalogue
from jaxbacklash.regression.equation_error import _WeakForm, estimate

from .hidden import hidden


@pytest.mark.parametrize(("name", "strength", "within"), [
    ("gravity", "G", 0.02), ("coulomb_joint", "Tc", 0.05), ("cubic_stiffness", "k3", 0.1), ("asymmetric_stiffness", "a", 0.1),
])  # fmt: skip
def test_a_strength_is_regressed_beside_the_play(name, strength, within):
    record, rig, effects, _ = hidden(name, "chirp", 3)
    (found,) = (start := estimate(record, inertia=rig.inertia, effects=[catalogue()[name]()])).effects
    assert float(getattr(found, strength)) == pytest.approx(effects[name][strength], rel=within)
    assert start.backlash == pytest.approx(rig.backlash, rel=0.02)


@pytest.mark.parametrize(("name", "steady"), [
    *((n, True) for n in ("gravity", "coulomb_joint", "coulomb_ground", "quadratic_drag")),
    *((n, False) for n in ("cubic_stiffness", "asymmetric_stiffness", "contact_damping", "stiffness_drift")),
])  # fmt: skip
def test_only_laws_that_the_play_shows_in_are_followed_with_it(name, steady):
    record, *_ = hidden("gravity", "chirp", 3, 4.0)
    weak, law = _WeakForm(record), catalogue()[name]
    effect = law(**{n: 1.0 for n in law().__dataclass_fields__ if n in ("G", "Tc", "q", "k3", "a", "cc", "r")})
    reach = float(np.max(np.abs(weak.z)))
    known = weak.steady(effect, reach)
    assert (known is not None) == steady
    for share in (0.2, 0.5):
        at = weak.torque(effect, share * reach)
        assert np.any(at != 0.0)
        assert known is None or np.array_equal(known, at)
