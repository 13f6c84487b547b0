"""What both readers of MATLAB files return: the file's variables as a tree of structs."""

from __future__ import annotations

import dataclasses
from typing import Any

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


Tree = dict[str, Any]
"""Fields of a struct by name: arrays, text, structs (dict), arrays of structs and cells (list), `Instance` and `Unread`."""
