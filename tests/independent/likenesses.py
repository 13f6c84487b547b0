"""Made-up records like measured ones that were published: what a rig of each kind answers, and what hides in it.

Each `Likeness` is a record with its answer. The kinds: a hardening spring under random force, as an electronic oscillator that
is used to compare methods; a pendulum that swings out in its bearing; the axis of a machine under position control, its
friction plain or of a law that no catalogue holds; a decay of two coupled masses; a link that a slipping band holds. Sizes,
rates and noise are drawn at random. The simulation shares nothing with the package.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.linalg import expm

from jaxbacklash.records import Record
from tests.independent.held_link import HeldLink, measured
from tests.independent.sliding_mass import SlidingMass


@dataclass(frozen=True)
class Likeness:
    """A record, ``how`` `refine` is called on it, and the answer: names of what ``hidden`` effects act, values of parameters.

    ``hidden`` None: the law that acts is in no catalogue.
    """

    kind: str
    record: Record
    hidden: tuple[str, ...] | None
    values: dict[str, float] = field(default_factory=dict)
    how: dict[str, Any] = field(default_factory=dict)


def hardening_spring(rng: np.random.Generator, size: float = 1.0) -> Likeness:
    """White-noise force on a sliding mass, whose spring hardens by 5 to 40 % where the motion is of usual size."""
    rate, samples = 610.0, round(8000 * size)
    mass = rng.uniform(0.5, 3.0)
    k = mass * (2.0 * np.pi * rng.uniform(40.0, 80.0)) ** 2
    c = 2.0 * rng.uniform(0.02, 0.06) * np.sqrt(k * mass)
    force = rng.uniform(20.0, 200.0) * rng.standard_normal(samples + 1)

    def moved(k3: float) -> np.ndarray:
        body = SlidingMass(mass, lambda y, v: k * y + k3 * y**3 + c * v)
        y, v, places = 0.0, 0.0, np.empty(samples)
        for n in range(samples):
            places[n] = y
            a, slope = force[n], (force[n + 1] - force[n]) * rate
            y, v = body.sample(n / rate, y, v, 1.0 / rate, lambda s, a=a, slope=slope: a + slope * s)
        return places

    usual = float(np.std(moved(0.0)[: samples // 4]))
    k3 = rng.uniform(0.05, 0.4) * k / usual**2
    y = moved(k3)
    seen = y + rng.uniform(0.001, 0.005) * np.std(y) * rng.standard_normal(samples)
    record = Record(np.arange(samples) / rate, {"F": force[:-1], "y": seen})
    values = {"inertia": mass, "stiffness": k, "damping": c, "cubic_stiffness.k3": k3}
    return Likeness("hardening spring", record, ("cubic_stiffness",), values, {"model": "linear", "translational": True})


def pendulum(rng: np.random.Generator, size: float = 1.0) -> Likeness:
    """Swings of a pendulum from 1 to 2.5 rad until its bearing ends them, read by an encoder; values are per unit inertia."""
    rate, samples = 200.0, round(6000 * size)
    weight = (2.0 * np.pi * rng.uniform(0.6, 1.2)) ** 2
    begin = rng.uniform(1.0, 2.5)
    dry = weight * begin / (4.0 * rng.uniform(20.0, 40.0))
    c = rng.uniform(0.01, 0.06)
    body = SlidingMass(1.0, lambda y, v: weight * np.sin(y) + c * v, lambda t, y, v, force: dry)
    y, v, places = begin, 0.0, np.empty(samples)
    for n in range(samples):
        places[n] = y
        y, v = body.sample(n / rate, y, v, 1.0 / rate, lambda s: 0.0, fine=4)
    count = 2.0 * np.pi / 8192
    seen = count * np.round((places + 5e-4 * rng.standard_normal(samples)) / count)
    values = {"gravity.G": -weight, "coulomb_ground.Tc": dry, "damping": c}
    how = {"model": "free", "inertia": 1.0}
    # It swings further than any joint is believed to without being told the unit.
    record = Record(np.arange(samples) / rate, {"z": seen}, confirmed=frozenset("z"))
    return Likeness("pendulum", record, ("coulomb_ground", "gravity"), values, how)


UNKNOWN_FRICTION: dict[str, Callable[[float], Callable[[float, float, float, float], float]]] = {
    "by place": lambda dry: lambda t, y, v, force: dry * (1.0 + 0.5 * np.sin(60.0 * y)),
    "by load": lambda dry: lambda t, y, v, force: 0.6 * dry + 0.3 * abs(force),
    "by warmth": lambda dry: lambda t, y, v, force: dry * (0.6 + 0.7 * np.exp(-t / 4.0)),
}
"""Friction laws that no catalogue holds, by what they go with: functions (t, y, v, F) -> [N] for a size [N]."""


def _axis(rng: np.random.Generator, size: float, friction: Callable[..., Any]) -> tuple[Record, dict[str, float]]:
    """A carriage that follows trapezoids under position control, its force held from sample to sample."""
    rate, samples = 500.0, round(6000 * size)
    mass, dry = rng.uniform(50.0, 150.0), rng.uniform(15.0, 40.0)
    c, pull = rng.uniform(100.0, 300.0), rng.uniform(-0.3, 0.3) * dry
    body = SlidingMass(mass, lambda y, v: c * v - pull, friction(dry))
    t = np.arange(samples) / rate
    ends = rng.uniform(-0.15, 0.15, 60)
    slowest = rng.uniform(0.1, 0.25)
    wanted = np.interp(t, np.concatenate([[0.0], np.cumsum(0.3 + np.abs(np.diff(ends)) / slowest)]), ends)
    wanted = np.convolve(np.pad(wanted, 20, mode="edge"), np.hanning(41) / np.sum(np.hanning(41)), mode="valid")
    stiff, damp = mass * (2.0 * np.pi * 6.0) ** 2, 1.4 * mass * 2.0 * np.pi * 6.0
    y, v, before, places, force = wanted[0], 0.0, wanted[0], np.empty(samples), np.empty(samples)
    for n in range(samples):
        places[n] = y
        ahead = (wanted[min(n + 1, samples - 1)] - wanted[max(n - 1, 0)]) * 0.5 * rate
        force[n] = stiff * (wanted[n] - y) + damp * (ahead - (y - before) * rate)
        before = y
        y, v = body.sample(n / rate, y, v, 1.0 / rate, lambda s, held=force[n]: held, fine=4)
    seen = places + 2e-6 * rng.standard_normal(samples)
    values = {"inertia": mass, "damping": c, "coulomb_ground.Tc": dry, "preload.T0": pull}
    return Record(t, {"F": force, "y": seen}), values


def plain_axis(rng: np.random.Generator, size: float = 1.0) -> Likeness:
    """The axis with Coulomb friction and a constant pull."""
    record, values = _axis(rng, size, lambda dry: lambda t, y, v, force: dry)
    how = {"model": "free", "translational": True}
    return Likeness("plain axis", record, ("coulomb_ground", "preload"), values, how)


def odd_axis(rng: np.random.Generator, size: float = 1.0) -> Likeness:
    """The axis with friction of a law that no catalogue holds."""
    names = list(UNKNOWN_FRICTION)
    name = names[int(rng.integers(len(names)))]
    record, _ = _axis(rng, size, UNKNOWN_FRICTION[name])
    return Likeness(f"axis, friction {name}", record, None, how={"model": "free", "translational": True})


def two_modes(rng: np.random.Generator, size: float = 1.0) -> Likeness:
    """A free decay of two masses on two springs, of which the one at the ground is measured; values are per unit inertia."""
    rate, samples = 500.0, round(5000 * size)
    k, second, ratio = (2.0 * np.pi * rng.uniform(4.0, 8.0)) ** 2, rng.uniform(0.1, 0.4), rng.uniform(1.2, 2.5)
    c = 2.0 * rng.uniform(0.005, 0.02) * np.sqrt(k)
    k2 = second * ratio**2 * k
    c2 = 2.0 * rng.uniform(0.005, 0.02) * np.sqrt(k2 * second)
    rates = np.array([
        [0.0, 1.0, 0.0, 0.0], [-k - k2, -c - c2, k2, c2],
        [0.0, 0.0, 0.0, 1.0], [k2 / second, c2 / second, -k2 / second, -c2 / second],
    ])  # fmt: skip
    step, state, places = expm(rates / rate), 0.05 * rng.standard_normal(4) * (1.0, 0.0, 1.0, 0.0), np.empty(samples)
    for n in range(samples):
        places[n] = state[0]
        state = step @ state
    seen = places + rng.uniform(0.001, 0.005) * np.std(places) * rng.standard_normal(samples)
    values = {"stiffness": k, "damping": c, "flexible_link.J2": second, "flexible_link.k2": k2, "flexible_link.c2": c2}
    how = {"model": "linear", "inertia": 1.0}
    return Likeness("two modes", Record(np.arange(samples) / rate, {"z": seen}), ("flexible_link",), values, how)


def band_brake(rng: np.random.Generator, size: float = 1.0) -> Likeness:
    """A link that a band holds, moved slowly over a joint with play: base motion and transmitted force are measured."""
    k, dry = rng.uniform(1e6, 4e6), rng.uniform(2000.0, 6000.0)
    link = HeldLink(rng.uniform(100.0, 300.0), rng.uniform(1e-3, 5e-3), k, rng.uniform(3000.0, 9000.0), dry)
    table = measured(link, rng.uniform(0.012, 0.02), 0.5, duration=6.0 * size, rate=256.0)
    noisy = {n: table[n] + s * rng.standard_normal(table["t"].size) for n, s in (("x", 1e-6), ("T", 2e-3 * dry))}
    values = {"backlash": link.backlash, "stiffness": k, "coulomb_ground.Tc": dry}
    return Likeness("band brake", Record(table["t"], noisy), ("coulomb_ground",), values, {"translational": True})


KINDS: dict[str, Callable[..., Likeness]] = {
    one.__name__: one for one in (hardening_spring, pendulum, plain_axis, odd_axis, two_modes, band_brake)
}
"""What draws a record of each kind, from a generator of random numbers and ``size``, the record's length over the usual one."""


def make_likeness(kind: str, seed: int, size: float = 1.0) -> Likeness:
    """Record number ``seed`` of a kind."""
    return KINDS[kind](np.random.default_rng([58, list(KINDS).index(kind), seed]), size)
