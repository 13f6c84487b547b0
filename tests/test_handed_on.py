"""Windows that stuck begin again where the window before has ended, the first of a record where its samples lead."""

from types import SimpleNamespace

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.fitting import handed_on as module
from jaxbacklash.fitting.handed_on import handed_on, stuck_windows
from jaxbacklash.mechanics import catalogue
from jaxbacklash.parameters import values as values_of
from jaxbacklash.sensors import SensorOffset
from jaxbacklash.shooting.levenberg import Levenberg, Minimum
from jaxbacklash.shooting.multiple_shooting import Prediction
from jaxbacklash.shooting.problem import Unknowns

from .hidden import fitter

WINDOWS, SAMPLES = 40, 10


def ended(missed, cost):
    """A fit whose windows miss by so many noises at every sample, each predicted to end at its number."""
    motion = np.broadcast_to(np.asarray(missed, float)[:, None], (WINDOWS, SAMPLES))
    end = np.stack([np.arange(WINDOWS), -np.arange(WINDOWS)], axis=1).astype(float)
    value = Unknowns(np.zeros(3), np.full((2, WINDOWS), 99.0), np.zeros((WINDOWS, 0)))
    return Minimum(value, {"cost": np.asarray(cost), "steps": 7, "predicted": Prediction(motion, np.zeros((WINDOWS, 0)), end)})


@pytest.fixture
def problem():
    tie = np.ones(WINDOWS)
    tie[20] = 0.0  # another record begins with window 21
    zero = np.zeros((WINDOWS, SAMPLES))
    windows = SimpleNamespace(measured=zero, weight=zero + 1.0, tie=tie, panel=0.01, every=1)
    return SimpleNamespace(windows=windows, system=SimpleNamespace(observed="y", effects={}))


def missing(*far):
    missed = np.ones(WINDOWS)
    missed[list(far)] = 10.0
    return missed


@pytest.mark.parametrize(
    ("far", "stuck"),
    [((), []), ((5,), [5]), ((5, 6), [5]), ((0,), [0]), ((21,), [21]), ((20, 21), [20, 21]), ((5, 10, 15), [])],
    ids=["none", "one", "two in a row", "the first", "the first of a record", "two in two records", "too many to be exceptions"],
)
def test_which_windows_have_stuck(problem, far, stuck):
    assert stuck_windows(problem, ended(missing(*far), 1.0)).tolist() == stuck


def test_a_model_that_fails_throughout_has_no_stuck_windows(problem):
    assert not stuck_windows(problem, ended(10.0 * np.ones(WINDOWS), 1.0)).size
    assert not stuck_windows(problem, ended(np.full(WINDOWS, np.nan), np.nan)).size
    assert not stuck_windows(problem, ended(np.full(WINDOWS, 1e200), np.inf)).size


def test_they_go_on_from_the_window_before_as_long_as_that_helps(problem, monkeypatch):
    left = [ended(missing(6), 80.0), ended(missing(), 50.0)]
    begun = []

    def minimise(problem, start, how):
        begun.append(np.array(start.starts))
        return left.pop(0)

    monkeypatch.setattr(module, "minimise", minimise)
    found, taken = handed_on(problem, ended(missing(5, 6), 100.0), Levenberg())
    assert (float(found.stats["cost"]), taken) == (50.0, 14)
    assert [b[:, k].tolist() for b, k in zip(begun, (5, 6))] == [[4.0, -4.0], [5.0, -5.0]]
    assert all(np.sum(b != 99.0) == 2 for b in begun)
    left.append(ended(missing(5), 101.0))
    first = ended(missing(5), 100.0)
    assert handed_on(problem, first, Levenberg()) == (first, 7)


def aside(*windows):
    """Windows that miss by four times the median square: more than noise makes of ten samples, and no fifth as usual."""
    missed = np.ones(WINDOWS)
    missed[list(windows)] = 2.0
    return missed


def test_one_that_misses_little_goes_on_from_the_window_before_where_a_look_finds_it_better(problem, monkeypatch):
    steps = []

    def minimise(problem, start, how):
        steps.append((int(how.limit), np.array(start.starts[:, 5])))
        return left.pop(0)

    monkeypatch.setattr(module, "minimise", minimise)
    first = ended(aside(5), 30.0)
    assert not stuck_windows(problem, first).size
    left = [ended(missing(), 20.0), ended(missing(), 19.0)]
    found, taken = handed_on(problem, first, Levenberg())
    assert (float(found.stats["cost"]), taken, len(left)) == (19.0, 7, 0)
    assert steps[0][0] == module.LOOK < steps[1][0]
    assert steps[0][1].tolist() == [4.0, -4.0]
    # Where it is no better there, it moves more than the others, and stays as it is.
    left = [ended(aside(5), 31.0)]
    assert handed_on(problem, first, Levenberg()) == (first, 0)
    # A second one in a row is left to the round after; many are no exception, and nothing is looked at.
    assert module.better_led(problem, ended(aside(5, 10, 15), 30.0), Levenberg()) is None
    assert not left


def test_the_start_of_a_link_that_is_not_seen_is_not_read_off_its_samples(problem):
    problem.system.observed = "T"
    assert not stuck_windows(problem, ended(missing(21), 1.0)).size


@pytest.mark.parametrize("offset", [0.0, 0.5])
def test_the_first_of_a_record_begins_where_its_samples_lead(problem, monkeypatch, offset):
    """It is thrown, and knocked back half way: only curves through its first half know how it was thrown."""
    problem.system.effects = {"sensor_offset": SensorOffset(offset)}
    t = 0.01 * np.arange(SAMPLES)
    knocked = np.minimum(t, 0.09 - t)
    problem.windows.measured = np.tile(offset + 3.0 + 2.0 * knocked + 1e-4 * (-1.0) ** np.arange(SAMPLES), (WINDOWS, 1))
    limits = []

    def at(start, cost, motion):
        seen = Prediction(motion, np.zeros((WINDOWS, 0)), np.zeros((WINDOWS, 2)))
        return Minimum(start, {"cost": np.asarray(cost), "steps": 7, "predicted": seen})

    def minimise(problem, start, how):
        limits.append(int(how.limit))
        y, dy = np.array(start.starts)[:, :, None]
        # A link that starts at another speed than it did misses its knock.
        return at(start, 50.0, offset + np.where(abs(dy - 2.0) < 0.1, y + 2.0 * knocked, y + dy * t))

    monkeypatch.setattr(module, "minimise", minimise)
    starts = np.array([[3.0], [2.0]]) * np.ones(WINDOWS)
    starts[:, [0, 21]] = [[3.3], [9.0]]
    begin = Unknowns(np.zeros(3), starts, np.zeros((WINDOWS, 0)))
    astray = minimise(problem, begin, Levenberg()).stats["predicted"].motion
    found, taken = handed_on(problem, at(begin, 100.0, astray), Levenberg())
    assert found.value.starts == pytest.approx(np.array([[3.0], [2.0]]) * np.ones(WINDOWS), rel=0.02)
    assert limits == [60, 1, 1, 1, 60]
    assert taken == 7


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
