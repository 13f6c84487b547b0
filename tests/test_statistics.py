"""Are the fit's intervals honest, and is it as precise as can be? Against fresh noise and the Cramer-Rao bound.

Every limit below is a quantile of the distribution that an honest fit would follow; the seeds are fixed, so a test
passes or fails for good, and its false-alarm probability is that of an honest fit failing by the luck of these seeds.
"""

import numpy as np
import pytest
from scipy import stats
from scipy.interpolate import BSpline

from benchmarks.interval_coverage import Case, Pushed, bound, fit, knot_spacing, study
from tests.independent import events
from tests.independent.cramer_rao import base_motion_bound, force_bound
from tests.independent.motions import Motion, Multisine
from tests.independent.rigs import Rig

FAST = Case("base", seconds=6.0)
SLOW = [Case("base"), Case("base", 3e-4), Case("force"), Case("force", inertia_given=False)]
FALSE_ALARM = 1e-3
PUSH = Multisine(np.array([60.0, 40.0]), np.array([2.1, 7.3]), np.array([0.3, 1.2]), ramp=0.1)  # N m


class Splined(Motion):
    """A quintic spline with knots `spacing` apart and given coefficients, from t = 0."""

    def __init__(self, spacing, coefficients):
        self.spline = BSpline(spacing * (np.arange(coefficients.size + 6) - 5), coefficients, 5)

    def derivatives(self, t):
        return tuple(self.spline(t, nu=order) for order in range(3))


def marginal(function, point, steps, wanted):
    """The bound (wanted, wanted) on the first parameters by central differences of samples in units of their noise."""
    columns = [(function(point + e) - function(point - e)) / (2 * h) for h, e in zip(steps, np.diag(steps))]
    jacobian = np.stack(columns, axis=1)
    scale = np.linalg.norm(jacobian, axis=0)
    return (np.linalg.inv((jacobian / scale).T @ (jacobian / scale)) / np.outer(scale, scale))[:wanted, :wanted]


@pytest.mark.parametrize("known", [False, True], ids=["x measured", "x known"])
def test_bound_is_that_of_brute_force_with_a_moving_base(known):
    rig, spacing, t = Rig(2.9, 0.024, 11500.0, 13.0), 0.05, 0.004 * np.arange(101)
    sigma_x, sigma_z = 2e-5, 3e-5
    wiggle = 0.03 * np.sin(1.1 * np.arange(13)) + 0.01 * np.random.default_rng(0).standard_normal(13)

    def run(u):
        base = Splined(spacing, wiggle if known else u[5:])
        y, v = events.simulate(events.Joint(rig.inertia, *u[:3], base, *u[3:5]), t, rtol=1e-13, atol=1e-15)
        return y, v, base.x(t)

    def samples(u):
        y, _, x = run(u)
        return (y - x) / sigma_z if known else np.concatenate([(y - x) / sigma_z, x / sigma_x])

    joint = np.array([rig.backlash, rig.stiffness, rig.damping, 0.013, 0.1])
    point = joint if known else np.concatenate([joint, wiggle])
    y, v, x = run(point)
    assert np.mean(y - x > rig.backlash / 2) > 0.1
    assert np.mean(y - x < -rig.backlash / 2) > 0.1
    brute = marginal(samples, point, 1e-6 * np.maximum(np.abs(point), 0.01), 3)
    noise = {"sigma_x": 0.0 if known else sigma_x, "sigma_z": sigma_z}
    exact = base_motion_bound(rig, t, y, v, Splined(spacing, wiggle).x, spacing=spacing, **noise)
    assert exact.misfit < 1e-12
    np.testing.assert_allclose(exact.covariance, brute, rtol=1e-5)


def test_bound_is_that_of_brute_force_with_a_force():
    rig, t, sigma = Rig(2.9, 0.024, 11500.0, 13.0), 0.004 * np.arange(151), 3e-5

    def run(u):
        return events.simulate(Pushed(*u[:4], y0=u[4], v0=u[5], force=PUSH), t, rtol=1e-13, atol=1e-15)

    point = np.array([rig.inertia, rig.backlash, rig.stiffness, rig.damping, 0.005, 0.2])
    y, v = run(point)
    assert y.max() > rig.backlash / 2 > -rig.backlash / 2 > y.min()
    brute = marginal(lambda u: run(u)[0] / sigma, point, 1e-6 * np.maximum(np.abs(point), 0.01), 4)
    exact = force_bound(rig, t, y, v, PUSH.x, sigma_y=sigma, inertia=True)
    np.testing.assert_allclose(exact.covariance, brute, rtol=1e-4)
    assert exact.names == ("inertia", "backlash", "stiffness", "damping")


@pytest.fixture(scope="module")
def few():
    """Twelve measurements of one motion, fitted."""
    return study(FAST, range(12))


def test_answers_scatter_as_the_covariance_says(few):
    q, n = len(FAST.names), len(few.values)
    # Together: the squared distances add up to a chi-square of q n; two-sided.
    low, high = stats.chi2.ppf([FALSE_ALARM / 2, 1 - FALSE_ALARM / 2], q * n)
    assert low < few.distances.sum() < high
    # Each parameter: scatter too wide, or off centre, at the same false-alarm probability.
    assert np.all(np.sum(few.scores**2, axis=0) < stats.chi2.ppf(1 - FALSE_ALARM / q, n))
    assert np.all(np.abs(few.scores.mean(axis=0)) * np.sqrt(n) < stats.norm.ppf(1 - FALSE_ALARM / (2 * q)))
    assert few.tied.all()
    assert few.shapes == 1


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(FAST, id="base"),
        pytest.param(Case("force", seconds=6.0), id="force", marks=pytest.mark.slow),
        pytest.param(Case("force", seconds=6.0, inertia_given=False), id="force, inertia fitted", marks=pytest.mark.slow),
    ],
)
def test_reported_covariance_is_the_bound(case):
    fitted = fit(case, 0)
    assert fitted.free == case.names
    # With the noise the fit found, and x in the fit's own space: what is left is the algebra and the ties.
    noise = fitted.input_noise[0], fitted.noise[0]
    exact = bound(case, spacing=knot_spacing(fitted), noise=noise).covariance
    scale = np.sqrt(np.diag(exact))
    np.testing.assert_allclose(np.sqrt(np.diag(fitted.covariance)), scale, rtol=0.04)
    np.testing.assert_allclose(fitted.covariance / np.outer(scale, scale), exact / np.outer(scale, scale), atol=0.08)
    # With the true noise and x in the smallest space that holds it: nothing much is given away.
    least = np.array([bound(case).stderr[name] for name in case.names])
    np.testing.assert_allclose(np.sqrt(np.diag(fitted.covariance)), least, rtol=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("case", SLOW, ids=str)
def test_intervals_hold_the_truth_and_the_fit_is_efficient(case):
    n, q = 100, len(case.names)
    many = study(case, range(n))
    # Bonferroni over the parameters: each test of this function fails an honest fit once in a thousand times.
    low, high = stats.binom.ppf([FALSE_ALARM / (2 * q), 1 - FALSE_ALARM / (2 * q)], n, 0.95)
    assert np.all(many.held >= low), many.held
    assert np.all(many.held <= high), many.held
    assert np.all(np.abs(many.scores.mean(axis=0)) * np.sqrt(n) < stats.norm.ppf(1 - FALSE_ALARM / (2 * q)))
    least = np.array([bound(case).stderr[name] for name in case.names])
    rms = np.sqrt(np.mean((many.values - case.truth) ** 2, axis=0))
    # At most 1.1 times the bound, plus what 100 fits leave open.
    spread = np.sqrt(stats.chi2.ppf(1 - FALSE_ALARM / q, n) / n)
    assert np.all(rms / least < 1.1 * spread), rms / least
