"""Changes, trends and outliers among estimates: found where there are some, claimed by chance as seldom as is said."""

import numpy as np
import pytest

from jaxbacklash.many.change import find_change
from jaxbacklash.many.outlying import find_outliers
from jaxbacklash.many.scatter import excess_scatter, usable_errors
from jaxbacklash.many.trend import find_trend


def draws(count, *, growth, seed, size=40):
    """Estimates of a play with unequal errors that scatter by more than these, and grow in the middle."""
    for k in range(count):
        rng = np.random.default_rng([seed, k])
        errors = rng.uniform(0.01, 0.04, size)
        step = 1.0 + growth * (np.arange(size) >= size // 2)
        yield step + np.hypot(errors, 0.02) * rng.standard_normal(size), errors**2


@pytest.mark.parametrize("count", [10, pytest.param(100, marks=pytest.mark.slow)])
def test_a_growth_by_a_tenth_is_found_and_none_is_claimed_of_nothing(count):
    found = [find_change(*one) for one in draws(count, growth=0.1, seed=1)]
    assert sum(one.claimed for one in found) >= 0.95 * count
    assert sum(one.between[0] <= 20 <= one.between[1] for one in found) >= 0.85 * count
    assert sum(abs(one.growth - 0.1) < one.growth_half for one in found) >= 0.85 * count
    assert sum(find_change(*one).claimed for one in draws(count, growth=0.0, seed=2)) <= 0.05 * count


def test_the_chance_of_an_outlier_where_there_is_none_is_what_is_said():
    named = sum(bool(find_outliers(*one)) for one in draws(300, growth=0.0, seed=3, size=12))
    assert named <= 9  # 3 are expected


def test_two_outliers_do_not_hide_each_other():
    (values, variances), *_ = draws(1, growth=0.0, seed=4, size=20)
    values[[3, 11]] += 0.5
    assert {one.index for one in find_outliers(values, variances)} == {3, 11}


def test_the_excess_scatter_is_that_of_which_the_values_are_made():
    rng = np.random.default_rng(5)
    errors = rng.uniform(0.5, 1.5, 4000)
    assert np.sqrt(excess_scatter(np.hypot(errors, 2.0) * rng.standard_normal(4000), errors**2)) == pytest.approx(2.0, rel=0.05)
    assert excess_scatter(0.5 * errors * rng.standard_normal(4000), errors**2) == 0.0


def test_the_trend_is_that_of_plain_weighted_least_squares():
    rng = np.random.default_rng(6)
    along, errors = np.arange(30.0), rng.uniform(0.5, 1.5, 30)
    values = 3.0 + 0.2 * along + errors * rng.standard_normal(30)
    found = find_trend(along, values, errors**2)
    slope, _ = np.polyfit(along, values, 1, w=1.0 / np.hypot(errors, found.scatter))
    assert found.slope == pytest.approx(slope)
    assert found.claimed
    assert found.low < 0.2 < found.high


def test_an_error_that_is_not_known_is_taken_for_that_of_the_others():
    assert usable_errors(np.array([1.0, np.nan, 0.0, 3.0]), np.ones(4)) == pytest.approx([1.0, 4.0, 4.0, 9.0])
