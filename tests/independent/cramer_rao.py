r"""How precisely can any unbiased method know the play, the stiffness and the damping? The Cramer-Rao bound.

The model. A link of inertia J hangs behind a joint with a sharp dead zone, on one continuous trajectory:

    J y'' = -k delta_b(y - x) - c (y' - x')        driven by its base,
    J y'' = -k delta_b(y) - c y' + F               driven by a force, the base at rest.

Driven by its base: x(t) = sum_j a_j B_j(t) lies in the space of quintic splines with equally spaced knots, fine enough
to hold the true motion (`Bound.misfit` says how far that is from it). The samples are x_i = x(t_i) + sigma_x e_i and
z_i = y(t_i) - x(t_i) + sigma_z e'_i, all e and e' independent and standard normal. Unknown are theta = (b, k, c), the
link's start s_0 = (y, y') and all a_j. Driven by a force: F is known exactly, y_i = y(t_i) + sigma e_i; unknown are
theta, with or without J, and s_0.

The bound. Stack the samples, each divided by its noise, in m(theta, u), u = (s_0, a); A = dm/du, E = dm/dtheta. For
Gaussian noise of known size the Fisher information is [A, E]^T [A, E], and the bound on theta with u unknown is the
inverse of the Schur complement

    S = E^T E - E^T A (A^T A)^-1 A^T E.

As a quadratic form in dtheta, S is the least that |A du + E dtheta|^2 can be made by choosing du.

The numbers. On a chaotic record dm/ds_0 and dm/dtheta grow like exp(lambda t) and drown in rounding. But S is a
minimum, and a minimum may be sought over more unknowns if these are tied by exact constraints: let the states s_i at
all samples be unknown, du = (ds_0 ... ds_N, da). The samples see them directly and theta not at all, |A du|^2, and they
are tied by the linearised exact step from sample to sample,

    ds_{i+1} = Phi_i ds_i + G_i da + H_i dtheta,         in short  C du = H dtheta.

For each unit vector dtheta the minimum solves [A^T A, C^T; C, 0] [du; lambda] = [0; H dtheta], a sparse system whose
entries do not grow; with its solutions U side by side, S = (A U)^T (A U).

The steps. Between switches and knots the motion is linear, with constant coefficients in the joint state
w = (y, y', D, D', ... D^(5), 1), D the driving x or F: w' = M w. The sensitivity s of (y, y') to a parameter obeys
s' = A s + (dM/dtheta) w, A now the first 2 x 2 of M, and one matrix exponential takes both over a piece exactly.
At a switch the field is continuous, since the spring starts from zero force, so the jump (f_before - f_after) dt of a
sensitivity vanishes: pieces are chained.

numpy and scipy only; nothing here shares code with the package.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.interpolate import BSpline, PPoly, make_lsq_spline
from scipy.optimize import brentq
from scipy.sparse import bmat, csc_matrix, diags
from scipy.sparse.linalg import splu

from tests.independent.rigs import Rig

JOINT = ("backlash", "stiffness", "damping")
_ORDER = 6  # a quintic: six coefficients a piece
_Y, _V, _D, _ONE, _SIZE = 0, 1, 2, 8, 9  # places in w


@dataclass(frozen=True)
class Bound:
    """A Cramer-Rao bound.

    names: the parameters; covariance (q, q) in their SI units; misfit: root mean square distance of the true driving
    motion or force from the spline that stands for it, in its unit.
    """

    names: tuple[str, ...]
    covariance: np.ndarray
    misfit: float

    @property
    def stderr(self) -> dict[str, float]:
        """The least standard deviation of each parameter."""
        return dict(zip(self.names, np.sqrt(np.diag(self.covariance))))


def base_motion_bound(
    rig: Rig, t, y, v, x: Callable, *, sigma_x: float, sigma_z: float, spacing: float, torques: dict | None = None
) -> Bound:
    """The bound on (b, k, c), and on the strengths of absent torques, all at once, from a base-motion record.

    Args: t (n,) sample times from 0 [s]; y, v (n,) the link's true motion [rad, rad/s]; x(t) the base's [rad];
    sigma_x, sigma_z [rad], sigma_x = 0: x known exactly; spacing: between the knots of the space that x lies in [s];
    torques: name -> (n,) torque at unit strength along the motion [N m], of laws whose strength is zero; by the trapezoidal rule.
    """
    steps = _Steps(rig, t, y, v, _Space(t[-1], spacing, x), JOINT, forced=False)
    for name, torque in (torques or {}).items():
        steps.add(name, np.asarray(torque, float))
    return Bound(steps.names, _covariance(steps, sigma_z, sigma_x), steps.space.misfit)


def widest_spacing(x: Callable, end: float, within: float, spacings: tuple[float, ...]) -> float:
    """The first of some distances of knots [s] whose spline is within a root mean square distance of x [rad] over (0, end)."""
    return next((s for s in spacings if _Space(end, s, x).misfit < within), spacings[-1])


def force_bound(rig: Rig, t, y, v, force: Callable, *, sigma_y: float, spacing: float = 5e-3, inertia: bool = False) -> Bound:
    """The bound on (b, k, c), or (J, b, k, c) if `inertia` is unknown too, from a record driven by force(t) [N m].

    Args: t, y, v as above; sigma_y [rad]; spacing: between the knots of the spline that stands for the force [s].
    """
    names = ("inertia", *JOINT) if inertia else JOINT
    steps = _Steps(rig, t, y, v, _Space(t[-1], spacing, force), names, forced=True)
    return Bound(names, _covariance(steps, sigma_y, 0.0), steps.space.misfit)


def _exponential(matrix: np.ndarray) -> np.ndarray:
    """The matrix exponential by Taylor's series, scaled and squared: no solve, whose threads would outweigh it."""
    halvings = max(0, int(np.ceil(np.log2(max(np.abs(matrix).sum(axis=1).max(), 1e-300)))) + 1)
    small = matrix / 2**halvings
    term = result = np.eye(len(matrix))
    for k in range(1, 17):
        term = term @ small / k
        result = result + term
    for _ in range(halvings):
        result = result @ result
    return result


class _Space:
    """Quintic splines with equal knots on [0, end], and the one nearest to a given motion."""

    def __init__(self, end: float, spacing: float, motion: Callable) -> None:
        self.spacing, self.intervals = spacing, max(1, int(np.ceil(end / spacing - 1e-9)))
        self.count = self.intervals + _ORDER - 1
        self.knots = spacing * (np.arange(self.count + _ORDER) - (_ORDER - 1))
        times = np.linspace(0.0, self.intervals * spacing, 8 * self.intervals + 9)
        self.coefficients = make_lsq_spline(times, motion(times), self.knots, _ORDER - 1).c
        gap = BSpline(self.knots, self.coefficients, _ORDER - 1)(times) - motion(times)
        self.misfit = float(np.sqrt(np.mean(gap**2)))
        # The six pieces of the basis function on unit knots, powers rising (scipy pads its knots on both sides).
        # The last piece belongs to an interval's first coefficient. _table: (6 orders, 6 coefficients, 6 powers).
        padded = PPoly.from_spline(BSpline.basis_element(np.arange(_ORDER + 1.0)))
        powers = padded.c[::-1, np.searchsorted(padded.x, 0.0) :][:, :_ORDER].T[::-1]
        self._table = np.zeros((_ORDER, _ORDER, _ORDER))
        for order in range(_ORDER):
            self._table[order, :, : _ORDER - order] = np.polynomial.polynomial.polyder(powers, order, axis=1)
            self._table[order] /= spacing**order

    def rows(self, t: float) -> tuple[int, np.ndarray]:
        """The first of six coefficients that matter just after t, and (6, 6): derivatives 0 to 5 from them."""
        first = min(int(t / self.spacing + 1e-9), self.intervals - 1)
        return first, self._table @ (t / self.spacing - first) ** np.arange(_ORDER)


class _Steps:
    """The linearised exact steps from sample to sample, along the true motion.

    phi (n-1, 2, 2); gains: for every step the first coefficient it meets and (2, m) what each does; h (n-1, 2, q).
    """

    def __init__(self, rig: Rig, t, y, v, space: _Space, names: tuple[str, ...], forced: bool) -> None:
        self.rig, self.t, self.space, self.names, self.forced = rig, np.asarray(t, float), space, names, forced
        self.sizes = {name: getattr(rig, name) for name in names}
        self._joint = {side: self._joint_system(side) for side in (-1, 0, 1)}
        self._known: dict[tuple[int, int], np.ndarray] = {}
        n, q = self.t.size, len(names)
        self.phi, self.h = np.empty((n - 1, 2, 2)), np.empty((n - 1, 2, q))
        self.gains = []
        for i in range(n - 1):
            self._step(i, np.array([y[i], v[i]]))

    def add(self, name: str, torque: np.ndarray) -> None:
        """One more parameter: the strength, at zero, of a torque that is known along the motion."""
        push = np.zeros((self.t.size, 2, 1))
        push[:, 1, 0] = torque / self.rig.inertia
        step = np.diff(self.t)[:, None, None]
        self.h = np.concatenate([self.h, 0.5 * step * (self.phi @ push[:-1] + push[1:])], axis=2)
        self.names = (*self.names, name)
        self.sizes[name] = self.rig.stiffness * self.rig.backlash / float(np.sqrt(np.mean(torque**2)))

    def _field(self, side: int) -> tuple[np.ndarray, np.ndarray]:
        """M (9, 9), and what its second row's derivatives by the parameters are, (q, 9)."""
        J, b, k, c = self.rig.inertia, self.rig.backlash, self.rig.stiffness, self.rig.damping
        touch, z, dz, edge = abs(side), np.zeros(_SIZE), np.zeros(_SIZE), np.zeros(_SIZE)
        z[_Y], dz[_V], edge[_ONE] = 1.0, 1.0, 0.5 * side
        push = np.zeros(_SIZE)
        if self.forced:
            push[_D] = 1.0
        else:
            z[_D], dz[_D + 1] = -1.0, -1.0
        torque = -k * touch * (z - b * edge) - c * dz + push
        slopes = {
            "inertia": -torque / J**2,
            "backlash": k * touch * edge / J,
            "stiffness": -touch * (z - b * edge) / J,
            "damping": -dz / J,
        }
        m = np.zeros((_SIZE, _SIZE))
        m[_Y, _V] = 1.0
        m[_V] = torque / J
        for order in range(_ORDER - 1):
            m[_D + order, _D + order + 1] = 1.0
        return m, np.array([slopes[name] for name in self.names])

    def _joint_system(self, side: int) -> np.ndarray:
        m, slopes = self._field(side)
        q = len(self.names)
        joint = np.zeros((_SIZE + 2 * q, _SIZE + 2 * q))
        joint[:_SIZE, :_SIZE] = m
        for p in range(q):
            at = _SIZE + 2 * p
            joint[at : at + 2, at : at + 2] = m[:2, :2]
            joint[at + 1, :_SIZE] = slopes[p]
        return joint

    def _flow(self, side: int, duration: float) -> np.ndarray:
        key = (side, round(duration * 1e12))
        if key not in self._known:
            self._known[key] = _exponential(self._joint[side] * duration)
        return self._known[key]

    def _margin(self, side: int, w: np.ndarray) -> tuple[float, int]:
        """How far w is from the edge of its branch (positive: on it), and the branch beyond."""
        z, half = w[_Y] if self.forced else w[_Y] - w[_D], self.rig.backlash / 2
        if side:
            return side * z - half, 0
        return (half - z, 1) if z > 0 else (half + z, -1)

    def _step(self, i: int, state: np.ndarray) -> None:
        inside = self.space.knots
        inside = inside[(inside > self.t[i] + 1e-9) & (inside < self.t[i + 1] - 1e-9)]
        edges = [self.t[i], *inside, self.t[i + 1]]
        first = self.space.rows(edges[0])[0]
        q = len(self.names)
        phi, h, gain = np.eye(2), np.zeros((2, q)), np.zeros((2, _ORDER + inside.size))
        side = None
        for begin, end in pairwise(edges):
            t = begin
            while end - t > 1e-13:
                lead, rows = self.space.rows(t)
                local = self.space.coefficients[lead : lead + _ORDER]
                w = np.concatenate([state, rows @ local, [1.0]])
                if side is None:
                    z = state[0] if self.forced else state[0] - w[_D]
                    side = int(np.sign(z)) if abs(z) > self.rig.backlash / 2 else 0
                duration, entered = self._until_switch(side, w, end - t)
                flow = self._flow(side, duration)
                start, own = flow[:, :_SIZE] @ w, flow[:2, :2]
                phi, gain = own @ phi, own @ gain
                gain[:, lead - first : lead - first + _ORDER] += flow[:2, _D : _D + _ORDER] @ rows
                h = own @ h + start[_SIZE:].reshape(q, 2).T
                state, side, t = start[:2], entered, t + duration
        self.phi[i], self.h[i] = phi, h
        self.gains.append((first, gain))

    def _until_switch(self, side: int, w: np.ndarray, longest: float) -> tuple[float, int]:
        """How long the branch is kept, at most `longest`, and the branch after that."""
        small = self._joint[side][:_SIZE, :_SIZE]
        before = 0.0
        for part in (0.25, 0.5, 0.75, 1.0):
            after = part * longest
            margin, beyond = self._margin(side, self._flow(side, after)[:_SIZE, :_SIZE] @ w)
            if margin < 0.0:
                if self._margin(side, _exponential(small * before) @ w)[0] <= 0.0:
                    break  # it begins on the edge and grazes it: nothing to be gained from the other branch
                root = brentq(lambda s: self._margin(side, _exponential(small * s) @ w)[0], before, after, xtol=1e-15)
                return max(root, 1e-12), beyond
            before = after
        return longest, side


def _covariance(steps: _Steps, sigma: float, sigma_x: float) -> np.ndarray:
    """The inverse of S (q, q): noise sigma of z or y, and sigma_x of x; without it the driving motion is known."""
    n = steps.t.size
    # Unknowns in units in which they are of the size of the noise: states, then coefficients.
    scale = sigma * np.tile([1.0, np.sqrt(steps.rig.stiffness / steps.rig.inertia)], n)
    ties = _ties(steps, scale)
    seen = csc_matrix((np.ones(n), (np.arange(n), 2 * np.arange(n))), shape=(n, 2 * n))
    if sigma_x > 0.0:
        space = steps.space
        design = BSpline.design_matrix(steps.t, space.knots, _ORDER - 1)[:, : space.count]
        through = _through(steps, scale) * sigma_x
        samples = bmat([[seen, -design * (sigma_x / sigma)], [None, design]], format="csc")
        ties = bmat([[ties, -through]], format="csc")
    else:
        samples = seen
    right = np.concatenate([np.zeros((samples.shape[1], len(steps.names))), _push(steps, scale)])
    system = bmat([[samples.T @ samples, ties.T], [ties, None]], format="csc")
    solution = splu(system).solve(right)
    seen_change = samples @ solution[: samples.shape[1]]
    size = _sizes(steps)
    return np.linalg.inv(seen_change.T @ seen_change) * np.outer(size, size)


def _sizes(steps: _Steps) -> np.ndarray:
    return np.array([steps.sizes[name] for name in steps.names])


def _ties(steps: _Steps, scale: np.ndarray) -> csc_matrix:
    """ds_{i+1} - Phi_i ds_i, (2n-2, 2n), states and rows in units of `scale` (2n,)."""
    n = steps.t.size
    row, column = np.indices((2, 2))
    rows = (2 * np.arange(n - 1)[:, None, None] + row).ravel()
    columns = (2 * np.arange(n - 1)[:, None, None] + column).ravel()
    forward = csc_matrix((steps.phi.ravel(), (rows, columns)), shape=(2 * n - 2, 2 * n))
    following = csc_matrix((np.ones(2 * n - 2), (np.arange(2 * n - 2), np.arange(2, 2 * n))), shape=(2 * n - 2, 2 * n))
    return (diags(1.0 / scale[2:]) @ (following - forward) @ diags(scale)).tocsc()


def _through(steps: _Steps, scale: np.ndarray) -> csc_matrix:
    """G_i da, (2n-2, coefficients), rows in units of `scale`."""
    entries = [
        (2 * i + side, first + j, gain[side, j] / scale[2 * i + 2 + side])
        for i, (first, gain) in enumerate(steps.gains)
        for side in (0, 1)
        for j in range(gain.shape[1])
        if gain[side, j] != 0.0
    ]
    rows, columns, values = zip(*entries)
    return csc_matrix((values, (rows, columns)), shape=(scale.size - 2, steps.space.count))


def _push(steps: _Steps, scale: np.ndarray) -> np.ndarray:
    """H_i dtheta, (2n-2, q), for parameters in units of their own size."""
    return steps.h.reshape(-1, len(steps.names)) / scale[2:, None] * _sizes(steps)
