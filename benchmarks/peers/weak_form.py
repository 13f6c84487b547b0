"""An expert's equation-error regression: which laws does a base-motion record need, without simulating anything.

    found = identify(t, x, z, inertia)        # found.effects, found.backlash, found.stiffness, found.complete

Rows of `weak_rows`, laws of `weak_laws`, one model at a time by `weak_fit`. The play comes from a grid, then from Gauss-
Newton through its derivative column, as do all other nonlinear parameters. Laws come in one by one by the Bayesian
information criterion: the best few are really refitted and the simplest is taken of those that do as well; after each the
others are tried without, and swapped; at the end blocked cross-validation has its say. What is left is set against what the
record's own noise leaves. There is no interval, and no prediction.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from benchmarks.peers.weak_fit import Regression, State, solve
from benchmarks.peers.weak_laws import BENT, LAWS, SHAPED, SIMPLER, Eta, torques
from benchmarks.peers.weak_rows import Rows

WORTH, SHARE = 10.0, 0.02
"""Fall of the criterion that a law must bring: at least, and as a share of what all laws together have brought. What is left of a
law that is only nearly right (friction that sticks, corners between samples) is small beside what it explained."""
AS_WELL = 0.98
"""Share of the best candidate's gain at which a simpler law is preferred."""
TRIED, MOST, BEAM = 4, 5, 2
"""Candidates refitted at each step, laws in a model, first steps that are followed."""
BLOCKS = 8
NOISE_ONLY = 1.15
"""What is left, over what noise leaves, up to which a model counts as complete."""


@dataclass(frozen=True)
class Named:
    """effects; backlash [rad], stiffness [N m/rad], damping; parameters of the rest; over_noise; complete."""

    effects: tuple[str, ...]
    backlash: float
    stiffness: float
    damping: float
    parameters: dict[str, float]
    over_noise: float

    @property
    def complete(self) -> bool:
        return self.over_noise < NOISE_ONLY


def identify(t: np.ndarray, x: np.ndarray, z: np.ndarray, inertia: float) -> Named:
    """Name what a record needs beyond play, stiffness and damping.

    Args: t (n,) even times [s]; x base, z relative motion (n,) [rad]; inertia J [kg m^2].
    """
    regression = Regression(Rows(t, x, z), inertia)
    state = Stepwise(regression).search()
    known = {**state.eta, "stiffness": state.theta[0], "damping": state.theta[1]}
    strengths = iter(state.theta[2:])
    for name in state.names:
        known |= {f"{name}.{j}": float(next(strengths)) for j in range(len(LAWS[name].signs))}
    backlash, stiffness, damping = (float(known.pop(n)) for n in ("b", "stiffness", "damping"))
    return Named(tuple(sorted(state.names)), backlash, stiffness, damping, known, regression.over_noise(state))


class Stepwise:
    """The search for the best set of laws; every model is fitted once."""

    def __init__(self, regression: Regression) -> None:
        self.regression = regression
        self.shaped: dict[str, list[np.ndarray]] = {}

    def search(self) -> State:
        """The best of the paths that begin with the best few laws, and its last checks."""
        base = self.regression.whiten(self.regression.start((), {"b": 0.0}))
        ends = [self.forward(base)]
        first = [s for s in self.attempts(base) if base.criterion - s.criterion > WORTH]
        for state in sorted(first, key=lambda s: s.criterion)[:BEAM]:
            if not set(state.names) <= set(ends[0].names):
                ends.append(self.forward(state))
        best = min(ends, key=self.price)
        # Now that a model is known, the checks are made with a whitening filter of its own.
        best = self.backward(self.regression.whiten(best))
        best = self.backward(self.forward(self.swap(best)))
        return self.validated(best)

    def worth(self, state: State) -> float:
        """The fall of the criterion that a law must bring beside those of a model."""
        return max(WORTH, SHARE * (self.regression.plain.criterion - state.criterion))

    def price(self, state: State) -> float:
        """The criterion with a preference for fewer terms."""
        return state.criterion + self.worth(state) * sum(LAWS[n].count for n in state.names)

    def forward(self, state: State) -> State:
        """Add laws one by one, dropping those that become needless, until nothing helps."""
        while len(state.names) < MOST:
            tried = self.attempts(state)
            if not tried:
                break
            lowest = min(s.criterion for s in tried)
            gain = state.criterion - lowest
            if gain < self.worth(min(tried, key=lambda s: s.criterion)):
                break
            level = [s for s in tried if state.criterion - s.criterion > AS_WELL * gain]
            state = self.backward(min(level, key=lambda s: (s.jacobian.shape[1], s.criterion)))
        return state

    def attempts(self, state: State) -> list[State]:
        """The likeliest additions, refitted."""
        ranked = sorted(self.ranking(state), key=lambda c: -c[0])
        tried: dict[str, State] = {}
        if not state.names:
            # A delay of more than a sample or two is out of a derivative's reach.
            for shape in BENT["sensor_delay"].shapes[1:]:
                late = self.regression.start(("sensor_delay",), {**state.eta, **shape}, 16)
                if late.allowed and ("sensor_delay" not in tried or late.cost < tried["sensor_delay"].cost):
                    tried["sensor_delay"] = self.regression.known[frozenset(late.names)] = late
        for gain, name, shape in ranked:
            if gain < 0.5 * WORTH or len(tried) > TRIED:
                break
            if name not in tried:
                found = self.with_law(state, name, shape)
                if found.allowed:
                    tried[name] = found
        return list(tried.values())

    def with_law(self, state: State, name: str, shape: Eta) -> State:
        kept = tuple(n for n in state.names if n != SIMPLER.get(name))
        key = frozenset((*kept, name))
        if key not in self.regression.known:
            found = self.regression.fit((*kept, name), {**state.eta, **shape})
            if not state.names:  # the joint alone may have put the play far from where it is
                again = self.regression.start((*kept, name), {**state.eta, **shape}, 12)
                found = min((found, again), key=lambda s: s.cost)
            self.regression.known[key] = found
        return self.regression.known[key]

    def ranking(self, state: State) -> Iterator[tuple[float, str, Eta]]:
        """Predicted fall of the criterion by each absent law at its best shape."""
        basis = np.linalg.qr(state.jacobian / np.linalg.norm(state.jacobian, axis=0))[0]
        for name, law in LAWS.items():
            if name in state.names or any(SIMPLER.get(n) == name for n in state.names):
                continue
            if name in BENT:
                sets = [self.regression.slopes(state.names, state.eta, state.theta, law.nonlinear)]
                wanted: tuple[int, ...] = (1,) if name == "sensor_delay" else (0,)
            else:
                raw = self.grid(name, state) if name in SHAPED else [self.columns(name, state.eta, state.theta[0])]
                sets, wanted = [self.regression.white(c) for c in raw], law.signs
            falls = [_fall(basis, state.residual, c, wanted) for c in sets]
            best = int(np.argmax(falls))
            n = state.residual.size
            left = max(state.cost - falls[best], 1e-12 * state.cost)
            gain = n * np.log(state.cost / left) - law.count * np.log(n)
            if name == "sensor_gain":
                at = state.names, state.eta, state.theta
                gain -= self.regression.by_noise(*at, state.jacobian, sets[0][:, 0], state.residual)
            yield float(gain), name, law.shapes[best] if law.shapes else {}

    def without(self, state: State, name: str) -> State:
        names = tuple(n for n in state.names if n != name)
        key = frozenset(names)
        if key not in self.regression.known:
            drop = LAWS[name].nonlinear
            self.regression.known[key] = self.regression.fit(names, {n: v for n, v in state.eta.items() if n not in drop})
        return self.regression.known[key]

    def backward(self, state: State) -> State:
        """The model without the laws that are not missed."""
        while state.names:
            less = [self.without(state, n) for n in state.names]
            best = min(less, key=lambda s: s.criterion)
            if best.criterion - state.criterion > self.worth(state):
                break
            state = best
        return state

    def swap(self, state: State) -> State:
        """One law after the other replaced by what else would do better."""
        for name in state.names:
            for other in self.attempts(self.without(state, name)):
                if self.price(other) < self.price(state) - 2.0:
                    return self.swap(other)
        return state

    def validated(self, state: State) -> State:
        """The model without the laws that do not help to predict blocks of rows that were left out."""
        while state.names:
            whole = _blocked(state)
            worse = {n: float(np.mean(_blocked(self.without(state, n)) > whole)) for n in state.names}
            name = min(worse, key=lambda n: worse[n])
            if worse[name] > 0.5:
                break
            state = self.without(state, name)
        return state

    def grid(self, name: str, state: State) -> list[np.ndarray]:
        """A shaped law's columns at every shape it may have, not whitened; made once."""
        if name not in self.shaped:
            self.shaped[name] = [self.columns(name, {**state.eta, **shape}, 1.0) for shape in SHAPED[name].shapes]
        return self.shaped[name]

    def columns(self, name: str, eta: Eta, k: float) -> np.ndarray:
        """A law's columns (rows, q), not whitened."""
        return torques(self.regression.rows, (name,), eta, k)[:, 2:]


def _fall(basis: np.ndarray, residual: np.ndarray, columns: np.ndarray, wanted: tuple[int, ...]) -> float:
    """Fall of the sum of squares by more columns, none where a strength would have a forbidden sign."""
    own = columns - basis @ (basis.T @ columns)
    if np.any(np.linalg.norm(own, axis=0) < 1e-7 * np.linalg.norm(columns, axis=0)):
        return 0.0
    strengths = solve(own, residual)
    if any(w * s < 0.0 for w, s in zip(wanted, strengths)):
        return 0.0
    return float(residual @ (own @ strengths))


def _blocked(state: State) -> np.ndarray:
    """Squared error of each of `BLOCKS` blocks of rows, predicted from the others (linearised where the fit ended)."""
    blocks = np.array_split(np.arange(state.residual.size), BLOCKS)
    size = np.linalg.norm(state.jacobian, axis=0)
    a = state.jacobian / np.where(size == 0.0, 1.0, size)
    gram, pull = a.T @ a, a.T @ state.residual
    errors = []
    for block in blocks:
        rows, left = a[block], state.residual[block]
        step = np.linalg.pinv(gram - rows.T @ rows, rcond=1e-12, hermitian=True) @ (pull - rows.T @ left)
        errors.append(float(np.sum((left - rows @ step) ** 2)))
    return np.array(errors)
