"""Coexisting attractors of CASE 1: found from many starts and by sweeping both ways, and there by scipy too."""

import numpy as np
import pytest

pytest.importorskip("xarray")

from jaxbacklash.dynamics.basins import basins
from jaxbacklash.dynamics.bifurcation import bifurcation
from jaxbacklash.dynamics.family import PaperCase
from jaxbacklash.dynamics.periodicity import CHAOTIC, UNRESOLVED, periodicity
from jaxbacklash.dynamics.sections import poincare, stroboscopic
from jaxbacklash.errors import BadInput
from jaxbacklash.models import case_1

from .independent import exponents

TWO = 3.0
"""1 / alpha at which a motion of period 1 and two of period 3, mirror images, exist side by side (2 zeta = 0.04)."""


def test_basins_find_what_scipy_finds():
    found = basins(PaperCase(1), {"inverse_alpha": TWO}, np.linspace(-3.0, 3.0, 12), np.linspace(-3.0, 3.0, 12), periods=200)
    assert sorted(a.period for a in found.attractors) == [1, 3, 3]
    assert np.all(found.number >= 0)
    first, second = (a for a in found.attractors if a.period == 3)
    # The law is odd and half a period turns the force round, so one is the other seen in a mirror half a period later.
    assert {tuple(np.sign(np.sort(a.p).round(3)[[0, -1]])) for a in (first, second)}
    for attractor in found.attractors:
        start = (float(attractor.p[-1]), float(attractor.v[-1]))
        _, samples, growth = exponents.follow(exponents.Cell(TWO, 0.02), 18, 0, start=start, rtol=1e-8)
        back = np.hypot(*(samples[attractor.period] - samples[0]))
        assert back < 1e-5
        assert attractor.period == 1 or np.hypot(*(samples[1] - samples[0])) > 0.05
        assert growth[-1] < 1.0


def test_sweeps_up_and_down_differ_where_two_attractors_are():
    """From 4.2 on period 1 stands beside chaos: sweeping up stays on the first, sweeping down comes from the other."""
    found = bifurcation(PaperCase(1), "inverse_alpha", np.linspace(4.0, 5.0, 11), settle=40, samples=20, start_periods=120)
    up, down = found.swept_up_period.values, found.swept_down_period.values
    here = (up == 1) & (down == CHAOTIC)
    assert here.sum() >= 2
    assert up[-1] == down[-1] == CHAOTIC
    assert up[0] == down[0] == 1
    one = float(found.inverse_alpha.values[here][0])
    start = (float(found.swept_up.values[-1, here][0]), 0.0)
    assert np.isfinite(start).all()
    lam, _, _ = exponents.follow(exponents.Cell(one, 0.02), 12, 2, start=(0.0, 0.0), rtol=1e-8)
    assert np.isfinite(lam)
    from_starts = found.from_starts_period.values[:, here]
    assert (from_starts == 1).any()
    assert (from_starts == CHAOTIC).any()


def test_periods_are_counted():
    turns = np.arange(24)
    p = np.stack([0.0 * turns, turns % 2, turns % 3, np.sin(turns), np.sin(turns), 1.0 / (1.0 + turns)], axis=1)
    exponent, error = np.array([-1.0, -1.0, -1.0, 0.1, 0.001, -0.01]), np.full(6, 0.01)
    assert periodicity(p, 0.0 * p, exponent, error).tolist() == [1, 2, 3, CHAOTIC, UNRESOLVED, UNRESOLVED]


def test_sections():
    system, force = case_1()
    strobe = stroboscopic(system, force, points=5, skip=3)
    through = poincare(system, force, plane=0.005, direction=1, duration=2.0, rate=2000.0)
    assert np.all(np.diff(strobe.t) == pytest.approx(2.0 * np.pi / 40.0))
    assert np.all(through.dz > 0.0)
    both = poincare(system, force, plane=0.005, duration=2.0, rate=2000.0)
    assert abs(2 * through.t.size - both.t.size) <= 1


def test_a_sweep_wants_rising_values():
    with pytest.raises(BadInput, match="rising"):
        bifurcation(PaperCase(1), "inverse_alpha", [2.0, 1.0])
    with pytest.raises(BadInput, match="no parameter"):
        bifurcation(PaperCase(1), "alpha", [1.0, 2.0])
