"""One table or figure of the paper made again: its numbers beside the paper's, a verdict, and the curves of its picture."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

REPRODUCED, IN_KIND, NOT = "reproduced", "reproduced in kind", "not reproduced"
DIGITS = 4
"""Significant digits that are kept of a curve: finer than a picture shows."""


@dataclass(frozen=True)
class Beside:
    """One quantity: what the paper prints (a number, words, or None where it prints nothing) beside what was found here."""

    what: str
    paper: float | str | None
    ours: float | str | None
    unit: str = ""


@dataclass(frozen=True)
class Item:
    """A table or a figure.

    Attributes
    ----------
    key : ``table_1`` or ``figure_02``, also the name of its files
    title : what it shows
    verdict : one of `REPRODUCED`, `IN_KIND`, `NOT`
    why : sentences: what was made, and why the verdict is this one
    beside : numbers, one row each
    disagrees : sentences about where the paper contradicts itself, or misprints
    curves : arrays by name, what the picture draws
    """

    key: str
    title: str
    verdict: str
    why: str
    beside: tuple[Beside, ...] = ()
    disagrees: tuple[str, ...] = ()
    curves: dict[str, np.ndarray] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """``Table 1``, ``Figure 2``."""
        kind, number = self.key.split("_")
        return f"{kind.capitalize()} {int(number)}"

    def write(self, folder: Path) -> Path:
        """As ``<key>.json`` in a folder; arrays take one line each and not-a-number becomes null."""
        told: dict[str, Any] = {
            "item": self.name, "title": self.title, "verdict": self.verdict, "why": self.why,
            "beside": [vars(row) for row in self.beside], "disagrees": list(self.disagrees),
        }  # fmt: skip
        text = json.dumps(told, indent=1, ensure_ascii=False, allow_nan=False)[:-2]
        rows = [f"  {json.dumps(name)}: {_as_text(values)}" for name, values in self.curves.items()]
        path = folder / f"{self.key}.json"
        path.write_text(text + ',\n "curves": {' + "\n" * bool(rows) + ",\n".join(rows) + "}\n}\n", encoding="utf-8")
        return path


def _as_text(values: np.ndarray) -> str:
    """An array with `DIGITS` significant digits, without spaces."""
    values = np.asarray(values)
    if values.dtype.kind in "iub":
        return json.dumps(values.tolist(), separators=(",", ":"))
    return json.dumps(_rounded(values.tolist()), separators=(",", ":"), allow_nan=False)


def _rounded(value: Any) -> Any:
    if isinstance(value, list):
        return [_rounded(part) for part in value]
    if value is None or not np.isfinite(value):
        return None
    short = float(f"{value:.{DIGITS}g}")
    return int(short) if short == int(short) else short


def read(path: Path) -> Item:
    """An item as `Item.write` left it."""
    told = json.loads(path.read_text(encoding="utf-8"))
    curves = {name: np.array(values, dtype=float) for name, values in told["curves"].items()}
    return Item(
        path.stem, told["title"], told["verdict"], told["why"], tuple(Beside(**row) for row in told["beside"]),
        tuple(told["disagrees"]), curves,
    )  # fmt: skip


def figures(value: float, digits: int = 4) -> float:
    """A number for a table, rounded to so many significant digits."""
    return float(f"{value:.{digits}g}")
