"""The like-for-like peer of our fit: scipy's `least_squares` and numba on the whole errors-in-variables problem.

Unknown are the total play b [rad], k [N m/rad] and c [N m s/rad]; every window's start y [rad], y' [rad/s]; and the
coefficients of the quintic spline that stands for the base motion x, m to a window. Residuals, all in units of the noise:
measured z and measured x, and in a second stage the end of each window minus the start of the next (`TIES`). A row of
weight 1e-3 per coefficient, towards the least-squares spline, holds the few that meet no sample. This is row for row
the problem that `jaxbacklash.fit` solves; `numba_shooting` solves a smaller one, with x taken as exact and no ties.

As there, v = y' + (c/J)(y - x) needs x alone:  y' = v - (c/J) (y - x),  v' = -(k/J) delta(y - x). Windows are the
innermost loop, so that the compiler makes vector instructions of them; RK4 steps of at most `longest` seconds.

`fit(..., jacobian="explicit")` hands scipy a sparse Jacobian filled by numba from forward differences, perturbing all
windows at once; `jacobian="grouped"` leaves the differences to scipy and its `jac_sparsity`. LSMR does the linear algebra
(a dense factorisation is out of the question at this size). It converges only if the unknowns are scaled: each
window's unknowns are first transformed by the Cholesky factor of their own block of the normal equations.
"""

from __future__ import annotations

import time

import numpy as np
from numba import njit
from scipy.interpolate import BSpline, make_lsq_spline
from scipy.optimize import least_squares
from scipy.sparse import csr_matrix

NAMES = ("backlash", "stiffness", "damping")
DEGREE = 5
TIES = 50.0 * np.array([1.0, 0.02])  # how many times sharper than one sample's noise a tie is: y [1], y' [s]
WHISPER = 1e-3


@njit(cache=True, error_model="numpy", inline="always")
def spline(weights, local, first, out):
    for w in range(out.size):
        out[w] = (
            weights[0] * local[first, w] + weights[1] * local[first + 1, w] + weights[2] * local[first + 2, w]
            + weights[3] * local[first + 3, w] + weights[4] * local[first + 4, w] + weights[5] * local[first + 5, w]
        )  # fmt: skip


@njit(cache=True, error_model="numpy")
def simulate(theta, starts, local, basis, first, steps, h, inertia, x0, z, ends):
    """z (m, w) of all windows, and y, y' at their ends (2, w).

    theta (3,); starts (2, w); local (m + 5, w) spline coefficients; basis (2 steps m + 1, 6) with the index `first` of its
    first coefficient; `steps` of length h a sample; x0 (2, w) is scratch.
    """
    half, k, c = theta[0] / 2, theta[1] / inertia, theta[2] / inertia
    samples, windows = z.shape
    y, v = starts[0].copy(), np.empty(windows)
    a, b, d = np.empty(windows), np.empty(windows), np.empty(windows)
    spline(basis[0], local, first[0], a)
    for w in range(windows):
        v[w] = starts[1, w] + c * (y[w] - a[w])
    row = 0
    for n in range(samples):
        for w in range(windows):
            z[n, w] = y[w] - a[w]
        for _ in range(steps):
            spline(basis[row + 1], local, first[row + 1], b)
            spline(basis[row + 2], local, first[row + 2], d)
            row += 2
            for w in range(windows):
                u = y[w] - a[w]
                dy1, dv1 = v[w] - c * u, -k * (u - min(max(u, -half), half))
                u = y[w] + h / 2 * dy1 - b[w]
                dy2, dv2 = v[w] + h / 2 * dv1 - c * u, -k * (u - min(max(u, -half), half))
                u = y[w] + h / 2 * dy2 - b[w]
                dy3, dv3 = v[w] + h / 2 * dv2 - c * u, -k * (u - min(max(u, -half), half))
                u = y[w] + h * dy3 - d[w]
                dy4, dv4 = v[w] + h * dv3 - c * u, -k * (u - min(max(u, -half), half))
                y[w] += h / 6 * (dy1 + 2 * dy2 + 2 * dy3 + dy4)
                v[w] += h / 6 * (dv1 + 2 * dv2 + 2 * dv3 + dv4)
                a[w] = d[w]
    for w in range(windows):
        ends[0, w] = y[w]
        ends[1, w] = v[w] - c * (y[w] - a[w])
