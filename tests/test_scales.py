"""Where laws whose shape is not known begin: the same place at any joint, in any units."""

from types import SimpleNamespace

import numpy as np
import pytest

from jaxbacklash.effects import Contact, Damper, FlexibleLink, Lugre, SecondPlay, Spring, Stribeck, TorqueRipple
from jaxbacklash.effects.scales import FURTHEST, LABORATORY, natural_frequency
from jaxbacklash.system import System
from tests.independent.rigs import Rig
from tests.independent.strangers import Scale


def joint(rig: Rig) -> System:
    return System(rig.inertia, Contact(rig.backlash, rig.stiffness), Damper(rig.damping), {}, "z")


def moving(scale: float = 1.0, slow: float = 1.0) -> SimpleNamespace:
    t = np.linspace(0.0, 10.0, 4001)
    y, dy = 0.1 * scale * np.sin(3.0 * t), 0.3 * scale / slow * np.cos(3.0 * t)
    return SimpleNamespace(t=t * slow, y=y, dy=dy, x=0.5 * y, dx=0.5 * dy)


@pytest.mark.parametrize("scale", [Scale(1e-3, 0.3, 0.2), Scale(50.0, 3.0, 4.0)])
def test_guesses_grow_with_a_joint(scale):
    rig = Rig(3.0, 0.025, 12000.0, 20.0)
    here, there = joint(rig), joint(scale.rig(rig))
    assert natural_frequency(there) == pytest.approx(natural_frequency(here) / scale.time, rel=1e-12)
    for one, other in zip(FlexibleLink.guesses(here), FlexibleLink.guesses(there), strict=True):
        grown = scale.values({"flexible_link": {n: getattr(one, n) for n in ("J2", "k2", "c2")}})["flexible_link"]
        assert {n: getattr(other, n) for n in grown} == pytest.approx(grown, rel=1e-12)
    motion, grown = moving(), moving(scale.angle, scale.time)
    plays = [[g.b2 for g in SecondPlay.guesses(s, m)] for s, m in ((here, motion), (there, grown))]
    assert plays[1] == pytest.approx([b * scale.angle for b in plays[0]], rel=1e-12)
    for law in (Stribeck, Lugre):
        speeds = [[g.vs for g in law.guesses(s, m)] for s, m in ((here, motion), (there, grown))]
        assert speeds[1] == pytest.approx([v * scale.angle / scale.time for v in speeds[0]], rel=1e-12)


def test_a_joint_that_tells_no_frequency_is_taken_for_a_laboratory_one():
    assert natural_frequency(System(2.0, None, Damper(1.0), {}, "z")) == LABORATORY
    assert natural_frequency(System(2.0, Spring(18.0), Damper(1.0), {}, "z")) == pytest.approx(3.0)


@pytest.mark.parametrize("swing", [0.02, 0.1, 0.6, 3.0])
def test_one_of_the_orders_is_near_any_ripple_that_shows(swing):
    t = np.linspace(0.0, 10.0, 4001)
    motion = SimpleNamespace(y=swing * np.sin(3.0 * t))
    orders = np.unique([g.N for g in TorqueRipple.guesses(joint(Rig(3.0, 0.025, 12000.0, 20.0)), motion)])
    assert orders[0] == 4.0
    assert np.max(np.diff(orders)) * swing < 1.6
    assert orders[-1] > min(0.9 * FURTHEST, 40.0 / swing)


def test_without_a_motion_orders_still_spread_over_a_drives():
    orders = [g.N for g in TorqueRipple.guesses(joint(Rig(3.0, 0.025, 12000.0, 20.0)))]
    assert min(orders) == 4.0
    assert max(orders) > 0.9 * FURTHEST
