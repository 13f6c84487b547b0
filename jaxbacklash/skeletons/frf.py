r"""Frequency response at the edge of the play: preload the joint to one side, strike or shake the link, read the mode.

With the link resting on one contact the joint is linear, and :math:`H = Y/F = 1/(k - J\omega^2 + j c\,\omega)`. H1 divides by the
spectrum of the force and is low where the force is noisy; H2 divides the spectrum of the motion and is high where the
motion is; their ratio is the coherence. The inertia is the mass line, as the paper reads it from its Figure 11: above the
mode :math:`-\omega^2 H \to 1/J`.

H1 and H2 of averaged, windowed stretches show the mode and tell which lines are coherent and how noisy, but a window
smooths a resonance, by percents of the damping after a hammer. So the numbers come from the spectra of the whole record,
without a window, where

.. math:: Y = \frac{F + T_0 + T_1 \omega + T_2 \omega^2}{k - J\omega^2 + j c\,\omega} + \text{noise},

T being what the record's start and end leave (Pintelon and Schoukens, System Identification, 2012, section 6.3: exact where the
samples hold all of the motion, that is, where an anti-aliasing filter did its work). Least squares in Y, with the noise as
weight, is not biased by that noise; a regression of H is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import BadInput, NoAnswer
from ..frames import dataframe, dataset
from ..records import Record
from ..showing import Shown
from .result import Value, columns_of

COHERENT = 0.8
"""Coherence that a line needs to count."""
FEWEST_LINES = 8


@dataclass(frozen=True)
class Response(Shown):
    """Receptance of the link. Arrays (F,): ``frequency`` [Hz]; ``h1``, ``h2`` complex [rad/(N m)]; ``coherence`` 0 to 1;
    ``used`` lines that the values come from. ``values``: natural_frequency [Hz], damping_ratio, inertia, stiffness, damping."""

    frequency: np.ndarray
    h1: np.ndarray
    h2: np.ndarray
    coherence: np.ndarray
    used: np.ndarray
    values: dict[str, Value]

    def __str__(self) -> str:
        lines = [f"{int(self.used.sum())} of {self.used.size} lines are coherent"]
        lines += [f"  {name.replace('_', ' '):<20} {v.value:.6g} +- {v.stderr:.2g} {v.unit}" for name, v in self.values.items()]
        return "\n".join(lines)

    def to_dataframe(self) -> Any:
        """The values as a `pandas.DataFrame`, a row each: ``value``, ``stderr``, ``low`` and ``high`` of the 95 % interval."""
        return dataframe({"parameter": list(self.values), **columns_of(list(self.values.values()))}, "parameter")

    def to_dataset(self) -> Any:
        """The lines as an `xarray.Dataset` along ``frequency`` [Hz]: complex ``h1``, ``h2``, ``coherence``, and which count."""
        unit = "m/N" if self.values["stiffness"].unit == "N/m" else "rad/(N m)"
        lines = {"h1": (self.h1, unit), "h2": (self.h2, unit), "coherence": (self.coherence, "1"), "used": (self.used, "1")}
        return dataset(
            {name: ("frequency", values, of) for name, (values, of) in lines.items()}, {"frequency": (self.frequency, "Hz")}
        )


def frequency_response(
    record: Record, *, segment: float | None = None, band: tuple[float, float] | None = None, translational: bool = False
) -> Response:
    """Natural frequency, damping and inertia from a force-driven record of the preloaded joint.

    The force is taken to be exact: noise on it makes inertia and stiffness high, as it makes H1 low, by its share of the force's
    power. A hammer must strike softly enough, or the sample rate be high enough, that the samples hold the whole stroke.

    Parameters
    ----------
    record : F and y, by shock or random force; the mean of both is taken off, since the preload is constant
    segment : length of the averaged stretches [s]; None: an eighth of the record, so that fifteen overlap
    band : lowest and highest frequency to use [Hz]; None: all that is coherent
    translational : units of a translating mass

    Returns
    -------
    `Response`: prints itself; ``values`` by name, with errors, and the lines

    Raises
    ------
    BadInput
        A record without F and y, or a segment that does not fit at least twice.
    NoAnswer
        Too few coherent lines, or no resonance among them.

    Examples
    --------
    >>> held = jb.base_motion_joint(3.16, 0.026, 15000.0, 22.0).with_effects(jb.Preload(120.0))
    >>> lines = np.arange(2.0, 60.0, 0.11)
    >>> push = jb.Multisine(np.ones(lines.size), 2.0 * np.pi * lines, lines**2, as_force=True)
    >>> shaken = jb.simulate(held, push, duration=30.0, rate=500.0, y0=0.021)
    >>> channels = {"F": np.asarray(shaken.drive.force), "y": np.asarray(shaken.y)}
    >>> test = jb.Record(np.asarray(shaken.t), channels)
    >>> found = jb.frequency_response(test, segment=4.0, band=(4.0, 40.0))
    >>> round(found.values["inertia"].value, 1)
    3.2
    """
    where = record.path or "the record"
    if record.kind != "force" or "y" not in record.channels:
        raise BadInput(f"{where}: is a {record.kind} record, wanted the force F and the motion y of the preloaded link")
    duration = record.samples * record.dt
    length = duration / 8.0 if segment is None else segment
    each = int(length / record.dt)
    if each < 32 or 2 * each > record.samples:
        raise BadInput(f"{where}: segments of {length:g} s; wanted at least 32 samples each and two in {duration:g} s")
    force, motion = record.channels["F"], record.channels["y"]
    keywords = {"fs": record.rate_hz, "nperseg": each, "window": "hann", "detrend": "linear"}
    from scipy import signal  # half a second to import

    frequency, cross = signal.csd(force, motion, **keywords)
    _, of_force = signal.welch(force, **keywords)
    _, of_motion = signal.welch(motion, **keywords)
    tiny = np.finfo(float).tiny
    h1, h2 = cross / np.maximum(of_force, tiny), of_motion / np.where(np.abs(cross) > tiny, np.conj(cross), tiny)
    coherence = np.abs(cross) ** 2 / np.maximum(of_force * of_motion, tiny)
    low, high = band or (1.5 / length, 0.4 * record.rate_hz)
    used = (coherence > COHERENT) & (frequency >= low) & (frequency <= high)
    if used.sum() < FEWEST_LINES:
        raise NoAnswer(f"{where}: only {used.sum()} lines are coherent beyond {COHERENT:g}, wanted {FEWEST_LINES}")
    averages = max(2.0, 1.8 * record.samples / each)
    start = _regression(frequency[used], h1[used], coherence[used], averages, where)
    # Averages of so few are coherent by chance: the noise is a little more than 1 - coherence tells.
    noise = of_motion * np.maximum(1.0 - coherence, 1e-9) * averages / (averages - 1.0)
    lines = np.fft.rfftfreq(record.samples, record.dt)
    inside = np.interp(lines, frequency, used.astype(float)) > 0.5
    push, answer = (np.fft.rfft(v - np.mean(v))[inside] for v in (force, motion))
    weight = 1.0 / np.sqrt(np.interp(lines[inside], frequency, noise))
    values = _mode(2.0 * np.pi * lines[inside], push, answer, weight, start, translational)
    natural = values["natural_frequency"].value or 0.0
    if not frequency[used][0] < natural < frequency[used][-1]:
        raise NoAnswer(f"{where}: the coherent lines hold no resonance; wanted a joint that rests on one contact")
    return Response(frequency, h1, h2, coherence, used, values)


def _regression(frequency: np.ndarray, h: np.ndarray, coherence: np.ndarray, averages: float, where: str) -> np.ndarray:
    """Stiffness, damping and inertia from 1 = (k - J w^2 + j c w) H, (3,): good to percents, where the search starts."""
    omega = 2.0 * np.pi * frequency
    # A line's relative error is sqrt((1 - coherence) / (2 coherence averages)): Bendat and Piersol.
    relative = np.sqrt(np.maximum(1.0 - coherence, 1e-6) / (2.0 * coherence * averages))
    columns = np.stack([h, 1j * omega * h, -(omega**2) * h], axis=1) / relative[:, None]
    matrix, right = np.concatenate([columns.real, columns.imag]), np.concatenate([1.0 / relative, 0.0 * omega])
    scale = np.linalg.norm(matrix, axis=0)
    k, c, j = np.linalg.lstsq(matrix / scale, right, rcond=None)[0] / scale
    if k <= 0.0 or j <= 0.0:
        raise NoAnswer(f"{where}: the coherent lines hold no resonance; wanted a joint that rests on one contact")
    return np.array([k, c if c > 0.0 else 0.02 * np.sqrt(k * j), j])


def _mode(
    omega: np.ndarray, force: np.ndarray, motion: np.ndarray, weight: np.ndarray, start: np.ndarray, translational: bool
) -> dict[str, Value]:
    """Stiffness, damping and inertia by least squares in the motion's spectrum, and what follows with first-order errors.

    Errors are those of White (Econometrica 48, 1980): they ask the residuals how large they are, not the weights.
    """
    unit = omega / omega[-1]
    ends = np.stack([unit**power for power in range(3)], axis=1).astype(complex)
    scale = np.concatenate([start, np.full(6, float(np.sqrt(np.mean(np.abs(force) ** 2))))])

    def model(of: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What the model makes of the force, and the slopes of that in the scaled parameters."""
        k, c, j, *t = of * scale
        pushed, below = force + ends @ (np.array(t[:3]) + 1j * np.array(t[3:])), k - j * omega**2 + 1j * c * omega
        y = pushed / below
        slopes = [-y / below, -1j * omega * y / below, omega**2 * y / below]
        slopes += [*(ends / below[:, None]).T, *(1j * ends / below[:, None]).T]
        return y, np.stack(slopes, axis=1) * scale

    def real(values: np.ndarray) -> np.ndarray:
        weighed = values * (weight if values.ndim == 1 else weight[:, None])
        return np.concatenate([weighed.real, weighed.imag])

    first = np.concatenate([np.ones(3), np.zeros(6)])
    from scipy.optimize import least_squares  # a seventh of a second to import

    found = least_squares(lambda v: real(model(v)[0] - motion), first, lambda v: real(model(v)[1]), method="lm")
    jacobian = real(model(found.x)[1])
    bread = np.linalg.inv(jacobian.T @ jacobian)
    scores = jacobian * found.fun[:, None]
    covariance = (bread @ (scores.T @ scores) @ bread)[:3, :3] * np.outer(start, start)
    k, c, j = found.x[:3] * start
    natural, ratio = np.sqrt(np.abs(k / j)) / (2.0 * np.pi), c / (2.0 * np.sqrt(np.abs(k * j)))
    slopes = {
        "natural_frequency": (natural, np.array([0.5 / k, 0.0, -0.5 / j]) * natural, "Hz"),
        "damping_ratio": (ratio, np.array([-0.5 / k, 1.0 / c, -0.5 / j]) * ratio, "1"),
        "inertia": (j, np.array([0.0, 0.0, 1.0]), "kg" if translational else "kg m^2"),
        "stiffness": (k, np.array([1.0, 0.0, 0.0]), "N/m" if translational else "N m/rad"),
        "damping": (c, np.array([0.0, 1.0, 0.0]), "N s/m" if translational else "N m s/rad"),
    }
    told = {}
    for name, (value, slope, unit_of) in slopes.items():
        error = float(np.sqrt(slope @ covariance @ slope))
        told[name] = Value(float(value), error, (float(value - 1.96 * error), float(value + 1.96 * error)), unit_of)
    return told
