"""The verdict of the growth benchmark, on numbers whose growth is known."""

import numpy as np
import pytest

from benchmarks import map_growth as growth

SIZE = 1024.0 * 4.0 ** np.arange(6)


def test_a_straight_line_with_a_constant_is_straight():
    constant, slope, misfit = growth.straight(SIZE, 0.3 + 2e-6 * SIZE)
    assert (constant, slope) == (pytest.approx(0.3), pytest.approx(2e-6))
    assert np.abs(misfit).max() < 1e-9


def test_growth_that_is_not_straight_is_seen():
    assert np.abs(growth.straight(SIZE, 1e-6 * SIZE**1.2)[2]).max() > growth.ROOM
    assert np.abs(growth.straight(SIZE, 1e-6 * SIZE**0.8)[2]).max() > growth.ROOM


def test_memory_may_grow_as_the_size_but_not_faster():
    assert growth.growth(500.0 + 1e-5 * SIZE, SIZE) < 1.0
    assert growth.growth(1e-3 * SIZE**1.2, SIZE) > 1.2
