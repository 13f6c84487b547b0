"""The like-for-like peer of our fit: scipy's `least_squares` and numba on the whole errors-in-variables problem.

Unknown are the total play b [rad], k [N m/rad], c [N m s/rad]; every window's start y [rad], y' [rad/s]; and the
coefficients of the quintic spline that stands for the base motion x, m to a window. Residuals in units of the noise:
measured z and measured x, and in a second stage the end of each window minus the start of the next. A row of weight
1e-3 a coefficient, towards the least-squares spline, holds the few that meet no sample. Row for row this is what
`jaxbacklash.fit` solves with its looser ties; `numba_shooting` solves less, with x taken as exact and no ties.

Plain RK4 in steps of 1 ms does not do: where the link meets an edge of the play its error is up to 0.7 of the noise and
25 of the ties. So each panel is two RK4 steps that meet where the link does. Windows are the innermost loop, so that
the compiler makes vector instructions of them. One core, no fastmath. LSMR does the linear algebra (a dense
factorisation is out of the question) and needs scaled unknowns. `jacobian` says how much is left to scipy:

* "grouped": the differences, by `jac_sparsity`; unknowns whitened window by window;
* "explicit": numba fills a sparse matrix with forward differences of all windows at once; whitened likewise;
* "operator": the same, whitened by the arrow-shaped Cholesky factor of the normal equations, made three times in a
  fit: a direct solver of our kind as LSMR's preconditioner.
"""

from __future__ import annotations

import time

import numpy as np
from numba import njit
from scipy.interpolate import BSpline
from scipy.linalg import cholesky_banded
from scipy.linalg.lapack import dtbtrs
from scipy.optimize import least_squares
from scipy.sparse import csr_matrix, diags
from scipy.sparse.linalg import LinearOperator, aslinearoperator, spsolve

NAMES = ("backlash", "stiffness", "damping")
TIES = 50.0 * np.array([1.0, 0.02])  # a tie against one sample's noise: for y [1], for y' [s]
WHISPER = 1e-3
FAR = 1e4  # standard errors: the first trust region; and the unit of "grouped", since scipy's differences step 1.5e-8


@njit(cache=True, error_model="numpy", inline="always")
def crossing(gap, speed, bend, h):
    """First time in (0, h) at which gap + speed t + bend t^2 / 2 is zero, or h."""
    square = speed * speed - 2 * bend * gap
    root = np.sqrt(max(square, 0.0))
    one, two = 2 * gap / (root - speed), -2 * gap / (root + speed)
    one = one if (square > 0.0) & (one > 0.0) & (one < h) else h
    two = two if (square > 0.0) & (two > 0.0) & (two < h) else h
    return min(one, two)


@njit(cache=True, error_model="numpy", inline="always")
def cubic(x0, x1, x2, x3, s):
    return x0 + s * (x1 + s * (x2 + s * x3)), x1 + s * (2 * x2 + 3 * s * x3)


@njit(cache=True, error_model="numpy", inline="always")
def rk4(y, v, half, k, c, z, x0, x1, x2, x3, s, h):
    """One step from time s of a panel with x = x0 + x1 s + ..., in the region that z lies in."""
    side = 1.0 if z > half else (-1.0 if z < -half else 0.0)
    k = k if side != 0.0 else 0.0
    push, m, e = k * side * half, s + h / 2, s + h
    (xa, da), (xm, dm), (xe, de) = cubic(x0, x1, x2, x3, s), cubic(x0, x1, x2, x3, m), cubic(x0, x1, x2, x3, e)
    a1 = push - k * (y - xa) - c * (v - da)
    v2 = v + h / 2 * a1
    a2 = push - k * (y + h / 2 * v - xm) - c * (v2 - dm)
    v3 = v + h / 2 * a2
    a3 = push - k * (y + h / 2 * v2 - xm) - c * (v3 - dm)
    v4 = v + h * a3
    a4 = push - k * (y + h * v3 - xe) - c * (v4 - de)
    return y + h / 6 * (v + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)


@njit(cache=True, error_model="numpy", inline="always")
def spline(basis, local, first, out):
    for w in range(out.size):
        low = basis[0] * local[first, w] + basis[1] * local[first + 1, w] + basis[2] * local[first + 2, w]
        high = basis[3] * local[first + 3, w] + basis[4] * local[first + 4, w] + basis[5] * local[first + 5, w]
        out[w] = low + high


@njit(cache=True, error_model="numpy")
def simulate(theta, starts, local, basis, first, panels, h, inertia, z, base, ends):
    """z and base x (m, w) of w windows of m samples, and y, y' at their ends (2, w).

    theta (3,); starts (2, w); local (m + 5, w) spline coefficients; basis (2, edges, 6) values and slopes of the six
    splines at a panel edge that are not zero, beginning with number first (edges,); `panels` of length h a sample.
    """
    half, k, c = theta[0] / 2, theta[1] / inertia, theta[2] / inertia
    samples, windows = z.shape
    y, v, edge = starts[0].copy(), starts[1].copy(), 0
    x, dx, x_end, dx_end = np.empty(windows), np.empty(windows), np.empty(windows), np.empty(windows)
    spline(basis[0, 0], local, first[0], x)
    spline(basis[1, 0], local, first[0], dx)
    for n in range(samples):
        for w in range(windows):
            z[n, w], base[n, w] = y[w] - x[w], x[w]
        for _ in range(panels):
            edge += 1
            spline(basis[0, edge], local, first[edge], x_end)
            spline(basis[1, edge], local, first[edge], dx_end)
            for w in range(windows):
                x0, x1, mean = x[w], dx[w], (x_end[w] - x[w]) / h
                x2, x3 = (3 * mean - 2 * x1 - dx_end[w]) / h, (x1 + dx_end[w] - 2 * mean) / (h * h)
                u, du = y[w] - x0, v[w] - x1
                ddu = -k * (u - min(max(u, -half), half)) - c * du - 2 * x2
                split = min(crossing(u + half, du, ddu, h), crossing(u - half, du, ddu, h))
                split = split if split < h else h / 2
                p = split / 2
                y1, v1 = rk4(y[w], v[w], half, k, c, u + p * (du + p / 2 * ddu), x0, x1, x2, x3, 0.0, split)
                at, dat = cubic(x0, x1, x2, x3, split)
                u, du, p = y1 - at, v1 - dat, (h - split) / 2
                y[w], v[w] = rk4(y1, v1, half, k, c, u + p * (du + p / 2 * ddu), x0, x1, x2, x3, split, h - split)
                x[w], dx[w] = x_end[w], dx_end[w]
    ends[0], ends[1] = y, v


@njit(cache=True, error_model="numpy")
def differences(
    theta, starts, local, basis, first, panels, h, inertia, z, base, ends, units, weight, sharp, out, out_ends
):  # fmt: skip
    """Forward differences of all windows at once, weighted: out (m, w, q) of z and out_ends (2, w, q) of the ends.

    The q = m + 10 columns: parameters in `units` (3,), a window's start, its coefficients and the next five.
    """
    simulate(theta, starts, local, basis, first, panels, h, inertia, z, base, ends)
    count, (samples, windows) = out.shape[2], z.shape
    moved, moved_ends = np.empty((count, samples, windows)), np.empty((count, 2, windows))
    for i in range(count):
        t, s, c = theta.copy(), starts.copy(), local.copy()
        if i < 3:
            t[i] += 1e-7 * units[i]
        elif i < 5:
            s[i - 3] += 1e-8
        else:
            c[i - 5] += 1e-8
        simulate(t, s, c, basis, first, panels, h, inertia, moved[i], base, moved_ends[i])
    for n in range(samples):
        for w in range(windows):
            for i in range(count):
                out[n, w, i] = (moved[i, n, w] - z[n, w]) * (1e7 if i < 3 else 1e8) * weight[n, w]
                if n < 2:
                    out_ends[n, w, i] = (moved_ends[i, n, w] - ends[n, w]) * (1e7 if i < 3 else 1e8) * sharp[n]


class Problem:
    """A record cut into windows, x on a spline.

    Unknowns (3 + w (m + 2) + 5,): parameters over their start; by window m coefficients, y and y'; five coefficients.

    Args: t, x, z (n,) [s, rad, rad]; inertia [kg m^2]; start {name: value}; sigma_z, sigma_x [rad]; intervals m of the
    spline in a window; window [s]; longest panel [s].
    """

    def __init__(self, t, x, z, inertia, start, sigma_z, sigma_x, intervals, window=0.1, longest=1e-3):
        dt, self.inertia = (t[-1] - t[0]) / (len(t) - 1), inertia
        self.samples, self.panels = round(window / dt), int(np.ceil(dt / longest - 1e-9))
        self.m, self.windows = m, w = intervals, -(-len(t) // self.samples)
        self.h, self.tied, self.cached = dt / self.panels, False, None
        self.scale = np.array([start[name] for name in NAMES], float)
        self.measured, self.base, held = self._cut(z), self._cut(x), self._cut(np.ones(len(t)))
        self.weight, self.base_weight = held / sigma_z, held / sigma_x
        self.sharp, self.whisper = TIES[:, None] / sigma_z, WHISPER / sigma_x

        edges = np.arange(self.samples * self.panels + 1) * (m / (self.samples * self.panels))
        self.first = np.minimum(edges.astype(int), m - 1)
        spacing, hump = self.samples * dt / m, BSpline.basis_element(np.arange(7.0))
        inside = np.clip((edges - self.first)[:, None] + 5.0 - np.arange(6), 0.0, 6.0)
        self.basis = np.stack([hump(inside), hump(inside, 1) / spacing])
        knots = t[0] + spacing * (np.arange(w * m + 11) - 5)
        design = BSpline.design_matrix(t, knots, 5)
        gram = (design.T @ design + diags(np.full(w * m + 5, 1e-10))).tocsc()
        self.coefficients = spsolve(gram, design.T @ x)
        link, at = BSpline(knots, spsolve(gram, design.T @ (x + z)), 5), t[0] + np.arange(w) * self.samples * dt

        # Where each unknown is, and which unknowns the rows of the Jacobian meet.
        block = 3 + np.arange(w) * (m + 2)
        self.at_starts = block + m + np.arange(2)[:, None]
        self.at_local = block + np.r_[0:m, m + 2 : m + 7][:, None]
        self.at_coefficients = np.append(self.at_local[:m].T.ravel(), self.at_local[m:, -1])
        self.first_guess = np.ones(3 + w * (m + 2) + 5)
        self.first_guess[self.at_starts] = link(at), link(at, 1)
        self.first_guess[self.at_coefficients] = self.coefficients
        own = np.vstack([np.full((3, w), [[0], [1], [2]]), self.at_starts, self.at_local]).T
        ties = [np.column_stack([own[:-1], self.at_starts[i, 1:]]) for i in range(2)]
        at_base = self.at_local[self.first[: -1 : self.panels, None] + np.arange(6)].transpose(0, 2, 1)
        columns = np.broadcast_to(own, (self.samples, *own.shape)), at_base, self.at_coefficients, *ties
        self.columns = np.concatenate([c.ravel() for c in columns]).astype(np.int32)
        values = self.basis[0, : -1 : self.panels, None, :] * self.base_weight[:, :, None]
        self.constant = np.append(values, np.full(self.at_coefficients.size, self.whisper))

    def _cut(self, values):
        padded = np.pad(values, (0, self.windows * self.samples - len(values)))
        return np.ascontiguousarray(padded.reshape(self.windows, -1).T)

    def _arguments(self, p):
        out = np.empty_like(self.weight), np.empty_like(self.weight), np.empty((2, self.windows))
        unknown = p[:3] * self.scale, p[self.at_starts], p[self.at_local]
        return *unknown, self.basis, self.first, self.panels, self.h, self.inertia, *out

    def residual(self, p):
        """All residuals in units of the noise, at the unknowns p: motion, base motion, whisper, ties."""
        arguments = self._arguments(p)
        simulate(*arguments)
        z, base, ends = arguments[-3:]
        parts = [(z - self.measured) * self.weight, (base - self.base) * self.base_weight]
        parts.append((p[self.at_coefficients] - self.coefficients) * self.whisper)
        if self.tied:
            parts.append((ends[:, :-1] - p[self.at_starts[:, 1:]]) * self.sharp)
        return np.concatenate([part.ravel() for part in parts])

    def jacobian(self, p):
        """Its sparse Jacobian, by forward differences."""
        if self.cached is not None and self.cached[0] == self.tied and np.array_equal(self.cached[1], p):
            return self.cached[2]
        q, w, n, held = self.m + 10, self.windows, self.weight.size, self.at_coefficients
        data, ends = np.empty(n * q + self.constant.size), np.empty((2, w, q))
        motion = data[: n * q].reshape(*self.weight.shape, q)
        differences(*self._arguments(p), self.scale, self.weight, self.sharp[:, 0], motion, ends)
        data[n * q :] = self.constant
        lengths = [[q, 6, 1], [n, n, held.size]]
        if self.tied:
            data = np.append(data, np.dstack([ends[:, :-1], np.broadcast_to(-self.sharp, (2, w - 1))]))
            lengths = [[*lengths[0], q + 1], [*lengths[1], 2 * (w - 1)]]
        rows = np.append(0, np.cumsum(np.repeat(*lengths)))
        self.cached = self.tied, p.copy(), csr_matrix((data, self.columns[: data.size], rows), (rows.size - 1, p.size))
        return self.cached[2]


def by_window(problem, normal):
    """Whitening, p = matrix u, by the Cholesky factors of the windows' own blocks of J^T J; a sparse matrix."""
    m, w, size = problem.m, problem.windows, normal.shape[0]
    where = 3 + np.arange(w)[:, None] * (m + 2) + np.arange(m + 2)
    rows, columns = np.broadcast_arrays(where[:, :, None], where[:, None, :])
    blocks = np.asarray(normal[rows.ravel(), columns.ravel()]).reshape(rows.shape)
    inverse = np.linalg.inv(np.linalg.cholesky(blocks)).transpose(0, 2, 1)
    upper, rest = np.triu_indices(m + 2), np.r_[0:3, size - 5 : size]
    data = np.append(inverse[:, *upper], normal.diagonal()[rest] ** -0.5)
    return csr_matrix((data, (np.append(rows[:, *upper], rest), np.append(columns[:, *upper], rest))), normal.shape)


def by_arrow(problem, normal):
    """Whitening by the whole factor of J^T J: banded for the windows, with a border for the parameters."""
    inner, width = normal[3:, 3:], 2 * problem.m + 4
    bands = [np.pad(inner.diagonal(-i), (0, i)) for i in range(width)]
    factor = cholesky_banded(np.stack(bands), lower=True)

    border = dtbtrs(factor, normal[3:, :3].toarray(), uplo="L")[0]
    corner = np.linalg.inv(np.linalg.cholesky(normal[:3, :3].toarray() - border.T @ border))

    def forward(u):
        theta = corner.T @ u[:3]
        return np.append(theta, dtbtrs(factor, u[3:] - border @ theta, uplo="L", trans="T")[0])

    def adjoint(g):
        inside = dtbtrs(factor, g[3:], uplo="L")[0].ravel()
        return np.append(corner @ (g[:3] - border.T @ inside), inside)

    return LinearOperator(normal.shape, matvec=forward, rmatvec=adjoint, dtype=float)


def fit(t, x, z, inertia, start, *, sigma_z, sigma_x, intervals, jacobian="operator", ftol=3e-8, **options):
    """Parameters, cost (half the sum of squares), nfev, seconds (without compiling and preparing the spline).

    Arguments as `Problem`'s; jacobian: "grouped", "explicit" or "operator".
    """
    problem = Problem(t, x, z, inertia, start, sigma_z, sigma_x, intervals, **options)
    problem.residual(problem.first_guess)
    problem.jacobian(problem.first_guess)  # both compile
    problem.cached = None
    began, p, evaluations = time.perf_counter(), problem.first_guess, 0
    whiten, rounds = (by_arrow, (3, None, None)) if jacobian == "operator" else (by_window, (None, None))
    for i, most in enumerate(rounds, 1):
        problem.tied = i == len(rounds)
        matrix = problem.jacobian(p)
        normal = (matrix.T @ matrix).tocsr()
        normal = normal + diags(1e-12 * normal.diagonal() + (normal.diagonal() == 0.0)).tocsr()
        p, found = _round(problem, p, whiten(problem, normal), jacobian, ftol=ftol, xtol=None, gtol=None, max_nfev=most)
        evaluations += found.nfev
    answer = {"cost": float(found.cost), "nfev": evaluations, "seconds": time.perf_counter() - began}
    return dict(zip(NAMES, map(float, p[:3] * problem.scale))) | answer


def _round(problem, p, white, jacobian, **settings):
    # scipy's first trust region is as large as the first guess: at the origin it would be one standard error.
    unit, far = (FAR, 1.0) if jacobian == "grouped" else (1.0, FAR)
    begin = np.full(p.size, far)

    def place(u):
        return p + white @ (unit * (u - begin))

    if jacobian == "grouped":
        pattern = problem.jacobian(p).copy()
        pattern.data[:] = 1.0
        settings |= {"jac_sparsity": pattern @ abs(white) != 0, "x_scale": "jac"}
    else:
        form = csr_matrix if jacobian == "explicit" else aslinearoperator
        settings["jac"] = lambda u: form(problem.jacobian(place(u))) @ white
    settings |= {"tr_solver": "lsmr", "tr_options": {"regularize": False}}
    found = least_squares(lambda u: problem.residual(place(u)), begin, **settings)
    return place(found.x), found
