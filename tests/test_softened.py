"""Dry friction spread over a range of speed: what it is, and where it leads a search that dry friction has stuck."""

from types import SimpleNamespace

import pytest

from jaxbacklash.criticism.tried import Tried
from jaxbacklash.criticism.workbench import Workbench
from jaxbacklash.fitting.setup import base_system

from .hidden import hidden
from .number_models import Model
from .test_under_noise import noisier


def stuck(seed, times, seconds=12.0):
    """A workbench and the joint with dry friction at its true value, the record with so many times its noise."""
    record, rig, effects, _ = hidden("coulomb_joint", "chirp", seed, seconds)
    base, free, _ = base_system(noisier(record, times, seed + 100), "joint", rig.inertia)
    bench = Workbench(noisier(record, times, seed + 100), base, free, 0.2)
    return bench, {n: bench.laws[n](**v) for n, v in effects.items()}


@pytest.mark.slow
@pytest.mark.parametrize("seed", [5, 11])
def test_a_search_that_dry_friction_has_stuck_comes_loose(seed):
    """Twenty times the noise: from free windows, the tied search gets nowhere at all.

    Where it comes to need not be the best there is: friction can be ten of its standard errors off. It leads on, no more.
    """
    bench, effects = stuck(seed, 20.0)
    free = bench.fit(effects, patience=60)
    tied = bench.fit(bench.effects(free), free, tied=True, patience=60)
    assert tied.misfit > 5.0
    loose = bench.fit_softly(tied, 60, 0)
    assert loose.misfit < 1.05
    assert loose.tied


@pytest.mark.parametrize(("costs", "kept"), [((90.0, 80.0, 79.5), 80.0), ((100.5,), 100.0)])
@pytest.mark.parametrize("slides", [True, False])
def test_a_stuck_model_with_dry_friction_begins_again_from_the_data(costs, kept, slides):
    """With its own parameters and nobody's windows, as long as that helps; others have no corners to stick at."""
    names, begun = frozenset({"coulomb_ground"}), []
    trial = Model(names, cost=100.0, system="where it stuck")

    def fit(effects, start=None, *, joint, tied, patience):
        assert (frozenset(effects), start, joint, tied) == (names, None, "where it stuck", True)
        begun.append(costs[len(begun)])
        return Model(names, cost=begun[-1], system=joint)

    bench = SimpleNamespace(
        laws={"coulomb_ground": SimpleNamespace(slides=slides)}, fit=fit, fit_softly=lambda trial, *_: trial,
        effects=lambda trial: dict.fromkeys(trial.names), grips=lambda names: False,
    )  # fmt: skip
    found = Tried(bench).shaken(trial)
    assert (found.cost, tuple(begun)) == ((kept, costs) if slides else (100.0, ()))
