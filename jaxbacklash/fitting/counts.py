"""An encoder whose counts are coarse beside the play: what counting adds is no noise, and no interval allows for it.

Within a count the reading stands still, so that its error goes with the place and does not average out. Noise before the counting
scatters it; where noise is less than a fraction of a count, play and stiffness of a few counts come out further off than their
standard errors say.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from ..parameters import channel_unit
from ..records import Record
from ..signals import count_of
from ..system import System
from .estimates import Estimate
from .settings import FEW_COUNTS, SCATTERED


class Fitted(Protocol):
    """A fit, as far as it says what was measured and which play was found; ``noise`` per record, of the observed channel."""

    @property
    def records(self) -> Sequence[Record]: ...
    @property
    def noise(self) -> Sequence[float]: ...
    @property
    def parameters(self) -> Mapping[str, Estimate]: ...
    @property
    def system(self) -> System: ...
    @property
    def translational(self) -> bool: ...


def few_counts(fit: Fitted) -> str:
    """What is said of a fit whose play is only a few counts; nothing where it is more, or noise scatters the readings."""
    play = fit.parameters.get("backlash")
    if play is None or play.value is None or fit.system.observed == "T":
        return ""
    for record, noise in zip(fit.records, fit.noise):
        name = record.observed_name
        count = count_of(record.channels[name])
        if count is None or noise > SCATTERED * count or not 0.0 < play.value < FEW_COUNTS * count:
            continue
        unit = channel_unit(name, translational=fit.translational)
        return (
            f"The play is only {play.value / count:.2g} counts of {count:.3g} {unit} in which {name} is read: intervals do not "
            "allow for what counting does, nor is a small effect sure."
        )
    return ""
