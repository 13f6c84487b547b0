"""Largest Lyapunov exponent and stroboscopic samples of the dimensionless oscillator by scipy with events.

p'' + 2 zeta p' + k1 p + F(p) = alpha cos(Omega tau), with one tangent vector beside it. Each branch is integrated by
scipy's DOP853 until an event, the edge of the play, ends it. The law is continuous there, so the tangent goes on as it is.
Nothing here shares code with the package.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp


@dataclass(frozen=True)
class Cell:
    """One cell of a map, with its contact damping cc (which makes the law jump, and the tangent with it)."""

    inverse_alpha: float
    zeta: float
    Omega: float = 0.2
    k1: float = 0.0
    cc: float = 0.0


def follow(cell, periods, skip, start=(0.0, 0.0), rtol=1e-10, atol=1e-12):
    """Exponent per unit of tau after `skip` periods, samples (periods + 1, 2) of p and p', ln |tangent| (periods + 1,)."""
    length = 2.0 * np.pi / cell.Omega
    state, side = np.array([*start, 1.0, 0.0]), 0
    if abs(start[0]) > 1.0:
        side = int(np.sign(start[0]))
    samples, growth = [state[:2].copy()], [0.0]
    for k in range(periods):
        state, side = _period(cell, state, side, k * length, length, rtol, atol)
        size = np.hypot(*state[2:])
        state[2:] /= size
        samples.append(state[:2].copy())
        growth.append(growth[-1] + np.log(size))
    growth = np.array(growth)
    return (growth[-1] - growth[skip]) / ((periods - skip) * length), np.array(samples), growth


def _period(cell, state, side, begin, length, rtol, atol):
    t, end = 0.0, length
    while t < end:
        damping, stiffness = 2.0 * cell.zeta + abs(side) * cell.cc, cell.k1 + abs(side)

        def rates(t, q, damping=damping, stiffness=stiffness, push=float(side)):
            force = np.cos(cell.Omega * (begin + t)) / cell.inverse_alpha
            return [
                q[1], force + push - damping * q[1] - stiffness * q[0], q[3], -damping * q[3] - stiffness * q[2],
            ]  # fmt: skip

        done = solve_ivp(rates, (t, end), state, method="DOP853", rtol=rtol, atol=atol, events=_edges(side), max_step=1.0)
        t, state = done.t[-1], done.y[:, -1].copy()
        if done.status == 1:
            new = 0 if side else (1 if state[0] > 0.0 else -1)
            jump = (abs(new) - abs(side)) * cell.cc
            state[3] -= jump * state[2]
            side = new
    return state, side


def _edges(side):
    found = []
    for edge in (1.0, -1.0) if side == 0 else (float(side),):

        def distance(t, q, edge=edge):
            return q[0] - edge

        distance.terminal = True
        # Out of the play upwards through its upper edge; out of a contact the other way.
        distance.direction = edge if side == 0 else -edge
        found.append(distance)
    return found
