r"""Which coordinates explain the missing torque, and what it looks like over them.

Tables over one or two coordinates of the smoothed motion are tried as the torque's mean (`explain`), each together with the
model's parameters, so that a torque which stiffness, damping or play could give is not taken for something new. The marginal
likelihood ranks them; two coordinates are taken instead of one only for a clear gain. How much a table explains is told
out of sample: a table made from other stretches of the record predicts the stretches left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp
import numpy as np

from ..effects.learned import UNITS, LearnedTorque
from ..frames import dataset
from ..parameters import values
from ..showing import Shown
from ..side_by_side import side_by_side
from ..system import System
from .explain import explain, prepare
from .latent import Latent
from .shares import out_of_sample, plainest, size_of, slopes_along, torque_with, weights
from .tables import at_times, basis_at_nodes, choose_knots, motions_of, smoothness, varies

LABELS = {
    "z": "the relative angle z", "dz": "the relative speed z'", "y": "the absolute angle y", "dy": "the absolute speed y'",
    "x": "the motor's angle behind its gear", "dx": "the motor's speed behind its gear",
    "t": "time", "deflection": "the deflection beyond the play", "side": "the side of the play",
}  # fmt: skip
SETS = (
    ("z",), ("dz",), ("y",), ("dy",), ("t",), ("deflection",), ("side",),
    ("z", "dz"), ("y", "dy"), ("side", "dz"), ("deflection", "dz"), ("deflection", "t"), ("dz", "t"), ("y", "z"),
)  # fmt: skip
"""Sets of coordinates that are tried."""
WIDTH = 36
"""Columns of every table, padded, so that one compiled program serves all of them."""
LEFT = 0.7
"""Two coordinates instead of one only if they leave less than this share of what one leaves unexplained."""


@dataclass(frozen=True)
class Surface(Shown):
    """The missing torque as a table over its best coordinates.

    Attributes: ``coordinates``; ``knots`` a row for each; ``table`` (R,) values at the knots and their standard errors
    ``stderr`` [unit], the last coordinate running fastest; ``share`` of the missing torque's mean square that a table predicts
    out of sample; ``tried`` (coordinates, share, evidence over no table) of all sets, best first; ``moved`` (as fitted, with
    this table) of the parameters; ``torque`` and ``fitted`` (N,) the missing torque at the times of the latent torque, given
    those parameters, and the table's part of it; ``coordinate_values`` (N, one or two).
    """

    coordinates: tuple[str, ...]
    knots: tuple[tuple[float, ...], ...]
    table: np.ndarray
    stderr: np.ndarray
    share: float
    tried: tuple[tuple[tuple[str, ...], float, float], ...]
    moved: dict[str, tuple[float, float]]
    torque: np.ndarray
    fitted: np.ndarray
    coordinate_values: np.ndarray
    system: System
    unit: str

    def effect(self) -> LearnedTorque:
        """The table as an effect that can be added to a model; a stopgap, not physics."""
        return LearnedTorque(self.coordinates, self.knots, tuple(float(v) for v in self.table))

    @property
    def rms(self) -> float:
        """Root mean square of the missing torque that goes with this table [unit]."""
        return float(np.sqrt(np.mean(self.torque**2)))

    def __str__(self) -> str:
        names = " and ".join(LABELS[name] for name in self.coordinates)
        share = "more than 99" if self.share > 0.995 else f"{100 * self.share:.0f}"
        return f"A torque that depends on {names} alone explains {share} % of it."

    def to_dataset(self) -> Any:
        """The table as an `xarray.Dataset`: ``torque`` and ``stderr`` [unit] over the knots of each coordinate."""
        shape = [len(row) for row in self.knots]
        return dataset(
            {
                "torque": (self.coordinates, np.reshape(self.table, shape), self.unit),
                "stderr": (self.coordinates, np.reshape(self.stderr, shape), self.unit),
            },
            {name: (row, UNITS.get(name, "rad")) for name, row in zip(self.coordinates, self.knots)},
            share=self.share,
        )  # fmt: skip


def explain_torque(latent: Latent, sets: tuple[tuple[str, ...], ...] = SETS) -> Surface:
    """Find the coordinates that explain a missing torque best.

    Parameters
    ----------
    latent : the missing torque
    sets : sets of one or two coordinates to try

    Returns
    -------
    `Surface`: the coordinates, a table over them, and the share that it explains

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> fit = jb.fit(record.between(0.0, 2.0), inertia=3.16, starts=1)
    >>> found = jb.explain_torque(jb.missing_torque(fit))
    >>> found.coordinates
    ('y',)
    >>> print(found)
    A torque that depends on the absolute angle y alone explains ... % of it.
    """
    inside = latent.inside
    smoother, point = inside.smoother, inside.point
    home = np.asarray(point.unknowns.theta)
    slopes, motions = slopes_along(latent, home), motions_of(latent)
    unit = float(smoother.unit)
    size = 3.0 * max(latent.rms, 2.0 * float(np.median(latent.stderr))) / unit
    log_precisions = np.log(inside.precision) + 2.0 * np.log(10.0) * np.array([0.0, 0.5, 1.2, 2.2])
    if inside.order != 1:
        log_precisions -= 2.0 * np.log(10.0) * 0.5
    prepared = prepare(smoother, point, inside.linear, jnp.asarray(log_precisions))

    def attempt(names: tuple[str, ...]) -> _Attempt:
        knots = tuple(choose_knots(latent, name, len(names)) for name in names)
        phi = basis_at_nodes(latent, motions, names, knots)
        penalty = np.eye(WIDTH)
        count = int(np.prod([len(row) for row in knots]))
        penalty[:count, :count] = smoothness(tuple(len(row) for row in knots)) / size**2
        padded = np.pad(phi, ((0, 0), (0, 0), (0, WIDTH - count)))
        found = explain(smoother, point, prepared, jnp.asarray(padded), jnp.asarray(penalty))
        at_nodes = at_times(latent, phi)
        covariance = unit**2 * np.asarray(found.covariance)[:count, :count]
        table, covariance, theta = plainest(
            latent, at_nodes, unit * np.asarray(found.beta)[:count], covariance, np.asarray(found.theta), slopes
        )
        torque = latent.torque - slopes @ (theta - home)
        left = out_of_sample(latent, at_nodes, torque, penalty[:count, :count] * (size / size_of(torque)) ** 2)
        # A remainder that wanders cannot tell its own level from the table's: the torque's level decides.
        table = table + float(np.average(torque - at_nodes @ table, weights=weights(latent, torque)))
        spread = np.sqrt(np.maximum(np.diag(covariance), 0.0))
        return _Attempt(names, knots, float(found.evidence), left, at_nodes, table, spread, theta)

    first, *others = [n for n in sets if varies(latent, n)] or [("t",)]
    tried = [attempt(first)]  # alone, so that one thread compiles what all of them run
    tried += side_by_side(attempt, others)
    tried.sort(key=lambda entry: -entry.evidence)
    plain = min(entry.evidence for entry in tried)
    best = _choose(tried)
    system, torque = torque_with(latent, best.theta)
    return Surface(
        best.names, best.knots, best.table, best.stderr, best.share,
        tuple((entry.names, entry.share, entry.evidence - plain) for entry in tried),
        {name: (latent.moved[name][0], values(system)[name]) for name in inside.free},
        torque, best.at_nodes @ best.table,
        np.stack([getattr(latent, name) for name in best.names], axis=1), system, latent.unit,
    )  # fmt: skip


@dataclass(frozen=True)
class _Attempt:
    """One set's table; ``left`` mean square that it does not predict out of sample, over the weight of the values."""

    names: tuple[str, ...]
    knots: tuple[tuple[float, ...], ...]
    evidence: float
    left: tuple[float, float]
    at_nodes: np.ndarray
    table: np.ndarray
    stderr: np.ndarray
    theta: np.ndarray

    @property
    def share(self) -> float:
        return max(0.0, 1.0 - self.left[0] / self.left[1])


def _choose(tried: list[_Attempt]) -> _Attempt:
    """The likeliest single coordinate, unless two are likelier and leave clearly less."""
    singles = [entry for entry in tried if len(entry.names) == 1]
    pairs = [entry for entry in tried if len(entry.names) == 2]
    if not singles or not pairs:
        return tried[0]
    one, two = singles[0], pairs[0]
    return two if two.evidence - one.evidence > 10.0 and two.left[0] < LEFT * one.left[0] else one
