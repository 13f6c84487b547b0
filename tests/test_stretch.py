"""A search that begins on a stretch of the record: the same minimum, and the whole record where a stretch does not tell."""

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.excitation import Multisine
from jaxbacklash.fitting import search as module
from jaxbacklash.fitting.fit import prepare
from jaxbacklash.fitting.search import freedom, search, tie_windows
from jaxbacklash.fitting.setup import first_guess, make_problem
from jaxbacklash.fitting.stretch import STRETCH, stretch
from jaxbacklash.parameters import values
from jaxbacklash.shooting.levenberg import Minimum
from jaxbacklash.simulation import as_record

NAMES = ("backlash", "stiffness", "damping")


def record(duration=24.0, quiet=0.0, seed=3):
    """A noisy record whose first ``quiet`` seconds stay inside the play."""
    system = jb.base_motion_joint(3.16, 0.02618, 13000.0, 12.0)
    drive = Multisine(np.array([0.05, 0.02, 0.01]), 2 * np.pi * np.array([1.1, 2.9, 5.3]), np.array([0.0, 1.0, 2.0]))
    clean = as_record(jb.simulate(system, drive, duration=duration, rate=500.0), system)
    rng = np.random.default_rng(seed)
    still = clean.t < quiet
    moved = {n: np.where(still, 0.01 * v / np.max(np.abs(v)), v) for n, v in clean.channels.items()}
    return clean.replace(**{n: v + 3e-5 * rng.standard_normal(v.size) for n, v in moved.items()})


def problem_of(one, start=(0.04, 22000.0, 6.0)):
    system = jb.base_motion_joint(3.16, *start)
    windows = prepare(system, [one], 0.2)[0]
    return system, windows, make_problem(system, windows, NAMES)


def test_a_short_record_has_no_stretch():
    _, _, problem = problem_of(record(duration=12.0))
    assert stretch(problem, first_guess(problem))[0] is None


def test_the_stretch_lies_where_the_link_moves():
    _, windows, problem = problem_of(record(quiet=12.0))
    part, begin = stretch(problem, first_guess(problem))
    assert part.windows.measured.shape == windows.measured.shape
    assert int(part.windows.used) == STRETCH
    assert part.windows.t0[0] >= 11.9
    assert np.all(np.diff(part.windows.t0[:STRETCH]) > 0)
    assert not np.any(part.windows.weight[STRETCH - 1 :])
    assert begin.starts.shape == (2, windows.count)


@pytest.mark.parametrize(("off", "asked"), [(20.0, [20]), (5.0, [20, 40])])
def test_a_sharply_tied_search_that_stays_far_off_is_given_up(monkeypatch, off, asked):
    """Loose ties, and searches that nobody gives many steps, are not cut short; what goes on begins undamped again."""
    _, _, problem = problem_of(record(duration=4.0))
    guess, limits, damped, near = first_guess(problem), [], [], set()

    def minimise(_, start, how):
        limits.append(int(how.limit))
        damped.append(float(how.damping))
        near.add(float(how.atol))
        cost = 0.5 * off**2 * freedom(problem, tied=True)
        return Minimum(start, {"cost": cost, "steps": limits[-1]})

    monkeypatch.setattr(module, "minimise", minimise)
    _, solution, steps = tie_windows(problem, guess, (100.0,), limit=60, near=0.02)
    assert limits == asked
    assert damped == [1e-9] * len(asked)
    assert near == {0.02}
    assert steps == sum(asked)
    assert ("given_up" in solution.stats) == (asked == [20])
    limits.clear()
    assert tie_windows(problem, guess, (1.0, 100.0), limit=60)[2] == 120
    assert tie_windows(problem, guess, (100.0,), limit=25)[2] == 25
    assert limits == [60, 60, 25]


def test_the_same_minimum_with_and_without_it(monkeypatch):
    system, windows, _ = problem_of(record())
    found = search(system, windows, NAMES, starts=3, seed=0)
    monkeypatch.setattr("jaxbacklash.fitting.stretch.WORTH", 10**6)
    whole = search(system, windows, NAMES, starts=3, seed=0)
    assert found.tied
    assert whole.tied
    assert (found.agreeing, found.tried) == (whole.agreeing, whole.tried) == (3, 3)
    assert found.cost == pytest.approx(whole.cost, abs=1e-2)
    errors = np.sqrt(np.diag(whole.covariance))
    ends = [dict(zip(values(system), np.asarray(one.problem.parameters(one.unknowns.theta)))) for one in (found, whole)]
    for name, truth, error in zip(NAMES, (0.02618, 13000.0, 12.0), errors):
        assert abs(ends[0][name] - ends[1][name]) < 0.05 * error
        assert abs(ends[0][name] - truth) < 4.0 * error


def test_a_stretch_that_does_not_tell_is_not_believed(monkeypatch):
    system, windows, problem = problem_of(record())
    lengths = []
    real = module.minimise

    def watched(problem, *args, **kwargs):
        lengths.append(int(problem.windows.used))
        return real(problem, *args, **kwargs)

    monkeypatch.setattr(module, "minimise", watched)
    monkeypatch.setattr(module, "told", lambda found, part: False)
    found = search(system, windows, NAMES, starts=1, seed=0)
    assert lengths[0] == STRETCH
    assert all(used == int(problem.windows.used) for used in lengths[1:])
    assert found.tied
