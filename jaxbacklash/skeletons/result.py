"""What a skeleton tells (parameters with intervals or reasons, curves over amplitude, masked stretches) and how it reads."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..frames import dataframe
from ..records import Record
from ..showing import Shown
from ..value import Value as Value
from ..value import columns_of as columns_of
from .fundamental import Fundamental
from .inversion import Inversion, Terms, invert
from .masks import Mask

NAMES = ("backlash", "stiffness", "damping")
LABELS = {"backlash": "total play b", "stiffness": "contact stiffness k", "damping": "viscous damping c", "inertia": "inertia J"}
INDEX = ("method", "parameter")
METHODS = {"hilbert": "Hilbert transform", "wavelet": "wavelet ridge"}


@dataclass(frozen=True)
class Curve:
    """A quantity over amplitude in bins: ``stderr`` of a bin's mean counts points four cycles apart as independent."""

    amplitude: np.ndarray
    mean: np.ndarray
    stderr: np.ndarray


@dataclass(frozen=True)
class Skeleton(Shown):
    """One method's answer; arrays have one entry a point of the skeleton, shape (M,).

    Attributes
    ----------
    method : ``"hilbert"`` or ``"wavelet"``
    parameters : ``backlash`` (total play), ``stiffness``, ``damping``, and ``inertia`` where a measured force told it
    t : times [s]
    frequency : of the carrier [Hz]
    amplitude, drive : envelopes of z and of what drives it (None in a free decay) [unit of the channel]
    peak : congruent envelope of z, the largest value within a cycle
    stiffness : modal stiffness :math:`\\omega_0^2(A)` [1/s^2], (2.4a), (3.6)
    damping : modal damping :math:`h_0(A)` [1/s], (2.4b)
    kept : points that count
    masks : why the others do not
    centre : middle of the play in z
    misfit : share of the torque that the fitted joint leaves (rms)
    warnings : sentences
    why : why there is nothing, empty if there is something
    """

    method: str
    parameters: dict[str, Value]
    t: np.ndarray
    frequency: np.ndarray
    amplitude: np.ndarray
    drive: np.ndarray | None
    peak: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    kept: np.ndarray
    masks: tuple[Mask, ...] = ()
    centre: float = 0.0
    misfit: float | None = None
    warnings: tuple[str, ...] = ()
    why: str = ""
    along: Fundamental | None = field(default=None, repr=False)
    terms: Terms | None = field(default=None, repr=False)

    @property
    def restoring_force(self) -> np.ndarray:
        """(3.7): f_s = A omega_0^2(A) per unit inertia, (M,)."""
        return self.amplitude * self.stiffness

    @property
    def damping_force(self) -> np.ndarray:
        """(3.8): f_d = 2 h_0(A) A' with A' the amplitude of the speed, omega A, per unit inertia, (M,)."""
        return 2.0 * self.damping * 2.0 * np.pi * self.frequency * self.amplitude

    @property
    def masked_fraction(self) -> float:
        """Share of the record's time that does not count."""
        if self.t.size < 2:
            return 1.0
        return float(1.0 - np.sum(np.gradient(self.t)[self.kept]) / (self.t[-1] - self.t[0]))

    def __str__(self) -> str:
        head = f"{METHODS[self.method]}: {100.0 * (1.0 - self.masked_fraction):.0f} % of the record counts"
        return "\n".join([head, *(line(name, value) for name, value in self.parameters.items())])

    def to_dataframe(self) -> Any:
        """The skeleton as a `pandas.DataFrame` along ``t`` [s].

        Columns: ``frequency`` [Hz], ``amplitude``, ``peak``, the modal ``stiffness`` [1/s^2] and ``damping`` [1/s], and which
        points are ``kept``.
        """
        names = ("t", "frequency", "amplitude", "peak", "stiffness", "damping", "kept")
        units = {"t": "s", "frequency": "Hz", "stiffness": "1/s^2", "damping": "1/s"}
        return dataframe({name: getattr(self, name) for name in names}, "t", units=units)

    def inverted(self, way: str = "waveform", inertia: float | None = None) -> Inversion | None:
        """Half play, stiffness and damping from the kept points once more, by another describing function of the dead zone.

        Parameters
        ----------
        way : ``"waveform"``: of the motion that was measured, ``"sine"``: of a pure sine, which misreads the play
        inertia : J [kg m^2]; None needs a measured force

        Returns
        -------
        None where too few points are kept
        """
        return None if self.terms is None else invert(self.terms, self.kept, inertia=inertia, way=way)

    def curve(self, what: str, bins: int = 20) -> Curve:
        """``"stiffness"``, ``"damping"``, ``"restoring_force"``, ``"damping_force"`` or ``"frequency"`` over amplitude.

        Bins hold equal numbers of kept points; empty where fewer than eight points are kept.
        """
        values, amplitude = getattr(self, what)[self.kept], self.amplitude[self.kept]
        if values.size < 8:
            return Curve(np.zeros(0), np.zeros(0), np.zeros(0))
        order = np.argsort(amplitude)
        parts = np.array_split(order, min(bins, max(1, values.size // 6)))
        mean = np.array([np.mean(values[part]) for part in parts])
        spread = np.array([np.std(values[part], ddof=1) / np.sqrt(max(1.0, part.size / 8.0)) for part in parts])
        return Curve(np.array([np.mean(amplitude[part]) for part in parts]), mean, spread)


@dataclass(frozen=True)
class Skeletons(Shown):
    """Both methods on one record, see `skeleton`. Prints itself; in a notebook it shows a table and its picture."""

    record: Record
    hilbert: Skeleton
    wavelet: Skeleton
    per_inertia: bool
    translational: bool
    warnings: tuple[str, ...]
    noise: dict[str, float]
    inertia: float | None

    @property
    def methods(self) -> tuple[Skeleton, Skeleton]:
        return self.hilbert, self.wavelet

    @property
    def masked_fraction(self) -> float:
        """Share of the record's time that neither method uses, the smaller of the two."""
        return min(self.hilbert.masked_fraction, self.wavelet.masked_fraction)

    def __str__(self) -> str:
        return text(self)

    def to_dataframe(self) -> Any:
        """The parameters as a `pandas.DataFrame`, a row for each ``method`` and ``parameter``.

        Columns: ``value``, ``stderr``, ``low`` and ``high`` of the 95 % interval in ``unit``; NaN, with a ``why``, where there is
        no number.
        """
        rows = [(method.method, name, value) for method in self.methods for name, value in method.parameters.items()]
        return dataframe({"method": [row[0] for row in rows], "parameter": [row[1] for row in rows],
                          **columns_of([row[2] for row in rows])}, INDEX)  # fmt: skip


def text(found: Skeletons) -> str:
    """The whole report."""
    unit = "m" if found.translational else "rad"
    lines = [found.record.summary()]
    lines += [f"  noise of {name} {level:.3g} {unit}" for name, level in found.noise.items()]
    for method in found.methods:
        lines.append(f"{METHODS[method.method]}: {100.0 * (1.0 - method.masked_fraction):.0f} % of the record counts")
        lines += [line(name, value) for name, value in method.parameters.items()]
    if found.per_inertia:
        lines.append("no inertia was given: stiffness and damping are per unit inertia")
    lines += [f"note: {sentence}" for sentence in found.warnings]
    lines.append(verdict(found))
    return "\n".join(lines)


def line(name: str, value: Value) -> str:
    """One parameter in words."""
    label = f"  {LABELS[name]:<22}"
    if value.value is None or value.stderr is None:
        return f"{label} none: {value.why}"
    shown = f"{label} {value.value:.6g} +- {value.stderr:.2g} {value.unit}"
    if value.unit == "rad":
        shown += f" = {np.degrees(value.value):.4g} deg"
    return shown


def verdict(found: Skeletons) -> str:
    """One sentence: what the two methods say together."""
    both = [m.parameters["backlash"] for m in found.methods]
    told = [v for v in both if v.value is not None]
    if not told:
        whys = list(dict.fromkeys(v.why for v in both))
        return f"No play can be told from this record's skeleton: {'; '.join(whys)}."
    if len(told) == 1:
        name = METHODS["hilbert" if both[0].value is not None else "wavelet"]
        return f"Only the {name} tells the play, {_play(told[0])}."
    a, b = both
    spread = float(np.hypot(a.stderr or 0.0, b.stderr or 0.0))
    apart = abs((a.value or 0.0) - (b.value or 0.0)) / max(spread, 1e-300)
    if apart < 3.0:
        best = a if (a.stderr or 0.0) < (b.stderr or 0.0) else b
        doubt = any("was left out" in sentence for sentence in found.warnings)
        but = ", but both left out the same torque, see the notes: its error allows for that" if doubt else ""
        return f"Both methods agree on a total play of {_play(best)}{but}."
    return (
        f"The methods differ by {apart:.1f} of their standard errors on the play ({_play(a)} and {_play(b)}): "
        "trust neither further than their difference."
    )


def _play(value: Value) -> str:
    assert value.value is not None
    degrees = f" ({np.degrees(value.value):.4g} deg)" if value.unit == "rad" else ""
    return f"{value.value:.5g} {value.unit}{degrees}"
