r"""The largest Lyapunov exponent of a joint over the level of its drive, for every play at once.

**Scaling.** Measure lengths in half plays and time in radians of the drive, :math:`z = (b/2)\,p` and :math:`\theta = \omega t`.
A joint whose laws other than the play are linear, moved by :math:`x = X\cos\omega t`, becomes

.. math:: p'' + \frac{c}{J\omega}\,p' + \frac{k_1 - G}{J\omega^2}\,p + \frac{k}{J\omega^2}\,F(p)
          = 2\,\frac{X}{b}\,\Bigl(1 + \frac{G}{J\omega^2}\Bigr)\cos\theta

with F the dead zone of half play 1 (compare the paper's 2.14). Play and amplitude enter as X / b alone, so one curve of the
exponent per drive period over X / b serves every play: another play shifts the curve along the logarithm of the amplitude.
Linear gravity and a spring across the play keep this law. Dry friction, a preload, sin y and a cubic spring bring a length or a
torque of their own and break it; such systems are refused.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..dynamics import NamedParameters
from ..dynamics.follow import follow
from ..dynamics.plan import Plan
from ..effects import Contact, GapSpring, LinearGravity
from ..effects.damping import ContactDamping
from ..errors import BadInput
from ..excitation import Harmonic
from ..frames import dataset
from ..showing import Shown
from ..system import System

Tell = Callable[[str, float], None]

LANES = 1024
"""Motions followed side by side."""
SIGMAS = 3.0
LEAST = 0.02
"""A motion counts as chaotic from so many error bars and from so much growth a drive period, whichever is more."""
SCALES = (LinearGravity, GapSpring, ContactDamping)


@dataclass(frozen=True, eq=False)
class ExponentMap(Shown):
    """Exponents over amplitude / play, from several starts, and over other parameters where asked.

    ``ratios`` (R,) amplitude of the base over the total play, rising, evenly spaced in the logarithm; ``axes`` names and values
    of the other parameters, none by default; ``exponent`` and ``stderr`` (S, ..., R) largest exponent per drive period and its
    error bar, one row a start, NaN where the motion could not be followed; ``frequency`` of the drive [Hz].
    """

    ratios: np.ndarray
    axes: dict[str, np.ndarray]
    exponent: np.ndarray
    stderr: np.ndarray
    frequency: float

    def __str__(self) -> str:
        over = "".join(f", {values.size} of {name}" for name, values in self.axes.items())
        return (
            f"exponents per drive period at {self.frequency:g} Hz, {self.exponent.shape[0]} starts each: {self.ratios.size} "
            f"ratios of amplitude to play from {self.ratios[0]:.3g} to {self.ratios[-1]:.3g}{over}"
        )

    def to_dataset(self) -> Any:
        """The map as an `xarray.Dataset`: ``exponent``, ``stderr`` [1/drive period] over ``start``, other axes, and ``ratio``."""
        dims = ("start", *self.axes, "ratio")
        return dataset(
            {"exponent": (dims, self.exponent, "1"), "stderr": (dims, self.stderr, "1")},
            {**{name: (values, "") for name, values in self.axes.items()}, "ratio": (self.ratios, "1")}, frequency=self.frequency,
        )  # fmt: skip

    @property
    def chaotic(self) -> np.ndarray:
        """(S, ..., R) True where the motion is chaotic: exponent above three error bars and above 0.02 a period."""
        with np.errstate(invalid="ignore"):
            return self.exponent > np.maximum(SIGMAS * self.stderr, LEAST)

    @property
    def chaotic_share(self) -> np.ndarray:
        """(..., R) share of the starts that lead to chaos; between 0 and 1 attractors coexist."""
        return self.chaotic.mean(axis=0)

    @property
    def step(self) -> float:
        """Distance of neighbouring ratios in the logarithm."""
        return float(np.log(self.ratios[-1] / self.ratios[0]) / (self.ratios.size - 1))

    def place(self, amplitude: Any, play: Any) -> np.ndarray:
        """Where amplitude / play falls on ``ratios``, as a fractional index; outside it is below 0 or above R - 1."""
        return np.log(np.asarray(amplitude) / np.asarray(play) / self.ratios[0]) / self.step


def exponent_map(
    system: System, frequency: float, ratios: tuple[float, float, int] = (0.5, 5.0, 461), *,
    over: Mapping[str, Any] | None = None, starts: int = 4, periods: int = 300, skip: int = 150, seed: int = 0,
    progress: Tell | None = None,
) -> ExponentMap:  # fmt: skip
    """Follow the joint over amplitude / play from several starts.

    The play of ``system`` itself is only a unit and may be anything. Steps are exact from edge to edge of the play.

    Parameters
    ----------
    system : a joint with play, else linear (see above); its damping, stiffness and gravity are taken as they are
    frequency : of the base motion [Hz]
    ratios : lowest and highest amplitude over total play, and how many values between them
    over : further parameters by name, each with its values: the map then has an axis for each (``{"damping": [2.0, 4.0]}``)
    starts : of the link: first at rest in the middle of the play, the others drawn over as wide a field as the motion spans.
        Attractors coexist in such joints, and one start sees one of them
    periods, skip : drive periods in all, and how many of them are transient
    seed : of the starts
    progress : told (stage, share done)

    Returns
    -------
    `ExponentMap`: ``exponent`` (starts, ..., ratios) per drive period, and which are ``chaotic``

    Raises
    ------
    BadInput
        The scaling does not hold for the system, or a number is out of range.

    Examples
    --------
    >>> joint = jb.two_link(3.16, np.radians(1.5), 15000.0, 9.0, -60.0, linearised=True)
    >>> curve = jb.signature.exponent_map(joint, 1.54, (0.6, 5.0, 60), starts=2, periods=60, skip=30)
    >>> curve.exponent.shape
    (2, 60)
    """
    system = _scaling(system)
    low, high, count = float(ratios[0]), float(ratios[1]), int(ratios[2])
    if not (0.0 < low < high and count >= 2):
        raise BadInput(f"ratios {ratios}: wanted lowest and highest amplitude over play, above zero, and a count above one")
    if not (np.isfinite(frequency) and frequency > 0.0):
        raise BadInput(f"frequency {frequency}: wanted the drive's, above zero [Hz]")
    if starts < 1:
        raise BadInput(f"starts {starts}: wanted at least 1")
    family = NamedParameters(system, Harmonic(1.0, 2.0 * np.pi * frequency))
    axes = {name: np.atleast_1d(np.asarray(values, dtype=float)) for name, values in (over or {}).items()}
    for name in axes:
        family.unit(name)  # refuses a name that is not there
    if "backlash" in axes:
        raise BadInput("over: the play is the unit of the map and cannot be one of its axes")
    ladder = np.geomspace(low, high, count)
    grids = np.meshgrid(*axes.values(), ladder, indexing="ij")
    shape = grids[0].shape
    given = {name: np.tile(g.ravel(), starts) for name, g in zip([*axes, "ratio"], grids)}
    ratio = given.pop("ratio")
    where = np.repeat(_starts(starts, seed), grids[0].size, axis=0)
    exponent, stderr = _followed(family, given, ratio, where, Plan(periods, skip, 1), progress)
    full = (starts, *shape)
    return ExponentMap(ladder, axes, exponent.reshape(full), stderr.reshape(full), float(frequency))


def _scaling(system: System) -> System:
    """The system, if amplitude and play enter its motion as their ratio alone."""
    if not isinstance(system.contact, Contact):
        raise BadInput("the system has no play, so no drive level stands out in it: wanted a joint with backlash")
    for name, effect in system.effects.items():
        if not isinstance(effect, SCALES):
            raise BadInput(
                f"with {name} the motion does not depend on amplitude over play alone: wanted no effects but linear_gravity, "
                "gap_spring and contact_damping"
            )
        if isinstance(effect, GapSpring) and float(np.max(np.abs(np.asarray(effect.z0)))) > 0.0:
            raise BadInput("gap_spring with z0 other than 0 brings a length of its own: wanted z0 = 0")
    return system


def _starts(count: int, seed: int) -> np.ndarray:
    """(S, 2) starts of z and z' in -1 ... 1 of the field that the motion spans, the first at rest in the play's middle."""
    drawn = np.random.default_rng(seed).uniform(-1.0, 1.0, (count, 2))
    drawn[0] = 0.0
    return drawn


def _followed(
    family: NamedParameters, given: dict[str, np.ndarray], ratio: np.ndarray, where: np.ndarray, plan: Plan, progress: Tell | None
) -> tuple[np.ndarray, np.ndarray]:
    """Exponents per drive period and error bars of all motions (N,), `LANES` at a time in one compiled program."""
    assert isinstance(family.drive, Harmonic)
    assert isinstance(family.system.contact, Contact)
    play, omega = float(family.system.contact.backlash), float(family.drive.omega)
    found, lanes = [], min(LANES, ratio.size)
    for begin in range(0, ratio.size, lanes):
        # The last tile is filled up with its last cell, so that all run the same program.
        at = np.minimum(np.arange(begin, begin + lanes), ratio.size - 1)
        amplitude = ratio[at] * play
        system, drive = family.build({name: values[at] for name, values in given.items()} | {"drive.amplitude": amplitude})
        z0, dz0 = (0.5 * play + amplitude) * where[at, 0], omega * amplitude * where[at, 1]
        one, _ = follow(system, drive, amplitude + z0, dz0, plan, exact=True)
        found.append(np.stack([np.asarray(one.lyapunov), np.asarray(one.stderr)])[:, : ratio.size - begin])
        if progress is not None:
            progress("following the joint over its drive", min(1.0, (begin + lanes) / ratio.size))
    exponent, stderr = np.concatenate(found, axis=1) * (2.0 * np.pi / omega)
    return exponent, stderr
