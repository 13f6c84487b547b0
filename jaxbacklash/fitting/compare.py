"""A given model beside a record: how far off, where, and whether noise alone would do that."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import BadInput, NoAnswer
from ..parameters import channel_unit
from ..records import Record, oriented
from ..records.size import check_size
from ..showing import Shown
from ..system import System
from .chance import near_noise
from .fit import predict_with_noise
from .score import Score, error_in_words


@dataclass(frozen=True)
class Comparison(Shown):
    """A model's windowed prediction of a record; ``noise`` std of the observed channel, in its unit."""

    system: System
    record: Record
    score: Score
    noise: float
    translational: bool

    @property
    def adequate(self) -> bool:
        """True when what the model leaves is noise."""
        return near_noise([self.score])

    def sentence(self) -> str:
        """The comparison in one or two sentences."""
        s = self.score
        if self.adequate:
            return f"The model predicts this record to its noise: {error_in_words(s)}, median window {s.median:.3g}."
        worst = s.window_times[int(np.nanargmax(s.window_rms))]
        return (
            f"The model misses this record by {error_in_words(s)} (median window {s.median:.3g}); "
            f"the worst window begins at {worst:.2f} s."
        )

    def __str__(self) -> str:
        name = self.record.observed_name
        unit = channel_unit(name, translational=self.translational)
        return "\n".join([self.record.summary(), f"  noise of {name} {self.noise:.3g} {unit}", self.sentence()])

    def to_dataset(self) -> Any:
        """The record with the prediction as an `xarray.Dataset`, see `Score.to_dataset`."""
        unit = channel_unit(self.record.observed_name, translational=self.translational)
        return self.score.to_dataset(unit).assign_attrs(record=self.record.path, noise=self.noise)


def _of_this_drive(system: System, record: Record) -> System:
    """The drive as this record sees it: by the encoders that it has.

    Raises
    ------
    BadInput
        One of the two is of a drive and the other is not, or their gears differ.
    """
    where = record.path or "the record"
    if system.motor is None or record.kind != "drive":
        one, other = ("record", "model") if record.kind == "drive" else ("model", "record")
        raise BadInput(f"{where}: the {one} is of a drive with its motor, the {other} is not; wanted both, or neither")
    if abs(record.ratio - float(system.motor.ratio)) > 1e-6 * record.ratio:
        raise BadInput(
            f"{where}: is of a gear of {record.ratio:g}, the model of {float(system.motor.ratio):g}; wanted one --ratio"
        )
    return dataclasses.replace(system, observed=" ".join(record.observed_names))


def compare(
    system: System, record: Record, *, window: float | None = None, translational: bool = False,
    known: tuple[float, float] = (1.0, 0.0),
) -> Comparison:  # fmt: skip
    """Predict a record window by window with a model's parameters as they are.

    ``known`` is what the fit of the model has told of the noise: by which factor it was below what the samples alone said, and
    its standard deviation (`Fit.known_noise`, in a model file ``[noise]``).

    Returns
    -------
    `Comparison`: prints itself; ``score.rms`` is the error over the noise, ``adequate`` whether noise would leave as much

    Raises
    ------
    BadInput
        The record does not hold the channel that the model observes.
    NoAnswer
        The model's motion grows without bound.

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> fit = jb.fit(record.between(0.0, 2.0), inertia=3.16, starts=1)
    >>> found = jb.compare(fit.system, heldout.between(0.0, 2.0))
    >>> found.adequate
    False
    >>> print(found.sentence())
    The model misses this record by ... times the noise, ...; the worst window begins at ... s.
    """
    if record.kind == "drive" or system.motor is not None:
        system = _of_this_drive(system, record)
    elif record.observed_name != system.observed:
        if {record.observed_name, system.observed} == {"z", "y"}:
            # The same motion seen from the base or from the ground: the record decides.
            system = System(system.inertia, system.contact, system.damper, system.effects, record.observed_name)
        else:
            raise BadInput(
                f"{record.path}: measures {record.observed_name}, but the model predicts {system.observed}; "
                f"wanted a record with {system.observed}"
            )
    record = oriented(record)
    check_size([record])
    with np.errstate(over="ignore", invalid="ignore"):  # a motion that grows without bound, which is told
        seen, noise = predict_with_noise(system, record, window=window, known=known)
    if not (np.isfinite(seen.rms) and np.isfinite(seen.median)):
        raise NoAnswer(
            f"{record.path}: within a window of {seen.length:.3g} s the model's motion grows without bound; are the signs of its "
            "effects right, and is its damping one that this record's rate can follow?"
        )
    return Comparison(system, record, seen, noise, translational)
