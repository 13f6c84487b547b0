"""How a model's numbers are written for another simulator: with all their digits."""

from __future__ import annotations

from ..effects import Contact
from ..system import System


def number(value: float) -> str:
    """A number with as many digits as give it back."""
    return repr(float(value))


def edges(system: System) -> tuple[float, float]:
    """Lower and upper edge of the play [rad], both 0 of a plain spring."""
    if not isinstance(system.contact, Contact):
        return 0.0, 0.0
    low, high = system.edges(0.0)
    return float(low), float(high)
