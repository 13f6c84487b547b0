"""What both readers of MATLAB files return: the file's variables as a tree of structs."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

MAX_DEPTH = 32
"""Structs are followed this deep."""


@dataclasses.dataclass(frozen=True)
class Instance:
    """A value of a MATLAB class that could not be read, by the name of its class."""

    kind: str


@dataclasses.dataclass(frozen=True)
class Unread:
    """A value that is no column, by the words for it in a sentence."""

    found: str


@dataclasses.dataclass(frozen=True)
class Measured:
    """A column (N,) of a table that has units."""

    values: np.ndarray
    unit: str


Tree = dict[str, Any]
"""Fields of a struct by name: arrays, text, structs (dict), arrays of structs and cells (list), `Measured`, `Instance` and
`Unread`."""


def has_instances(value: Any) -> bool:
    """Whether a value of a class stands anywhere below."""
    if isinstance(value, dict):
        return any(map(has_instances, value.values()))
    return isinstance(value, Instance) or (isinstance(value, list) and any(map(has_instances, value)))
