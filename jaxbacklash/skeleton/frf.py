r"""Frequency response at the edge of the play: preload the joint to one side, strike or shake the link, read the mode.

With the link resting on one contact the joint is linear, and :math:`H = Y/F = 1/(k - J\omega^2 + j c\,\omega)`. H1 divides by the
spectrum of the force and is low where the force is noisy; H2 divides the spectrum of the motion and is high where the
motion is; their ratio is the coherence. The inertia is the mass line, as the paper reads it from its Figure 11: above the
mode :math:`-\omega^2 H \to 1/J`. All three numbers come from one weighted regression of
:math:`1 = (k - J\omega^2 + j c\,\omega) H` over the lines that are coherent.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import BadInput, NoAnswer
from ..records import Record
from .result import Value

COHERENT = 0.8
"""Coherence that a line needs to count."""
FEWEST_LINES = 8


@dataclass(frozen=True)
class Response:
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


def frequency_response(
    record: Record, *, segment: float | None = None, band: tuple[float, float] | None = None, translational: bool = False
) -> Response:
    """Natural frequency, damping and inertia from a force-driven record of the preloaded joint.

    Parameters
    ----------
    record : F and y, by shock or random force; the mean of both is taken off, since the preload is constant
    segment : length of the averaged stretches [s]; None: an eighth of the record, so that fifteen overlap
    band : lowest and highest frequency to use [Hz]; None: all that is coherent
    translational : units of a translating mass

    Raises
    ------
    BadInput
        A record without F and y, or a segment that does not fit at least twice.
    NoAnswer
        Too few coherent lines, or no resonance among them.

    Examples
    --------
    >>> response = frequency_response(read_record("hammer.csv"), band=(3.0, 40.0))  # doctest: +SKIP
    >>> print(response.values["inertia"].value)  # doctest: +SKIP
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
    values = _mode(frequency[used], h1[used], coherence[used], averages, where, translational)
    return Response(frequency, h1, h2, coherence, used, values)


def _mode(
    frequency: np.ndarray, h: np.ndarray, coherence: np.ndarray, averages: float, where: str, translational: bool
) -> dict[str, Value]:
    """Stiffness, damping and inertia by regression, and what follows from them with first-order errors."""
    omega = 2.0 * np.pi * frequency
    # A line's relative error is sqrt((1 - coherence) / (2 coherence averages)): Bendat and Piersol.
    relative = np.sqrt(np.maximum(1.0 - coherence, 1e-6) / (2.0 * coherence * averages))
    columns = np.stack([h, 1j * omega * h, -(omega**2) * h], axis=1) / relative[:, None]
    matrix, right = np.concatenate([columns.real, columns.imag]), np.concatenate([1.0 / relative, 0.0 * omega])
    scale = np.linalg.norm(matrix, axis=0)
    solution = np.linalg.lstsq(matrix / scale, right, rcond=None)[0]
    residual = right - matrix / scale @ solution
    excess = max(1.0, float(residual @ residual) / max(residual.size - 3, 1))
    covariance = excess * np.linalg.inv((matrix / scale).T @ (matrix / scale)) / np.outer(scale, scale)
    k, c, j = solution / scale
    if k <= 0.0 or j <= 0.0 or not frequency[0] < np.sqrt(k / j) / (2.0 * np.pi) < frequency[-1]:
        raise NoAnswer(f"{where}: the coherent lines hold no resonance; wanted a joint that rests on one contact")
    natural, ratio = np.sqrt(k / j) / (2.0 * np.pi), c / (2.0 * np.sqrt(k * j))
    slopes = {
        "natural_frequency": (natural, np.array([0.5 / k, 0.0, -0.5 / j]) * natural, "Hz"),
        "damping_ratio": (ratio, np.array([-0.5 / k, 1.0 / c, -0.5 / j]) * ratio, "1"),
        "inertia": (j, np.array([0.0, 0.0, 1.0]), "kg" if translational else "kg m^2"),
        "stiffness": (k, np.array([1.0, 0.0, 0.0]), "N/m" if translational else "N m/rad"),
        "damping": (c, np.array([0.0, 1.0, 0.0]), "N s/m" if translational else "N m s/rad"),
    }
    found = {}
    for name, (value, slope, unit) in slopes.items():
        error = float(np.sqrt(slope @ covariance @ slope))
        found[name] = Value(float(value), error, (float(value - 1.96 * error), float(value + 1.96 * error)), unit)
    return found
