"""A cause of misfit that lies in the record and not in the joint: what it is, how large, and what the fit would be without it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..frames import dataframe
from ..showing import Shown

if TYPE_CHECKING:
    from ..records import Record


@dataclass(frozen=True)
class Cause(Shown):
    """Something about the record that explains a misfit.

    Attributes
    ----------
    name : what kind of cause: ``delay``, ``clock``, ``scale``, ``sign``, ``inertia``, ``held_samples``, ``held_start``, ``step``,
        ``slow``
    channel : the channel that it is about, empty where it is about all
    size : how large it is, None where it has no size (a turned sign)
    stderr : standard error of the size, None where that cannot be told
    unit : unit of the size, ``"1"`` for a ratio
    before, left : misfit of the model over noise as the record stands, and without the cause
    gain : fall of the sum of squares, in units of the noise and of what is left
    sentence : one sentence for a person, with the sizes in it
    remedy : options to add to the command, or a command, ready to paste; empty where there is none
    law : the canonical name of the catalogue's effect that says the same, empty where there is none
    certain : whether only noise is left without it; else something else is missing beside it
    parameters : values of the joint on the corrected record, by name, None where one is not determined
    record : the corrected record
    """

    name: str
    channel: str
    size: float | None
    stderr: float | None
    unit: str
    before: float
    left: float
    gain: float
    sentence: str
    remedy: str
    law: str = ""
    certain: bool = True
    parameters: dict[str, float | None] = field(default_factory=dict)
    record: Record | None = None

    def __str__(self) -> str:
        after = f" Pass {self.remedy}." if self.remedy.startswith("--") else f" {self.remedy}." if self.remedy else ""
        return f"{self.sentence}.{after}"

    @property
    def undone(self) -> str:
        """What the joint comes to on the corrected record, in words."""
        known = ", ".join(f"{name} {value:.6g}" for name, value in self.parameters.items() if value is not None)
        return f"On the record without it: {known}" if known else ""

    def to_dataframe(self) -> Any:
        """One row, of the cause's name: channel, size with its standard error and unit, misfit over noise with it and without."""
        return dataframe(
            {
                "cause": [self.name], "channel": [self.channel], "size": [self.size], "stderr": [self.stderr],
                "unit": [self.unit], "rms_over_noise": [self.before], "rms_over_noise_without": [self.left],
                **{name: [value] for name, value in self.parameters.items()},
            },
            "cause", remedy=self.remedy,
        )  # fmt: skip

    def as_json(self) -> dict[str, Any]:
        """The cause's entry in result.json: plain numbers, None where there is none."""

        def plain(v: float | None) -> float | None:
            return None if v is None or not np.isfinite(v) else float(v)

        return {
            "name": self.name, "channel": self.channel, "size": plain(self.size), "stderr": plain(self.stderr), "unit": self.unit,
            "rms_over_noise": plain(self.before), "rms_over_noise_without": plain(self.left), "text": self.sentence,
            "remedy": self.remedy, "effect": self.law or None, "certain": self.certain,
            "parameters": {name: plain(value) for name, value in self.parameters.items()},
        }  # fmt: skip
