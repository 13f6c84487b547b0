"""Starting points compared on a segment of the record: a fit ends the same, and takes the whole record where that does not do."""

import equinox as eqx
import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.excitation import Multisine
from jaxbacklash.fitting import segment as module
from jaxbacklash.fitting.continuation import LOOSEST, tied
from jaxbacklash.fitting.fit import prepare
from jaxbacklash.fitting.search import search
from jaxbacklash.fitting.segment import WINDOWS, determines, segment
from jaxbacklash.fitting.setup import first_guess, make_problem
from jaxbacklash.parameters import values
from jaxbacklash.shooting.levenberg import Levenberg, minimise
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


def test_a_short_record_has_no_segment():
    _, _, problem = problem_of(record(duration=12.0))
    assert segment(problem, first_guess(problem)) is None


def test_the_segment_lies_where_the_link_moves():
    _, windows, problem = problem_of(record(quiet=12.0))
    part, begin = segment(problem, first_guess(problem))
    assert part.windows.measured.shape == windows.measured.shape
    assert int(part.windows.used) == WINDOWS
    assert part.windows.t0[0] >= 11.9
    assert np.all(np.diff(part.windows.t0[:WINDOWS]) > 0)
    assert not np.any(part.windows.weight[WINDOWS - 1 :])
    assert begin.starts.shape == (2, windows.count)


def test_the_same_end_with_and_without_it(monkeypatch):
    system, windows, _ = problem_of(record())
    found = search(system, windows, NAMES, starts=3, seed=0)
    monkeypatch.setattr(module, "TIMES", 10**6)
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


def test_a_segment_that_never_meets_an_edge_determines_nothing():
    _, _, problem = problem_of(record())
    part, begin = segment(tied(problem, LOOSEST), first_guess(problem))
    found = minimise(part, begin, Levenberg())
    assert determines(found, part)
    inside = eqx.tree_at(lambda p: p.windows.measured, part, 0.01 * np.asarray(part.windows.measured))
    assert not determines(minimise(inside, begin, Levenberg()), inside)
