"""One model of the equation-error regression: Gauss-Newton over what enters nonlinearly, on whitened rows.

For given nonlinear parameters (the play, shapes, a delay) the strengths come from least squares; the nonlinear ones step through
their derivative columns, which are differences. Rows are whitened by an autoregression of what the richest model leaves.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.signal import lfilter

from benchmarks.peers.weak_laws import BENT, LAWS, LINEAR, STEPS, Eta, inertia_side, signs, torques
from benchmarks.peers.weak_rows import Rows

ORDER = 12
"""Of the autoregression."""
JOINT_BOUNDS = {"b": (1e-4, 0.2)}


@dataclass(frozen=True)
class State:
    """A fitted model: names; eta; theta (q,) stiffness, damping, strengths; cost, sum of squares of the whitened residual;
    jacobian (rows, p) and residual (rows,), whitened; criterion."""

    names: tuple[str, ...]
    eta: Eta
    theta: np.ndarray
    cost: float
    jacobian: np.ndarray = field(repr=False)
    residual: np.ndarray = field(repr=False)
    allowed: bool
    spurious: float = 0.0

    @property
    def criterion(self) -> float:
        """Bayesian, without the fall that errors in the regressors alone would have brought."""
        n, p = self.jacobian.shape
        return n * float(np.log(max(self.cost, 1e-300) / n)) + p * float(np.log(n)) + self.spurious


class Regression:
    """Fits any set of laws to one record."""

    def __init__(self, rows: Rows, inertia: float) -> None:
        self.rows, self.inertia = rows, inertia
        self.taps = np.ones(1)
        self.known: dict[frozenset[str], State] = {}
        self._again: Regression | None = None
        self.plain: State

    def white(self, columns: np.ndarray) -> np.ndarray:
        """Rows through the whitening filter."""
        return lfilter(self.taps, [1.0], columns, axis=0)[self.taps.size - 1 :]

    def linear(self, names: tuple[str, ...], eta: Eta, k: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """theta, whitened columns and whitened residual for given nonlinear parameters."""
        a = self.white(torques(self.rows, names, eta, k))
        left = self.white(inertia_side(self.rows, eta, self.inertia))
        theta = solve(a, left)
        return theta, a, left - a @ theta

    def slopes(self, names: tuple[str, ...], eta: Eta, theta: np.ndarray, of: tuple[str, ...]) -> np.ndarray:
        """Derivatives of the whitened residual by nonlinear parameters, with the other sign: columns (rows, len(of))."""
        default = {"z0": 0.0, "r": 0.0, "tau": 0.0, "g": 1.0}
        here = self.error(names, eta, theta)
        moved = [self.error(names, {**eta, n: eta.get(n, default.get(n, 0.0)) + STEPS[n]}, theta) for n in of]
        return self.white(-np.stack([(m - here) / STEPS[n] for m, n in zip(moved, of)], axis=1))

    def fit(self, names: tuple[str, ...], eta: Eta, limit: int = 10) -> State:
        """Gauss-Newton over the nonlinear parameters, the strengths eliminated."""
        free = ("b", *(p for n in names for p in LAWS[n].nonlinear))
        bounds = JOINT_BOUNDS | {p: b for n in names for p, b in (LAWS[n].bounds or {}).items()}
        k = 1e4
        theta, a, e = self.linear(names, eta, k)
        for _ in range(limit):
            k = max(float(theta[0]), 1.0)
            theta, a, e = self.linear(names, eta, k)
            cost = float(e @ e)
            d = self.slopes(names, eta, theta, free)
            step = solve(np.concatenate([a, d], axis=1), e)[a.shape[1] :]
            for share in (1.0, 0.5, 0.2, 0.05):
                trial = dict(eta)
                for n, s in zip(free, step):
                    trial[n] = float(np.clip(eta[n] + share * s, *bounds[n]))
                found = self.linear(names, trial, k)
                if float(found[2] @ found[2]) < cost:
                    break
            else:
                break
            eta, (theta, a, e) = trial, found
            if e.size * np.log(cost / float(e @ e)) < 0.02:
                break
        d = self.slopes(names, eta, theta, free)
        jacobian = np.concatenate([a, d], axis=1)
        spurious = 0.0
        if "g" in free:
            own = a.shape[1] + free.index("g")
            spurious = self.by_noise(names, eta, theta, np.delete(jacobian, own, axis=1), jacobian[:, own], e)
        return State(names, eta, theta, float(e @ e), jacobian, e, self.allowed(names, theta, jacobian, e), spurious)

    def by_noise(
        self, names: tuple[str, ...], eta: Eta, theta: np.ndarray, others: np.ndarray, column: np.ndarray, e: np.ndarray
    ) -> float:
        """Fall of the criterion that a sensor's gain brings by noise alone: its column holds the very noise that is left.

        The record is disturbed by as much noise again to see how the column and what is left go together.
        """
        again = self.again()
        known = {"g": 1.0, **eta}
        shift = again.slopes(names, known, theta, ("g",))[:, 0] - self.slopes(names, known, theta, ("g",))[:, 0]
        left = again.error(names, eta, theta) - self.error(names, eta, theta)
        basis = np.linalg.qr(others / np.linalg.norm(others, axis=0))[0]
        free = column - basis @ (basis.T @ column)
        return float((shift @ self.white(left)) ** 2 / (free @ free) / (e @ e / e.size))

    def again(self) -> Regression:
        """The record disturbed by as much noise again, seen through the same filters."""
        if self._again is None:
            rng, rows = np.random.default_rng(0), self.rows
            x = rows.x + rows.smooth_x.sigma * rng.standard_normal(rows.x.size)
            z = rows.z + rows.smooth_z.sigma * rng.standard_normal(rows.z.size)
            self._again = Regression(Rows(rows.t, x, z, (rows.smooth_x.gain, rows.smooth_z.gain)), self.inertia)
        self._again.taps = self.taps
        return self._again

    def error(self, names: tuple[str, ...], eta: Eta, theta: np.ndarray) -> np.ndarray:
        """What a model leaves (rows,), not whitened."""
        return inertia_side(self.rows, eta, self.inertia) - torques(self.rows, names, eta, theta[0]) @ theta

    def allowed(self, names: tuple[str, ...], theta: np.ndarray, jacobian: np.ndarray, e: np.ndarray) -> bool:
        """Whether no strength has a sign (beyond two standard errors) or a size that physics forbids."""
        size = np.linalg.norm(jacobian, axis=0)
        size[size == 0.0] = 1.0
        inverse = np.linalg.pinv((jacobian / size).T @ (jacobian / size), rcond=1e-12, hermitian=True)
        errors = np.sqrt(np.maximum(np.diag(inverse), 0.0) * (e @ e) / e.size) / size
        hung = 2 + sum(len(LAWS[n].signs) for n in names[: names.index("flexible_link")]) if "flexible_link" in names else None
        light = hung is None or theta[hung] < self.inertia  # what hangs on the link is not heavier than the link
        return bool(light and np.all((signs(names) == 0) | (theta > -2.0 * errors[: theta.size])))

    def start(self, names: tuple[str, ...], eta: Eta, count: int = 40) -> State:
        """The play from a grid with everything else linear, then Gauss-Newton."""
        reach = 2.0 * float(np.quantile(np.abs(self.rows.smooth_z.values), 0.995))
        costs = {}
        for b in reach * np.linspace(0.03, 0.97, count):
            theta, _, e = self.linear(names, {**eta, "b": b}, 1e4)
            costs[float(b)] = float(e @ e) if theta[0] > 0.0 else np.inf
        return self.fit(names, {**eta, "b": min(costs, key=lambda b: costs[b])})

    def whiten(self, state: State) -> State:
        """Take the whitening filter from what the richest model leaves, and fit again."""
        self.taps = np.ones(1)
        columns = [torques(self.rows, (*state.names, *(n for n in LINEAR if n not in state.names)), state.eta, state.theta[0])]
        bent = tuple(p for law in BENT.values() for p in law.nonlinear)
        columns.append(self.slopes(state.names, state.eta, state.theta, ("b", *bent)))
        rich = np.concatenate(columns, axis=1)
        left = inertia_side(self.rows, state.eta, self.inertia)
        rest = left - rich @ solve(rich, left)
        self.taps = _autoregression(rest)
        self.known.clear()
        found = self.fit(state.names, state.eta)
        self.plain = self.fit((), {"b": state.eta["b"]})
        return found

    def over_noise(self, state: State) -> float:
        """What the model leaves, over what the record's noise leaves, as root mean squares."""
        left = self.error(state.names, state.eta, state.theta)
        noise = self.again().error(state.names, state.eta, state.theta) - left
        return float(np.sqrt(np.sum(left**2) / np.sum(noise**2)))


def solve(a: np.ndarray, left: np.ndarray) -> np.ndarray:
    """Least squares with columns scaled to one."""
    size = np.linalg.norm(a, axis=0)
    size[size == 0.0] = 1.0
    return np.linalg.lstsq(a / size, left, rcond=1e-12)[0] / size


def _autoregression(rest: np.ndarray) -> np.ndarray:
    """Prediction error filter by Burg's method, which stands the spectrum's range of many decades."""
    forward, back, taps = rest[1:], rest[:-1], np.ones(1)
    for _ in range(min(ORDER, rest.size // 10)):
        reflection = -2.0 * float(forward @ back) / float(forward @ forward + back @ back)
        taps = np.append(taps, 0.0) + reflection * np.append(taps, 0.0)[::-1]
        forward, back = (forward + reflection * back)[1:], (back + reflection * forward)[:-1]
    return taps
