"""A play too wide for a loose joint: what is said of a fit whose angles may have been degrees that were taken for radians.

The reader asks about a motion of more than a radian (`quantities`). Degrees that stay below it pass there, and
are known by the play that comes out.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import degrees
from typing import Any, Protocol

WIDE_RAD = 0.5
"""Play above which it is said: 29 degrees. The loosest joints that the package was tried on have a few degrees."""


class Fitted(Protocol):
    """What is asked of a fit: its parameters by name, its records, and whether its play is a length."""

    @property
    def parameters(self) -> Mapping[str, Any]: ...
    @property
    def records(self) -> Sequence[Any]: ...
    @property
    def translational(self) -> bool: ...


def wide_play(fit: Fitted) -> str:
    """The sentence, with the option for it; nothing where the play is narrower, is a length, or was not found."""
    play = fit.parameters.get("backlash")
    if fit.translational or play is None or play.value is None or not play.value > WIDE_RAD:
        return ""
    channels = fit.records[0].channels
    option = ",".join(f"{name}=deg" for name in ("x", "z", "y", "motor", "link") if name in channels)
    return (
        f"A play of {degrees(play.value):.3g} degrees is wide for a loose joint: if the angles of the file are in degrees, "
        f"pass --unit {option}."
    )
