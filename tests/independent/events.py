"""Exact, non-smooth simulation: one smooth piece at a time, every switch located and restarted from.

The dead zone is sharp. Inside the play and on either side of it the motion is smooth, so each piece is integrated with
scipy's DOP853 at tight tolerances along the field of its own branch, continued smoothly past the switch; the switch is
where |z| reaches half the play. It is looked for at closely spaced points of every step's dense output and at the
extrema between them, so that a grazing touch within one step is not missed, and its time is then refined by
integrating to it afresh, which frees it from the dense output's interpolation error.

Nothing here shares code with the package: it is what the package is tested against.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

from tests.independent.motions import Motion, Rest

_POINTS = 16  # looks for a switch per step
_AT_REST = Rest()


@dataclass(frozen=True)
class ForcedOscillator:
    """Force-driven oscillator, Table 1 and (2.13): m y'' + c y' + k1 y + k0 delta(y) = A cos(omega t).

    Args: mass [kg]; damping [N s/m]; k1, k0 [N/m]; half_play x_0 [m]; amplitude A [N]; omega [rad/s]; y0 [m], v0 [m/s].
    """

    mass: float = 1.0
    damping: float = 8.0
    k1: float = 0.0
    k0: float = 40000.0
    half_play: float = 0.005
    amplitude: float = 100.0
    omega: float = 40.0
    y0: float = 0.0
    v0: float = 0.0
    base: Motion = field(default=_AT_REST)

    def acceleration(self, side, t, y, v):
        """y'' on one branch: side = +1 or -1 in contact, 0 inside the play."""
        spring = self.k1 * y + abs(side) * self.k0 * (y - side * self.half_play)
        return (self.amplitude * np.cos(self.omega * t) - self.damping * v - spring) / self.mass


def case1(amplitude: float = 100.0) -> ForcedOscillator:
    """CASE 1 of Table 1; 1/alpha = k0 x_0 / A is 2 at A = 100 N."""
    return ForcedOscillator(amplitude=amplitude)


def case2(amplitude: float = 240.0) -> ForcedOscillator:
    """CASE 2 of Table 1, with a spring across the play."""
    return ForcedOscillator(k1=1000.0, k0=31000.0, amplitude=amplitude)


@dataclass(frozen=True)
class Joint:
    """Base-motion joint (3.1)-(3.2): J y'' = -k delta(y - x) - c (y' - x').

    Args: inertia J [kg m^2]; backlash b, the total play [rad]; stiffness k [N m/rad]; damping c [N m s/rad]; base, the
    motion x(t) [rad]; y0 [rad], v0 [rad/s] the link's start.
    """

    inertia: float
    backlash: float
    stiffness: float
    damping: float
    base: Motion = field(default=_AT_REST)
    y0: float = 0.0
    v0: float = 0.0

    @property
    def half_play(self):
        return self.backlash / 2

    def load(self, t, y, v):
        """Further torque on the link [N m]; none here."""
        return 0.0

    def acceleration(self, side, t, y, v):
        """y'' on one branch: side = +1 or -1 in contact, 0 inside the play."""
        x, dx, _ = self.base.derivatives(t)
        spring = abs(side) * self.stiffness * (y - x - side * self.half_play)
        return (self.load(t, y, v) - spring - self.damping * (v - dx)) / self.inertia


@dataclass(frozen=True)
class TwoLink(Joint):
    """Two-link with gravity (3.3)-(3.4): the joint plus J C sin(y), or J C y as the paper has it if `linear`.

    Args: those of the joint; C = m g L / J [1/s^2], positive upright.
    """

    C: float = 0.0
    linear: bool = False

    def load(self, t, y, v):
        return self.inertia * self.C * (y if self.linear else np.sin(y))


def free_vibration(inertia, backlash, stiffness, amplitude, damping=0.0) -> Joint:
    """A link released at rest from z = amplitude > backlash/2, its base still."""
    return Joint(inertia, backlash, stiffness, damping, y0=amplitude)


def simulate(system, t_out, rtol=1e-12, atol=1e-14, max_step=3e-3):
    """The motion of `system` from t = 0 at the times t_out.

    Args: t_out (n,) [s], rising, from 0 or later; rtol, atol: tolerances of DOP853; max_step [s].
    Returns: y, v, each (n,): the absolute position and its rate.
    """
    run = _Run(system, np.asarray(t_out, float), rtol, atol, max_step)
    run.go(run.t_out[-1])
    return run.y, run.v


def switches(system, t_end, rtol=1e-12, atol=1e-14, max_step=3e-3):
    """The times (m,) [s] of all switches in 0 < t < t_end and the branch entered at each, (m,) of -1, 0, +1."""
    run = _Run(system, np.empty(0), rtol, atol, max_step)
    run.go(t_end)
    return np.array(run.times), np.array(run.sides)


def initial_side(system) -> int:
    """The branch the start lies on; exactly at the edge counts as inside the play."""
    z = system.y0 - float(system.base.derivatives(0.0)[0])
    return int(np.sign(z)) if abs(z) > system.half_play else 0


class _Run:
    """One simulation: its clock, its branch, what it has written."""

    def __init__(self, system, t_out, rtol, atol, max_step):
        self.system, self.t_out = system, t_out
        self.options = {"rtol": rtol, "atol": atol, "max_step": max_step}
        self.y, self.v = np.empty(len(t_out)), np.empty(len(t_out))
        self.written = 0
        self.times, self.sides = [], []

    def go(self, t_end):
        t, state, side = 0.0, np.array([self.system.y0, self.system.v0], float), initial_side(self.system)
        while self.written < len(self.t_out) and self.t_out[self.written] <= t:
            self._write(self.t_out[self.written], state)
        while t < t_end:
            t, state, side = self._piece(t, state, side, t_end)

    def _field(self, side):
        return lambda t, s: np.array([s[1], self.system.acceleration(side, t, s[0], s[1])])

    def _margins(self, side, t, state):
        """How far states (2, ...) at t (...) are from the edges of their branch (positive: on it), these distances'
        rates, and the branch beyond the edge."""
        x, dx, _ = self.system.base.derivatives(t)
        z, dz, half = state[0] - x, state[1] - dx, self.system.half_play
        if side:
            return ((side * z - half, side * dz, 0),)
        return ((half - z, -dz, 1), (half + z, dz, -1))

    def _piece(self, t, state, side, t_end):
        """Integrate along one branch until it is left; return where, and the branch entered."""
        solver = DOP853(self._field(side), t, state, t_end, **self.options)
        while solver.status == "running":
            start = solver.y.copy()
            message = solver.step()
            if solver.status == "failed":
                raise RuntimeError(f"DOP853 failed at t = {solver.t}: {message}")
            dense = solver.dense_output()
            hit = self._first_exit(side, dense, solver.t_old, solver.t)
            if hit is None:
                self._write_until(solver.t, dense)
                continue
            when, to = hit
            when, state = self._refine(side, to, solver.t_old, start, when)
            self._write_until(when, dense)
            self.times.append(when)
            self.sides.append(to)
            return when, state, to
        return solver.t, solver.y, side

    def _first_exit(self, side, dense, t0, t1):
        """The first time in [t0, t1] at which an edge of the branch is crossed outwards, with the branch beyond it."""
        points = np.linspace(t0, t1, _POINTS + 1)
        margins = self._margins(side, points, dense(points))
        quiet = [(m[:-1] > 0) & (m[1:] >= 0) & (r[:-1] * r[1:] >= 0) for m, r, _ in margins]
        for i in np.flatnonzero(~np.all(quiet, axis=0)):
            exits = []
            for edge, (_, _, to) in enumerate(margins):
                when = self._exit_between(side, edge, dense, points[i], points[i + 1])
                if when is not None:
                    exits.append((when, to))
            if exits:
                return min(exits)
        return None

    def _exit_between(self, side, edge, dense, t0, t1):
        """The time in [t0, t1] at which one edge is crossed outwards, or None; the extremum between is looked at."""

        def distance(t):
            return float(self._margins(side, t, dense(t))[edge][0])

        def rate(t):
            return float(self._margins(side, t, dense(t))[edge][1])

        inside, outside = t0, t1
        if distance(t0) <= 0 or distance(t1) >= 0:
            # on the edge at first (a piece has just begun), or on the branch at both ends: the extremum decides
            if rate(t0) * rate(t1) >= 0:
                return t0 if distance(t1) < 0 else None
            turn = brentq(rate, t0, t1, xtol=1e-16)
            inside, outside = (t0, turn) if distance(t1) >= 0 else (turn, t1)
            if distance(outside) >= 0:
                return None
            if distance(inside) <= 0:
                return t0
        return brentq(distance, inside, outside, xtol=1e-16)

    def _refine(self, side, to, t0, start, when):
        """The state at the switch and its time, integrated from the step's start, not read from its interpolant."""
        if when <= t0:
            return t0, start
        index = 1 if (side == 0 and to == -1) else 0
        for _ in range(3):
            solver = DOP853(self._field(side), t0, start, when, first_step=when - t0, **self.options)
            while solver.status == "running":
                solver.step()
            state = solver.y
            margin, rate, _ = self._margins(side, when, state)[index]
            shift = -margin / rate if abs(rate) > 1e-6 else 0.0
            if abs(shift) < 1e-15 or abs(shift) > 1e-6 or when + shift <= t0:
                break
            when += shift
        return when, state

    def _write(self, t, state):
        self.y[self.written], self.v[self.written] = state
        self.written += 1

    def _write_until(self, t, dense):
        while self.written < len(self.t_out) and self.t_out[self.written] <= t:
            self._write(self.t_out[self.written], dense(self.t_out[self.written]))
