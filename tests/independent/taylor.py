"""Largest Lyapunov exponents of many cells of a map, by Taylor series with located edges: a quick referee.

The oscillator is that of `exponents.py`, p'' + 2 zeta p' + k1 p + F(p) = alpha cos(Omega tau), with one tangent vector. On
a branch the law is linear and its force a cosine, so the coefficients of the solution's Taylor series follow from one another; a
step of `STEP` with `TERMS` of them is good to rounding. The edge of the play is looked for on that polynomial at closely
spaced points and at the extrema between them, and found by bisection. It needs numba, and shares no code with the package:
there the branches are solved by sines and cosines, and edges found on a quintic.
"""

from __future__ import annotations

import numpy as np

from tests.independent.kernel import njit

STEP = 0.5  # of 1 / omega_0
TERMS = 22  # 0.5^22 / 22! is 2e-28
LOOKS = 8  # at the distance from the edge, a step


@njit(cache=True)
def _series(p, v, theta, damping, stiffness, push, alpha, Omega, out):
    """Taylor coefficients of the motion about here into out (TERMS,); alpha = push = 0 gives a tangent vector."""
    out[0], out[1] = p, v
    cos, sin, size = np.cos(theta), np.sin(theta), alpha
    for n in range(TERMS - 2):
        # The n-th derivative of a cosine turns by a quarter each time; size is alpha Omega^n / n!.
        turn = n % 4
        force = size * (cos if turn == 0 else (-sin if turn == 1 else (-cos if turn == 2 else sin)))
        if n == 0:
            force += push
        out[n + 2] = (force - damping * (n + 1) * out[n + 1] - stiffness * out[n]) / ((n + 1) * (n + 2))
        size *= Omega / (n + 1)


@njit(cache=True)
def _at(series, u):
    """Value and slope of the polynomial at u."""
    value, slope = 0.0, 0.0
    for n in range(TERMS - 1, -1, -1):
        slope = slope * u + value
        value = value * u + series[n]
    return value, slope


@njit(cache=True)
def _margin(series, side, edge, u):
    """Distance from an edge, positive on the branch, and its rate."""
    p, v = _at(series, u)
    if side == 0:
        return 1.0 - edge * p, -edge * v
    return side * p - 1.0, side * v


@njit(cache=True)
def _leaves(series, side, edge, h):
    """Where in (0, h] the branch is left through one edge, or -1."""
    before, rate_before = _margin(series, side, edge, 0.0)
    for k in range(LOOKS):
        low, high = k * h / LOOKS, (k + 1) * h / LOOKS
        after, rate_after = _margin(series, side, edge, high)
        inside, outside = low, high
        if after >= 0.0:
            if not (rate_before < 0.0 and rate_after > 0.0):
                before, rate_before = after, rate_after
                continue
            a, b = low, high  # the distance has a least value between
            for _ in range(60):
                middle = 0.5 * (a + b)
                if _margin(series, side, edge, middle)[1] < 0.0:
                    a = middle
                else:
                    b = middle
            if _margin(series, side, edge, b)[0] >= 0.0:
                before, rate_before = after, rate_after
                continue
            outside = b
        elif before <= 0.0 and k == 0 and rate_before > 0.0:
            a, b = low, high  # it begins on the edge and comes back: the greatest distance is between
            for _ in range(60):
                middle = 0.5 * (a + b)
                if _margin(series, side, edge, middle)[1] > 0.0:
                    a = middle
                else:
                    b = middle
            inside = a
        for _ in range(70):
            middle = 0.5 * (inside + outside)
            if _margin(series, side, edge, middle)[0] > 0.0:
                inside = middle
            else:
                outside = middle
        return outside
    return -1.0


@njit(cache=True)
def _run(inverse_alpha, zeta, Omega, k1, cc, p, v, dp, dv, periods, samples, growth):
    alpha, length = 1.0 / inverse_alpha, 2.0 * np.pi / Omega
    series, tangent = np.empty(TERMS), np.empty(TERMS)
    side = 0
    if abs(p) > 1.0:
        side = 1 if p > 0.0 else -1
    samples[0, 0], samples[0, 1], growth[0] = p, v, 0.0
    for k in range(periods):
        t = 0.0
        while t < length:
            damping, stiffness = 2.0 * zeta + abs(side) * cc, k1 + abs(side)
            _series(p, v, Omega * t, damping, stiffness, float(side), alpha, Omega, series)
            _series(dp, dv, 0.0, damping, stiffness, 0.0, 0.0, Omega, tangent)
            h, to, edge = min(STEP, length - t), side, 0.0
            if side == 0:
                for way in (1, -1):
                    u = _leaves(series, 0, float(way), h)
                    if u >= 0.0 and (to == 0 or u < h):
                        h, to, edge = u, way, float(way)
            else:
                u = _leaves(series, side, float(side), h)
                if u >= 0.0:
                    h, to, edge = u, 0, float(side)
            p, v = _at(series, h)
            dp, dv = _at(tangent, h)
            t = t + h if to != side or t + h < length - 1e-12 else length
            if to != side:
                p = edge
                dv -= (abs(to) - abs(side)) * cc * dp
                side = to
        size = np.hypot(dp, dv)
        dp, dv = dp / size, dv / size
        samples[k + 1, 0], samples[k + 1, 1], growth[k + 1] = p, v, growth[k] + np.log(size)
    return dp, dv


def follow(cell, periods, start=(0.0, 0.0), tangent=(1.0, 0.0)):
    """Follow one cell of `exponents.Cell`.

    Returns samples (periods + 1, 2) of p and p' at whole periods, ln |tangent| (periods + 1,), and the last tangent (2,).
    """
    samples, growth = np.empty((periods + 1, 2)), np.empty(periods + 1)
    numbers = (float(n) for n in (cell.inverse_alpha, cell.zeta, cell.Omega, cell.k1, cell.cc, *start, *tangent))
    last = _run(*numbers, periods, samples, growth)
    return samples, growth, np.array(last)
