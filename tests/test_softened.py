"""Dry friction spread over a range of speed: what it is, and where it leads a search that dry friction has stuck."""

from types import SimpleNamespace

import equinox as eqx
import numpy as np
import pytest

from jaxbacklash.criticism.tried import Tried
from jaxbacklash.criticism.workbench import Workbench
from jaxbacklash.fitting.setup import base_system, first_guess
from jaxbacklash.fitting.shooting import predictions
from jaxbacklash.fitting.softened import softened
from jaxbacklash.fitting.windows import Windows
from jaxbacklash.parameters import values

from .hidden import hidden
from .number_models import Model
from .test_under_noise import noisier


def stuck(seed, times, seconds=12.0):
    """A workbench and the joint with dry friction at its true value, the record with so many times its noise."""
    record, rig, effects, _ = hidden("coulomb_joint", "chirp", seed, seconds)
    base, free, _ = base_system(noisier(record, times, seed + 100), "joint", rig.inertia)
    bench = Workbench(noisier(record, times, seed + 100), base, free, 0.2)
    return bench, {n: bench.laws[n](**v) for n, v in effects.items()}


def test_the_narrower_the_range_the_nearer_to_dry_friction():
    bench, effects = stuck(5, 1.0, 4.0)
    problem, _ = bench.problem(effects, bench.base)
    guess = first_guess(problem)
    run = eqx.filter_jit(predictions)
    dry = np.asarray(run(problem, guess).motion)
    apart = []
    for width in (0.1, 0.03, 0.01):
        soft = softened(problem, {"coulomb_joint": width})
        assert soft.system.slides == ()
        assert float(values(soft.rebuild(guess.theta))["coulomb_joint.width"]) == width
        apart.append(float(np.max(np.abs(np.asarray(run(soft, guess).motion) - dry))))
    assert apart[0] > 2.0 * apart[1] > 4.0 * apart[2] > 0.0
    # All else is the same problem.
    assert isinstance(soft.windows, Windows)
    assert bool(eqx.tree_equal(soft.windows, problem.windows))
    assert problem.system.slides == ("joint",)
    # A law that states no range is left as it is.
    assert np.array_equal(softened(problem, {"gravity": 0.1}).base, problem.base)


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
