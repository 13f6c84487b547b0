"""Windows that begin on the wrong side of a play, or astray, cost a fit by continuation neither parameters nor evidence."""

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.mechanics import catalogue
from jaxbacklash.parameters import values as values_of

from .hidden import fitter


@pytest.mark.slow
@pytest.mark.parametrize("draw", [1, 7])
def test_a_first_window_astray_bends_no_joint(monkeypatch, draw):
    """Two noises of a joint whose first start was astray: the true model, begun at the truth, missed by 1.54 times the noise."""
    pytest.importorskip("numba", reason="the generator needs numba")
    from benchmarks.effect_strangers import make_case
    from tests.independent import strangers

    measure = strangers.measure
    own = np.random.default_rng([7, draw])
    monkeypatch.setattr(strangers, "measure", lambda truth, rng, x, z, step: measure(truth, own, x, z, step))
    case = make_case(12, 10.0, 19)
    own = fitter(case.record, case.rig.inertia)
    found = own.fit_model({name: catalogue()[name](**values) for name, values in case.values.items()})
    assert found.misfit < 1.03
    for name in ("backlash", "stiffness", "damping"):
        assert values_of(found.system)[name] == pytest.approx(getattr(case.rig, name), rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("phase", [0.0, 0.5 * np.pi])
def test_one_window_of_two_hundred_at_the_wrong_edge_costs_no_evidence(phase):
    """A ripple begun in another phase bent one start to the wrong edge: 2.5 times the median square, 240 by the criterion."""
    pytest.importorskip("numba", reason="the generator needs numba")
    from benchmarks.effect_strangers import make_case

    case = make_case(18, 10.0, 53)
    one, other = (fitter(case.record, case.rig.inertia) for _ in range(2))  # each keeps the better of two fits of one model
    ripple = catalogue()["torque_ripple"]
    found = one.fit_model({"torque_ripple": ripple(1.0, 91.0, phase)}, one.fit_model({}))
    best = other.fit_model({"torque_ripple": ripple(**case.values["torque_ripple"])})
    assert found.criterion < best.criterion + 1.0


@pytest.mark.slow
def test_a_play_shaken_by_a_rough_force_needs_no_effect():
    """As wide as the motion: at first some windows start on its wrong side. The force is held, 64 Runge-Kutta steps a sample."""
    rng, rate, samples = np.random.default_rng([91, 12]), 610.0, 8000
    mass, damping, stiffness, half = 1.7237564, 11.458323, 63304.606, 0.056266521
    push = 4500.0 * rng.standard_normal(samples)
    h, y, v, path = 1.0 / (64.0 * rate), 0.0, 0.0, []

    def pull(y, v, now):
        return (now - damping * v - stiffness * (y - min(max(y, -half), half))) / mass

    for now in push:
        path.append(y)
        for _ in range(64):
            a = pull(y, v, now)
            b = pull(y + 0.5 * h * v, v + 0.5 * h * a, now)
            c = pull(y + 0.5 * h * (v + 0.5 * h * a), v + 0.5 * h * b, now)
            d = pull(y + h * (v + 0.5 * h * b), v + h * c, now)
            y, v = y + h * v + h * h / 6.0 * (a + b + c), v + h / 6.0 * (a + 2.0 * (b + c) + d)
    seen = np.array(path) + 1e-3 * np.std(path) * rng.standard_normal(samples)
    record = jb.Record(np.arange(samples) / rate, {"F": push, "y": seen}, confirmed=frozenset("tFy"))
    with pytest.warns(UserWarning, match="held from each sample to the next"):
        found = jb.refine(record, translational=True)
    assert found.effects == ()
    assert found.verdict.complete
    play = found.stages[-1].fit.parameters["backlash"]
    assert play.value == pytest.approx(2.0 * half, abs=4.0 * play.stderr)
