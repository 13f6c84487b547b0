"""Random records of joints nobody has in a laboratory: from instrument size to machine size, seldom or often sampled.

A stranger is a laboratory rig of `rigs`, drawn from wider ranges (damping, play, drive, strengths from barely visible to
dominant), measured with an encoder of its own on each side, and then enlarged or reduced by similarity. With time, angle and
inertia multiplied by a, g and m the equation of motion keeps its form if torques grow by m g / a^2: an exact simulation of the
rig is one of the stranger. Only sin(y) does not follow an angle's scale: joints with gravity keep their angles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.independent.generator import measure, simulate_truth
from tests.independent.rigs import RIG_STRENGTHS, SIGNED, STRENGTHS, Rig, make_excitation

# name -> parameter -> powers of inertia m, angle g and time a in its unit
_TORQUE, _STIFFNESS, _DAMPING, _SPEED = (1, 1, -2), (1, 0, -2), (1, 0, -1), (0, 1, -1)
_ONE, _ANGLE, _RATE = (0, 0, 0), (0, 1, 0), (0, 0, -1)
UNITS = {
    "gravity": {"G": _TORQUE, "phi0": _ONE},
    "preload": {"T0": _TORQUE},
    "gap_spring": {"k1": _STIFFNESS},
    "asymmetric_gap": {"z0": _ANGLE},
    "asymmetric_stiffness": {"a": _ONE},
    "cubic_stiffness": {"k3": (1, -2, -2)},
    "contact_damping": {"cc": _DAMPING, "pulls": _ONE},
    "hunt_crossley": {"chi": (1, -1, -1), "pulls": _ONE},
    "coulomb_joint": {"Tc": _TORQUE},
    "stribeck": {"Tc": _TORQUE, "Ts": _TORQUE, "vs": _SPEED},
    "coulomb_ground": {"Tc": _TORQUE},
    "quadratic_drag": {"q": (1, -1, 0)},
    "torque_ripple": {"A": _TORQUE, "N": (0, -1, 0), "phi": _ONE},
    "dahl": {"sigma": _STIFFNESS, "Fc": _TORQUE},
    "lugre": {"sigma0": _STIFFNESS, "sigma1": _DAMPING, "Fc": _TORQUE, "Fs": _TORQUE, "vs": _SPEED},
    "bouc_wen": {"sigma": _STIFFNESS, "Fc": _TORQUE, "n": _ONE, "beta": _ONE},
    "flexible_link": {"J2": (1, 0, 0), "k2": _STIFFNESS, "c2": _DAMPING},
    "gap_drift": {"r": _RATE},
    "stiffness_drift": {"r": _RATE},
    "sensor_delay": {"tau": (0, 0, 1)},
    "sensor_gain": {"g": _ONE},
    "transmission_error": {"e": _ANGLE, "M": (0, -1, 0), "psi": _ONE},
    "load_friction": {"mu": _ONE},
    "relaxation": {"kr": _STIFFNESS, "tau_r": (0, 0, 1)},
    "contact_exponent": {"p": _ONE, "d0": _ANGLE},
    "damping_drift": {"r": _RATE},
    "friction_drift": {"r": _RATE},
    "disturbance": {"A": _TORQUE, "omega": _RATE, "phi": _ONE},
    "second_play": {"J2": (1, 0, 0), "k2": _STIFFNESS, "c2": _DAMPING, "b2": _ANGLE},
    "sensor_filter": {"tau_f": (0, 0, 1)},
    "clock_drift": {"r": _ONE},
    "unknown_disturbance": {"A": _TORQUE, "w": _RATE, "phi": _ONE},
    "speed_stiffness": {"s": (1, -1, -1)},
}
# name -> the parameters that are its size; the others are its shape
_SIZES = {
    "stribeck": ("Tc", "Ts"), "dahl": ("sigma", "Fc"), "lugre": ("sigma0", "sigma1", "Fc", "Fs"), "bouc_wen": ("sigma", "Fc"),
    "flexible_link": ("J2", "k2", "c2"), "second_play": ("J2", "k2", "c2"), "relaxation": ("kr",),
}  # fmt: skip
_ONE_IS_NONE = {"sensor_gain": "g", "contact_exponent": "p"}
RUBBING = ("coulomb_joint", "stribeck", "dahl", "lugre", "bouc_wen")
SHAPES = (
    (125.0, 5000), (200.0, 6000), (250.0, 10000), (500.0, 5000), (500.0, 15000), (1000.0, 10000), (1000.0, 20000),
    (2000.0, 20000),
)  # fmt: skip
"""Rates [Hz] and lengths [samples]: few, so that a study compiles few programs; what they are to a joint is left to its scale."""
RATES, DURATIONS = (160.0, 2500.0), (8.0, 60.0)
"""The same as a laboratory's joint would see them [Hz, s]: 16 to 250 samples in a period in contact."""
TOUCHES, DRAWS = 0.03, 100
"""Share of the time that a link must touch each side, or the joint is drawn again: what never touches tells nothing."""


@dataclass(frozen=True)
class Stranger:
    """A record t [s], x, z [rad] as measured and ``again`` another of the same joint under another excitation; with their answer,
    the rig, its effects' values, and how the first was made."""

    rig: Rig
    values: dict[str, dict[str, float]]
    seen: dict[str, np.ndarray]
    kind: str
    noise: float
    step: float | None
    again: dict[str, np.ndarray]


@dataclass(frozen=True)
class Scale:
    """How much larger inertia, angle and time are than in the laboratory."""

    inertia: float = 1.0
    angle: float = 1.0
    time: float = 1.0

    def of(self, powers: tuple[int, int, int]) -> float:
        """The factor of a quantity with these powers in its unit."""
        return float(self.inertia ** powers[0] * self.angle ** powers[1] * self.time ** powers[2])

    def rig(self, rig: Rig) -> Rig:
        """The joint, scaled."""
        return Rig(rig.inertia * self.inertia, rig.backlash * self.angle, rig.stiffness * self.of(_STIFFNESS),
                   rig.damping * self.of(_DAMPING))  # fmt: skip

    def values(self, values: dict[str, dict[str, float]]) -> dict[str, dict[str, float]]:
        """Effects' values, scaled."""
        return {name: {k: v * self.of(UNITS[name][k]) for k, v in of.items()} for name, of in values.items()}


def make_stranger(rng, hidden: tuple[str, ...], kinds: tuple[str, str], noise: float = 1.0) -> Stranger:
    """A stranger that hides ``hidden``, under two kinds of excitation; ``noise`` multiplies what its encoders have."""
    kind, other = kinds
    slow, rate, duration = _clock(rng)
    for _ in range(DRAWS):
        rig = _rig(rng)
        values = {name.partition(":")[0]: _strength(rng, name) for name in hidden}
        # The drive follows the play, within what a servo does.
        size = float(np.clip(rig.backlash / 0.025, 0.5, 1.6) * rng.uniform(0.7, 1.4))
        truth = simulate_truth(rig, values, make_excitation(rng, kind, duration, scale=size), rate, duration)
        if all(np.mean(truth["contact"] == side) > TOUCHES for side in (-1, 1)):
            break
    else:
        raise RuntimeError(f"no joint with {', '.join(hidden) or 'nothing'} met both sides of its play in {DRAWS} draws")
    sigma_z = noise * np.exp(rng.uniform(np.log(1e-5), np.log(1e-4)))
    sigma_x = sigma_z * np.exp(rng.uniform(np.log(0.4), np.log(2.5)))
    # A cheap encoder: its count is what limits it.
    step = float(sigma_z * rng.uniform(2.0, 6.0)) if rng.random() < 1.0 / 3.0 else None
    seen = measure(truth, rng, sigma_x, sigma_z, step)
    scale = Scale(*(float(10.0 ** rng.uniform(-w, w)) for w in (2.0, 0.0 if "gravity" in values else 0.5)), slow)
    for name, order in (("torque_ripple", "N"), ("transmission_error", "M")):  # as many teeth as a drive has
        if name in values:
            scale = Scale(scale.inertia, min(scale.angle, values[name][order] / 5.0), scale.time)
    last = rng.spawn(1)[0]
    truth = simulate_truth(rig, values, make_excitation(last, other, duration, scale=size), rate, duration)
    again = measure(truth, last, sigma_x, sigma_z, step)
    grown, anew = ({n: r[n] * (scale.time if n == "t" else scale.angle) for n in "txz"} for r in (seen, again))
    return Stranger(scale.rig(rig), scale.values(values), grown, kind, sigma_z * scale.angle,
                    None if step is None else step * scale.angle, anew)  # fmt: skip


def _clock(rng) -> tuple[float, float, float]:
    """How much slower than the laboratory a joint is, and the rate [Hz] and duration [s] of its record as seen from there."""
    while True:
        rate, samples = SHAPES[int(rng.integers(len(SHAPES)))]
        slow = float(10.0 ** rng.uniform(-0.5, 0.5))
        if RATES[0] <= rate * slow <= RATES[1] and DURATIONS[0] <= samples / (rate * slow) <= DURATIONS[1]:
            return slow, rate * slow, samples / (rate * slow)


def _rig(rng) -> Rig:
    """A laboratory's inertia and frequency, and any damping and play that such a drive can cross."""
    inertia, omega = rng.uniform(2.6, 3.8), 2.0 * np.pi * rng.uniform(8.0, 11.5)
    ratio, play = (float(np.exp(rng.uniform(*np.log(ends)))) for ends in ((0.01, 0.1), (0.008, 0.05)))
    return Rig(inertia, play, inertia * omega**2, 2.0 * ratio * inertia * omega)


def _strength(rng, name: str) -> dict[str, float]:
    """The values of one effect: its size between a tenth and three times that of the laboratory, its shape as there."""
    drawn = STRENGTHS[name] if name in STRENGTHS else RIG_STRENGTHS[name]
    draw = {key: float(rng.uniform(*bounds)) for key, bounds in drawn.items()}
    if (key := _ONE_IS_NONE.get(name)) is not None:
        return draw | {key: 1.0 + (draw[key] - 1.0) * _size(rng)}
    size, sized = _size(rng), _SIZES.get(name, tuple(draw)[:1])
    if name in SIGNED:
        size *= float(rng.choice((-1.0, 1.0)))
    if name == "asymmetric_gap":
        size = float(np.clip(size, -1.5, 1.5))  # within the play
    return {key: value * size if key in sized else value for key, value in draw.items()}


def _size(rng) -> float:
    """A tenth to three times, evenly on a logarithmic scale."""
    return float(np.exp(rng.uniform(np.log(0.1), np.log(3.0))))
