"""A peer for the fit: scipy's `least_squares` over a multiple-shooting residual in numba.

The base-motion joint J y'' = -k delta(y - x) - c (y' - x') is cut into windows of 0.1 s, each simulated from its own
start by RK4 in steps of at most 1 ms. With v = y' + (c/J)(y - x) the equations need x alone, not x':

    y' = v - (c/J) (y - x),   v' = -(k/J) delta(y - x).

Unknown are the total play b [rad], k [N m/rad], c [N m s/rad] and every window's y [rad] and v [rad/s]. The Jacobian's
structure goes to scipy as `jac_sparsity`: its finite differences then need five columns' worth of simulations in all
(b, k, c, all y, all v). x comes from scipy's smoothing spline of the measured x, prepared outside the timed part (its
time is reported beside). x is taken as exact, as the plain use of these tools does. One core, no fastmath; windows
are the innermost loop, so that the compiler makes vector instructions of them.

`fit_schur` has the same residual and the same five differences, but a hand-written Levenberg-Marquardt that eliminates
the windows' starts by 2 x 2 blocks: what an expert would write once scipy's generality is what takes the time.

    python -m benchmarks.peers.numba_shooting RECORD.csv --inertia 3.16
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from numba import njit
from scipy.interpolate import make_smoothing_spline
from scipy.optimize import least_squares
from scipy.sparse import coo_matrix

NAMES = ("backlash", "stiffness", "damping")


@njit(cache=True, error_model="numpy")
def simulate(theta, starts, fine, substeps, dt, inertia, out):
    """y (m, w) of w windows into `out`: theta (3,); starts (2, w) y and v; fine (2 substeps (m-1) + 1, w) is x."""
    half, k, c = theta[0] / 2, theta[1] / inertia, theta[2] / inertia
    samples, windows = out.shape
    y, v, h = starts[0].copy(), starts[1].copy(), dt / substeps
    out[0] = y
    for n in range(1, samples):
        for i in range(substeps):
            row = 2 * ((n - 1) * substeps + i)
            a, b, d = fine[row], fine[row + 1], fine[row + 2]
            for w in range(windows):
                z = y[w] - a[w]
                dy1, dv1 = v[w] - c * z, -k * (z - min(max(z, -half), half))
                z = y[w] + h / 2 * dy1 - b[w]
                dy2, dv2 = v[w] + h / 2 * dv1 - c * z, -k * (z - min(max(z, -half), half))
                z = y[w] + h / 2 * dy2 - b[w]
                dy3, dv3 = v[w] + h / 2 * dv2 - c * z, -k * (z - min(max(z, -half), half))
                z = y[w] + h * dy3 - d[w]
                dy4, dv4 = v[w] + h * dv3 - c * z, -k * (z - min(max(z, -half), half))
                y[w] += h / 6 * (dy1 + 2 * dy2 + 2 * dy3 + dy4)
                v[w] += h / 6 * (dv1 + 2 * dv2 + 2 * dv3 + dv4)
        out[n] = y


@njit(cache=True, error_model="numpy")
def gram(columns, out):
    """Per window, the products (6, 6, w) of five difference columns and the residual, columns (6, m, w); upper half."""
    count, samples, windows = columns.shape
    out[:] = 0.0
    for n in range(samples):
        for i in range(count):
            for j in range(i, count):
                for w in range(windows):
                    out[i, j, w] += columns[i, n, w] * columns[j, n, w]


class Problem:
    """A record cut into windows, with x known between its samples.

    Args: t, x, z (n,) [s, rad, rad]; inertia [kg m^2]; window [s]; longest RK4 step [s]; cutoff [Hz] of the spline.
    """

    def __init__(self, t, x, z, inertia, window=0.1, longest=1e-3, cutoff=80.0):
        began = time.perf_counter()
        self.dt, self.inertia = (t[-1] - t[0]) / (len(t) - 1), inertia
        self.samples = round(window / self.dt)
        self.windows = len(t) // self.samples
        self.substeps = int(np.ceil(self.dt / longest - 1e-9))
        spline = make_smoothing_spline(t, x, lam=1 / (self.dt * (2 * np.pi * cutoff) ** 4))
        used, per = self.samples * self.windows, 2 * self.substeps
        fine = spline(t[0] + np.arange(used * per) * (self.dt / per)).reshape(self.windows, -1)
        self.fine = np.ascontiguousarray(fine[:, : per * (self.samples - 1) + 1].T)
        self.x = np.ascontiguousarray(self.fine[::per])
        self.z = np.ascontiguousarray(z[:used].reshape(self.windows, -1).T)
        self.seconds_spline = time.perf_counter() - began

    def starts(self, damping):
        """First guess (2, w) of the windows' starts: a parabola through each window's first samples."""
        count = min(9, self.samples)
        powers = np.vander(np.arange(count) * self.dt, 3, increasing=True)
        y = self.x[:count] + self.z[:count]
        y0, dy0 = (np.linalg.pinv(powers) @ y)[:2]
        return np.stack([y0, dy0 + damping / self.inertia * self.z[:count].mean(axis=0)])

    def residual(self, unknowns):
        """y - x - z (m w,) [rad] at unknowns (3 + 2 w,): b, k, c, all y, all v."""
        y = np.empty_like(self.z)
        starts = unknowns[3:].reshape(2, -1)
        simulate(unknowns[:3], starts, self.fine, self.substeps, self.dt, self.inertia, y)
        return (y - self.x - self.z).ravel()

    def sparsity(self):
        """Which residual depends on which unknown: (m w, 3 + 2 w)."""
        rows = np.arange(self.z.size)
        window = rows % self.windows
        columns = [*(np.full_like(rows, i) for i in range(3)), 3 + window, 3 + self.windows + window]
        shape = (self.z.size, 3 + 2 * self.windows)
        return coo_matrix((np.ones(5 * rows.size), (np.tile(rows, 5), np.concatenate(columns))), shape).tocsr()


def residual(t, x, z, inertia, parameters):
    """The residual (m w,) [rad] at the first guess of the windows' starts; parameters as `fit`'s start."""
    problem, theta = Problem(t, x, z, inertia), np.array([parameters[name] for name in NAMES])
    return problem.residual(np.concatenate([theta, problem.starts(theta[2]).ravel()]))


def _answer(theta, cost, evaluations, seconds, problem):
    numbers = dict(zip(NAMES, map(float, theta)))
    rms = float(np.sqrt(2 * cost / problem.z.size))
    return {
        **numbers, "cost": float(cost), "rms": rms, "nfev": int(evaluations), "seconds": seconds,
        "seconds_spline": problem.seconds_spline,
    }  # fmt: skip


def fit(t, x, z, inertia, start, **options):
    """The named peer: scipy `least_squares`, grouped differences. start: {backlash, stiffness, damping} (total play).

    Returns those three, cost [rad^2] (half the sum of squares), rms [rad], nfev, seconds (without compiling and the
    spline), seconds_spline. options: window, longest, cutoff of `Problem`.
    """
    problem = Problem(t, x, z, inertia, **options)
    theta = np.array([start[name] for name in NAMES], float)
    problem.residual(np.concatenate([theta, problem.starts(theta[2]).ravel()]))  # compiles
    began = time.perf_counter()
    unknowns = np.concatenate([theta, problem.starts(theta[2]).ravel()])
    settings = {"x_scale": "jac", "tr_solver": "lsmr", "ftol": 1e-8, "xtol": 1e-8}
    found = least_squares(problem.residual, unknowns, jac_sparsity=problem.sparsity(), **settings)
    return _answer(found.x[:3], found.cost, found.nfev, time.perf_counter() - began, problem)


class _Schur:
    """The linear half of `fit_schur`: grouped differences, and the step with the windows' starts eliminated."""

    def __init__(self, problem):
        self.problem, shape = problem, problem.z.shape
        self.columns, self.products = np.empty((6, *shape)), np.empty((6, 6, shape[1]))
        self.scratch = np.empty(shape)

    def simulate(self, theta, starts, out):
        p = self.problem
        simulate(theta, starts, p.fine, p.substeps, p.dt, p.inertia, out)

    def cost(self, theta, starts):
        """Half the sum of squared residuals [rad^2]; the residual stays in `scratch`."""
        self.simulate(theta, starts, self.scratch)
        self.scratch -= self.problem.x
        self.scratch -= self.problem.z
        return 0.5 * float(np.vdot(self.scratch, self.scratch))

    def linearise(self, theta, starts):
        """Fill the products at a point whose residual `scratch` holds."""
        self.columns[5] = self.scratch
        measured = self.problem.x + self.problem.z
        for i in range(5):
            moved, begun = theta.copy(), starts.copy()
            step = 1e-7 * theta[i] if i < 3 else 1e-8
            if i < 3:
                moved[i] += step
            else:
                begun[i - 3] += step
            self.simulate(moved, begun, self.columns[i])
            self.columns[i] -= measured
            self.columns[i] -= self.columns[5]
            self.columns[i] /= step
        gram(self.columns, self.products)

    def step(self, damping):
        """The steps of theta (3,) and of the starts (2, w) under Marquardt's factor `damping`."""
        g = self.products
        a, b, d = g[3, 3] * (1 + damping), g[3, 4], g[4, 4] * (1 + damping)
        cross = np.concatenate([g[:3, 3:5], -g[3:5, 5][None]])  # (4, 2, w): what couples to theta, and the right side
        back = np.stack([d * cross[:, 0] - b * cross[:, 1], a * cross[:, 1] - b * cross[:, 0]], axis=1)
        back /= a * d - b * b
        total = g.sum(axis=2)
        normal = np.triu(total[:3, :3]) + np.triu(total[:3, :3], 1).T
        normal += np.diag(damping * np.diag(normal)) - np.einsum("iaw,jaw->ij", cross[:3], back[:3])
        right = -total[:3, 5] - np.einsum("iaw,aw->i", cross[:3], back[3])
        theta = np.linalg.solve(normal, right)
        return theta, back[3] - np.tensordot(theta, back[:3], 1)


def fit_schur(t, x, z, inertia, start, rounds=60, **options):
    """The same fit with the windows' starts eliminated; arguments and answer as `fit`'s."""
    problem = Problem(t, x, z, inertia, **options)
    theta = np.array([start[name] for name in NAMES], float)
    schur = _Schur(problem)
    schur.cost(theta, problem.starts(theta[2]))
    gram(schur.columns, schur.products)  # compiles
    began = time.perf_counter()
    starts, damping, evaluations = problem.starts(theta[2]), 1e-3, 1
    cost = schur.cost(theta, starts)
    schur.linearise(theta, starts)
    for _ in range(rounds):
        step, move = schur.step(damping)
        trial = schur.cost(theta + step, starts + move) if np.all(theta + step > 0) else np.inf
        evaluations += 1
        if not trial <= cost:
            damping *= 10
            if damping > 1e8:
                break
            continue
        gain, theta, starts, cost, damping = cost - trial, theta + step, starts + move, trial, damping / 10
        if gain < 1e-8 * cost:
            break
        schur.linearise(theta, starts)
    return _answer(theta, cost, evaluations, time.perf_counter() - began, problem)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("record", help="CSV with columns t, x, z")
    parser.add_argument("--inertia", type=float, required=True, help="kg m^2")
    parser.add_argument("--start", type=float, nargs=3, default=(0.03, 15000.0, 15.0), metavar=("B", "K", "C"))
    given = parser.parse_args()
    t, x, z = np.loadtxt(given.record, delimiter=",", skiprows=1, usecols=(0, 1, 2)).T
    for peer in (fit, fit_schur):
        print(peer.__name__, peer(t, x, z, given.inertia, dict(zip(NAMES, given.start))))


if __name__ == "__main__":
    main()
