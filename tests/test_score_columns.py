"""Information about torques on the link and shifts of what is shown: against differences, and a law's own column."""

import numpy as np
import pytest

from jaxbacklash.criticism.perturbed import panel_edges
from jaxbacklash.fitting.continuation import tied
from jaxbacklash.shooting.levenberg import Levenberg, minimise
from jaxbacklash.shooting.problem import Unknowns, changed
from jaxbacklash.shooting.score_columns import information_beside, torque_scores

from .hidden import fitter, hidden


@pytest.fixture(scope="module")
def fitted():
    record, rig, _, _ = hidden("gravity", "multisine", 4, 3.0, G=20.0)
    own = fitter(record, rig.inertia)
    return own, own.fit_model({})


def test_the_column_of_a_torque_is_that_of_the_law_that_exerts_it(fitted):
    """A constant torque is what a preload exerts: information and score of one are those of the other."""
    own, model = fitted
    problem, free = own.problem({}, model.system, extra=["preload.T0"])
    at = Unknowns(np.zeros(problem.directions.shape[1]), model.unknowns.starts, model.unknowns.coefficients)
    stats = minimise(tied(problem, model.tie), at, Levenberg(limit=1)).stats
    scale = float(np.sum(problem.directions[:, len(free) - 1]))
    law = [*range(len(free) - 1), len(free) - 1]

    torque = np.full((1, *np.shape(own.windows.force)), scale)
    bare, _ = own.problem({}, model.system)
    information, score = information_beside(
        tied(bare, model.tie), at, torque, np.zeros((1, *np.shape(own.windows.measured)))
    )  # fmt: skip
    column = [*range(len(free) - 1), len(score) - 1]
    np.testing.assert_allclose(score[column], stats["score"][law], rtol=1e-6, atol=1e-6 * np.max(np.abs(score)))
    np.testing.assert_allclose(information[np.ix_(column, column)], stats["schur"][np.ix_(law, law)], rtol=1e-6)


def test_the_column_of_a_shift_is_how_the_cost_falls_with_it(fitted):
    """The cost to which a step leads, by differences over the size of the shift, is what score and information say."""
    own, model = fitted
    problem, _ = own.problem({}, model.system)
    problem = tied(problem, model.tie)
    q = problem.directions.shape[1]
    at = Unknowns(np.zeros(q), model.unknowns.starts, model.unknowns.coefficients)
    measured = np.asarray(own.windows.measured)
    shift = 1e-5 * np.sin(np.arange(measured.size)).reshape(measured.shape)

    def lowest(size):
        moved = changed(problem, windows=changed(problem.windows, measured=measured - size * shift))
        stats = minimise(moved, at, Levenberg(limit=1)).stats
        return float(stats["cost"] - stats["promise"])

    information, score = information_beside(problem, at, np.zeros((1, *np.shape(own.windows.force))), shift[None])
    active = np.diag(information) > 0.0
    active[:q] &= np.arange(q) < len(model.free)
    step = np.linalg.solve(information[np.ix_(active, active)], score[active])
    own_only = active & (np.arange(active.size) < q)
    alone = np.linalg.solve(information[np.ix_(own_only, own_only)], score[own_only])
    fall = 0.5 * (score[active] @ step - score[own_only] @ alone)
    assert lowest(0.0) - lowest(float(step[-1])) == pytest.approx(fall, rel=1e-3)


def test_the_scores_of_a_torque_are_the_gradient_of_the_cost(fitted):
    """Against differences of the cost over the size of a torque, with all unknowns held where the fit ended."""
    own, model = fitted
    problem, _ = own.problem({}, model.system)
    problem = tied(problem, model.tie)
    at = Unknowns(np.zeros(problem.directions.shape[1]), model.unknowns.starts, model.unknowns.coefficients)
    times, scores = torque_scores(problem, at)
    torque = np.sin(9.0 * panel_edges(own))

    def cost(size):
        pushed = changed(problem, windows=changed(problem.windows, force=np.asarray(own.windows.force) + size * torque))
        return float(minimise(pushed, at, Levenberg(limit=1)).stats["cost"])

    slope = (cost(1e-3) - cost(-1e-3)) / 2e-3
    assert np.sum(scores * np.sin(9.0 * times)) == pytest.approx(-slope, rel=1e-2)
    assert abs(slope) > 1.0


@pytest.mark.slow
def test_columns_are_told_apart_by_their_number(fitted):
    own, model = fitted
    problem, _ = own.problem({}, model.system)
    at = Unknowns(np.zeros(problem.directions.shape[1]), model.unknowns.starts, model.unknowns.coefficients)
    shape = np.shape(own.windows.force)
    torques = np.stack([np.ones(shape), 2.0 * np.ones(shape)])
    none = np.zeros((2, *np.shape(own.windows.measured)))
    information, score = information_beside(tied(problem, model.tie), at, torques, none)
    assert score[-1] == pytest.approx(2.0 * score[-2])
    assert information[-1, -1] == pytest.approx(4.0 * information[-2, -2])
