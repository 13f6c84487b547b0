"""B-splines at samples: their values, least squares through samples, and curves that are sums of them.

Every smoothing of a record begins here: `smoothing` with equal knots, `cycles` with knots that follow a phase. Values come from
the Cox-de Boor recursion (de Boor, A Practical Guide to Splines, chapter X), of all samples at once in NumPy: sums over the
samples of an interval take the place of sparse matrices, which makes a fit of 15,000 samples four times as quick as
`scipy.interpolate`, whose import alone would take a sixth of a second of a command's start.
"""

from __future__ import annotations

from functools import cache, cached_property
from typing import Any

import numpy as np
from scipy.linalg import cholesky_banded
from scipy.linalg.lapack import dpbtrs


class BSplines:
    """All B-splines of a degree on given knots, at given times.

    Attributes: ``count`` of the splines; ``first`` (N,) the first of the ``degree + 1`` splines that a time sees; ``rows``
    (degree + 1, N) the values of those.

    Parameters
    ----------
    t : times, shape (N,); beyond the knots in use the outermost intervals go on
    knots : rising, shape (count + degree + 1,), in the unit of ``t``
    degree : of the polynomials between knots

    Examples
    --------
    >>> hats = BSplines(np.array([0.25, 1.5]), np.arange(-1.0, 4.0), 1)
    >>> hats.of(np.array([0.0, 1.0, 3.0])).tolist()
    [0.25, 2.0]
    """

    def __init__(self, t: np.ndarray, knots: np.ndarray, degree: int) -> None:
        self.count = knots.size - degree - 1
        at = np.clip(np.searchsorted(knots, t, "right") - 1, degree, self.count - 1)
        above = [knots[at + k] - t for k in range(1, degree + 1)]
        below = [t - knots[at - k] for k in range(degree)]
        self.first = at - degree
        self.rows = np.empty((degree + 1, t.size))
        self.rows[0] = 1.0
        for order in range(1, degree + 1):
            carried: Any = 0.0
            for k in range(order):
                share = self.rows[k] / (above[k] + below[order - 1 - k])
                self.rows[k] = carried + above[k] * share
                carried = below[order - 1 - k] * share
            self.rows[order] = carried

    @classmethod
    def equal(cls, t: np.ndarray, t0: float, spacing: float, count: int, degree: int) -> BSplines:
        """The same on equal knots, a third of the work: the first interval in use begins at ``t0``."""
        made = cls.__new__(cls)
        place = (t - t0) / spacing
        made.count = count
        made.first = np.clip(place.astype(int), 0, count - degree - 1)  # before t0 the first interval goes on
        powers = np.ones((degree + 1, t.size))
        for k in range(degree):
            np.multiply(powers[k], place - made.first, out=powers[k + 1])
        made.rows = _polynomials(degree) @ powers
        return made

    def of(self, coefficients: np.ndarray) -> np.ndarray:
        """The sum of the splines with these coefficients (count, ...) at the times, shape (N, ...)."""
        if coefficients.ndim == 1:
            return np.einsum("kn,kn->n", self.rows, coefficients[self._seen])
        along = (slice(None),) + (None,) * (coefficients.ndim - 1)
        total = self.rows[0][along] * coefficients[self.first]
        for k, row in enumerate(self.rows[1:], 1):
            total += row[along] * coefficients[self.first + k]
        return total

    def onto(self, values: np.ndarray) -> np.ndarray:
        """Sum over the samples (N,), times rising, of value times spline, for each spline: shape (count,)."""
        if np.iscomplexobj(values):
            return self.onto(values.real) + 1j * self.onto(values.imag)
        begins, _ = self._groups
        sums = np.add.reduceat(self.rows * values, begins, axis=1)
        return np.bincount(self._places, sums.ravel(), self.count)

    @cached_property
    def gram(self) -> np.ndarray:
        """Upper bands (degree + 1, count) of the splines' products summed over the samples, times rising, the diagonal last."""
        width = len(self.rows)
        bands = [
            self._spread([self.rows[k] * self.rows[k + off] for k in range(width - off)], range(off, width))
            for off in range(width)
        ]
        return np.stack(bands[::-1])

    @cached_property
    def _groups(self) -> tuple[np.ndarray, np.ndarray]:
        """Where the samples of the next interval that holds any begin, and the first spline that each group sees."""
        begins = np.concatenate([[0], np.flatnonzero(np.diff(self.first)) + 1])
        return begins, self.first[begins]

    @cached_property
    def _seen(self) -> np.ndarray:
        """The splines that each time sees, (degree + 1, N)."""
        return self.first + np.arange(len(self.rows))[:, None]

    @cached_property
    def _places(self) -> np.ndarray:
        """The same of each group of samples, in a row."""
        return (self._groups[1] + np.arange(len(self.rows))[:, None]).ravel()

    def _spread(self, products: list[np.ndarray], places: range) -> np.ndarray:
        begins, first = self._groups
        total = np.zeros(self.count)
        for product, place in zip(products, places):
            total[first + place] += np.add.reduceat(product, begins)
        return total


@cache
def _polynomials(degree: int) -> np.ndarray:
    """The splines that a time between equal knots sees, as polynomials in its distance to the knot below, a unit the spacing:
    shape (degree + 1, degree + 1), powers rising along the last axis."""
    rows = np.zeros((degree + 1, degree + 1))
    rows[0, 0] = 1.0
    for order in range(1, degree + 1):
        carried = np.zeros(degree + 1)
        for k in range(order):
            share, raised = rows[k] / order, np.append(0.0, rows[k, :-1] / order)
            rows[k] = carried + (k + 1) * share - raised
            carried = raised + (order - 1 - k) * share
        rows[order] = carried
    return rows


class LeastSquares:
    """Sums of B-splines through samples by least squares, the normal equations factored once.

    Parameters
    ----------
    splines : at the samples, times rising
    ridge : added to the diagonal of the normal equations, for splines that see few samples
    """

    def __init__(self, splines: BSplines, ridge: float) -> None:
        self.splines = splines
        bands = splines.gram.copy()
        bands[-1] += ridge
        self._factor = cholesky_banded(bands)

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Coefficients (count,) for real or complex samples (N,)."""
        right = self.splines.onto(values)
        if np.iscomplexobj(right):
            both = dpbtrs(self._factor, np.stack([right.real, right.imag], axis=1))[0]
            return both[:, 0] + 1j * both[:, 1]
        return dpbtrs(self._factor, right)[0]  # LAPACK itself: checking and wrapping take three times as long


def curve(t: np.ndarray, knots: np.ndarray, coefficients: np.ndarray, degree: int, order: int = 0) -> np.ndarray:
    """A sum of B-splines, or its derivative of an order up to the degree.

    Parameters
    ----------
    t : times, shape (N,)
    knots : rising, shape (count + degree + 1,)
    coefficients : real or complex, shape (count, ...)

    Returns
    -------
    shape (N, ...)
    """
    for lower in range(degree, degree - order, -1):
        apart = knots[lower + 1 : -1] - knots[1 : -lower - 1]
        along = (slice(None),) + (None,) * (coefficients.ndim - 1)
        coefficients = lower * np.diff(coefficients, axis=0) / apart[along]
        knots = knots[1:-1]
    return BSplines(t, knots, degree - order).of(coefficients)
