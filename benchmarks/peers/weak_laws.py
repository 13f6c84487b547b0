"""The catalogue as an expert's regression sees it: columns for each law, what it must guess, what physics allows.

Three kinds of laws. `LINEAR`: one column each, strength at once. `SHAPED`: columns for a given shape (a speed, an order, a
length, a resonance), which comes from a grid and then from Gauss-Newton. `BENT`: a parameter of the play or of the sensor, which
enters everything and comes from Gauss-Newton alone. dahl stands for its family (lugre, bouc_wen). The laws that only
real rigs add, `benchmarks.effect_recovery.RIG_SINGLES`, are not known to it. A sensor's offset is not
listed: beside a play whose centre is free only gravity could tell it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.peers.weak_rows import Rows, View, dahl, follower

Eta = dict[str, float]
"""What enters nonlinearly: b, and what the model's laws add."""


@dataclass(frozen=True)
class Law:
    """columns(rows, view, eta, k) -> (rows, q), torques under the bump at unit strength; signs: of the q strengths, 0 for any;
    extra columns without a sign are nuisances. shapes: starting points; bounds: of the nonlinear parameters."""

    columns: Callable[[Rows, View, Eta, float], np.ndarray]
    signs: tuple[int, ...]
    shapes: tuple[Eta, ...] = ()
    bounds: dict[str, tuple[float, float]] | None = None

    @property
    def nonlinear(self) -> tuple[str, ...]:
        return tuple(self.bounds or ())

    @property
    def count(self) -> int:
        return len(self.signs) + len(self.nonlinear)


def _plain(torque: Callable[[View, float], np.ndarray], sign: int) -> Law:
    return Law(lambda rows, v, eta, k: rows.over(torque(v, k)), (sign,))


def _stribeck(rows: Rows, v: View, eta: Eta, k: float) -> np.ndarray:
    fall = np.exp(-((v.dz / eta["vs"]) ** 2))
    return rows.over(-v.sign_z, -fall * v.sign_z)


def _ripple(rows: Rows, v: View, eta: Eta, k: float) -> np.ndarray:
    return rows.over(np.sin(eta["N"] * v.y), np.cos(eta["N"] * v.y))


def _dahl(rows: Rows, v: View, eta: Eta, k: float) -> np.ndarray:
    return rows.over(-dahl(v.z, eta["length"]))


def _flexible(rows: Rows, v: View, eta: Eta, k: float) -> np.ndarray:
    """-J2 y2'' of what hangs on the link, and the free decay that its unknown start may have left."""
    omega, zeta = eta["omega2"], eta["zeta2"]
    y2 = follower(v.y, rows.step, omega, zeta)
    away = y2 - v.y
    torque = omega**2 * away + 2.0 * zeta * omega * np.gradient(away, rows.step)
    since = v.t - v.t[0]
    decay = np.exp(-zeta * omega * since) * omega**2
    return rows.over(torque, decay * np.cos(omega * since), decay * np.sin(omega * since))


def _nothing(rows: Rows, v: View, eta: Eta, k: float) -> np.ndarray:
    return np.zeros((rows.centres.size, 0))


LINEAR: dict[str, Law] = {
    "gravity": _plain(lambda v, k: np.sin(v.y), 0),
    "preload": _plain(lambda v, k: np.ones_like(v.y), 0),
    "gap_spring": _plain(lambda v, k: -v.z, 1),
    "asymmetric_stiffness": _plain(lambda v, k: -k * np.abs(v.d), 0),
    "cubic_stiffness": _plain(lambda v, k: -(v.d**3), 0),
    "contact_damping": _plain(lambda v, k: -v.touch * v.dz, 1),
    "hunt_crossley": _plain(lambda v, k: -np.abs(v.d) * v.dz, 1),
    "coulomb_joint": _plain(lambda v, k: -v.sign_z, 1),
    "coulomb_ground": _plain(lambda v, k: -v.sign_y, 1),
    "quadratic_drag": _plain(lambda v, k: -np.abs(v.dy) * v.dy, 1),
    "stiffness_drift": _plain(lambda v, k: -k * v.t * v.d, 0),
}
SHAPED: dict[str, Law] = {
    "stribeck": Law(_stribeck, (1, 1), tuple({"vs": vs} for vs in (0.03, 0.1, 0.3)), {"vs": (5e-3, 1.0)}),
    "torque_ripple": Law(_ripple, (0, 0), tuple({"N": float(n)} for n in range(5, 121, 5)), {"N": (4.0, 150.0)}),
    "dahl": Law(_dahl, (1,), tuple({"length": v} for v in np.geomspace(4e-4, 2e-2, 6)), {"length": (1e-4, 0.05)}),
    "flexible_link": Law(
        _flexible, (1, 0, 0), tuple({"omega2": 2 * np.pi * f, "zeta2": 0.02} for f in np.geomspace(13.0, 60.0, 9)),
        {"omega2": (60.0, 450.0), "zeta2": (1e-3, 0.4)},
    ),
}  # fmt: skip
BENT: dict[str, Law] = {
    "asymmetric_gap": Law(_nothing, (), ({"z0": 0.0},), {"z0": (-0.02, 0.02)}),
    "gap_drift": Law(_nothing, (), ({"r": 0.0},), {"r": (-0.03, 0.1)}),
    "sensor_delay": Law(_nothing, (), tuple({"tau": v} for v in (0.0, 1.5e-3, 4e-3)), {"tau": (0.0, 0.015)}),
    "sensor_gain": Law(_nothing, (), ({"g": 1.0},), {"g": (0.7, 1.4)}),
}
LAWS = {**LINEAR, **SHAPED, **BENT}
STEPS = {"b": 1e-6, "z0": 1e-6, "r": 1e-5, "tau": 1e-5, "g": 1e-4, "vs": 1e-4, "N": 1e-2, "length": 1e-6, "omega2": 1e-2,
         "zeta2": 1e-4}  # fmt: skip
"""Of the differences that take the place of a derivative by what enters nonlinearly."""
SIMPLER = {"stribeck": "coulomb_joint"}
"""A law and the simpler one that it contains: both together are never a model."""


def viewed(rows: Rows, eta: Eta) -> View:
    """The motion with the play and the sensor as they are taken to be."""
    return rows.view(eta["b"], eta.get("z0", 0.0), eta.get("r", 0.0), eta.get("tau", 0.0), eta.get("g", 1.0))


def torques(rows: Rows, names: tuple[str, ...], eta: Eta, k: float) -> np.ndarray:
    """Columns (rows, q): contact spring, damper, and the named laws' in their order."""
    v = viewed(rows, eta)
    damper = -rows.raw("z", 1, eta.get("tau", 0.0)) / eta.get("g", 1.0)
    base = np.column_stack([-rows.over(v.d), damper])
    return np.concatenate([base, *(LAWS[n].columns(rows, v, eta, k) for n in names)], axis=1)


def signs(names: tuple[str, ...]) -> np.ndarray:
    """What physics allows of the columns of `torques`: 1 for positive only, 0 for any sign."""
    return np.array([1, 1, *(s for n in names for s in LAWS[n].signs)])


def inertia_side(rows: Rows, eta: Eta, inertia: float) -> np.ndarray:
    """J y'' under the bump (rows,)."""
    return inertia * (rows.raw("x", 2) + rows.raw("z", 2, eta.get("tau", 0.0)) / eta.get("g", 1.0))
