"""How each parameter goes from record to record, in numbers and in words: "the play has grown by 12 +- 2 % since record 40"."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any

import numpy as np

from ..fitting.estimates import number
from .change import Change, find_change
from .outlying import Outlier, find_outliers
from .scatter import excess_scatter, usable_errors
from .trend import Trend, find_trend

WORDS = {"backlash": "play"}
"""What a parameter is called in a sentence, where that is not its name."""
NAMED = 5
"""Records that stand out and are named."""


@dataclass(frozen=True)
class Course:
    """One parameter from record to record.

    Attributes: ``name``; ``unit``; ``numbers`` (M,) of the records that have it, counted from 1, with ``values`` and
    ``stderr`` (M,); ``trend`` and ``change`` over them, None of too few; ``joints``, names of the folders that the records are
    in, with ``differ`` those whose joint differs from the rest (empty where all are in one folder); ``outliers``, single records
    that stand out beside the change.
    """

    name: str
    unit: str
    numbers: np.ndarray
    values: np.ndarray
    stderr: np.ndarray
    trend: Trend | None
    change: Change | None
    joints: tuple[str, ...]
    differ: tuple[Outlier, ...]
    outliers: tuple[Outlier, ...]

    @property
    def word(self) -> str:
        """What the parameter is called in a sentence."""
        return WORDS.get(self.name, self.name)

    @property
    def changed(self) -> bool:
        """Whether a change is claimed."""
        return self.change is not None and self.change.claimed

    def __str__(self) -> str:
        return " ".join(self.sentences())

    def sentences(self) -> list[str]:
        """What there is to say, the mean first."""
        if not self.values.size:
            return [f"The {self.word} was found in no record."]
        said = [self._level()]
        if self.joints:
            return said + self._joints()
        if self.change is None:
            return [*said, "There are too few records to tell a change from chance."]
        if self.changed:
            said.append(self._change(self.change))
        elif self.trend is not None and self.trend.claimed:
            said.append(self._trend(self.trend))
        else:
            said.append(f"Nothing speaks of a change (p = {self.change.p_value:.2g}).")
        if self.outliers:
            said.append(f"Standing out: {self._listed(self.outliers, [f'record {n}' for n in self.numbers])}.")
        return said

    def _level(self) -> str:
        variances = self.stderr**2
        square = excess_scatter(self.values, variances)
        weights = 1.0 / (variances + square)
        mean, error = float(np.sum(weights * self.values) / np.sum(weights)), float(1.0 / np.sqrt(np.sum(weights)))
        unit = "" if self.unit == "1" else f" {self.unit}"
        # A scatter is told where it is no smaller than what single records are uncertain by.
        beside = f", scattering by {np.sqrt(square):.2g}{unit} between records" if square > np.median(variances) else ""
        return f"{self.word}: {number(mean, error)} +- {error:.2g}{unit} in {self.values.size} records{beside}."

    def _change(self, change: Change) -> str:
        numbers = self.numbers
        verb = "grown" if change.growth > 0.0 else "fallen"
        first, last = numbers[change.between[0]], numbers[change.between[1]]
        where = "" if first == last else f" (between {first} and {last})"
        return (
            f"The {self.word} has {verb} by {_percent(abs(change.growth), change.growth_half)} since record "
            f"{numbers[change.at]}{where}; chance makes as much with p = {change.p_value:.2g}."
        )

    def _trend(self, trend: Trend) -> str:
        per = 100.0 * abs(trend.level) / 100.0
        verb = "grows" if trend.slope > 0.0 else "falls"
        half = 0.5 * (trend.high - trend.low)
        return f"The {self.word} {verb} by {_percent(100.0 * abs(trend.slope) / per, 100.0 * half / per)} in a hundred records."

    def _joints(self) -> list[str]:
        if not self.differ:
            return [f"None of the {len(self.joints)} joints differs from the others."]
        return [f"Of {len(self.joints)} joints differ from the others: {self._listed(self.differ, self.joints)}."]

    def _listed(self, found: tuple[Outlier, ...], names: Any) -> str:
        told = [f"{names[one.index]} ({one.apart * 100:+.2g} +- {one.half * 100:.2g} %)" for one in found[:NAMED]]
        return ", ".join(told) + (f" and {len(found) - NAMED} more" if len(found) > NAMED else "")

    def as_json(self) -> dict[str, Any]:
        """All of it as plain data."""
        return {
            "unit": self.unit, "records": int(self.values.size), "text": str(self),
            "trend": None if self.trend is None else vars(self.trend) | {"claimed": self.trend.claimed},
            "change": None if self.change is None else self._change_json(self.change),
            "joints": [
                {"joint": self.joints[one.index], "apart_percent": 100 * one.apart, "ci95_half_percent": 100 * one.half}
                for one in self.differ
            ],
            "outliers": [
                {"record": int(self.numbers[one.index]), "apart_percent": 100 * one.apart, "ci95_half_percent": 100 * one.half}
                for one in self.outliers
            ],
        }  # fmt: skip

    def _change_json(self, change: Change) -> dict[str, Any]:
        return {
            "record": int(self.numbers[change.at]),
            "record_between": [int(self.numbers[k]) for k in change.between],
            "before": change.before, "after": change.after, "before_stderr": change.before_stderr,
            "after_stderr": change.after_stderr, "growth_percent": _or_none(100 * change.growth),
            "growth_ci95_half_percent": _or_none(100 * change.growth_half), "p_value": change.p_value, "claimed": change.claimed,
        }  # fmt: skip


def course_of(name: str, unit: str, values: np.ndarray, errors: np.ndarray, records: Sequence[str]) -> Course:
    """How a parameter goes from record to record.

    Parameters
    ----------
    name, unit : of the parameter
    values, errors : (N,) estimates and their standard errors, NaN where there is none
    records : paths of the records; where they are in several folders, each folder is a joint
    """
    there = np.flatnonzero(np.isfinite(values))
    folders = [str(PurePath(path).parent) for path in records]
    values = values[there]
    variances = usable_errors(errors[there], values)
    own = [folders[k] for k in there]
    joints = tuple(dict.fromkeys(own))
    differ: tuple[Outlier, ...] = ()
    if len(joints) > 1:
        differ = tuple(find_outliers(*_by_joint(values, variances, own, joints)))
    change = find_change(values, variances)
    beside = values.copy()
    if change is not None and change.claimed:  # what stands out does so beside the change
        beside[change.at :] *= change.before / change.after
    return Course(
        name, unit, there + 1, values, np.sqrt(variances), find_trend(there + 1.0, values, variances), change,
        joints if len(joints) > 1 else (), differ, tuple(find_outliers(beside, variances)),
    )  # fmt: skip


def _by_joint(
    values: np.ndarray, variances: np.ndarray, own: list[str], joints: tuple[str, ...]
) -> tuple[np.ndarray, np.ndarray]:
    """The mean of each joint's records, and its variance with their scatter."""
    means, squares = [], []
    for joint in joints:
        at = np.array([k for k, other in enumerate(own) if other == joint])
        weights = 1.0 / (variances[at] + excess_scatter(values[at], variances[at]))
        means.append(float(np.sum(weights * values[at]) / np.sum(weights)))
        squares.append(float(1.0 / np.sum(weights)))
    return np.array(means), np.array(squares)


def _percent(share: float, half: float) -> str:
    if not np.isfinite([share, half]).all() or half <= 0.0:
        return f"{100 * share:.3g} %"
    decimals = max(0, int(-np.floor(np.log10(100.0 * half))) + (1 if 100.0 * half < 1.0 else 0))
    return f"{100 * share:.{decimals}f} +- {100 * half:.{decimals}f} %"


def _or_none(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
