"""What an ideal test can find: detection probability against strength at `refine`'s threshold, and the unit of strength.

`refine` takes an effect with one strength when twice the fall of the cost exceeds

    T = ln N + 2 ln L,      N samples, L laws in the catalogue:

the penalty of the Bayesian criterion for one parameter, and one for having chosen among L. Twice the fall of the cost is
the square of a normal variable of variance 1; its mean is the strength in standard errors, m, for whoever attains the
bound, and 0 without the effect. So

    power(m) = P(chi2_1(m^2) > T) = Phi(m - sqrt T) + Phi(-m - sqrt T),

and only the first part where physics allows one sign. The standard error is the Cramer-Rao bound of
`tests.independent.cramer_rao` at the joint without the effect, base motion and start unknown too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

import jaxbacklash.effects  # noqa: F401 (its laws are the catalogue)
from jaxbacklash.mechanics import catalogue
from jaxbacklash.parameters import specs
from tests.independent.cramer_rao import base_motion_bound, widest_spacing
from tests.independent.generator import make_excitation, make_rig, simulate_truth
from tests.independent.rigs import Excitation, Rig

STRENGTH = {
    "gravity": "G", "coulomb_joint": "Tc", "cubic_stiffness": "k3", "asymmetric_gap": "z0", "contact_damping": "cc",
    "load_friction": "mu", "damping_drift": "r", "contact_exponent": "p",
}  # fmt: skip
DEEP = 0.005  # rad, deflection at which the stiffness of a contact with another exponent is k
RATE, SIGMA = 500.0, 3e-5  # Hz, rad
KINDS = ("multisine", "stepped", "modulated", "chirp")
SPACINGS = (0.04, 0.03, 0.025, 0.02, 0.015, 0.0125, 0.01, 0.008, 0.006)  # s, between knots that may hold x(t)


@dataclass(frozen=True)
class Setting:
    """A joint and how it is driven, the same at every strength."""

    seed: int
    rig: Rig
    kind: str
    excitation: Excitation


def setting(seed: int, duration: float) -> Setting:
    """Rig and excitation of a seed."""
    rng = np.random.default_rng([31, seed])
    rig, kind = make_rig(rng), KINDS[seed % len(KINDS)]
    return Setting(seed, rig, kind, make_excitation(rng, kind, duration))


def threshold(samples: int) -> float:
    """T: what twice the fall of the cost must exceed for an effect with one strength."""
    laws = sum(law.catalogued for law in catalogue().values())
    return float(np.log(samples) + 2.0 * np.log(laws))


def ideal_power(multiple: np.ndarray | float, limit: float, one_sided: bool) -> np.ndarray:
    """Probability that an ideal test finds a strength of so many standard errors, with a threshold of `limit`."""
    m, edge = np.asarray(multiple, float), np.sqrt(limit)
    return norm.cdf(m - edge) + (0.0 if one_sided else norm.cdf(-m - edge))


def one_sided(name: str) -> bool:
    """Whether physics bounds the strength of an effect at its null value."""
    spec = specs(catalogue()[name]())[STRENGTH[name]]
    return bool(spec.lower >= spec.null)


def unit_torques(rig: Rig, truth: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The torque of each effect at unit strength along a motion (n,), the play's shift as the torque it makes."""
    z, dz = truth["y"] - truth["x"], truth["v"] - truth["dx"]
    d = z - np.clip(z, -0.5 * rig.backlash, 0.5 * rig.backlash)
    touch = (d != 0.0).astype(float)
    grown = np.log(np.where(d != 0.0, np.abs(d), DEEP) / DEEP)
    return {"gravity": np.sin(truth["y"]), "coulomb_joint": -np.sign(dz), "cubic_stiffness": -(d**3),
            "asymmetric_gap": rig.stiffness * touch, "contact_damping": -touch * dz,
            "load_friction": -rig.stiffness * np.abs(d) * np.sign(dz), "damping_drift": -rig.damping * truth["t"] * dz,
            "contact_exponent": -rig.stiffness * d * grown}  # fmt: skip


def least_errors(of: Setting, duration: float) -> dict[str, float]:
    """The least standard error of each effect's strength, each alone beside b, k and c, base motion and start unknown."""
    truth = simulate_truth(of.rig, {}, of.excitation, RATE, duration)
    x = of.excitation.base.x
    wide = widest_spacing(x, duration, 0.1 * SIGMA, SPACINGS)
    found = base_motion_bound(
        of.rig, truth["t"], truth["y"], truth["v"], x, sigma_x=SIGMA, sigma_z=SIGMA, spacing=wide,
        torques=unit_torques(of.rig, truth),
    )  # fmt: skip
    size = np.sqrt(np.diag(found.covariance))
    information = np.linalg.inv(found.covariance / np.outer(size, size))
    errors = {}
    for name in STRENGTH:
        own = [*range(3), found.names.index(name)]
        alone = np.linalg.inv(information[np.ix_(own, own)])
        errors[name] = float(np.sqrt(alone[3, 3]) * size[own[3]])
    return errors
