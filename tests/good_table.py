"""The good text table that the tests of text tables dress up, and how they read it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from jaxbacklash.records.table import Table
from jaxbacklash.records.text import read_text

ROWS = 120
T = np.round(np.arange(ROWS) * 0.002, 6)
X = np.round(0.1 * np.sin(13 * T) - 0.01, 7)
Z = np.round(3e-4 * np.cos(29 * T), 9)
GOOD = {"t": T, "x": X, "z": Z}


def cells(mark: str = ".") -> list[list[str]]:
    """The rows of the good table as text."""
    return [[f"{value:.12g}".replace(".", mark) for value in row] for row in zip(T, X, Z, strict=True)]


def text(separator=",", mark=".", names=("t", "x", "z"), end="\n", quote="") -> str:
    """The good table."""
    head = [separator.join(names)] if names else []
    return end.join([*head, *(separator.join(f"{quote}{cell}{quote}" for cell in row) for row in cells(mark))]) + end


def read(folder: Path, content: str | bytes, name: str = "rec.csv", **options) -> Table:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return read_text(path, **options)


def assert_good(table: Table, names=("t", "x", "z"), places=(0, 1, 2)) -> None:
    """The three columns hold the good values to the last digit."""
    assert [table.columns[place].name for place in places] == list(names)
    for place, values in zip(places, GOOD.values(), strict=True):
        np.testing.assert_allclose(table.columns[place].values, values, rtol=1e-15, atol=0)


def put(number: int, line: str):
    """A change that puts a line before line ``number`` (from 1)."""
    return lambda lines: [*lines[: number - 1], line, *lines[number - 1 :]]
