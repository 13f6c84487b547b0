"""Windows that stuck begin again where the window before has ended."""

from types import SimpleNamespace

import numpy as np
import pytest

from jaxbacklash.fitting import handed_on as module
from jaxbacklash.fitting.handed_on import handed_on, stuck_windows
from jaxbacklash.fitting.levenberg import Levenberg, Minimum
from jaxbacklash.fitting.shooting import Prediction, Unknowns

WINDOWS, SAMPLES = 40, 10


def ended(missed, cost):
    """A fit whose windows miss by so many noises at every sample, each predicted to end at its number."""
    motion = np.broadcast_to(np.asarray(missed, float)[:, None], (WINDOWS, SAMPLES))
    end = np.stack([np.arange(WINDOWS), -np.arange(WINDOWS)], axis=1).astype(float)
    value = Unknowns(np.zeros(3), np.full((2, WINDOWS), 99.0), np.zeros((WINDOWS, 0)))
    return Minimum(value, {"cost": np.asarray(cost), "predicted": Prediction(motion, np.zeros((WINDOWS, 0)), end)})


@pytest.fixture
def problem():
    tie = np.ones(WINDOWS)
    tie[20] = 0.0  # another record begins with window 21
    zero = np.zeros((WINDOWS, SAMPLES))
    return SimpleNamespace(windows=SimpleNamespace(measured=zero, weight=zero + 1.0, tie=tie))


def missing(*far):
    missed = np.ones(WINDOWS)
    missed[list(far)] = 10.0
    return missed


@pytest.mark.parametrize(
    ("far", "stuck"),
    [((), []), ((5,), [5]), ((5, 6), [5]), ((0,), []), ((21,), []), ((5, 10, 15), [])],
    ids=["none", "one", "two in a row", "the first", "the first of a record", "too many to be exceptions"],
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
    assert float(handed_on(problem, ended(missing(5, 6), 100.0), Levenberg()).stats["cost"]) == 50.0
    assert [b[:, k].tolist() for b, k in zip(begun, (5, 6))] == [[4.0, -4.0], [5.0, -5.0]]
    assert all(np.sum(b != 99.0) == 2 for b in begun)
    left.append(ended(missing(5), 101.0))
    first = ended(missing(5), 100.0)
    assert handed_on(problem, first, Levenberg()) is first
