"""What a slow record says of its play, in words: the result of `lost_motion`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..frames import dataframe
from ..records import Record
from ..showing import Shown
from ..value import Value, columns_of
from .reading import Condition, Error, OverAngle

WAYS = {
    "carried": "two positions, the link carried by friction",
    "pulled": "a link pulled both ways by a force known by its sign",
    "loop": "a slow loop of torque over angle",
}
PASSES = {"carried": "strokes", "pulled": "pulls", "loop": "half loops"}
LABELS = {
    "backlash": "total play b", "lost_motion": "lost motion", "wind_up": "elastic wind-up", "stiffness": "contact stiffness k",
    "stiffness_up": "stiffness, upper side", "stiffness_down": "stiffness, lower side", "friction": "dry friction",
    "lag": "lag of the link", "ratio": "gear ratio",
}  # fmt: skip


@dataclass(frozen=True)
class LostMotion(Shown):
    """What a slow record says of its play, see `jaxbacklash.lost_motion`. Prints itself; a notebook shows it with its picture.

    Attributes
    ----------
    record : that was read
    way : ``"carried"``, ``"pulled"`` or ``"loop"``
    parameters : by name, ``backlash`` (total play) and ``lost_motion`` always; ``stiffness``, ``friction`` and others where
        they show
    conditions : what the reading rests on, each with what was found
    passes : strokes, pulls or half loops that stand behind it
    side : (N,) the edge that z is at, -1 or +1; 0 in between and where that is not known
    drift : (N,) what z drifts by, in its own unit
    noise : standard deviation of z about its levels
    over_angle : both levels over the angle, None where nothing turns
    transmission_error : waves of the motor's and the link's turn
    peak_to_peak : of what depends on the angle alone, without its straight line
    includes_wind_up : whether ``backlash`` is the lost motion, of which elastic wind-up under the friction may be a part
    turned : whether z was taken for x - y
    notes : sentences
    """

    record: Record
    way: str
    parameters: dict[str, Value]
    conditions: tuple[Condition, ...]
    passes: int
    side: np.ndarray
    drift: np.ndarray
    noise: float | None
    over_angle: OverAngle | None
    transmission_error: tuple[Error, ...]
    peak_to_peak: float | None
    includes_wind_up: bool
    translational: bool
    turned: bool = False
    notes: tuple[str, ...] = ()

    @property
    def failed(self) -> Condition | None:
        """The first condition that does not hold, None where the play is read."""
        return next((one for one in self.conditions if one.holds is False), None)

    @property
    def applies(self) -> bool:
        """Whether the record shows its play this way."""
        return self.failed is None

    @property
    def unit(self) -> str:
        """Of angles, or of travel."""
        return "m" if self.translational else "rad"

    def to_dataframe(self) -> Any:
        """The parameters as a `pandas.DataFrame`, a row for each ``parameter``.

        Columns: ``value``, ``stderr``, ``low`` and ``high`` of the 95 % interval in ``unit``; NaN, with a ``why``, where there is
        no number.
        """
        return dataframe({"parameter": list(self.parameters), **columns_of(list(self.parameters.values()))}, "parameter")

    def __str__(self) -> str:
        return text(self)


def text(found: LostMotion) -> str:
    """The whole of it for a terminal."""
    lines = [found.record.summary(), f"read as {WAYS[found.way]}"]
    lines += [_line(name, value) for name, value in found.parameters.items()]
    if found.peak_to_peak is not None and found.applies:
        lines.append(f"  {'transmission error':<24} {found.peak_to_peak:.4g} {found.unit} peak to peak")
        lines += [f"    {one.turn} turn, order {one.order}: amplitude {one.amplitude:.3g} +- {one.stderr:.2g} {found.unit}"
                  for one in found.transmission_error]  # fmt: skip
    lines.append(f"what this rests on, lengths in {found.unit}")
    lines += [f"  {MARKS[one.holds]} {one.name}: {one.found}" for one in found.conditions]
    lines += [f"note: {sentence}" for sentence in found.notes]
    lines.append(verdict(found))
    return "\n".join(lines)


MARKS = {True: "yes", False: "NO ", None: "?  "}


def _line(name: str, value: Value) -> str:
    label = f"  {LABELS[name]:<24}"
    if value.value is None or value.ci95 is None:
        return f"{label} none: {value.why}"
    shown = f"{label} {value.value:.6g} {value.unit}, 95 % interval {value.ci95[0]:.6g} to {value.ci95[1]:.6g}"
    return shown + (f" ({np.degrees(value.value):.4g} deg)" if value.unit == "rad" else "")


def verdict(found: LostMotion) -> str:
    """One or two sentences."""
    failed = found.failed
    if failed is not None:
        way = f" Way out: {'say ' if failed.way_out.startswith('--') else ''}{failed.way_out}." if failed.way_out else ""
        return f"The play does not show here: {failed.why}.{way}"
    b = found.parameters["backlash"]
    assert b.value is not None
    assert b.ci95 is not None
    between = f"between {b.ci95[0]:.5g} and {b.ci95[1]:.5g} with 95 % certainty, by {found.passes} {PASSES[found.way]}"
    said = f"The total play is {b.value:.5g} {b.unit}, {between}."
    if found.includes_wind_up:
        said += " Elastic wind-up under the friction or the pull is part of it: this record cannot tell the two apart."
    return said
