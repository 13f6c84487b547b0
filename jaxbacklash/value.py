"""A number with its error and unit, or the reason why there is none: what readings without a model give for each parameter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from .frames import known


@dataclass(frozen=True)
class Value:
    """One parameter in ``unit``; errors allow for correlated residuals. All are None, with a ``why``, where there is no value."""

    value: float | None
    stderr: float | None
    ci95: tuple[float, float] | None
    unit: str
    why: str = ""

    def as_json(self) -> dict[str, Any]:
        """The entry of result.json; a null value has its ``why``."""
        ends = None if self.ci95 is None else list(self.ci95)
        entry: dict[str, Any] = {"value": self.value, "stderr": self.stderr, "ci95": ends, "unit": self.unit}
        return entry | ({"why": self.why} if self.why else {})


def columns_of(values: Sequence[Value]) -> dict[str, Any]:
    """Values as columns of a table."""
    return {
        "value": known([one.value for one in values]), "stderr": known([one.stderr for one in values]),
        "low": known([None if one.ci95 is None else one.ci95[0] for one in values]),
        "high": known([None if one.ci95 is None else one.ci95[1] for one in values]),
        "unit": [one.unit for one in values], "why": [one.why for one in values],
    }  # fmt: skip
