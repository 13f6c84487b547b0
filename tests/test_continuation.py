"""Fits by continuation in the size of the torque left out: the evidence against a Kalman filter, the size against what acted."""

import equinox as eqx
import numpy as np
import pytest
from scipy.linalg import expm

import jaxbacklash as jb
from jaxbacklash.fitting.continuation import TIGHTEST, continued, log_evidence
from jaxbacklash.fitting.setup import base_system, first_guess, make_problem
from jaxbacklash.shooting.levenberg import Levenberg, minimise
from jaxbacklash.shooting.windows import cut

from .hidden import fitter, hidden

SIGMA, DT, WINDOW = 1e-4, 0.004, 0.048
OMEGA, ZETA = 25.0, 0.02


def decay(seed, samples=1200, power=0.0):
    """A free decay of a linear link, with a torque that is white in time of so much power, measured with noise."""
    rng = np.random.default_rng(seed)
    a = np.array([[0.0, 1.0], [-(OMEGA**2), -2.0 * ZETA * OMEGA]])
    # Van Loan 1978: the covariance that white noise of the acceleration adds in a step.
    block = expm(DT * np.block([[-a, np.diag([0.0, power])], [np.zeros((2, 2)), a.T]]))
    step = block[2:, 2:].T
    root = np.linalg.cholesky(step @ block[:2, 2:] + 1e-24 * np.eye(2))
    state, found = np.array([0.2, 0.0]), []
    for _ in range(samples):
        found.append(state[0])
        state = step @ state + root @ rng.standard_normal(2)
    return jb.Record(DT * np.arange(samples), {"z": np.array(found) + SIGMA * rng.standard_normal(samples)})


def shooting(record, free=("stiffness", "damping")):
    """The problem of a linear link at its true values, and its noise."""
    base, _, _ = base_system(record, "linear", 1.0)
    windows, layout = cut([record], WINDOW)
    system = eqx.tree_at(
        lambda s: (s.contact.stiffness, s.damper.damping), base, (np.asarray(OMEGA**2), np.asarray(2.0 * ZETA * OMEGA))
    )
    return make_problem(system, windows, free), layout.noise[0]


def kalman(record, noise, jump, length):
    """Log likelihood of a record whose state jumps by N(0, diag(jump^2)) every ``length`` samples, begun from anywhere."""
    a = np.array([[0.0, 1.0], [-(OMEGA**2), -2.0 * ZETA * OMEGA]])
    step = expm(DT * a)
    mean, spread, total = np.array([record.channels["z"][0], 0.0]), np.diag([1.0, 1e2]), 0.0
    for k, measured in enumerate(record.channels["z"]):
        if k:
            mean, spread = step @ mean, step @ spread @ step.T
            if k % length == 0:
                spread = spread + np.diag(jump**2)
        off, var = measured - mean[0], spread[0, 0] + noise**2
        total -= 0.5 * (np.log(var) + off**2 / var)
        gain = spread[:, 0] / var
        keep = np.eye(2) - np.outer(gain, [1.0, 0.0])
        mean, spread = mean + gain * off, keep @ spread @ keep.T + noise**2 * np.outer(gain, gain)  # Joseph
    return total


def test_the_evidence_is_the_likelihood_of_a_kalman_filter():
    record = decay(0, power=1e-3)
    problem, noise = shooting(record, free=())
    found, filtered = [], []
    for tie in (1e-3, 1e-2, 1e-1, 1.0):
        at = eqx.tree_at(lambda p: p.tie, problem, np.asarray(tie))
        found.append(log_evidence(at, minimise(at, first_guess(at), Levenberg(atol=1e-6))))
        filtered.append(kalman(record, noise, 1.0 / (tie * np.asarray(problem.windows.drop)), problem.windows.samples))
    np.testing.assert_allclose(np.diff(found), np.diff(filtered), rtol=1e-3, atol=0.02)


def test_a_complete_model_leaves_no_torque_out():
    ended = [continued(*begun(decay(seed))).tie for seed in range(20)]
    # The likelihood ratio lets one in twenty pass by chance.
    assert sum(tie < TIGHTEST for tie in ended) <= 4


@pytest.mark.parametrize("power", [1e-3, 1e-1])
def test_the_size_of_the_torque_left_out_is_found(power):
    tie = continued(*begun(decay(1, power=power))).tie
    problem, _ = shooting(decay(1, power=power))
    drop = np.asarray(problem.windows.drop)[1]
    jump = 1.0 / (tie * drop)
    # Ties come in factors of ten, so that the likeliest is within the square root of that, and a little for chance.
    assert abs(np.log10(jump / np.sqrt(power * WINDOW))) < 0.8


def test_parameters_hold_while_a_torque_is_left_out():
    # So little that it moves the link by less than the noise within a window: it acts where windows join.
    off = []
    for seed in range(20):
        problem, start = begun(decay(seed, power=1e-5))
        found = continued(problem, start)
        assert found.converged
        value = np.asarray(problem.parameters(found.minimum.value.theta))[np.argmax(problem.directions, axis=0)]
        error = np.sqrt(np.diag(np.linalg.inv(found.minimum.stats["schur"]))) * np.sum(problem.directions, axis=0)
        off.append((value - [OMEGA**2, 2.0 * ZETA * OMEGA]) / error)
    # Ties in factors of ten may allow a torque up to three times too large, and errors with it, but not understate them.
    assert 0.3 < np.sqrt(np.mean(np.square(off))) < 1.2


def begun(record):
    """A problem and where to begin it."""
    problem, _ = shooting(record)
    return problem, first_guess(problem)


@pytest.mark.slow
def test_no_law_is_stiffer_than_a_step_of_the_integration_follows():
    """Dahl's law on a link that dry friction holds: its stiffness may grow as far as a Runge-Kutta step is stable, no further."""
    record, rig, _, _ = hidden("coulomb_joint", "multisine", 5, 4.0, Tc=4.5)
    own = fitter(record, rig.inertia)
    alone = own.fit_model({})
    step = 0.5 * float(own.windows.panel)
    problem, free = own.problem({"dahl": jb.Dahl(4.5, 4.5e3)}, alone.system)
    most = dict(zip(free, 1.0 + problem.upper))
    assert 0.5 < most["dahl.sigma"] * 4.5e3 * step**2 / rig.inertia < 2.8**2
    assert np.isinf(most["stiffness"])
    assert np.isinf(most["dahl.Fc"])
    assert np.isfinite(own.fit_model({"dahl": jb.Dahl(4.5, 3e6)}, alone).log_evidence)
