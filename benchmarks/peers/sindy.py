"""PySINDy as a user runs it: smoothed differences, a library of the plausible terms, STLSQ, the play from a grid.

The user knows J and solves for y'': inputs are t, y, z and their smoothed speeds, the terms those of the catalogue that are
linear in one strength (no hidden states, no delay, no unknown orders). Columns are normalised; threshold and play come from
a grid, by the Bayesian criterion of the acceleration on every third second of the record, which the fit has not seen. It
needs pysindy 2.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from scipy.signal import savgol_filter

THRESHOLDS = np.geomspace(1e-3, 0.3, 5)
"""As shares of the largest normalised coefficient."""
WINDOWS, QUIET = (11, 15, 21, 31, 41), 0.1
"""Samples of the smoother, from pysindy's own choice up, until noise is this share of the acceleration."""
TERMS = ("stiffness", "damping", "gravity", "preload", "gap_spring", "asymmetric_gap", "asymmetric_stiffness", "cubic_stiffness",
         "contact_damping", "hunt_crossley", "coulomb_joint", "coulomb_ground", "quadratic_drag", "stiffness_drift",
         "gap_drift")  # fmt: skip


@dataclass(frozen=True)
class Found:
    """effects; backlash [rad]; stiffness [N m/rad]; damping [N m s/rad]; left, rms of the acceleration's residual [rad/s^2]."""

    effects: tuple[str, ...]
    backlash: float
    stiffness: float
    damping: float
    left: float


def terms(t: np.ndarray, y: np.ndarray, dy: np.ndarray, z: np.ndarray, dz: np.ndarray, b: float) -> np.ndarray:
    """The library for a total play b [rad]: (n, len(TERMS)), signs as in the catalogue."""
    d = z - np.clip(z, -0.5 * b, 0.5 * b)
    touch, side = (d != 0.0).astype(float), np.sign(d)
    columns = (-d, -dz, np.sin(y), np.ones_like(y), -z, touch, -np.abs(d), -(d**3), -touch * dz, -np.abs(d) * dz, -np.sign(dz),
               -np.sign(dy), -np.abs(dy) * dy, -t * d, t * side)  # fmt: skip
    return np.stack(columns, axis=1)


def installed() -> bool:
    """Whether pysindy can be imported."""
    from importlib.util import find_spec

    return find_spec("pysindy") is not None


def identify(t: np.ndarray, x: np.ndarray, z: np.ndarray, inertia: float) -> Found:
    """Name what a record needs beyond play, stiffness and damping. Args: t [s], x, z [rad] (n,); inertia [kg m^2]."""
    import pysindy as ps

    y = x + z
    for window in WINDOWS:
        smoothed = ps.SmoothedFiniteDifference(smoother_kws={"window_length": window, "polyorder": 3})

        def rate(u: np.ndarray, by: Any = smoothed) -> np.ndarray:
            return np.asarray(by(u[:, None], t))[:, 0]

        dy, dz = rate(y), rate(z)
        ddy = rate(dy)
        noise = np.random.default_rng(0).standard_normal(t.size) * np.std(y - savgol_filter(y, window, 3))
        if np.std(rate(rate(noise))) < QUIET * np.std(ddy):
            break
    inside = slice(50, -50)  # a smoother's ends are not to be trusted
    t, y, dy, z, dz, ddy = (v[inside] for v in (t, y, dy, z, dz, ddy))
    held = ((t - t[0]) % 3.0) >= 2.0

    @cache
    def library_of(b: float) -> np.ndarray:
        return terms(t, y, dy, z, dz, b)

    @cache
    def sparse(b: float, threshold: float) -> np.ndarray:
        library = library_of(b)[~held]
        size = np.linalg.norm(library, axis=0)
        library = library / np.where(size > 0.0, size, 1.0)
        optimizer = ps.STLSQ(threshold=threshold, alpha=1e-8)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            optimizer.fit(library, ddy[~held, None])
        return np.asarray(optimizer.coef_).ravel() / np.where(size > 0.0, size, 1.0)

    def error(b: float, coefficients: np.ndarray) -> float:
        left = (ddy - library_of(b) @ coefficients)[held]
        return float(left @ left)

    def worth(b: float, coefficients: np.ndarray) -> float:
        return n * np.log(error(b, coefficients) / n) + np.count_nonzero(coefficients) * np.log(n)

    n = int(held.sum())
    reach = 2.0 * float(np.quantile(np.abs(z), 0.995))
    plays = reach * np.linspace(0.03, 0.97, 24)
    size = np.linalg.norm(library_of(0.5 * reach)[~held], axis=0)
    largest = float(np.max(np.abs(sparse(0.5 * reach, 0.0) * size)))
    tried = [(b, share * largest) for share in THRESHOLDS for b in plays]
    b, threshold = min(tried, key=lambda p: worth(p[0], sparse(*p)))
    b = float(min(np.linspace(b - reach / 24, b + reach / 24, 13), key=lambda b: worth(b, sparse(b, threshold))))
    best = sparse(b, threshold)
    kept = tuple(sorted(name for name, c in zip(TERMS[2:], best[2:]) if c != 0.0))
    return Found(kept, b, inertia * float(best[0]), inertia * float(best[1]), float(np.sqrt(error(b, best) / n)))
