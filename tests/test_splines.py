"""Splines, quantiles and minima of our own are those that SciPy computes, which takes long to import."""

import numpy as np
import pytest
from scipy.fft import next_fast_len
from scipy.interpolate import BSpline, make_lsq_spline
from scipy.optimize import minimize_scalar
from scipy.special import chdtri

from jaxbacklash.regression.least import least_between
from jaxbacklash.signals import BSplines, chi_square, curve, fast_length
from jaxbacklash.signals.bsplines import LeastSquares

RNG = np.random.default_rng(5)
UNEVEN = np.sort(RNG.uniform(0.0, 10.0, 40))
EQUAL = 0.3 + 1.7 * (np.arange(40) - 5.0)


@pytest.mark.parametrize("knots", [UNEVEN, EQUAL], ids=["uneven", "equal"])
@pytest.mark.parametrize("order", range(6))
def test_a_curve_and_its_derivatives_are_scipys(knots, order):
    coefficients = RNG.standard_normal(34) + 1j * RNG.standard_normal(34)
    t = np.concatenate([RNG.uniform(knots[5], knots[-6], 300), knots[5:-6], [knots[5] - 0.01, knots[-6] + 0.01]])
    wanted = BSpline(knots, coefficients, 5)(t, nu=order)
    np.testing.assert_allclose(curve(t, knots, coefficients, 5, order), wanted, atol=1e-12 * np.max(np.abs(wanted)))


@pytest.mark.parametrize("degree", range(6))
def test_equal_knots_give_what_any_knots_give(degree):
    knots = 0.3 + 1.7 * (np.arange(31 + degree) - degree)
    t = np.sort(RNG.uniform(0.3, knots[30], 200))
    quick, plain = BSplines.equal(t, 0.3, 1.7, 30, degree), BSplines(t, knots, degree)
    np.testing.assert_array_equal(quick.first, plain.first)
    np.testing.assert_allclose(quick.rows, plain.rows, atol=1e-12)


def test_a_fit_by_least_squares_is_scipys():
    t = np.sort(RNG.uniform(UNEVEN[5], UNEVEN[-6], 2000))
    values = np.sin(3.0 * t) + 0.1 * RNG.standard_normal(t.size)
    found = LeastSquares(BSplines(t, UNEVEN, 5), 0.0)
    np.testing.assert_allclose(found(values), make_lsq_spline(t, values, UNEVEN, 5).c, rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(found(1j * values).imag, found(values))


def test_intervals_without_a_sample_are_passed_over():
    t = np.array([0.1, 0.2, 3.4, 3.5])
    splines = BSplines.equal(t, 0.0, 1.0, 9, 5)
    dense = BSpline.design_matrix(t, np.arange(-5.0, 10.0), 5).toarray()
    np.testing.assert_allclose(splines.onto(np.arange(4.0)), dense.T @ np.arange(4.0), atol=1e-15)
    gram = dense.T @ dense
    for off in range(6):
        np.testing.assert_allclose(splines.gram[5 - off][off:], np.diagonal(gram, off), atol=1e-15)


@pytest.mark.parametrize("freedom", [1.0, 5.5, 16.0, 40.3, 700.0, 1e6])
@pytest.mark.parametrize("beyond", [0.5, 1e-2, 1e-4])
def test_quantiles_of_chi_square_are_scipys(freedom, beyond):
    assert chi_square(freedom, beyond) == pytest.approx(chdtri(freedom, beyond), rel=2e-4 if freedom < 40 else 2e-5)


@pytest.mark.parametrize("least", [1, 7, 11, 1009, 18751])
def test_a_fast_length_is_the_next_without_large_factors(least):
    found = fast_length(least)
    assert found >= least
    assert found <= next(n for n in range(least, 2 * least + 1) if next_fast_len(n, real=True) == n)


def test_the_least_between_bounds_is_scipys():
    def function(x):
        return np.cosh(x - 0.4) + 0.1 * x

    wanted = minimize_scalar(function, bounds=(-1.0, 2.0), method="bounded", options={"xatol": 1e-8}).x
    assert least_between(function, -1.0, 2.0, 1e-6) == pytest.approx(wanted, abs=2e-6)
    assert least_between(lambda x: x, -1.0, 2.0, 1e-6) == pytest.approx(-1.0, abs=1e-5)
