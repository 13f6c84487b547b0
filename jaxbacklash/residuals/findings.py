"""Where a model fails: findings in plain sentences, each backed by a test."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..fitting import Fit, error_in_words
from ..frames import dataframe
from ..showing import Shown
from .at_motor import AtMotor, missing_at_motor
from .failures import Dependence, depends
from .latent import Latent, missing_torque
from .surface import Surface, explain_torque
from .transmitted import explain_force, missing_force
from .words import NOISE, NONE_ON_LINK, NOT_APART, best_coordinates, headline, sentences

OF_MOTOR = (("dx",), ("x",), ("t",), ("x", "dx"))
"""Coordinates that a torque at the motor is held against."""
TOGETHER = 4
"""Values of it that are taken together where it is held against the motor's direction."""


@dataclass(frozen=True)
class Findings(Shown):
    """Where and how a model fails.

    Attributes: ``sentences`` for a person, most telling first; a single one where nothing fails; ``dependences`` every question
    that was asked (`Dependence`), strongest first; ``latent`` the missing torque, ``surface`` its best coordinates (None
    where no torque is missing on the link); ``misfit``, ``median`` of the prediction error over the noise; ``at_motor``, what is
    missing at the motor of a drive, None where nothing is. Of a drive of which the motor alone is seen all of it is told at the
    motor.
    """

    sentences: tuple[str, ...]
    dependences: tuple[Dependence, ...]
    latent: Latent
    surface: Surface | None
    misfit: float
    median: float
    at_motor: AtMotor | None = None

    @property
    def adequate(self) -> bool:
        """True when what the model leaves is noise."""
        return self.surface is None and self.at_motor is None

    @property
    def significant(self) -> tuple[Dependence, ...]:
        """The dependences that chance does not explain."""
        return () if self.surface is None else tuple(found for found in self.dependences if found.significant)

    def __str__(self) -> str:
        return "\n".join(self.sentences)

    def to_dataframe(self) -> Any:
        """Every question that was asked as a `pandas.DataFrame`, the strongest first: the ``coordinate``, whether the torque's
        ``size`` or ``value`` was asked of it, the ``strength`` of the answer (share of the ranks' variance), the ``trend`` (rank
        correlation) and the probability ``p`` of as much by chance.
        """
        asked = self.dependences
        return dataframe(
            {
                "coordinate": [one.coordinate for one in asked], "of": [one.of for one in asked],
                "label": [one.label for one in asked], "strength": [one.strength for one in asked],
                "trend": [one.trend for one in asked], "p": [one.p for one in asked],
            },
            ["coordinate", "of"], sentences=list(self.sentences),
        )  # fmt: skip

    def as_json(self) -> dict[str, Any]:
        """Findings and the missing torque as entries of result.json."""
        surface = self.surface
        told: dict[str, Any] = {
            "rms": self.latent.rms if surface is None else surface.rms,
            "stderr": float(np.median(self.latent.stderr)),
            "unit": self.latent.unit,
            "port": self.latent.port,
            "evident": self.latent.evident,
            "evidence": self.latent.evidence,
            "explained_by": [] if surface is None else list(surface.coordinates),
            "share": None if surface is None else surface.share,
            "tried": [] if surface is None else [
                {"coordinates": list(names), "share": share, "evidence": evidence} for names, share, evidence in surface.tried
            ],
            "moved": {} if surface is None else {
                name: {"fitted": a, "beside_torque": b} for name, (a, b) in surface.moved.items()
            },
        }  # fmt: skip
        if self.at_motor is not None:
            motor = self.at_motor
            told["at_motor"] = {"rms": motor.rms, "noise": motor.noise, "by_direction": motor.by_direction}
        return {"findings": list(self.sentences), "latent_torque": told}


def where_it_fails(fit: Fit, latent: Latent | None = None, surface: Surface | None = None) -> Findings:
    """Set the misfit of a fit against what it may depend on.

    Parameters
    ----------
    fit : a fit
    latent, surface : the missing torque and its best coordinates, where they are known already

    Returns
    -------
    `Findings`: prints its sentences; ``surface`` is what the missing torque depends on

    Raises
    ------
    NoAnswer
        The missing torque cannot be found.

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> fit = jb.fit(record.between(0.0, 2.0), inertia=3.16, starts=1)
    >>> found = jb.where_it_fails(fit)
    >>> found.adequate, found.surface.coordinates
    (False, ('y',))
    """
    seen = fit.records[0].kind == "transmitted"
    if latent is None:
        latent = missing_force(fit) if seen else missing_torque(fit)
    if latent.port == "motor":
        return _of_the_motor_alone(fit, latent, surface)
    at_motor = None if fit.adequate else missing_at_motor(fit.system, fit.free, fit.records[0], latent.unit)
    if at_motor is not None and not at_motor.evident:
        at_motor = None
    errors = fit.score.rms, fit.score.median
    if not latent.evident:
        asked = depends(latent, latent.torque, _misfit(fit, latent))
        numbers = _numbers(fit, latent)
        told: tuple[str, ...] = (NOISE.format(**numbers),)
        if at_motor is not None:
            told = (f"The misfit is {numbers['error']}. {at_motor}", NONE_ON_LINK.format(**numbers))
        return Findings(told, tuple(asked), latent, None, *errors, at_motor)
    if surface is None:
        surface = explain_force(latent) if seen else explain_torque(latent)
    asked = depends(latent, surface.torque, _misfit(fit, latent))
    told = (headline(fit, surface), *sentences(surface, asked), *([] if at_motor is None else [str(at_motor)]))
    return Findings(told, tuple(asked), latent, surface, *errors, at_motor)


def _of_the_motor_alone(fit: Fit, latent: Latent, surface: Surface | None) -> Findings:
    """What a drive of which the motor alone is seen tells: the torque at the motor that would make up for all that is missing."""
    numbers, errors = _numbers(fit, latent), (fit.score.rms, fit.score.median)
    asked = tuple(depends(latent, latent.torque, _misfit(fit, latent)))
    if not latent.evident:
        return Findings((NOISE.format(**numbers),), asked, latent, None, *errors)
    surface = surface or explain_force(latent, OF_MOTOR)
    found = AtMotor(latent.rms, float(np.median(latent.stderr)), _by_direction(latent), latent.unit)
    told = (f"The misfit is {numbers['error']}. {found}", NOT_APART, best_coordinates(surface))
    return Findings(told, asked, latent, surface, *errors, found)


def _by_direction(latent: Latent) -> float:
    """Share of the missing torque's variance that goes with the direction in which the motor turns, beside its speed; on average
    over a few values, which are rougher than the torque."""
    count = latent.t.size // TOGETHER * TOGETHER
    torque, speed = (v[:count].reshape(-1, TOGETHER).mean(axis=1) for v in (latent.torque, latent.dx))
    plane = np.linalg.qr(np.stack([np.ones(speed.size), speed], axis=1))[0]
    rest, apart = (v - plane @ (plane.T @ v) for v in (torque, np.sign(speed)))
    return float((rest @ apart) ** 2 / max(float(apart @ apart) * float(rest @ rest), 1e-300))


def _numbers(fit: Fit, latent: Latent) -> dict[str, Any]:
    bound, where = 2.0 * float(np.median(latent.stderr)), " at the motor" if latent.port == "motor" else ""
    return {"error": error_in_words(fit.score), "bound": bound, "unit": latent.unit, "where": where}


def _misfit(fit: Fit, latent: Latent) -> np.ndarray:
    """Residual over noise at the latent torque's times, (N,): root mean square over one spacing of them."""
    found = np.zeros(latent.t.size)
    for number, score in enumerate(fit.scores):
        rows = latent.record == number
        if not rows.any():  # of a drive the first record alone is looked at
            continue
        t = latent.t[rows]
        near = np.clip(np.searchsorted(t, score.t + 0.5 * latent.spacing) - 1, 0, t.size - 1)
        count = np.maximum(np.bincount(near, minlength=t.size), 1)
        found[rows] = np.sqrt(np.bincount(near, score.residual**2, t.size) / count)
    return found
