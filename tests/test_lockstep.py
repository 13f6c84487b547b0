"""Work in lockstep: the same results as alone, whoever stands beside, and errors where they belong."""

from pathlib import Path

import jax
import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.compiled import kept_jit
from jaxbacklash.lockstep import in_lockstep
from jaxbacklash.many.chunk import rows_of
from jaxbacklash.many.wanted import Wanted
from jaxbacklash.once import once

CALLS = []


@kept_jit
def growth(values, factor, power):
    CALLS.append(values.shape)  # while tracing alone
    return {"sum": (factor * values**power).sum(), "values": values * factor}


@pytest.fixture
def unkept():
    """Programs of this process alone: one that an earlier run has kept would not be traced."""
    folder = jax.config.jax_compilation_cache_dir
    jax.config.update("jax_compilation_cache_dir", None)
    yield
    jax.config.update("jax_compilation_cache_dir", folder)


def work(k):
    def of_it():
        first = growth(np.arange(3.0) + k, np.asarray(2.0), 2)
        if k % 2:  # half of them ask once more
            return float(growth(np.asarray(first["values"]), np.asarray(3.0), 2)["sum"])
        return float(first["sum"])

    return of_it


def test_lanes_are_answered_as_each_would_be_alone(unkept):
    alone = [work(k)() for k in range(70)]
    CALLS.clear()
    together = dict(in_lockstep([(k, work(k)) for k in range(70)]))
    assert [together[k] for k in range(70)] == pytest.approx(alone, rel=1e-15)
    assert len(CALLS) <= 1  # none where another test of this process has asked for it


def test_an_error_in_one_lane_is_raised_and_one_that_is_caught_stops_nothing(unkept):
    def fails():
        raise ValueError("own")

    def catches():
        try:
            growth("no array", np.asarray(1.0), 2)
        except Exception as error:
            return type(error).__name__
        return None

    with pytest.raises(ValueError, match="own"):
        list(in_lockstep([("a", fails)]))
    told = dict(in_lockstep([("a", catches), ("b", work(0))]))
    assert told["a"] is not None
    assert told["b"] == work(0)()


class Sized:
    """What is worked out once, and asks for a program on the way."""

    def __init__(self, k):
        self.k = k

    @once
    def sum(self):
        return float(growth(np.arange(3.0) + self.k, np.asarray(2.0), 2)["sum"])


def test_a_property_that_asks_for_a_program_holds_up_nobody(unkept):
    """With functools.cached_property of Python 3.11 the second lane waits for a lock that the first has, for ever."""
    own = [Sized(k) for k in range(3)]
    together = dict(in_lockstep([(k, lambda one=one: one.sum) for k, one in enumerate(own)]))
    assert [together[k] for k in range(3)] == pytest.approx([Sized(k).sum for k in range(3)])


def test_no_property_of_a_fit_holds_a_lock_while_it_is_worked_out():
    """What a fit may read on its way in lockstep: nothing below the layer that starts it is a cached_property."""
    below = ("fitting", "shooting", "regression", "one_encoder", "causes", "residuals", "criticism", "solvers", "effects")
    package = Path(jb.__file__).parent
    held = [
        path.name for name in below for path in (package / name).rglob("*.py") if "cached_property" in path.read_text("utf-8")
    ]
    assert held == []


@pytest.mark.slow
def test_a_row_is_that_of_a_fit_alone_and_does_not_depend_on_its_company():
    record, heldout = jb.demo_records()
    records = [record.between(0.0, 2.0), heldout.between(0.0, 2.0), record.between(2.0, 4.0), record.between(0.0, 1.5)]
    wanted = Wanted("fit", inertia=3.16, effects=("gravity",))
    rows = dict(rows_of(wanted, list(enumerate(records))))
    assert dict(rows_of(wanted, [(1, records[1])]))[1] == rows[1]
    for number, one in enumerate(records):
        alone = jb.fit(one, inertia=3.16, effects=["gravity"])
        for name, estimate in alone.parameters.items():
            found = rows[number]["parameters"][name]
            assert found["value"] == pytest.approx(estimate.value, abs=0.02 * estimate.stderr)
            assert found["stderr"] == pytest.approx(estimate.stderr, rel=0.02)
